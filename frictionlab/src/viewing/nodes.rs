//! A view of the nodes of this process.

use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use ros_node::parameters::Parameters;
use ros_node::{Participant, RosNodeError};
use view::{Hub, View, ViewError, ViewOptions};

use super::asking::{Asking, Join, Publishing};
use super::settings::{Settings, now_ns};
use super::{channels, services};

/// How often the nodes are asked for their parameters.
const AGAIN: Duration = Duration::from_secs(1);

/// A view with the node through which it asks, `/view`. Dropped, it ends.
pub struct NodesView {
    /// Goes first: nobody asks any more.
    view: Option<View>,
    poke: Option<Sender<()>>,
    watching: Option<JoinHandle<()>>,
}

/// What keeps a view from opening.
#[derive(Debug, thiserror::Error)]
pub enum NodesViewError {
    /// The server.
    #[error(transparent)]
    View(#[from] ViewError),
    /// The node.
    #[error(transparent)]
    Ros(#[from] RosNodeError),
    /// The thread.
    #[error("a thread for the view cannot be started: {0}")]
    Thread(std::io::Error),
}

impl NodesViewError {
    /// Whether the user can mend it: a port, an address, an environment variable.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::View(error) => error.is_bad_input(),
            Self::Ros(error) => error.is_bad_input(),
            Self::Thread(_) => false,
        }
    }
}

impl NodesView {
    /// Opens a view of the nodes of this participant; with `experiments`, of `/experiment_runner`
    /// too. `join` joins the network once more, for what people at a page say themselves.
    ///
    /// # Errors
    /// [`NodesViewError`] if the port is taken, or the middleware or the system refuses.
    pub fn open(
        options: &ViewOptions,
        participant: &Participant,
        experiments: bool,
        join: Join,
    ) -> Result<Self, NodesViewError> {
        let hub = Hub::default();
        let node = Arc::new(participant.node("view")?);
        Parameters::usual(&node)?;
        channels::open(participant, &node, &hub)?;
        let names = ["rig_driver", "friction_observer", "controller"];
        let settings = Arc::new(Settings::new(&node, &names, &hub)?);
        let (poke, poked) = channel();
        let asking = Asking {
            offers: services::all(&node, experiments)?,
            settings: Arc::clone(&settings),
            publishing: Publishing::new(node, join),
            poke: Mutex::new(poke.clone()),
        };
        let view = View::start(options, hub.clone(), Arc::new(asking))?;
        let watch = move || {
            // The last sender goes with the view.
            while !matches!(poked.recv_timeout(AGAIN), Err(RecvTimeoutError::Disconnected)) {
                while poked.try_recv().is_ok() {}
                hub.time(now_ns());
                if hub.viewers() > 0 {
                    settings.refresh();
                }
            }
        };
        let watching = thread::Builder::new().name("view settings".into()).spawn(watch);
        let watching = Some(watching.map_err(NodesViewError::Thread)?);
        Ok(Self { view: Some(view), poke: Some(poke), watching })
    }

    /// Where it is, in words for people.
    #[must_use]
    pub fn words(&self) -> String {
        self.view.as_ref().map(super::words).unwrap_or_default()
    }
}

impl Drop for NodesView {
    fn drop(&mut self) {
        drop(self.view.take());
        drop(self.poke.take());
        if let Some(watching) = self.watching.take() {
            let _ = watching.join();
        }
    }
}
