//! One estimate for each joint state, and the thread that makes them. While it runs it locks,
//! allocates and publishes nothing.

use std::time::Duration;

use ros_node::queue::{Receiver, Sender, Waker};

use crate::parameters::{ObserverSettings, Regulated};
use crate::{Estimate, FrictionEstimator, Seen};

/// One joint state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Time of the measurement \[ns since the epoch\].
    pub stamp_ns: u64,
    /// Position \[rad\].
    pub position: f64,
    /// Velocity \[rad/s\].
    pub velocity: f64,
    /// Friction torque \[N m\], where it is measured.
    pub effort: Option<f64>,
}

/// What goes with a joint state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beside {
    /// Voltage on the motor in the period before \[V\].
    pub volts: f64,
    /// Position of the reference \[rad\].
    pub reference_position: f64,
    /// Velocity of the reference \[rad/s\].
    pub reference_velocity: f64,
}

/// What the thread is told, each by its own queue.
pub(super) struct Inputs {
    pub(super) joints: Receiver<Joint>,
    /// Volts.
    pub(super) voltages: Receiver<f64>,
    /// Position \[rad\] and velocity \[rad/s\].
    pub(super) references: Receiver<(f64, f64)>,
}

/// What people ask of it, taken at the beginning of a cycle.
#[derive(Debug, Clone, Copy)]
#[expect(
    clippy::large_enum_variant,
    reason = "settings travel in place: taking them allocates nothing"
)]
pub(super) enum Order {
    Settings(ObserverSettings),
    Reset,
    Run(bool),
}

/// One estimate on its way to the publisher.
#[derive(Debug, Clone, Copy)]
pub struct Estimated {
    /// Time of the measurement \[ns since the epoch\].
    pub stamp_ns: u64,
    /// What is thought of it.
    pub estimate: Estimate,
}

/// The estimator of the running node: settings, resets and the lifecycle reach it as orders, which
/// it takes between two cycles.
pub struct Estimation {
    settings: ObserverSettings,
    estimator: FrictionEstimator,
    orders: Receiver<Order>,
    runs: bool,
}

impl Estimation {
    pub(super) fn new(
        settings: ObserverSettings,
        estimator: FrictionEstimator,
        orders: Receiver<Order>,
    ) -> Self {
        Self { settings, estimator, orders, runs: false }
    }

    /// Does what people asked for since the last cycle.
    pub fn take_orders(&mut self) {
        while let Some(order) = self.orders.take() {
            match order {
                Order::Reset => self.estimator.reset(),
                Order::Run(wanted) => {
                    if wanted && !self.runs {
                        self.estimator.reset();
                    }
                    self.runs = wanted;
                }
                Order::Settings(new) => {
                    // It was built once by the one who sent it: it cannot fail.
                    if (new.model, new.options) == (self.settings.model, self.settings.options)
                        || self.estimator.change(&new.model, new.options).is_ok()
                    {
                        self.settings = new;
                    }
                }
            }
        }
    }

    /// Back to rest, as when the motor begins to move.
    pub fn reset(&mut self) {
        self.estimator.reset();
    }

    /// The estimate for a joint state; none while the node is not active.
    pub fn step(&mut self, joint: &Joint, beside: &Beside) -> Option<Estimated> {
        if !self.runs {
            return None;
        }
        let error = if self.settings.regulated == Regulated::Position {
            joint.position - beside.reference_position
        } else {
            joint.velocity - beside.reference_velocity
        };
        let estimate = self.estimator.estimate(&Seen {
            velocity: joint.velocity,
            position: joint.position,
            reference_velocity: beside.reference_velocity,
            error,
            voltage: beside.volts,
            torque: joint.effort.filter(|effort| effort.is_finite()),
        });
        Some(Estimated { stamp_ns: joint.stamp_ns, estimate })
    }
}

/// Estimates until the joint states' queue has no other end.
pub(super) fn estimate(mut estimation: Estimation, mut inputs: Inputs, mut out: Sender<Estimated>) {
    let mut beside = Beside::default();
    loop {
        estimation.take_orders();
        beside.volts = inputs.voltages.take_last().unwrap_or(beside.volts);
        if let Some(reference) = inputs.references.take_last() {
            (beside.reference_position, beside.reference_velocity) = reference;
        }
        let Some(joint) = inputs.joints.take() else {
            if inputs.joints.is_over() {
                return;
            }
            Waker::sleep(Duration::from_millis(100));
            continue;
        };
        if let Some(estimated) = estimation.step(&joint, &beside) {
            out.send(estimated);
        }
    }
}
