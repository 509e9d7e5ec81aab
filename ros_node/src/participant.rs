//! The process on the network.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use ros2_client::Context;
use rustdds::DomainParticipantBuilder;
use tokio::runtime::Builder;

use crate::{
    Arguments, Discovery, Graph, RosNode, RosNodeError,
    apart::Apart,
    hearing::Hearers,
    inside::{Ears, Listener},
    lagging::Lagging,
    middleware::{self, Leave},
    scope::Scope,
    security::{self, Enclave, Others, Prefix, Protection, Wish},
    shared::{LastPhases, Shared, Workers},
    terminal,
    turn::Turn,
};

/// One process's place on the network, shared by its nodes. It leaves when the last of them and
/// this are dropped.
pub struct Participant {
    shared: Arc<Shared>,
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
        let protection = if arguments.in_the_clear {
            Protection::Off(None)
        } else {
            Wish::from_environment()?.protection(arguments.enclave.as_deref())?
        };
        let builder = security::protect(builder, discovery.domain, &protection)?;
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
            ears: Ears::default(),
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

    /// Has a listener hear what the nodes of this process publish and log, without the network.
    /// There is one listener; false if there was one before.
    pub fn listen_inside(&self, listener: Listener) -> bool {
        self.shared.ears.listen(listener)
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
