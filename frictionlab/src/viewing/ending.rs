//! Work that a viewer may end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::{Value, json};
use view::{Access, Service};

/// What ends the work.
const STOP: &str = "/rig_driver/emergency_stop";
/// The same, as experiments know it.
const ABORT: &str = "/experiment_runner/abort";

/// The wish to end, of a viewer or of whoever started the work.
pub(super) struct Ending {
    stop: Arc<AtomicBool>,
    /// A viewer's wish.
    by_viewer: AtomicBool,
    /// The work is over: nothing is driven any more.
    over: AtomicBool,
}

impl Ending {
    /// Of work that ends once `stop` is set.
    pub(super) fn new(stop: &Arc<AtomicBool>) -> Self {
        let stop = Arc::clone(stop);
        Self { stop, by_viewer: AtomicBool::new(false), over: AtomicBool::new(false) }
    }

    /// Both services.
    pub(super) fn services() -> Vec<Service> {
        let service = |name: &str, stops| Service {
            name: name.to_owned(),
            kind: "std_srvs/srv/Trigger".to_owned(),
            request: json!({}),
            response: json!({ "success": true, "message": "" }),
            access: Access::Full,
            stops,
        };
        vec![service(STOP, true), service(ABORT, true)]
    }

    /// Calls one of them; none for another name.
    pub(super) fn call(&self, service: &str) -> Option<Value> {
        if service != STOP && service != ABORT {
            return None;
        }
        if self.over.load(Ordering::SeqCst) {
            let message = "nothing is driven any more: the work is over";
            return Some(json!({ "success": true, "message": message }));
        }
        self.by_viewer.store(true, Ordering::SeqCst);
        self.stop.store(true, Ordering::SeqCst);
        let message = "the run ends, and with it the motor's voltage; what was measured is kept";
        Some(json!({ "success": true, "message": message }))
    }

    /// The work is over. The flag is whoever's who started it from now on.
    pub(super) fn over(&self) {
        self.over.store(true, Ordering::SeqCst);
        if self.by_viewer.swap(false, Ordering::SeqCst) {
            self.stop.store(false, Ordering::SeqCst);
        }
    }

    /// Whether it is to end.
    pub(super) fn is_wished(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_viewer_ends_the_work_and_not_what_comes_after_it() {
        let stop = Arc::new(AtomicBool::new(false));
        let ending = Ending::new(&stop);
        assert!(ending.call("/rig_driver/clear_fault").is_none());
        assert!(!ending.is_wished());
        assert_eq!(ending.call(STOP).unwrap()["success"], true);
        assert!(ending.is_wished());
        ending.over();
        assert!(!ending.is_wished());
        assert!(ending.call(ABORT).unwrap()["message"].as_str().unwrap().contains("over"));
        assert!(!ending.is_wished());
        // Ctrl-C.
        stop.store(true, Ordering::SeqCst);
        ending.over();
        assert!(ending.is_wished());
    }
}
