//! The process on the network.

use std::sync::Arc;

use ros2_client::Context;
use rustdds::DomainParticipantBuilder;
use tokio::runtime::{Builder, Runtime};

use crate::{Discovery, RosNode, RosNodeError};

/// One process's place on the network, shared by its nodes. It leaves when the last of them and this are dropped.
pub struct Participant {
    shared: Arc<Shared>,
}

/// What participant and nodes hold together. The fields are dropped in this order: the runtime last, so that nothing
/// runs on a participant that is gone.
pub(crate) struct Shared {
    pub(crate) context: Context,
    pub(crate) runtime: Runtime,
}

impl Participant {
    /// Joins the network.
    ///
    /// # Errors
    /// [`RosNodeError::Runtime`] or [`RosNodeError::Join`].
    pub fn join(discovery: &Discovery) -> Result<Self, RosNodeError> {
        let runtime = Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name("ros")
            .enable_time()
            .build()
            .map_err(RosNodeError::Runtime)?;
        let join_error = |detail: String| RosNodeError::Join { domain: discovery.domain, detail };
        let mut builder = DomainParticipantBuilder::new(discovery.domain);
        if let Some(networks) = discovery.networks() {
            builder = builder.with_only_networks(networks);
        }
        let participant = builder.build().map_err(|error| join_error(error.to_string()))?;
        let context =
            Context::from_domain_participant(participant).map_err(|error| join_error(error.to_string()))?;
        Ok(Self { shared: Arc::new(Shared { context, runtime }) })
    }

    /// A node of that name in the root namespace, whose background work runs from now on.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the name is none or the middleware refuses.
    pub fn node(&self, name: &str) -> Result<RosNode, RosNodeError> {
        RosNode::start(Arc::clone(&self.shared), name)
    }
}
