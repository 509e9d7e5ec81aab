//! The thread that controls: one command for each joint state. While it runs it locks, allocates and publishes nothing.

use std::time::{Duration, Instant};

use ros_node::queue::{Receiver, Sender, Waker};

use super::{parameters::ControlSettings, reference::ReferenceKeeper};
use crate::{Command, ControlFault, Controller, Feedback, Reference};

/// One joint state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    pub(super) stamp_ns: u64,
    pub(super) position: f64,
    pub(super) velocity: f64,
}

/// One friction estimate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Friction {
    pub(super) stamp_ns: u64,
    pub(super) torque: f64,
}

/// What people ask of it, taken at the beginning of a cycle.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::large_enum_variant, reason = "settings travel in place: taking them allocates nothing")]
pub(super) enum Order {
    Settings(ControlSettings),
    Reset,
    Run(bool),
}

/// What the thread is told, each by its own queue.
pub(super) struct Inputs {
    pub(super) joints: Receiver<Joint>,
    pub(super) frictions: Receiver<Friction>,
    pub(super) references: Receiver<Reference>,
    pub(super) orders: Receiver<Order>,
}

/// One command on its way to the publisher.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decided {
    pub(super) stamp_ns: u64,
    pub(super) command: Command,
    pub(super) fault: Option<ControlFault>,
    /// It stands in for a reference that does not come.
    pub(super) stale_reference: bool,
    /// The estimate that belongs to the joint state had come.
    pub(super) fresh_estimate: bool,
}

/// Controls until the joint states' queue has no other end.
pub(super) fn control(
    mut settings: ControlSettings,
    mut controller: Controller,
    mut inputs: Inputs,
    mut out: Sender<Decided>,
) {
    let period = settings.options.period;
    let mut keeper: Option<ReferenceKeeper> = None;
    let mut friction = Friction::default();
    let mut runs = false;
    let mut pending: Option<(Joint, Instant)> = None;
    let mut last_stamp = 0;
    loop {
        while let Some(order) = inputs.orders.take() {
            match order {
                Order::Reset => controller.reset(),
                Order::Run(wanted) => {
                    if wanted && !runs {
                        controller.reset();
                        (keeper, friction) = (None, Friction::default());
                        // What was said before it was active does not count.
                        let _ = inputs.references.take_last();
                    }
                    runs = wanted;
                }
                Order::Settings(new) => {
                    // It was built once by the one who sent it: it cannot fail.
                    if new.options == settings.options || controller.change(new.options).is_ok() {
                        settings = new;
                        if let Some(keeper) = &mut keeper {
                            keeper.limit(new.reference_timeout, new.reference_deceleration);
                        }
                    }
                }
            }
        }
        friction = inputs.frictions.take_last().unwrap_or(friction);
        if pending.is_none() {
            pending = inputs.joints.take().map(|joint| (joint, Instant::now()));
        }
        let Some((joint, came)) = pending else {
            if inputs.joints.is_over() {
                return;
            }
            Waker::sleep(Duration::from_millis(100));
            continue;
        };
        // A joint state that comes twice, or late, is no news.
        if !runs || joint.stamp_ns <= last_stamp && last_stamp - joint.stamp_ns < 1_000_000_000 {
            pending = None;
            last_stamp = last_stamp.max(joint.stamp_ns);
            continue;
        }
        let fresh = friction.stamp_ns >= joint.stamp_ns;
        let needed = settings.options.compensation.enabled && friction.stamp_ns > 0;
        let wait = Duration::from_secs_f64(settings.estimate_wait);
        if needed && !fresh && came.elapsed() < wait {
            Waker::sleep(wait.saturating_sub(came.elapsed()));
            continue;
        }
        pending = None;
        last_stamp = joint.stamp_ns;
        let keeper = keeper.get_or_insert_with(|| {
            ReferenceKeeper::new(settings.reference_timeout, settings.reference_deceleration, joint.position)
        });
        while let Some(reference) = inputs.references.take() {
            keeper.take(reference);
        }
        let reference = keeper.next(period);
        let age = joint.stamp_ns.saturating_sub(friction.stamp_ns) as f64 * 1e-9;
        let torque = if age <= settings.estimate_timeout { friction.torque } else { 0.0 };
        let feedback =
            Feedback { position: joint.position, velocity: joint.velocity, friction: torque, cycle: None };
        let command = controller.step(&reference, &feedback);
        out.send(Decided {
            stamp_ns: joint.stamp_ns,
            command,
            fault: command.fault,
            stale_reference: keeper.is_stale(),
            fresh_estimate: fresh,
        });
    }
}
