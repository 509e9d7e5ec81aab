//! The reference as it comes over a network, and what stands in for it when it stops coming.

use crate::Reference;

/// Follows references; one that is too old ramps to zero velocity.
#[derive(Debug, Clone, Copy)]
pub(super) struct ReferenceKeeper {
    /// Age at which a reference is stale [s].
    timeout: f64,
    /// How fast its velocity goes to zero then [rad/s^2].
    deceleration: f64,
    now: Reference,
    age: f64,
}

impl ReferenceKeeper {
    /// Stands still at `position` [rad] until the first reference.
    pub(super) fn new(timeout: f64, deceleration: f64, position: f64) -> Self {
        let now = Reference { position, ..Reference::default() };
        Self { timeout, deceleration, now, age: f64::INFINITY }
    }

    /// Other limits from now on.
    pub(super) fn limit(&mut self, timeout: f64, deceleration: f64) {
        (self.timeout, self.deceleration) = (timeout, deceleration);
    }

    /// Takes a new reference. One that is not finite counts as not come.
    pub(super) fn take(&mut self, reference: Reference) {
        let Reference { position, velocity, acceleration } = reference;
        if position.is_finite() && velocity.is_finite() && acceleration.is_finite() {
            (self.now, self.age) = (reference, 0.0);
        }
    }

    /// The reference for a cycle of `period` [s].
    pub(super) fn next(&mut self, period: f64) -> Reference {
        let is = self.now;
        self.age += period;
        if self.age > self.timeout {
            let before = self.now.velocity;
            let step = self.deceleration * period;
            let velocity = before - before.clamp(-step, step);
            // Towards zero it decelerates; at zero it stands.
            let acceleration = (velocity - before) / period;
            let position = self.now.position + 0.5 * (before + velocity) * period;
            self.now = Reference { position, velocity, acceleration };
            return self.now;
        }
        is
    }

    /// Whether it stands in for a reference that does not come.
    pub(super) fn is_stale(&self) -> bool {
        self.age > self.timeout
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stale_reference_ramps_to_zero_velocity_and_its_position_follows() {
        let mut keeper = ReferenceKeeper::new(0.5, 2.0, 0.0);
        keeper.take(Reference { position: 1.0, velocity: 1.0, acceleration: 0.0 });
        for _ in 0..499 {
            assert_eq!(keeper.next(1e-3), Reference { position: 1.0, velocity: 1.0, acceleration: 0.0 });
        }
        assert!(!keeper.is_stale());
        let ramp: Vec<_> = (0..700).map(|_| keeper.next(1e-3)).collect();
        assert!(keeper.is_stale());
        assert!(
            ramp.windows(2)
                .all(|pair| (pair[0].velocity - pair[1].velocity - 2e-3).abs() < 1e-9
                    || pair[1].velocity == 0.0)
        );
        let last = ramp[ramp.len() - 1];
        assert_eq!((last.velocity, last.acceleration), (0.0, 0.0));
        // v^2 / (2 a) from where it was.
        assert!((last.position - 1.25).abs() < 2e-3, "{}", last.position);
        keeper.take(Reference { velocity: -1.0, ..Reference::default() });
        assert_eq!(keeper.next(1e-3).velocity, -1.0);
    }

    #[test]
    fn before_the_first_reference_it_stands_where_it_is() {
        let mut keeper = ReferenceKeeper::new(0.5, 2.0, 0.7);
        keeper.take(Reference { velocity: f64::NAN, ..Reference::default() });
        assert_eq!(keeper.next(1e-3), Reference { position: 0.7, velocity: 0.0, acceleration: 0.0 });
    }
}
