//! The thread that estimates: one estimate for each joint state. While it runs it locks, allocates and publishes nothing.

use std::time::Duration;

use ros_node::queue::{Receiver, Sender, Waker};

use super::parameters::ObserverSettings;
use crate::{Estimate, FrictionEstimator, Seen};

/// One joint state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    pub(super) stamp_ns: u64,
    pub(super) position: f64,
    pub(super) velocity: f64,
    pub(super) effort: Option<f64>,
}

/// What the thread is told, each by its own queue.
pub(super) struct Inputs {
    pub(super) joints: Receiver<Joint>,
    /// Volts.
    pub(super) voltages: Receiver<f64>,
    /// Position [rad] and velocity [rad/s].
    pub(super) references: Receiver<(f64, f64)>,
    pub(super) orders: Receiver<Order>,
}

/// What people ask of it, taken at the beginning of a cycle.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::large_enum_variant, reason = "settings travel in place: taking them allocates nothing")]
pub(super) enum Order {
    Settings(ObserverSettings),
    Reset,
    Run(bool),
}

/// One estimate on its way to the publisher.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimated {
    pub(super) stamp_ns: u64,
    pub(super) estimate: Estimate,
}

/// Estimates until the joint states' queue has no other end.
pub(super) fn estimate(
    mut settings: ObserverSettings,
    mut estimator: FrictionEstimator,
    mut inputs: Inputs,
    mut out: Sender<Estimated>,
) {
    let (mut volts, mut reference) = (0.0, (0.0, 0.0));
    let mut runs = false;
    loop {
        while let Some(order) = inputs.orders.take() {
            match order {
                Order::Reset => estimator.reset(),
                Order::Run(wanted) => {
                    if wanted && !runs {
                        estimator.reset();
                    }
                    runs = wanted;
                }
                Order::Settings(new) => {
                    // It was built once by the one who sent it: it cannot fail.
                    if (new.model, new.options) == (settings.model, settings.options)
                        || estimator.change(&new.model, new.options).is_ok()
                    {
                        settings = new;
                    }
                }
            }
        }
        volts = inputs.voltages.take_last().unwrap_or(volts);
        reference = inputs.references.take_last().unwrap_or(reference);
        let Some(joint) = inputs.joints.take() else {
            if inputs.joints.is_over() {
                return;
            }
            Waker::sleep(Duration::from_millis(100));
            continue;
        };
        if !runs {
            continue;
        }
        let error =
            if settings.position { joint.position - reference.0 } else { joint.velocity - reference.1 };
        let estimate = estimator.estimate(&Seen {
            velocity: joint.velocity,
            position: joint.position,
            reference_velocity: reference.1,
            error,
            voltage: volts,
            torque: joint.effort.filter(|effort| effort.is_finite()),
        });
        out.send(Estimated { stamp_ns: joint.stamp_ns, estimate });
    }
}
