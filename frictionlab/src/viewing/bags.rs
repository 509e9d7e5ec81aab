//! A view of work that writes a bag and has no nodes: `run`, `commission`.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use msgs::friction_msgs::ExperimentStatus;
use msgs::std_msgs::Header;
use msgs::{cdr, topics};
use serde_json::{Value, json};
use view::{Access, ChannelId, Hub, Service, Steering, View, ViewError, ViewOptions};
use work::progress::Progress;

use super::clock::now_ns;
use super::topics::known;
use super::words::words;

/// Cycles that are shown within a second: a simulated rig may be far quicker than time.
const CYCLES: u32 = 2000;
/// How often viewers are told how far the work is.
const TOLD: Duration = Duration::from_millis(250);
/// What ends the work.
const STOP: &str = "/rig_driver/emergency_stop";
/// The same, as experiments know it.
const ABORT: &str = "/experiment_runner/abort";

/// A view of what is written into bags. Dropped, it ends.
pub struct BagsView {
    view: Option<View>,
    over: Arc<AtomicBool>,
    telling: Option<JoinHandle<()>>,
}

impl BagsView {
    /// Opens a view of work called `name` that sets `stop` when a viewer wants it to end.
    ///
    /// # Errors
    /// [`ViewError`] if the port is taken or the system refuses.
    pub fn open(
        options: &ViewOptions,
        name: &str,
        stop: &Arc<AtomicBool>,
        progress: &Progress,
    ) -> Result<Self, ViewError> {
        let hub = Hub::default();
        let channels: BTreeMap<String, ChannelId> = known()
            .into_iter()
            .map(|channel| (channel.topic.clone(), hub.offer(channel)))
            .collect();
        let status = channels.get(topics::EXPERIMENT_STATUS.name).copied();
        let view = View::start(options, hub.clone(), Arc::new(Ending(Arc::clone(stop))))?;
        let pace = Mutex::new(Pace::default());
        let heard = hub.clone();
        recording::bag::listen(Box::new(move |topic, stamp_ns, bytes| {
            let Some(channel) = channels.get(topic) else { return };
            let shown = heard.viewers() > 0
                && pace.lock().unwrap_or_else(PoisonError::into_inner).shows(stamp_ns);
            if shown {
                heard.publish(*channel, stamp_ns, bytes);
            }
        }));
        let over = Arc::new(AtomicBool::new(false));
        let (ends, progress, name) = (Arc::clone(&over), progress.clone(), name.to_owned());
        let tell = move || {
            while !ends.load(Ordering::Acquire) {
                hub.time(now_ns());
                if let Some(status) = status {
                    tell(&hub, status, &name, &progress);
                }
                thread::park_timeout(TOLD);
            }
        };
        let telling = thread::Builder::new().name("view progress".into()).spawn(tell);
        let telling = Some(telling.map_err(ViewError::System)?);
        Ok(Self { view: Some(view), over, telling })
    }

    /// Where it is, in words for people.
    #[must_use]
    pub fn words(&self) -> String {
        self.view.as_ref().map(words).unwrap_or_default()
    }
}

impl Drop for BagsView {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Release);
        if let Some(telling) = self.telling.take() {
            telling.thread().unpark();
            let _ = telling.join();
        }
    }
}

fn tell(hub: &Hub, channel: ChannelId, name: &str, progress: &Progress) {
    let now = now_ns();
    let status = ExperimentStatus {
        header: Header::at(now),
        experiment: name.to_owned(),
        stage: progress.message(),
        progress: progress.fraction(),
        remaining: f64::NAN,
        ..ExperimentStatus::default()
    };
    if let Ok(bytes) = cdr::encode(&status) {
        hub.publish(channel, now, &bytes);
    }
}

/// Which cycles are shown.
#[derive(Default)]
struct Pace {
    began: Option<Instant>,
    shown: u32,
    stamp_ns: u64,
    shows: bool,
}

impl Pace {
    /// Whether messages of that time are: all of a cycle or none.
    fn shows(&mut self, stamp_ns: u64) -> bool {
        if stamp_ns == self.stamp_ns {
            return self.shows;
        }
        self.stamp_ns = stamp_ns;
        if self.began.is_none_or(|began| began.elapsed() >= Duration::from_secs(1)) {
            (self.began, self.shown) = (Some(Instant::now()), 0);
        }
        self.shows = self.shown < CYCLES;
        self.shown += u32::from(self.shows);
        self.shows
    }
}

/// All that can be asked of such work is to end.
struct Ending(Arc<AtomicBool>);

impl Steering for Ending {
    fn services(&self) -> Vec<Service> {
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

    fn call(&self, service: &str, _: Value) -> Result<Value, String> {
        if service != STOP && service != ABORT {
            return Err(format!("there is no service {service}"));
        }
        self.0.store(true, Ordering::SeqCst);
        let message = "the run ends, and with it the motor's voltage; what was measured is kept";
        Ok(json!({ "success": true, "message": message }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_is_shown_whole_or_not_at_all() {
        let mut pace = Pace::default();
        for stamp in 0..u64::from(CYCLES) + 100 {
            let shown = pace.shows(stamp + 1);
            assert_eq!(shown, pace.shows(stamp + 1));
            if pace.began.is_some_and(|began| began.elapsed() < Duration::from_millis(900)) {
                assert_eq!(shown, stamp < u64::from(CYCLES));
            }
        }
    }
}
