//! Asking other nodes: a service's client whose caller waits, but not for ever.

use std::{
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

use ros2_client::{Message, ServiceMapping, service::Client};

use crate::{RosNodeError, hearing, shared::Shared};

/// How long one request waits before it is sent once more, where that does no harm: a server that
/// was not discovered yet never heard the first.
const AGAIN: Duration = Duration::from_secs(1);
/// Time that a server of Cyclone DDS is given to find the endpoints with which it is asked: what is
/// sent before never comes.
const FOUND: Duration = Duration::from_millis(200);

/// Pause after an answer that cannot be read: a reader that only ever fails must not take the
/// processor.
const AFTER_FAILURE: Duration = Duration::from_millis(1);

/// Makes endpoints that ask in a way.
type Make<Q, A> = Box<dyn Fn(ServiceMapping) -> Result<Client<Q, A>, RosNodeError> + Send + Sync>;

/// A client of one service. The node it was made by must outlive its calls.
pub struct ServiceClient<Q: Message + Send + Sync + 'static, A: Message + Send + Sync + 'static> {
    name: String,
    endpoints: Mutex<Endpoints<Q, A>>,
    make: Make<Q, A>,
    shared: Arc<Shared>,
}

struct Endpoints<Q: Message, A: Message> {
    /// Ask servers of Fast DDS and RustDDS.
    usual: Client<Q, A>,
    /// Ask servers of Cyclone DDS; there once there is one.
    cyclone: Option<Client<Q, A>>,
}

impl<Q, A> ServiceClient<Q, A>
where
    Q: Message + Clone + Send + Sync + 'static,
    A: Message + Send + Sync + 'static,
{
    pub(crate) fn new(
        name: String,
        shared: Arc<Shared>,
        make: Make<Q, A>,
    ) -> Result<Self, RosNodeError> {
        let endpoints =
            Mutex::new(Endpoints { usual: make(ServiceMapping::Enhanced)?, cyclone: None });
        Ok(Self { name, endpoints, make, shared })
    }

    /// Absolute name of the service.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Asks once and waits for the answer. Never call it from a control thread, nor from a callback
    /// of a node.
    ///
    /// # Errors
    /// [`RosNodeError::NoAnswer`] if none comes in time.
    pub fn call(&self, request: Q, patience: Duration) -> Result<A, RosNodeError> {
        // One at a time: two that wait would take each other's answers.
        let mut endpoints = self.endpoints.lock().unwrap_or_else(PoisonError::into_inner);
        let error = |detail: String| RosNodeError::NoAnswer { service: self.name.clone(), detail };
        let mut unreadable = None;
        let answer = self.shared.runtime.block_on(async {
            let asked = async {
                let client = self.for_server(&mut endpoints).await?;
                let sent = client.async_send_request(request).await;
                let id = sent.map_err(|failed| error(format!("{failed:?}")))?;
                loop {
                    match client.async_receive_response(id).await {
                        Ok(answer) => return Ok(answer),
                        // All clients of a service hear all answers: what is for one of another
                        // middleware may not be readable here.
                        Err(failed) => {
                            unreadable = Some(format!("{failed:?}"));
                            tokio::time::sleep(AFTER_FAILURE).await;
                        }
                    }
                }
            };
            tokio::time::timeout(patience, asked).await
        });
        answer.unwrap_or_else(|_| {
            let none = format!("none within {:.1} s", patience.as_secs_f64());
            Err(error(match unreadable {
                None => none,
                Some(why) => format!("{none} that could be read ({why})"),
            }))
        })
    }

    /// The endpoints that ask in the way of whoever serves.
    async fn for_server<'a>(
        &self,
        endpoints: &'a mut Endpoints<Q, A>,
    ) -> Result<&'a Client<Q, A>, RosNodeError> {
        if !self.shared.hearers.are_of_cyclone(&hearing::requests_of(&self.name)) {
            return Ok(&endpoints.usual);
        }
        if endpoints.cyclone.is_none() {
            endpoints.cyclone = Some((self.make)(ServiceMapping::Cyclone)?);
            tokio::time::sleep(FOUND).await;
        }
        Ok(endpoints.cyclone.as_ref().unwrap_or(&endpoints.usual))
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
