//! A managed node while it runs.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU8, Ordering},
    },
    time::Duration,
};

use msgs::{
    lifecycle_msgs::{
        ChangeState, ChangeStateResponse, GetAvailableStates, GetAvailableStatesResponse,
        GetAvailableTransitions, GetAvailableTransitionsResponse, GetState, GetStateResponse,
        TransitionEvent,
    },
    topics::Qos,
};

use super::table::{Phase, TRANSITIONS, Transition, find};
use crate::{Logger, NodeClock, Publisher, RosNode, RosNodeError, Twin, quoted, twins::Twins};

/// How often another node of the same name is looked for.
const LOOK: Duration = Duration::from_millis(250);

/// Why a transition did not happen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CallbackError {
    /// It could not be done; the node is where it was before.
    Failure(String),
    /// Something broke; the node has to be configured anew.
    Error(String),
}

impl From<String> for CallbackError {
    fn from(reason: String) -> Self {
        Self::Failure(reason)
    }
}

/// A transition that was asked for and did not happen.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TransitionError {
    /// There is no such transition from the state that the node is in.
    #[error(
        "the node is {} and cannot `{asked}`; from here it can: {}", from.label(), possible(*from)
    )]
    NotFromHere {
        /// Where it is.
        from: Phase,
        /// Label or number of what was asked for.
        asked: String,
    },
    /// A node of the same name was there before: this one does not work beside it.
    #[error("{0}")]
    Elder(Twin),
    /// The node could not do what belongs to the transition.
    #[error("{reason}")]
    Refused {
        /// The first reason it gave.
        reason: String,
    },
    /// The table of transitions lacks a step, a mistake of this crate.
    #[error("there is no {label} from {}", from.label())]
    NoStep {
        /// The step.
        label: &'static str,
        /// Where it would begin.
        from: Phase,
    },
}

/// What can be asked for in a state.
fn possible(from: Phase) -> String {
    let rows = TRANSITIONS.iter().filter(|row| row.start == from);
    let labels: Vec<&str> = rows.map(|row| row.label).collect();
    if labels.is_empty() { "nothing".to_owned() } else { labels.join(", ") }
}

/// What a node does on its way between states. What is left out does nothing and succeeds.
pub trait Managed: Send {
    /// Sets up.
    ///
    /// # Errors
    /// The reason.
    fn configure(&mut self) -> Result<(), CallbackError> {
        Ok(())
    }

    /// Begins its work.
    ///
    /// # Errors
    /// The reason.
    fn activate(&mut self) -> Result<(), CallbackError> {
        Ok(())
    }

    /// Ends its work.
    ///
    /// # Errors
    /// The reason.
    fn deactivate(&mut self) -> Result<(), CallbackError> {
        Ok(())
    }

    /// Forgets what it was set up with.
    ///
    /// # Errors
    /// The reason.
    fn clean_up(&mut self) -> Result<(), CallbackError> {
        Ok(())
    }

    /// Ends, from whatever state.
    ///
    /// # Errors
    /// The reason.
    fn shut_down(&mut self) -> Result<(), CallbackError> {
        Ok(())
    }

    /// Mends what went wrong, so that it can be configured anew.
    ///
    /// # Errors
    /// The reason, after which it is finalized.
    fn recover(&mut self) -> Result<(), CallbackError> {
        self.shut_down()
    }
}

/// What a program asks its own node for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Requested {
    /// Set up.
    Configure,
    /// Begin to work.
    Activate,
    /// End its work.
    Deactivate,
    /// Forget what it was set up with.
    CleanUp,
    /// End for good.
    ShutDown,
}

impl Requested {
    /// The name of the transition, as `ros2 lifecycle set` has it.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Configure => "configure",
            Self::Activate => "activate",
            Self::Deactivate => "deactivate",
            Self::CleanUp => "cleanup",
            Self::ShutDown => "shutdown",
        }
    }
}

/// The states of a running node. Clones are the same node's.
#[derive(Clone)]
pub struct Lifecycle(Arc<Inner>);

struct Inner {
    phase: AtomicU8,
    /// The same for a life after this one.
    kept: Arc<AtomicU8>,
    /// What the life before left there.
    before: u8,
    managed: Mutex<Box<dyn Managed>>,
    events: Publisher<TransitionEvent>,
    logger: Logger,
    clock: NodeClock,
    /// Other nodes of this one's name: beside one that was there before it does not work.
    twins: Twins,
}

impl Lifecycle {
    /// Makes `node` a managed one, in state unconfigured, and offers its five services and its
    /// event.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn start(node: &RosNode, managed: Box<dyn Managed>) -> Result<Self, RosNodeError> {
        let kept = node.last_phase();
        let this = Self(Arc::new(Inner {
            phase: AtomicU8::new(Phase::Unconfigured as u8),
            before: kept.swap(Phase::Unconfigured as u8, Ordering::AcqRel),
            kept,
            managed: Mutex::new(managed),
            events: node.publisher_on("~/transition_event", Qos::DEFAULT)?,
            logger: node.logger().clone(),
            clock: node.clock().clone(),
            twins: node.twins()?,
        }));
        let lifecycle = this.clone();
        node.spawn(async move { lifecycle.look_for_twins().await });
        let lifecycle = this.clone();
        node.serve::<ChangeState>("~/change_state", move |asked| ChangeStateResponse {
            success: lifecycle.change(asked.transition.id, &asked.transition.label).is_ok(),
        })?;
        let lifecycle = this.clone();
        node.serve::<GetState>("~/get_state", move |_| GetStateResponse {
            current_state: lifecycle.phase().message(),
        })?;
        node.serve::<GetAvailableStates>("~/get_available_states", |_| {
            GetAvailableStatesResponse {
                available_states: Phase::ALL.iter().map(|phase| phase.message()).collect(),
            }
        })?;
        let lifecycle = this.clone();
        node.serve::<GetAvailableTransitions>("~/get_available_transitions", move |_| {
            let phase = lifecycle.phase();
            GetAvailableTransitionsResponse {
                available_transitions: described(|row| row.start == phase),
            }
        })?;
        node.serve::<GetAvailableTransitions>("~/get_transition_graph", |_| {
            GetAvailableTransitionsResponse { available_transitions: described(|_| true) }
        })?;
        Ok(this)
    }

    /// The state now.
    #[must_use]
    pub fn phase(&self) -> Phase {
        let id = self.0.phase.load(Ordering::Acquire);
        Phase::ALL.iter().copied().find(|phase| *phase as u8 == id).unwrap_or(Phase::Unknown)
    }

    /// Whether the node is to configure and activate itself, given its parameter `autostart`: in a
    /// process's first life, and in a later one if it was active when the middleware died. What was
    /// stopped stays stopped.
    #[must_use]
    pub fn starts_itself(&self, autostart: bool) -> bool {
        autostart && (self.0.before == 0 || self.0.before == Phase::Active as u8)
    }

    /// Asks for a transition.
    ///
    /// # Errors
    /// [`TransitionError`] says why it did not happen; the log has it too.
    pub fn request(&self, requested: Requested) -> Result<Phase, TransitionError> {
        self.change(0, requested.label())
    }

    /// Asks for a transition by number or label, as `change_state` does. Waits for one that is
    /// under way.
    fn change(&self, id: u8, label: &str) -> Result<Phase, TransitionError> {
        let mut managed = self.0.managed.lock().unwrap_or_else(PoisonError::into_inner);
        let from = self.phase();
        let Some(first) = find(from, id, label) else {
            let asked = if label.is_empty() { id.to_string() } else { quoted(label).into_owned() };
            let reason = TransitionError::NotFromHere { from, asked };
            self.0.logger.error(&reason.to_string());
            return Err(reason);
        };
        let begins = matches!(first.goal, Phase::Configuring | Phase::Activating);
        let outcome = match self.0.twins.found().filter(|twin| twin.elder && begins) {
            Some(elder) => Err(TransitionError::Elder(elder)),
            None => self.walk(managed.as_mut(), first),
        };
        match &outcome {
            Ok(phase) => self.0.logger.info(&format!(
                "{}: {} to {}",
                first.label,
                from.label(),
                phase.label()
            )),
            Err(reason) => {
                self.0.logger.error(&format!("{} did not succeed: {reason}", first.label))
            }
        }
        outcome
    }

    /// A sentence about the node of the same name that was there before, if there is one: this one
    /// does not work beside it.
    #[must_use]
    pub fn elder(&self) -> Option<String> {
        self.0.twins.found().filter(|twin| twin.elder).map(|twin| twin.to_string())
    }

    /// Brings the node out of its work when it is heard that one of its name was there before, and
    /// tells of one that has come later. On a busy network the first may be heard a moment after
    /// this node began to work.
    async fn look_for_twins(&self) {
        let mut told = None;
        loop {
            tokio::time::sleep(LOOK).await;
            let twin = self.0.twins.found();
            if let Some(twin) = twin.as_ref().filter(|twin| told.as_ref() != Some(*twin)) {
                self.0.logger.error(&twin.to_string());
            }
            if twin.as_ref().is_some_and(|twin| twin.elder) {
                // What the node does on its way may take its time.
                tokio::task::block_in_place(|| {
                    for (phase, requested) in [
                        (Phase::Active, Requested::Deactivate),
                        (Phase::Inactive, Requested::CleanUp),
                    ] {
                        if self.phase() == phase {
                            // The log says what does not succeed.
                            let _ = self.request(requested);
                        }
                    }
                });
            }
            told = twin;
        }
    }

    /// Takes the transition, does what belongs to it, and takes the one that its outcome leads to,
    /// up to a primary state.
    fn walk(
        &self,
        managed: &mut dyn Managed,
        first: &'static Transition,
    ) -> Result<Phase, TransitionError> {
        let mut step = first;
        let mut reason = None;
        loop {
            self.enter(step);
            let outcome = match step.goal {
                Phase::Configuring => managed.configure(),
                Phase::Activating => managed.activate(),
                Phase::Deactivating => managed.deactivate(),
                Phase::CleaningUp => managed.clean_up(),
                Phase::ShuttingDown => managed.shut_down(),
                Phase::ErrorProcessing => managed.recover(),
                primary => {
                    return reason
                        .map_or(Ok(primary), |reason| Err(TransitionError::Refused { reason }));
                }
            };
            let label = match outcome {
                Ok(()) => "transition_success",
                Err(CallbackError::Failure(why)) => {
                    reason.get_or_insert(why);
                    "transition_failure"
                }
                Err(CallbackError::Error(why)) => {
                    reason.get_or_insert(why);
                    "transition_error"
                }
            };
            match find(step.goal, 0, label) {
                Some(next) => step = next,
                // The table has one for each; a test says so.
                None => return Err(TransitionError::NoStep { label, from: step.goal }),
            }
        }
    }

    fn enter(&self, step: &Transition) {
        self.0.phase.store(step.goal as u8, Ordering::Release);
        self.0.kept.store(step.goal as u8, Ordering::Release);
        // Nobody is harmed if an event is not heard.
        let _ = self.0.events.publish(TransitionEvent {
            timestamp: self.0.clock.now_ns(),
            transition: step.message(),
            start_state: step.start.message(),
            goal_state: step.goal.message(),
        });
    }
}

fn described(
    wanted: impl Fn(&Transition) -> bool,
) -> Vec<msgs::lifecycle_msgs::TransitionDescription> {
    TRANSITIONS.iter().filter(|row| wanted(row)).map(Transition::description).collect()
}
