//! The view of work that begins and ends: the server, what tells viewers how far it is, and the
//! time in which they look at what came of it.

use std::io::{self, IsTerminal};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use view::{Hub, Steering, View, ViewError, ViewOptions};

use super::clock::now_ns;
use super::ending::Ending;
use super::words::words;

/// How often viewers are told how far the work is.
const TOLD: Duration = Duration::from_millis(250);
/// How often it is looked whether the view may end.
const LOOKED: Duration = Duration::from_millis(100);
/// Where nobody sits at a terminal, the view ends so long after the last viewer has left.
const ALONE: Duration = Duration::from_secs(5);

/// A view of work. Dropped, it ends.
pub(super) struct WorkView {
    view: Option<View>,
    ending: Arc<Ending>,
    over: Arc<AtomicBool>,
    telling: Option<JoinHandle<()>>,
}

impl WorkView {
    /// Opens it; `tell` is called now and then to tell viewers how far the work is.
    ///
    /// # Errors
    /// [`ViewError`] if the port is taken or the system refuses.
    pub(super) fn open(
        options: &ViewOptions,
        hub: &Hub,
        (steering, ending): (Arc<dyn Steering>, Arc<Ending>),
        mut tell: impl FnMut() + Send + 'static,
    ) -> Result<Self, ViewError> {
        let view = View::start(options, hub.clone(), steering)?;
        let over = Arc::new(AtomicBool::new(false));
        let (ends, hub) = (Arc::clone(&over), hub.clone());
        let telling = move || {
            while !ends.load(Ordering::Acquire) {
                hub.time(now_ns());
                tell();
                thread::park_timeout(TOLD);
            }
        };
        let telling = thread::Builder::new().name("view progress".into()).spawn(telling);
        let telling = Some(telling.map_err(ViewError::System)?);
        Ok(Self { view: Some(view), ending, over, telling })
    }

    /// Where it is, in words for people.
    pub(super) fn words(&self) -> String {
        self.view.as_ref().map(words).unwrap_or_default()
    }

    /// Has viewers told at once.
    pub(super) fn poke(&self) {
        if let Some(telling) = &self.telling {
            telling.thread().unpark();
        }
    }

    /// The work is over: whoever looks may go on looking. It waits until ctrl-C where somebody sits
    /// at a terminal, else until the last viewer has left; not at all where there was none, or where
    /// ctrl-C ended the work.
    pub(super) fn stay(&self, quiet: bool) {
        self.ending.over();
        self.poke();
        let Some(view) = &self.view else { return };
        let terminal = io::stderr().is_terminal();
        let mut seen = (view.hub().viewers() > 0).then(Instant::now);
        if self.ending.is_wished() || !terminal && seen.is_none() {
            return;
        }
        if !quiet {
            let until = if terminal { "until ctrl-C" } else { "until it is closed" };
            eprintln!("the view stays {until}: {}", view.urls().0.split('#').next().unwrap_or(""));
        }
        while !self.ending.is_wished() {
            if view.hub().viewers() > 0 {
                seen = Some(Instant::now());
            }
            if !terminal && seen.is_none_or(|seen| seen.elapsed() > ALONE) {
                return;
            }
            thread::sleep(LOOKED);
        }
    }
}

impl Drop for WorkView {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Release);
        if let Some(telling) = self.telling.take() {
            telling.thread().unpark();
            // It panicked where this is an error; the work goes on without it.
            let _ = telling.join();
        }
    }
}
