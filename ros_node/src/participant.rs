//! The process on the network.

use std::{
    collections::BTreeMap,
    ops::Deref,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU8},
    },
    time::Duration,
};

use ros2_client::Context;
use rustdds::DomainParticipantBuilder;
use tokio::runtime::{Builder, Runtime};

use crate::{
    Arguments, Discovery, Graph, RosNode, RosNodeError,
    apart::Apart,
    hearing::Hearers,
    lagging::Lagging,
    middleware::{self, Leave},
    scope::Scope,
    security::{self, Enclave, Others, Prefix, Protection},
    terminal,
    turn::Turn,
};

/// Longest wait for what follows the participant's events to end.
const LEAVING: Duration = Duration::from_secs(1);

/// One process's place on the network, shared by its nodes. It leaves when the last of them and
/// this are dropped.
pub struct Participant {
    shared: Arc<Shared>,
}

/// States in which the managed nodes of a process were last, by their absolute names.
pub(crate) type LastPhases = Mutex<BTreeMap<String, Arc<AtomicU8>>>;

/// What participant and nodes hold together. The fields are dropped in this order: the runtime
/// last, so that nothing runs on a participant that is gone.
pub(crate) struct Shared {
    pub(crate) context: Context,
    pub(crate) runtime: Workers,
    pub(crate) arguments: Arguments,
    /// Who can hear the answers of the nodes' services.
    pub(crate) hearers: Arc<Hearers>,
    /// Hears of others, apart: answers wait for it. `None` only while this is being dropped.
    following: Option<Apart>,
    /// Subscribers that do not keep up.
    pub(crate) lagging: Arc<Lagging>,
    /// Who else is there; it is filled once somebody wants to know.
    pub(crate) graph: Graph,
    pub(crate) graph_is_watched: AtomicBool,
    /// Of the life before; empty in the first.
    pub(crate) last_phases: Arc<LastPhases>,
    protection: Protection,
    others: Arc<Others>,
    /// Anybody on the network can command the nodes, and nobody has been told.
    pub(crate) open: AtomicBool,
    /// A node has said what it makes of `RMW_IMPLEMENTATION`.
    pub(crate) rmw_is_told: AtomicBool,
    /// Ends when all else is gone.
    leave: Leave,
}

/// The threads of the nodes' background work. Dropped, they end, but one that is stuck is not
/// waited for.
pub(crate) struct Workers(Option<Runtime>);

impl Deref for Workers {
    type Target = Runtime;

    fn deref(&self) -> &Runtime {
        self.0.as_ref().expect("there until it is dropped")
    }
}

impl Drop for Workers {
    fn drop(&mut self) {
        if let Some(runtime) = self.0.take() {
            runtime.shutdown_timeout(LEAVING);
        }
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        self.leave.begin();
        // It holds a part of the participant, which leaves when nobody holds it any more.
        if let Some(following) = self.following.take() {
            following.join(LEAVING);
        }
        // What the nodes said last.
        terminal::flush();
    }
}

impl Participant {
    /// Joins the network.
    ///
    /// # Errors
    /// [`RosNodeError::Runtime`] or [`RosNodeError::Join`]; [`RosNodeError::Security`] or
    /// [`RosNodeError::Environment`] where security is asked for and cannot be had.
    pub fn join(discovery: &Discovery) -> Result<Self, RosNodeError> {
        Self::join_with(discovery, Arguments::default())
    }

    /// Joins the network; all nodes follow what the command line says.
    ///
    /// # Errors
    /// As for [`join`](Self::join).
    pub fn join_with(discovery: &Discovery, arguments: Arguments) -> Result<Self, RosNodeError> {
        Self::join_after(discovery, arguments, Arc::default())
    }

    /// Joins the network once more, after a life that left `last_phases`.
    pub(crate) fn join_after(
        discovery: &Discovery,
        arguments: Arguments,
        last_phases: Arc<LastPhases>,
    ) -> Result<Self, RosNodeError> {
        middleware::guard();
        let runtime = Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("ros")
            .enable_time()
            .build()
            .map_err(RosNodeError::Runtime)?;
        let runtime = Workers(Some(runtime));
        let join_error = |detail: String| RosNodeError::Join { domain: discovery.domain, detail };
        let mut builder = DomainParticipantBuilder::new(discovery.domain);
        let networks = discovery.networks();
        let only_here = networks.is_some();
        if let Some(networks) = networks {
            builder = builder.with_only_networks(networks);
        }
        let (builder, protection) = security::protect(builder, discovery.domain, &arguments)?;
        // As ROS tells it, also in the clear.
        let enclave = protection.enclave().map_or("/", |enclave| &enclave.name);
        #[cfg(feature = "mended")]
        let builder = builder
            .dialect(&crate::dialect::ROS)
            .user_data(format!("enclave={enclave};").into_bytes());
        #[cfg(not(feature = "mended"))]
        let _ = enclave;
        if let Some(warning) = protection.warning() {
            terminal::tell(format!("this process {warning}"));
        }
        let _turn = Turn::wait(discovery.domain);
        let scope = Scope::new();
        let participant = builder.build().map_err(|error| join_error(error.to_string()))?;
        if only_here {
            scope.close()?;
        }
        let context = Context::from_domain_participant(participant)
            .map_err(|error| join_error(error.to_string()))?;
        let hearers = Arc::<Hearers>::default();
        let (heard, participant) = (Arc::clone(&hearers), context.domain_participant().clone());
        let graph = Graph::default();
        let others = Arc::<Others>::default();
        let lagging = Arc::<Lagging>::default();
        let (known, told, slow) = (graph.clone(), Arc::clone(&others), Arc::clone(&lagging));
        let following =
            Apart::start(
                "hearing",
                async move { heard.follow(participant, known, &told, &slow).await },
            )
            .map_err(RosNodeError::Runtime)?;
        let open = AtomicBool::new(!only_here);
        let shared = Shared {
            context,
            runtime,
            arguments,
            hearers,
            following: Some(following),
            lagging,
            graph,
            graph_is_watched: AtomicBool::new(false),
            last_phases,
            protection,
            others,
            open,
            rmw_is_told: AtomicBool::new(false),
            leave: Leave::new(),
        };
        Ok(Self { shared: Arc::new(shared) })
    }

    /// A node that the code calls `name`, in the root namespace unless the command line says
    /// otherwise.
    ///
    /// # Errors
    /// [`RosNodeError::Name`] or [`RosNodeError::Create`] if the name is none or the middleware
    /// refuses.
    pub fn node(&self, name: &str) -> Result<RosNode, RosNodeError> {
        RosNode::start(Arc::clone(&self.shared), name)
    }

    /// The enclave as which it is secured; `None` in the clear.
    #[must_use]
    pub fn enclave(&self) -> Option<&Enclave> {
        self.shared.protection.enclave()
    }

    /// First bytes of its identifier.
    #[must_use]
    pub fn prefix(&self) -> Prefix {
        security::prefix(
            rustdds::RTPSEntity::guid(&self.shared.context.domain_participant()).prefix,
        )
    }

    /// How the others stand with it.
    #[must_use]
    pub fn others(&self) -> &Others {
        &self.shared.others
    }

    /// What the command line says.
    #[must_use]
    pub fn arguments(&self) -> &Arguments {
        &self.shared.arguments
    }
}
