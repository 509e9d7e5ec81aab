//! Answers of an action, each sent when its client can hear it.

use std::sync::{Arc, Mutex, PoisonError};

use ros2_client::{RmwRequestId, WriteError};
use tokio::{runtime::Handle, task::JoinSet};

use crate::{
    Logger,
    hearing::{self, Hearers},
};

/// One of the services that make an action.
#[derive(Debug, Clone, Copy)]
pub(super) enum Service {
    SendGoal,
    CancelGoal,
    GetResult,
}

/// Sends answers, at once or later.
pub(crate) struct Answers {
    action: String,
    logger: Logger,
    hearers: Arc<Hearers>,
    runtime: Handle,
    held: Mutex<JoinSet<()>>,
}

impl Answers {
    /// Those of the action of that absolute name.
    pub(crate) fn new(
        action: &str,
        logger: Logger,
        hearers: Arc<Hearers>,
        runtime: Handle,
    ) -> Arc<Self> {
        Arc::new(Self {
            action: action.to_owned(),
            logger,
            hearers,
            runtime,
            held: Mutex::default(),
        })
    }

    /// Calls `send` at once if the client hears the answer, and else as soon as it does.
    pub(super) fn send(
        &self,
        service: Service,
        to: RmwRequestId,
        send: impl FnOnce() -> Result<(), WriteError<()>> + Send + 'static,
    ) {
        let service = match service {
            Service::SendGoal => "send_goal",
            Service::CancelGoal => "cancel_goal",
            Service::GetResult => "get_result",
        };
        let name = format!("{}/_action/{service}", self.action);
        let topic = hearing::answers_of(&name);
        let logger = self.logger.clone();
        let tell = move |sent: Result<(), WriteError<()>>, name: &str| {
            if let Err(error) = sent {
                logger.warn_of(name, || format!("an answer of {name} was not sent: {error:?}"));
            }
        };
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        while held.try_join_next().is_some() {}
        if self.hearers.hear(&to, &topic) || held.len() >= hearing::MOST_HELD {
            drop(held);
            return tell(send(), &name);
        }
        self.logger.debug(&format!("an answer of {name} waits until its client is found"));
        let hearers = Arc::clone(&self.hearers);
        let later = async move {
            hearers.until_heard(&to, &topic).await;
            tell(send(), &name);
        };
        held.spawn_on(later, &self.runtime);
    }

    /// Gives up what is still held back.
    pub(super) fn give_up(&self) {
        self.held.lock().unwrap_or_else(PoisonError::into_inner).abort_all();
    }
}
