//! Asking other nodes: a service's client whose caller waits, but not for ever.

use std::{
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

use ros2_client::{Message, service::Client};

use crate::{RosNodeError, participant::Shared};

/// How long one request waits before it is sent once more, where that does no harm: a server that was not discovered yet never heard the first.
const AGAIN: Duration = Duration::from_secs(1);

/// A client of one service. The node it was made by must outlive its calls.
pub struct ServiceClient<Q: Message + Send + Sync + 'static, A: Message + Send + Sync + 'static> {
    name: String,
    client: Mutex<Client<Q, A>>,
    shared: Arc<Shared>,
}

impl<Q, A> ServiceClient<Q, A>
where
    Q: Message + Clone + Send + Sync + 'static,
    A: Message + Send + Sync + 'static,
{
    pub(crate) fn new(name: String, client: Client<Q, A>, shared: Arc<Shared>) -> Self {
        Self { name, client: Mutex::new(client), shared }
    }

    /// Absolute name of the service.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Asks once and waits for the answer. Never call it from a control thread, nor from a callback of a node.
    ///
    /// # Errors
    /// [`RosNodeError::NoAnswer`] if none comes in time.
    pub fn call(&self, request: Q, patience: Duration) -> Result<A, RosNodeError> {
        // One at a time: two that wait would take each other's answers.
        let client = self.client.lock().unwrap_or_else(PoisonError::into_inner);
        let error = |detail: String| RosNodeError::NoAnswer { service: self.name.clone(), detail };
        let answer = self
            .shared
            .runtime
            .block_on(async { tokio::time::timeout(patience, client.async_call_service(request)).await });
        answer
            .map_err(|_| error(format!("none within {:.1} s", patience.as_secs_f64())))?
            .map_err(|failed| error(format!("{failed:?}")))
    }

    /// Asks until an answer comes: only for requests that may be heard twice.
    ///
    /// # Errors
    /// [`RosNodeError::NoAnswer`] if none comes in time.
    pub fn call_until_answered(&self, request: &Q, patience: Duration) -> Result<A, RosNodeError> {
        let until = Instant::now() + patience;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            match self.call(request.clone(), left.min(AGAIN)) {
                Err(error) if left <= AGAIN => return Err(error),
                Err(_) => {}
                answer => return answer,
            }
        }
    }
}
