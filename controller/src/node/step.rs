//! One command for each joint state, and the thread that gives them. While it runs it locks,
//! allocates and publishes nothing.

use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use ros_node::queue::{Receiver, Sender, Waker};

use super::{
    estimates::Estimates, friction::Friction, parameters::ControlSettings,
    reference::ReferenceKeeper,
};
use crate::{Command, Compensation, ControlFault, ControlMode, Controller, Feedback, Reference};

/// Time without joint states after which the loop begins anew \[s\]: the rig driver takes that of
/// commands for a fault.
const SILENCE: f64 = 0.5;
/// A joint state that is older than the one before by that much is of a driver that was started
/// anew, by another clock \[ns\].
const RESTARTED: u64 = 1_000_000_000;

/// One joint state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Time of the measurement \[ns since the epoch\].
    pub stamp_ns: u64,
    /// Position \[rad\].
    pub position: f64,
    /// Velocity \[rad/s\].
    pub velocity: f64,
    /// Number of the measurement, where it is known: one that comes twice is found by it.
    pub cycle: Option<u64>,
}

/// What people ask of it, taken at the beginning of a cycle.
#[derive(Debug, Clone, Copy)]
#[expect(
    clippy::large_enum_variant,
    reason = "settings travel in place: taking them allocates nothing"
)]
pub(super) enum Order {
    Settings(ControlSettings),
    Reset,
    Run(bool),
}

/// What the thread is told, each by its own queue.
pub(super) struct Inputs {
    pub(super) joints: Receiver<Joint>,
    pub(super) frictions: Receiver<Friction>,
    /// Counts estimates that answer no joint state.
    pub(super) strange: Arc<AtomicU64>,
}

/// One command on its way to the publisher.
#[derive(Debug, Clone, Copy)]
pub struct Decided {
    /// Time of the measurement \[ns since the epoch\].
    pub stamp_ns: u64,
    /// What was decided.
    pub command: Command,
    /// Why it is zero volts, if it is.
    pub fault: Option<ControlFault>,
    /// It stands in for a reference that does not come.
    pub stale_reference: bool,
    /// The estimate that belongs to the joint state had come.
    pub fresh_estimate: bool,
}

/// The controller of the running node: settings, resets, the lifecycle and references reach it by
/// queues, which it empties between two cycles.
pub struct Control {
    settings: ControlSettings,
    controller: Controller,
    orders: Receiver<Order>,
    /// With the moment at which each came.
    references: Receiver<(Reference, Instant)>,
    newest_reference: Option<(Reference, Instant)>,
    keeper: Option<ReferenceKeeper>,
    runs: bool,
    faulted: bool,
    /// Whether the last cycle had an estimate that counts; `None` before the first.
    estimated: Option<bool>,
}

impl Control {
    pub(super) fn new(
        settings: ControlSettings,
        controller: Controller,
        orders: Receiver<Order>,
        references: Receiver<(Reference, Instant)>,
    ) -> Self {
        Self {
            settings,
            controller,
            orders,
            references,
            newest_reference: None,
            keeper: None,
            runs: false,
            faulted: false,
            estimated: None,
        }
    }

    /// Does what people asked for since the last cycle.
    pub fn take_orders(&mut self) {
        while let Some(order) = self.orders.take() {
            match order {
                Order::Reset => self.controller.reset(),
                Order::Run(wanted) => {
                    if wanted && !self.runs {
                        self.reset();
                        // What was said before it was active does not count.
                        let _ = self.references.take_last();
                        self.newest_reference = None;
                    }
                    self.runs = wanted;
                }
                Order::Settings(new) => {
                    // It was built once by the one who sent it: it cannot fail.
                    if new.options == self.settings.options
                        || self.controller.change(new.options).is_ok()
                    {
                        self.settings = new;
                        if let Some(keeper) = &mut self.keeper {
                            keeper.limit(
                                new.reference_timeout,
                                new.reference_deceleration,
                                new.fastest,
                            );
                        }
                    }
                }
            }
        }
        // Also while no joint state comes: a full queue would keep the oldest.
        self.newest_reference = self.references.take_last().or(self.newest_reference.take());
    }

    /// Back to rest, unless a fault is latched: the shaft may be elsewhere, and what was asked for
    /// before is old.
    fn begin_anew(&mut self) {
        self.keeper = None;
        if !self.faulted {
            self.controller.reset();
        }
    }

    /// Back to rest, without a reference, as when the motor begins to move.
    pub fn reset(&mut self) {
        self.controller.reset();
        self.keeper = None;
    }

    /// Whether the node is active.
    #[must_use]
    pub const fn runs(&self) -> bool {
        self.runs
    }

    /// What is regulated, in the settings that count now.
    #[must_use]
    pub const fn mode(&self) -> ControlMode {
        self.settings.options.mode
    }

    /// The reference for a cycle: the newest that came, or what stands in for it. `position`
    /// \[rad\] is where the axis stands without any.
    pub fn next_reference(&mut self, position: f64) -> Reference {
        let settings = &self.settings;
        let keeper = self.keeper.get_or_insert_with(|| {
            let mut keeper = ReferenceKeeper::new(position);
            keeper.limit(
                settings.reference_timeout,
                settings.reference_deceleration,
                settings.fastest,
            );
            keeper
        });
        if let Some((reference, came)) = self.newest_reference.take() {
            keeper.take(reference, came.elapsed().as_secs_f64());
        }
        keeper.next(settings.options.period)
    }

    /// The command for a joint state; none while the node is not active. `friction` is the newest
    /// estimate.
    pub fn step(
        &mut self,
        joint: &Joint,
        reference: &Reference,
        friction: &Friction,
    ) -> Option<Decided> {
        if !self.runs {
            return None;
        }
        let Compensation { volts_per_newton_metre, .. } = self.settings.options.compensation;
        // One from the future belongs to another clock.
        let age = joint.stamp_ns.abs_diff(friction.stamp_ns) as f64 * 1e-9;
        // More than the motor can overcome is no friction that it could compensate: it would be
        // full voltage.
        let volts = friction.torque.abs() * volts_per_newton_metre;
        let counts =
            age <= self.settings.estimate_timeout && volts <= self.settings.options.voltage_limit;
        let friction_torque = if counts { friction.torque } else { 0.0 };
        // An observer that went away or came back is no reason to kick the shaft.
        if self.estimated.replace(counts).is_some_and(|before| before != counts) {
            self.controller.replace_estimate(friction_torque);
        }
        let feedback = Feedback {
            position: joint.position,
            velocity: joint.velocity,
            friction: friction_torque,
            cycle: joint.cycle,
        };
        let command = self.controller.step(reference, &feedback);
        self.faulted = command.fault.is_some();
        Some(Decided {
            stamp_ns: joint.stamp_ns,
            command,
            fault: command.fault,
            stale_reference: self.keeper.is_some_and(|keeper| keeper.is_stale()),
            fresh_estimate: counts && friction.stamp_ns >= joint.stamp_ns,
        })
    }
}

/// Controls until the joint states' queue has no other end.
pub(super) fn control(mut control: Control, mut inputs: Inputs, mut out: Sender<Decided>) {
    // As many as an estimate may be late: a second at most.
    let mut estimates = Estimates::new((1.0 / control.settings.options.period) as usize + 2);
    let mut pending: Option<(Joint, Instant)> = None;
    let mut last_stamp = 0;
    loop {
        let ran = control.runs();
        control.take_orders();
        if control.runs() && !ran {
            estimates.clear();
        }
        if pending.is_none() {
            pending = inputs.joints.take().map(|joint| (joint, Instant::now()));
            if let Some((joint, _)) = pending {
                if joint.stamp_ns < last_stamp && last_stamp - joint.stamp_ns >= RESTARTED {
                    estimates.clear();
                }
                estimates.see(joint.stamp_ns);
            }
        }
        while let Some(friction) = inputs.frictions.take() {
            estimates.take(friction);
        }
        inputs.strange.fetch_add(estimates.strange(), Ordering::Relaxed);
        let friction = estimates.newest();
        let Some((joint, came)) = pending else {
            if inputs.joints.is_over() {
                return;
            }
            Waker::sleep(Duration::from_millis(100));
            continue;
        };
        // A joint state that comes twice, or late, is no news.
        if !control.runs()
            || joint.stamp_ns <= last_stamp && last_stamp - joint.stamp_ns < RESTARTED
        {
            pending = None;
            last_stamp = last_stamp.max(joint.stamp_ns);
            continue;
        }
        let settings = &control.settings;
        let needed = settings.options.compensation.enabled && friction.stamp_ns > 0;
        let wait = Duration::from_secs_f64(settings.estimate_wait);
        if needed && friction.stamp_ns < joint.stamp_ns && came.elapsed() < wait {
            Waker::sleep(wait.saturating_sub(came.elapsed()));
            continue;
        }
        pending = None;
        if joint.stamp_ns.saturating_sub(last_stamp) as f64 * 1e-9 > SILENCE {
            control.begin_anew();
        }
        last_stamp = joint.stamp_ns;
        let reference = control.next_reference(joint.position);
        if let Some(decided) = control.step(&joint, &reference, &friction) {
            out.send(decided);
        }
    }
}
