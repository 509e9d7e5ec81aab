//! A node that answers and leaves cleanly.

mod graph;
mod services;
mod topics;

use std::future::Future;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use msgs::topics::Qos;
use msgs::type_description_interfaces::GetTypeDescription;
use ros2_client::qos::{Durability, History, QosProfile, WhenFull};
use ros2_client::{Name, Node, NodeName, NodeOptions};
use tokio::task::JoinHandle;

pub use self::topics::Sent;
use crate::apart::Apart;
use crate::hearing::Hearers;
use crate::shared::Shared;
use crate::types::{self, Types};
use crate::{Logger, Named, NodeClock, NodeIdentity, RosNodeError, logger, rmw};

/// How long a leaving node waits for its background work.
const LEAVING: Duration = Duration::from_secs(1);

/// The client library's node, while it is there.
type Slot = Arc<Mutex<Option<Node>>>;

/// A node of the ROS graph. Dropped, it takes its name off the graph.
pub struct RosNode {
    identity: NodeIdentity,
    clock: NodeClock,
    logger: Logger,
    /// `None` only while it is being dropped.
    node: Slot,
    tasks: Mutex<Vec<JoinHandle<()>>>,
    /// What has a thread of its own.
    apart: Mutex<Vec<Apart>>,
    /// What its endpoints carry.
    types: Arc<Types>,
    /// When it began \[ns since the epoch\].
    began: u64,
    shared: Arc<Shared>,
}

impl RosNode {
    pub(crate) fn start(shared: Arc<Shared>, name: &str) -> Result<Self, RosNodeError> {
        let error =
            |detail: String| RosNodeError::Create { what: format!("the node /{name}"), detail };
        let arguments = &shared.arguments;
        let identity =
            arguments.remaps.node(name, arguments.namespace.as_deref().unwrap_or("/"))?;
        let node_name =
            NodeName::new(&identity.namespace, &identity.name).map_err(|e| error(e.to_string()))?;
        // Without a spinner: it would listen to `/clock` with a type that is not the clock's, and
        // only serves the client's own parameters, in whose place stand those of this crate.
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let mut node =
            shared.context.new_node(node_name, options).map_err(|e| error(e.to_string()))?;
        let rosout = (!arguments.rosout_disabled).then(|| logger::rosout(&mut node));
        let rosout = rosout.transpose().map_err(|detail| RosNodeError::Create {
            what: "a publisher on /rosout".into(),
            detail,
        })?;
        let clock = NodeClock::default();
        let logger = Logger::new(
            identity.logger(),
            arguments.level_of(&identity.logger()),
            !arguments.terminal_disabled,
            clock.clone(),
            rosout,
            shared.ears.clone(),
        );
        for argument in &arguments.ignored {
            logger.warn(&format!(
                "`{argument}` changes nothing: log lines go to the terminal and to /rosout, not to files; --log-level says which"
            ));
        }
        let began = u64::try_from(since_epoch().as_nanos()).unwrap_or(u64::MAX);
        if shared.open.swap(false, Ordering::Relaxed) {
            logger.warn(
                "ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET: anybody on the network can command this process's nodes; LOCALHOST keeps them to this machine",
            );
        }
        if !shared.rmw_is_told.swap(true, Ordering::Relaxed) {
            match rmw::said() {
                None => {}
                Some(rmw::Said::Fine(said)) => logger.debug(&said),
                Some(rmw::Said::Warning(said)) => logger.warn(&said),
            }
        }
        let (node, tasks, apart) =
            (Arc::new(Mutex::new(Some(node))), Mutex::default(), Mutex::default());
        let types = Arc::<Types>::default();
        if !shared.arguments.rosout_disabled {
            types.uses_named("rcl_interfaces/msg/Log");
        }
        let node = Self { identity, clock, logger, node, tasks, apart, types, began, shared };
        node.describe_types();
        Ok(node)
    }

    /// Tells whoever asks what the types of its endpoints are.
    fn describe_types(&self) {
        if self.given(types::WANTED) == Some(crate::ParameterValue::Boolean(false)) {
            return;
        }
        let types = Arc::clone(&self.types);
        let serving =
            self.serve::<GetTypeDescription>(types::SERVICE, move |asked| types.answer(&asked));
        // It is not worth the node: permissions that were signed before may not know it.
        if let Err(error) = serving {
            self.logger.warn(&format!("nobody is told of the types of this node: {error}"));
        }
    }

    /// Name of the node, without its namespace.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.identity.name
    }

    /// Name and namespace.
    #[must_use]
    pub fn identity(&self) -> &NodeIdentity {
        &self.identity
    }

    /// The node's log.
    #[must_use]
    pub fn logger(&self) -> &Logger {
        &self.logger
    }

    /// The node's time.
    #[must_use]
    pub fn clock(&self) -> &NodeClock {
        &self.clock
    }

    /// What the command line gives for a parameter of this node.
    #[must_use]
    pub fn given(&self, parameter: &str) -> Option<crate::ParameterValue> {
        self.arguments().overrides(&self.identity.qualified()).remove(parameter)
    }

    /// Names of all parameters that the command line gives to this node.
    #[must_use]
    pub fn given_names(&self) -> Vec<String> {
        self.arguments().overrides(&self.identity.qualified()).into_keys().collect()
    }

    /// State in which the managed node of this process's life before ended; zero in the first.
    pub(crate) fn last_phase(&self) -> Arc<AtomicU8> {
        let mut all = self.shared.last_phases.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(all.entry(self.identity.qualified()).or_default())
    }

    /// What the command line says.
    pub(crate) fn arguments(&self) -> &crate::Arguments {
        &self.shared.arguments
    }

    /// The absolute name of a topic or service that the code calls `name`: relative names lie in
    /// the node's namespace, then the command line's remappings apply.
    ///
    /// # Errors
    /// [`RosNodeError::Name`] if it is none.
    pub fn resolve(&self, named: Named, name: &str) -> Result<String, RosNodeError> {
        self.shared.arguments.remaps.resolve(&self.identity, named, name)
    }

    fn with_node<T>(
        &self,
        what: &str,
        name: &str,
        make: impl FnOnce(&mut Node) -> Result<T, String>,
    ) -> Result<T, RosNodeError> {
        with(&self.node, what, name, make)
    }

    /// Who of the others hears what.
    pub(crate) fn hearers(&self) -> Arc<Hearers> {
        Arc::clone(&self.shared.hearers)
    }

    pub(crate) fn spawn(&self, task: impl Future<Output = ()> + Send + 'static) {
        let handle = self.shared.runtime.spawn(task);
        self.tasks.lock().unwrap_or_else(PoisonError::into_inner).push(handle);
    }
}

impl Drop for RosNode {
    fn drop(&mut self) {
        // What runs in the background holds readers and writers: it goes first, then the node takes
        // its name off the graph.
        let tasks = std::mem::take(&mut *self.tasks.lock().unwrap_or_else(PoisonError::into_inner));
        tasks.iter().for_each(JoinHandle::abort);
        let mut apart =
            std::mem::take(&mut *self.apart.lock().unwrap_or_else(PoisonError::into_inner));
        apart.iter_mut().for_each(Apart::end);
        // Not by the runtime's clock: it stands still if all of its threads are stuck.
        let began = Instant::now();
        while !tasks.iter().all(JoinHandle::is_finished) && began.elapsed() < LEAVING {
            thread::sleep(Duration::from_millis(1));
        }
        apart.into_iter().for_each(|apart| apart.join(LEAVING));
        self.shared.lagging.leaves(&self.logger);
        self.logger.leave();
        drop(self.node.lock().unwrap_or_else(PoisonError::into_inner).take());
    }
}

/// Makes something of a node that is not leaving.
fn with<T>(
    node: &Slot,
    what: &str,
    name: &str,
    make: impl FnOnce(&mut Node) -> Result<T, String>,
) -> Result<T, RosNodeError> {
    let error = |detail: String| RosNodeError::Create { what: format!("{what} on {name}"), detail };
    let mut node = node.lock().unwrap_or_else(PoisonError::into_inner);
    make(node.as_mut().ok_or_else(|| error("the node is leaving".into()))?).map_err(error)
}

fn since_epoch() -> Duration {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default()
}

fn parse(name: &str) -> Result<Name, String> {
    Name::parse(name).map_err(|e| e.to_string())
}

fn profile(qos: Qos) -> QosProfile {
    let durability =
        if qos.transient_local { Durability::TransientLocal } else { Durability::Volatile };
    // A reader that does not keep up may cost the publishing thread a moment, not a tenth of a
    // second as by default.
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Wait(Duration::from_millis(5)))
        .durability(durability)
        .history(History::KeepLast { depth: qos.depth as usize })
}
