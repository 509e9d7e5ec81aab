//! A view of running nodes.

use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use ros_node::parameters::Parameters;
use ros_node::{Participant, RosNodeError};
use view::{Hub, View, ViewError, ViewOptions};
use work::BadInput;

pub use super::asking::Join;
use super::asking::{Asking, Publishing};
use super::channels::{self, Heard};
use super::clock::now_ns;
use super::commissioning::requested;
use super::paper::Paper;
use super::services;
use super::settings::Settings;
use super::shelf::{Shelf, WithShelf};
use super::words::words;

/// How often the nodes are asked for their parameters.
const AGAIN: Duration = Duration::from_secs(1);
/// How often viewers are told the time, and how a commission stands.
const TOLD: Duration = Duration::from_millis(250);

/// What a view shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shown {
    /// Whose messages.
    pub heard: Heard,
    /// `/experiment_runner` takes requests.
    pub experiments: bool,
    /// `/reference` has the parameters of the reference.
    pub reference: bool,
}

/// A view with the node through which it asks, `/view`. Dropped, it ends.
pub struct NodesView {
    /// Goes first: nobody asks any more.
    view: Option<View>,
    poke: Option<Sender<()>>,
    watching: Vec<JoinHandle<()>>,
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

/// A view that cannot be opened, as the command tells it.
#[must_use]
pub fn refused(error: NodesViewError) -> anyhow::Error {
    if error.is_bad_input() { BadInput(error.to_string()).into() } else { error.into() }
}

impl NodesView {
    /// Opens a view of nodes that this participant hears. `join` joins the network once more, for
    /// what people at a page say themselves.
    ///
    /// # Errors
    /// [`NodesViewError`] if the port is taken, or the middleware or the system refuses.
    pub fn open(
        options: &ViewOptions,
        participant: &Participant,
        (shown, shelf): (Shown, Arc<Shelf>),
        join: Join,
    ) -> Result<Self, NodesViewError> {
        let hub = Hub::default();
        let node = Arc::new(participant.node("view")?);
        Parameters::usual(&node)?;
        channels::open(participant, &node, &hub, shown.heard)?;
        let mut names = vec!["rig_driver", "friction_observer", "controller"];
        names.extend(shown.reference.then_some("reference"));
        let settings = Arc::new(Settings::new(&node, &names, &hub, shown.heard)?);
        let (poke, poked) = channel();
        let asking = Asking {
            offers: services::all(&node, shown.experiments)?,
            settings: Arc::clone(&settings),
            publishing: Publishing::new(node, join),
            poke: Mutex::new(poke.clone()),
        };
        // On a secured network the view steers with this process's own key.
        let secured = participant.enclave().is_some();
        let options = ViewOptions { token: options.token || secured, ..options.clone() };
        let view = View::start(
            &options,
            hub.clone(),
            Arc::new(WithShelf { asked: Arc::new(asking), shelf }),
        )?;
        let mut opened = Self { view: Some(view), poke: Some(poke), watching: Vec::new() };
        let (ends, ended) = channel::<()>();
        let told = hub.clone();
        opened.watch("view settings", move || {
            // The last sender goes with the view, and `ends` with this thread.
            let _ends = ends;
            while !matches!(poked.recv_timeout(AGAIN), Err(RecvTimeoutError::Disconnected)) {
                while poked.try_recv().is_ok() {}
                if hub.viewers() > 0 {
                    settings.refresh();
                }
            }
        })?;
        let mut paper = Paper::new(&told);
        opened.watch("view time", move || {
            while !matches!(ended.recv_timeout(TOLD), Err(RecvTimeoutError::Disconnected)) {
                told.time(now_ns());
                if let Some(standing) = requested() {
                    paper.tell(&standing);
                }
            }
        })?;
        Ok(opened)
    }

    fn watch(
        &mut self,
        name: &str,
        run: impl FnOnce() + Send + 'static,
    ) -> Result<(), NodesViewError> {
        let thread = thread::Builder::new().name(name.to_owned()).spawn(run);
        self.watching.push(thread.map_err(NodesViewError::Thread)?);
        Ok(())
    }

    /// Where it is, in words for people.
    #[must_use]
    pub fn words(&self) -> String {
        self.view.as_ref().map(words).unwrap_or_default()
    }
}

impl Drop for NodesView {
    fn drop(&mut self) {
        drop(self.view.take());
        drop(self.poke.take());
        for thread in self.watching.drain(..) {
            let _ = thread.join();
        }
    }
}
