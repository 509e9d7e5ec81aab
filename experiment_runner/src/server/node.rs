//! The node `/experiment_runner`: an action, three services and a status that stays for latecomers.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;

use msgs::friction_msgs::{
    ExperimentStatus, Identify, ListExperiments, ListExperimentsResponse, RunExperiment,
    RunExperimentFeedback, RunExperimentGoal, RunExperimentResult, StartExperiment,
    StartExperimentResponse,
};
use msgs::std_srvs::{Trigger, TriggerResponse};
use msgs::topics;
use ros_node::lifecycle::{CallbackError, Lifecycle, Managed, Requested};
use ros_node::parameters::{Declared, ParameterError, Parameters, Values};
use ros_node::{
    ActionHandler, ActionServer, Goal, GoalEnd, GoalId, Participant, RosNode, RosNodeError, Stop,
};

use super::desk::{Desk, UsualRig, Watcher};
use super::ended::Ended;
use super::parameters::RunnerParameters;
use super::permissions::Permissions;
use super::request::ExperimentRequest;
use super::{Refusal, identification, listing, outcome};
use crate::errand::Errands;
use crate::run::Beside;

/// The executable `experiment_runner`: the node with its parameters, until the wish to end.
///
/// # Errors
/// [`RosNodeError`] if the middleware refuses, or a parameter that was given does not fit.
pub fn run(
    participant: &Participant,
    stop: &Stop,
    (beside, errands): (Beside, Errands),
) -> Result<(), RosNodeError> {
    let node = participant.node("experiment_runner")?;
    let runner = ManagedRunner::new(&node, (beside, errands))?;
    while !stop.wait(Duration::from_secs(1)) {}
    node.logger().info("leaving");
    // The experiment ends and its result is sent before the node goes.
    drop(runner);
    Ok(())
}

/// What the node offers, with its parameters and as a managed node.
pub struct ManagedRunner {
    _lifecycle: Lifecycle,
    _runner: Runner,
}

impl ManagedRunner {
    /// Offers everything on `node`, and becomes active if the parameter `autostart` says so.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses, or a parameter that was given does not fit.
    pub fn new(node: &RosNode, (beside, errands): (Beside, Errands)) -> Result<Self, RosNodeError> {
        let usual = UsualRig::default();
        let named = usual.clone();
        let axis = node.identity().namespace.clone();
        let first = OnceLock::new();
        let judge = move |values: &Values, _: &BTreeSet<String>| {
            let said = RunnerParameters::default().with(values);
            let rig = said.rig().map_err(ParameterError::refused)?;
            // What is allowed is what the program was started with.
            let allowed = match first.get() {
                Some(allowed) => allowed,
                None => {
                    let allowed = said.permissions(&axis).map_err(ParameterError::refused)?;
                    first.get_or_init(|| allowed)
                }
            };
            allowed.rig(rig.clone()).map_err(ParameterError::refused)?;
            named.set(rig);
            Ok(())
        };
        let declared = RunnerParameters::default().declarations();
        let parameters = Parameters::declare(node, declared, judge)?.values();
        let said = RunnerParameters::default().with(&parameters);
        let permissions = said.permissions(&node.identity().namespace).map_err(|error| {
            let node = node.identity().qualified();
            RosNodeError::Parameters { node, reason: error.to_string() }
        })?;
        let runner = Runner::new(node, permissions.and(beside).offering(errands), usual)?;
        runner.desk.close(Refusal::Inactive, Duration::ZERO);
        let lifecycle = Lifecycle::start(node, Box::new(Management(runner.desk.clone())))?;
        if said.autostart && lifecycle.request(Requested::Configure).is_ok() {
            // The log says why it is not active, if it is not.
            let _ = lifecycle.request(Requested::Activate);
        }
        Ok(Self { _lifecycle: lifecycle, _runner: runner })
    }
}

/// Requests are taken while the node is active.
struct Management(Desk);

impl Management {
    fn close(&self) -> Result<(), CallbackError> {
        if self.0.close(Refusal::Inactive, PATIENCE) {
            Ok(())
        } else {
            Err(CallbackError::Failure("the running experiment does not end".to_owned()))
        }
    }
}

impl Managed for Management {
    fn activate(&mut self) -> Result<(), CallbackError> {
        self.0.open();
        Ok(())
    }

    fn deactivate(&mut self) -> Result<(), CallbackError> {
        self.close()
    }

    fn shut_down(&mut self) -> Result<(), CallbackError> {
        self.close()
    }
}

/// Time for clients to fetch the last result before the node goes.
const LINGER: Duration = Duration::from_millis(500);
/// How long a leaving node waits for its experiment to end.
const PATIENCE: Duration = Duration::from_secs(30);

/// What the node offers. Dropped, it ends what runs and answers no more.
pub struct Runner {
    desk: Desk,
    cancel_identification: Arc<AtomicBool>,
    _action: ActionServer,
}

impl Runner {
    /// Offers everything on `node`; requests may use what `permissions` say, and are on the `usual`
    /// rig unless they name one.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses.
    pub fn new(
        node: &RosNode,
        permissions: Permissions,
        usual: UsualRig,
    ) -> Result<Self, RosNodeError> {
        let status = node.publisher(&topics::EXPERIMENT_STATUS)?;
        let logger = node.logger().clone();
        let mut last = String::new();
        let announce = move |message: ExperimentStatus| {
            // What is news goes to the log too.
            if message.message != last {
                last.clone_from(&message.message);
                logger.info(&last);
            }
            // A status that does not get through is followed by the next.
            let _ = status.publish(message);
        };
        let (for_recordings, errands) = (permissions.clone(), *permissions.errands());
        let desk = Desk::new(permissions, usual, Box::new(announce));
        let goals = Goals { desk: desk.clone(), cancels: Arc::default() };
        let (starts, aborts) = (desk.clone(), desk.clone());
        let cancel_identification = Arc::new(AtomicBool::new(false));
        let cancel = Arc::clone(&cancel_identification);
        node.serve::<StartExperiment>("~/start_experiment", move |asked| {
            start(&starts, asked.into())
        })?;
        node.serve::<ListExperiments>("~/list_experiments", move |_| ListExperimentsResponse {
            experiments: listing::descriptions(&errands),
        })?;
        node.serve::<Identify>("~/identify", move |asked| {
            identification::identify(&asked, &for_recordings, &cancel)
        })?;
        node.serve::<Trigger>("~/abort", move |_| stop(&aborts))?;
        let action = node.serve_action::<RunExperiment>("~/run_experiment", goals)?;
        Ok(Self { desk, cancel_identification, _action: action })
    }
}

impl Drop for Runner {
    fn drop(&mut self) {
        self.cancel_identification.store(true, Ordering::Relaxed);
        self.desk.close(Refusal::Leaving, PATIENCE);
        thread::sleep(LINGER);
    }
}

fn start(desk: &Desk, request: ExperimentRequest) -> StartExperimentResponse {
    match desk.start(&request, Arc::default(), ()) {
        Ok(started) => StartExperimentResponse {
            success: true,
            message: format!("{} runs; /experiment_status tells how it goes", started.run_id),
            folder: started.folder.display().to_string(),
            run_id: started.run_id,
        },
        Err(refusal) => {
            StartExperimentResponse { message: refusal.to_string(), ..Default::default() }
        }
    }
}

fn stop(desk: &Desk) -> TriggerResponse {
    match desk.abort() {
        Some(run_id) => {
            TriggerResponse { success: true, message: format!("{run_id} is being stopped") }
        }
        None => TriggerResponse { success: false, message: "no experiment runs".to_owned() },
    }
}

/// What ends the experiment of a goal.
#[derive(Default)]
struct Cancel {
    /// Ends it, whoever sets it.
    stop: Arc<AtomicBool>,
    /// The goal's client asked for it.
    asked: AtomicBool,
}

type Cancels = Arc<Mutex<BTreeMap<GoalId, Arc<Cancel>>>>;

fn lock(cancels: &Cancels) -> MutexGuard<'_, BTreeMap<GoalId, Arc<Cancel>>> {
    // Insertions and removals are one step: what a panicked thread left is whole.
    cancels.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Goals of the action, each with what cancels it.
struct Goals {
    desk: Desk,
    cancels: Cancels,
}

impl ActionHandler<RunExperiment> for Goals {
    fn start(&self, request: RunExperimentGoal, goal: Goal<RunExperiment>) {
        let cancel: Arc<Cancel> = Arc::default();
        lock(&self.cancels).insert(goal.id(), Arc::clone(&cancel));
        let follower = Arc::new(Mutex::new(Some(goal)));
        let watcher = Follower {
            goal: Arc::clone(&follower),
            cancel: Arc::clone(&cancel),
            cancels: Arc::clone(&self.cancels),
        };
        let desk = self.desk.clone();
        // Waiting for a preempted experiment to end must not keep cancel requests waiting.
        let begin = move || {
            let refused = desk.start(&request.into(), Arc::clone(&cancel.stop), watcher).err();
            if let Some(refusal) = refused
                && let Some(goal) = follower.lock().unwrap_or_else(PoisonError::into_inner).take()
            {
                goal.finish(GoalEnd::Aborted, outcome::refused(&refusal));
            }
        };
        // Without a thread both closures are dropped, and the goal with them: it is aborted.
        let _ = thread::Builder::new().name("goal".into()).spawn(begin);
    }

    fn cancel(&self, id: GoalId) -> bool {
        let Some(cancel) = lock(&self.cancels).get(&id).cloned() else { return false };
        cancel.asked.store(true, Ordering::Relaxed);
        cancel.stop.store(true, Ordering::Relaxed);
        true
    }
}

/// Tells the client of a goal how its experiment goes.
struct Follower {
    goal: Arc<Mutex<Option<Goal<RunExperiment>>>>,
    cancel: Arc<Cancel>,
    cancels: Cancels,
}

impl Watcher for Follower {
    fn progress(&self, feedback: RunExperimentFeedback) {
        if let Some(goal) = &*self.goal.lock().unwrap_or_else(PoisonError::into_inner) {
            goal.feedback(feedback);
        }
    }

    fn ended(self: Box<Self>, ended: &Ended) {
        let result = outcome::result(ended);
        let end = match result.outcome {
            RunExperimentResult::SUCCEEDED => GoalEnd::Succeeded,
            RunExperimentResult::CANCELED if self.cancel.asked.load(Ordering::Relaxed) => {
                GoalEnd::Canceled
            }
            _ => GoalEnd::Aborted,
        };
        if let Some(goal) = self.goal.lock().unwrap_or_else(PoisonError::into_inner).take() {
            lock(&self.cancels).remove(&goal.id());
            goal.finish(end, result);
        }
    }
}

impl Drop for Follower {
    fn drop(&mut self) {
        // Refused or panicked: nobody will cancel it any more.
        if let Some(goal) = &*self.goal.lock().unwrap_or_else(PoisonError::into_inner) {
            lock(&self.cancels).remove(&goal.id());
        }
    }
}
