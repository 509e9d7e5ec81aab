//! Changing what estimates while it runs: the estimate goes over in a stated time, without a jump.

use crate::running::Running;
use crate::{Estimate, Seen};

/// What is being left.
#[derive(Debug, Clone)]
#[expect(
    clippy::large_enum_variant,
    reason = "states live in place: the step path does not allocate"
)]
enum Leaving {
    /// An estimator that goes on estimating.
    Running(Running),
    /// A torque that is held [N m]: the change came in the middle of another one.
    Held(f64),
}

/// A change that is under way.
#[derive(Debug, Clone)]
pub(crate) struct Change {
    from: Leaving,
    /// Share of what is being left, from 1 down to 0.
    share: f64,
    step: f64,
}

impl Change {
    /// A change away from `from` that takes `cycles`.
    pub(crate) fn away_from(from: Running, cycles: f64) -> Self {
        Self { from: Leaving::Running(from), share: 1.0, step: 1.0 / cycles.max(1.0) }
    }

    /// A change away from a torque \[N m\].
    pub(crate) fn away_from_torque(torque: f64, cycles: f64) -> Self {
        Self { from: Leaving::Held(torque), share: 1.0, step: 1.0 / cycles.max(1.0) }
    }

    /// Mixes what is being left into `estimate`; false once nothing of it is left.
    #[inline]
    pub(crate) fn mix(&mut self, seen: &Seen, estimate: &mut Estimate) -> bool {
        let left = match &mut self.from {
            Leaving::Running(running) => running.estimate(seen).1.torque,
            Leaving::Held(torque) => *torque,
        };
        estimate.torque += self.share * (left - estimate.torque);
        estimate.residual = seen.torque.map(|measured| measured - estimate.torque);
        self.share -= self.step;
        self.share > 0.0
    }
}
