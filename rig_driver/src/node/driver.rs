//! The managed node around the rig. Its states are those of the safety layer, and the motor moves
//! in `active` only.

use std::{
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use msgs::{
    builtin_interfaces::Time,
    diagnostic_msgs::DiagnosticArray,
    std_srvs::{Trigger, TriggerResponse},
    topics,
};
use ros_node::{
    ParameterValue, Participant, Publisher, RosNode, RosNodeError, Stop,
    lifecycle::{CallbackError, Lifecycle, Managed, Requested, TransitionError},
    parameters::Parameters,
};

use super::{
    axis::{Axis, UnconfiguredRig},
    commander::Commander,
    control::VoltageCommand,
    declarations,
    in_cycle::InCycle,
    limits_guard::LimitsGuard,
    locked::locked,
    parameters::RigSettings,
    warmth::Warmth,
};
use crate::{
    safety::{State, StopLatch},
    station::Kind,
};

/// How often faults are looked for.
const WATCH: Duration = Duration::from_millis(20);
/// Time between two diagnostics.
const DIAGNOSTICS: Duration = Duration::from_secs(1);

/// Time for zero volts where the process is ended by force.
const LAST_MOMENT: Duration = Duration::from_millis(100);

/// What outlives a life of the node: where the middleware dies the node starts anew in the same
/// process, and a motor that was stopped stays so.
#[derive(Debug, Clone, Default)]
pub struct Lasting {
    stop: StopLatch,
    warmth: Arc<Warmth>,
}

/// Why the node did not become active.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(transparent)]
pub struct NotActive(#[from] TransitionError);

/// Runs the node until `stop`.
///
/// # Errors
/// [`RosNodeError`] if it cannot start; everything later is told in the log.
pub fn run(participant: &Participant, stop: &Stop, lasting: &Lasting) -> Result<(), RosNodeError> {
    let mut driver = RigDriver::lasting(participant, None, None, lasting)?;
    // The log says why it is not active, if it is not.
    let _ = driver.start();
    while !stop.wait(WATCH) {
        driver.tend();
    }
    driver.node.logger().info("leaving");
    // The motor is at zero volts before the node goes.
    driver.halt();
    Ok(())
}

/// The managed node `/rig_driver` with its parameters, services and threads.
pub struct RigDriver {
    axis: Arc<Axis>,
    commander: Commander,
    /// What the parameters say.
    settings: Arc<Mutex<Option<RigSettings>>>,
    lifecycle: Lifecycle,
    autostart: bool,
    diagnostics: Publisher<DiagnosticArray>,
    next: Instant,
    // Dropped last: publishers go before the node they belong to.
    node: RosNode,
}

impl RigDriver {
    /// Joins the participant, unconfigured. `in_cycle` answers each measurement on the control
    /// thread; without it commands come over `/motor_voltage` only. `opened` is the rig of the
    /// first configuration, if it is open already; otherwise the parameters say which.
    ///
    /// # Errors
    /// [`RosNodeError`] if the middleware refuses, or a parameter that was given cannot be.
    pub fn new(
        participant: &Participant,
        in_cycle: Option<Box<dyn InCycle>>,
        opened: Option<UnconfiguredRig>,
    ) -> Result<Self, RosNodeError> {
        Self::lasting(participant, in_cycle, opened, &Lasting::default())
    }

    /// The same, with what is left of the node's lives before.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn lasting(
        participant: &Participant,
        in_cycle: Option<Box<dyn InCycle>>,
        opened: Option<UnconfiguredRig>,
        lasting: &Lasting,
    ) -> Result<Self, RosNodeError> {
        let node = participant.node("rig_driver")?;
        let rig = match node.given("rig") {
            Some(ParameterValue::String(rig)) => rig,
            _ => "simulated".to_owned(),
        };
        let commander = Commander::new(&node, in_cycle.is_some())?;
        let axis = Arc::new({
            let Lasting { stop, warmth } = lasting.clone();
            Axis::new(&node, in_cycle, opened, (stop, warmth))?
        });
        let settings = Arc::new(Mutex::new(None));
        let (judged, driven, named) = (Arc::clone(&settings), Arc::clone(&axis), commander.clone());
        let mut guard = LimitsGuard::default();
        let parameters = Parameters::declare(&node, declarations(&rig), move |values, changed| {
            guard.judge(values, changed, driven.may_move())?;
            let read = RigSettings::read(values)?;
            named.name(values.text("commander"))?;
            *locked(&judged) = Some(read);
            guard.take(values);
            Ok(())
        })?;
        let commands = Arc::clone(&axis.commands);
        let heard = commander.clone();
        node.subscribe_from(&topics::MOTOR_VOLTAGE, move |message, sent| {
            let stamp = message.header.stamp;
            if !heard.hear(sent, stamp != Time::default()) {
                return;
            }
            if let Some(queue) = &mut *locked(&commands) {
                // Before 1970 is long ago; zero says that there is no stamp.
                let stamp_ns = if stamp.sec < 0 { 1 } else { stamp.to_nanos() };
                let (volts, came_ns) = (message.voltage, sent.taken_ns);
                queue.send(VoltageCommand { stamp_ns, volts, came_ns });
            }
        })?;
        let last = Arc::downgrade(&axis);
        ros_node::before_forced_exit(move || {
            if let Some(axis) = last.upgrade() {
                axis.stop_before_exit(LAST_MOMENT);
            }
        });
        let managed = Driver {
            axis: Arc::clone(&axis),
            commander: commander.clone(),
            settings: Arc::clone(&settings),
        };
        let lifecycle = Lifecycle::start(&node, Box::new(managed))?;
        serve(&node, &axis, &lifecycle)?;
        let diagnostics = node.publisher(&topics::DIAGNOSTICS)?;
        let autostart = lifecycle.starts_itself(parameters.values().boolean("autostart"));
        let next = Instant::now() + DIAGNOSTICS;
        Ok(Self { axis, commander, settings, lifecycle, autostart, diagnostics, next, node })
    }

    /// Configures and activates the node, if its parameter `autostart` says so.
    ///
    /// # Errors
    /// [`NotActive`] says why it is not; the log says it too.
    pub fn start(&self) -> Result<(), NotActive> {
        if self.autostart {
            self.lifecycle.request(Requested::Configure)?;
            self.lifecycle.request(Requested::Activate)?;
        }
        Ok(())
    }

    /// Looks for faults and publishes diagnostics once a second. To be called some fifty times a
    /// second.
    pub fn tend(&mut self) {
        self.axis.watch(&self.lifecycle);
        if Instant::now() >= self.next {
            self.next += DIAGNOSTICS;
            self.axis.keep_temperature(false);
            let wanted = locked(&self.settings).clone();
            let (clock, phase) = (self.node.clock(), self.lifecycle.phase());
            let mut message =
                self.axis.diagnostics(clock, phase, wanted.as_ref(), self.node.lagging_readers());
            let name = self.node.identity().qualified();
            message.status.push(self.commander.status(
                &name,
                &self.axis.counters(),
                self.node.twin(),
            ));
            // The next one comes in a second.
            let _ = self.diagnostics.publish(message);
        }
    }

    /// Puts the motor at zero volts and lets go of the rig.
    pub fn halt(&self) {
        self.axis.halt();
    }

    /// What the system said about the control thread's priority; empty before the first
    /// configuration.
    #[must_use]
    pub fn priority(&self) -> String {
        self.axis.priority()
    }

    /// A sentence about the node of the same name that was there before, if there is one: this one
    /// stays inactive.
    #[must_use]
    pub fn elder(&self) -> Option<String> {
        self.lifecycle.elder()
    }

    /// State of the safety layer in the last cycle.
    #[must_use]
    pub fn state(&self) -> State {
        self.axis.state()
    }

    /// Cycles that were published, and cycles that were not: the queue was full, or the middleware
    /// refused.
    #[must_use]
    pub fn published(&self) -> (u64, u64) {
        self.axis.published()
    }

    /// Cycles that started a whole period late or more.
    #[must_use]
    pub fn overruns(&self) -> u64 {
        self.axis.overruns()
    }
}

impl Drop for RigDriver {
    fn drop(&mut self) {
        self.axis.halt();
    }
}

/// Offers what people stop and mend the rig with.
fn serve(node: &RosNode, axis: &Arc<Axis>, lifecycle: &Lifecycle) -> Result<(), RosNodeError> {
    let answer = |result: Result<String, String>| match result {
        Ok(message) => TriggerResponse { success: true, message },
        Err(message) => TriggerResponse { success: false, message },
    };
    let this = Arc::clone(axis);
    node.serve_apart::<Trigger>("~/emergency_stop", move |_| answer(this.emergency_stop()))?;
    let (this, states) = (Arc::clone(axis), lifecycle.clone());
    node.serve::<Trigger>("~/clear_fault", move |_| answer(this.clear(&states)))?;
    let this = Arc::clone(axis);
    node.serve::<Trigger>("~/zero_sensors", move |_| answer(this.zero()))
}

/// What the managed node does on its way.
struct Driver {
    axis: Arc<Axis>,
    commander: Commander,
    settings: Arc<Mutex<Option<RigSettings>>>,
}

impl Managed for Driver {
    fn configure(&mut self) -> Result<(), CallbackError> {
        let settings = locked(&self.settings).clone();
        Ok(self.axis.carry_out(Kind::Configure, settings.as_ref())?)
    }

    fn activate(&mut self) -> Result<(), CallbackError> {
        self.commander.open()?;
        if let Err(reason) = self.axis.carry_out(Kind::Activate, None) {
            self.commander.close();
            return Err(reason.into());
        }
        Ok(())
    }

    fn deactivate(&mut self) -> Result<(), CallbackError> {
        self.commander.close();
        match self.axis.carry_out(Kind::Deactivate, None) {
            Ok(()) => Ok(()),
            // A fault has deactivated the safety layer already; then there is nothing to do but to
            // say so.
            Err(_) if self.axis.state() != State::Active => Ok(()),
            Err(reason) => Err(CallbackError::Error(reason)),
        }
    }

    fn clean_up(&mut self) -> Result<(), CallbackError> {
        Ok(self.axis.carry_out(Kind::CleanUp, None)?)
    }

    fn shut_down(&mut self) -> Result<(), CallbackError> {
        self.axis.halt();
        Ok(())
    }

    fn recover(&mut self) -> Result<(), CallbackError> {
        self.clean_up()
    }
}
