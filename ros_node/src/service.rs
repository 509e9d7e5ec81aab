//! A service: its requests one after the other, each answer when its client can hear it.

use std::{sync::Arc, time::Duration};

use futures::{StreamExt, stream::FuturesUnordered};
use ros2_client::{Message, RmwRequestId, service::Server};

use crate::{
    Logger,
    hearing::{self, Hearers},
    limits,
};

/// Pause after a request that cannot be read: a reader that only ever fails must not take the
/// processor.
const AFTER_FAILURE: Duration = Duration::from_millis(10);

/// A service that is offered.
pub(crate) struct Service<Q: Message, A: Message> {
    name: String,
    server: Server<Q, A>,
    hearers: Arc<Hearers>,
    logger: Logger,
}

impl<Q: Message + 'static, A: Message + 'static> Service<Q, A> {
    /// That of the absolute name `name`.
    pub(crate) fn new(
        name: String,
        server: Server<Q, A>,
        hearers: Arc<Hearers>,
        logger: Logger,
    ) -> Self {
        Self { name, server, hearers, logger }
    }

    /// Answers whoever asks, for ever.
    pub(crate) async fn run(&self, mut answer: impl FnMut(Q) -> A) {
        let topic = hearing::answers_of(&self.name);
        let mut held = FuturesUnordered::new();
        loop {
            let next = tokio::select! {
                next = self.server.async_receive_request() => next,
                Some(()) = held.next() => continue,
            };
            let (client, request) = match next {
                Ok(next) => next,
                Err(error) => {
                    self.logger.warn_of(&self.name, || {
                        format!(
                            "a request to {} was not understood and has no answer: {error:?}",
                            self.name
                        )
                    });
                    tokio::time::sleep(AFTER_FAILURE).await;
                    continue;
                }
            };
            let response = answer(request);
            if limits::is_too_long(&response) {
                let (name, longest) = (&self.name, limits::ANSWER);
                self.logger.warn_of(name, || {
                    format!(
                        "an answer of {name} would be longer than {longest} bytes and was not sent; ask for less at a time"
                    )
                });
            } else if self.hearers.hear(&client, &topic) || held.len() >= hearing::MOST_HELD {
                self.send(client, response).await;
            } else {
                self.logger
                    .debug(&format!("an answer of {} waits until its client is found", self.name));
                let topic = &topic;
                held.push(async move {
                    self.hearers.until_heard(&client, topic).await;
                    self.send(client, response).await;
                });
            }
        }
    }

    async fn send(&self, client: RmwRequestId, response: A) {
        if let Err(error) = self.server.async_send_response(client, response).await {
            self.logger.warn_of(&self.name, || {
                format!("an answer of {} was not sent: {error:?}", self.name)
            });
        }
    }
}
