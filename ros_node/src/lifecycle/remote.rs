//! States of another node.

use std::time::Duration;

use msgs::lifecycle_msgs::{
    ChangeState, ChangeStateRequest, ChangeStateResponse, GetState, GetStateRequest,
    GetStateResponse, Transition,
};

use super::{Phase, Requested};
use crate::{RosNode, RosNodeError, ServiceClient};

/// Transitions from anywhere to anywhere: more would be going round in circles.
const TRANSITIONS_AT_MOST: usize = 4;

/// Tells and changes the state of a managed node that may run anywhere.
pub struct RemoteLifecycle {
    node: String,
    get: ServiceClient<GetStateRequest, GetStateResponse>,
    change: ServiceClient<ChangeStateRequest, ChangeStateResponse>,
}

impl RemoteLifecycle {
    /// Of the node that `this` node calls `name`.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn new(this: &RosNode, name: &str) -> Result<Self, RosNodeError> {
        Ok(Self {
            node: name.to_owned(),
            get: this.client::<GetState>(&format!("{name}/get_state"))?,
            change: this.client::<ChangeState>(&format!("{name}/change_state"))?,
        })
    }

    /// The state it is in.
    ///
    /// # Errors
    /// [`RosNodeError::NoAnswer`].
    pub fn phase(&self, patience: Duration) -> Result<Phase, RosNodeError> {
        let answer = self.get.call_until_answered(&GetStateRequest::default(), patience)?;
        let phase =
            Phase::ALL.iter().copied().find(|phase| *phase as u8 == answer.current_state.id);
        Ok(phase.unwrap_or(Phase::Unknown))
    }

    /// Leads it to `goal`, which is unconfigured, inactive or active, by as many transitions as it
    /// takes.
    ///
    /// # Errors
    /// [`RosNodeError::Refused`] if the node does not make a transition;
    /// [`RosNodeError::NoAnswer`].
    pub fn lead_to(&self, goal: Phase, patience: Duration) -> Result<(), RosNodeError> {
        for _ in 0..TRANSITIONS_AT_MOST {
            let is = self.phase(patience)?;
            let step = match (is, goal) {
                _ if is == goal => return Ok(()),
                (Phase::Unconfigured, _) => Requested::Configure,
                (Phase::Inactive, Phase::Active) => Requested::Activate,
                (Phase::Inactive, _) => Requested::CleanUp,
                (Phase::Active, _) => Requested::Deactivate,
                _ => return Err(self.refused(format!("it is {}", is.label()))),
            };
            let label = step.label().to_owned();
            // Not to be sent twice: the second would find the node elsewhere. A lost answer shows
            // in the next state.
            let request = ChangeStateRequest { transition: Transition { id: 0, label } };
            if let Ok(answer) = self.change.call(request, patience)
                && !answer.success
            {
                let reason = format!(
                    "it does not {} while it is {}; its log says why",
                    step.label(),
                    self.phase(patience)?.label()
                );
                return Err(self.refused(reason));
            }
        }
        Err(self.refused("it does not stay where it is led".to_owned()))
    }

    fn refused(&self, reason: String) -> RosNodeError {
        RosNodeError::Refused { node: self.node.clone(), what: "the transition", reason }
    }
}
