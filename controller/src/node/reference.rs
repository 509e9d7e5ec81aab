//! The reference as it comes over a network, and what stands in for it when it stops coming.

use crate::Reference;

/// Follows references; one that is too old ramps to zero velocity.
#[derive(Debug, Clone, Copy)]
pub(super) struct ReferenceKeeper {
    /// Age at which a reference is stale \[s\].
    timeout: f64,
    /// How fast its velocity goes to zero then \[rad/s^2\].
    deceleration: f64,
    /// From which velocity it goes there at most \[rad/s\].
    fastest: f64,
    now: Reference,
    age: f64,
}

impl ReferenceKeeper {
    /// Stands still at `position` \[rad\] until the first reference; without [limits](Self::limit)
    /// each is stale at once.
    pub(super) fn new(position: f64) -> Self {
        let now = Reference { position, ..Reference::default() };
        Self { timeout: 0.0, deceleration: 0.0, fastest: 0.0, now, age: f64::INFINITY }
    }

    /// Limits from now on: the age at which a reference is stale \[s\], how fast its velocity goes
    /// to zero then \[rad/s^2\], and from which velocity at most \[rad/s\].
    pub(super) fn limit(&mut self, timeout: f64, deceleration: f64, fastest: f64) {
        (self.timeout, self.deceleration, self.fastest) = (timeout, deceleration, fastest);
    }

    /// Takes a reference that came `age` \[s\] ago. One that is not finite, or stale already,
    /// counts as not come.
    pub(super) fn take(&mut self, reference: Reference, age: f64) {
        let Reference { position, velocity, acceleration } = reference;
        if position.is_finite()
            && velocity.is_finite()
            && acceleration.is_finite()
            && age <= self.timeout
        {
            (self.now, self.age) = (reference, age);
        }
    }

    /// The reference for a cycle of `period` \[s\].
    pub(super) fn next(&mut self, period: f64) -> Reference {
        let is = self.now;
        self.age += period;
        if self.age > self.timeout {
            // The shaft was never faster than that, whatever it was asked for.
            let before = self.now.velocity.clamp(-self.fastest, self.fastest);
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

    fn keeper(position: f64) -> ReferenceKeeper {
        let mut keeper = ReferenceKeeper::new(position);
        keeper.limit(0.5, 2.0, 10.0);
        keeper
    }

    #[test]
    fn a_stale_reference_that_nothing_could_follow_ramps_from_what_the_drive_reaches() {
        let mut keeper = keeper(0.0);
        keeper.take(Reference { velocity: 100.0, ..Reference::default() }, 0.0);
        let stops = (0..).position(|_| keeper.next(1e-3).velocity == 0.0).unwrap();
        assert!(
            (5490..=5510).contains(&stops),
            "{stops} cycles: 0.5 s until it is stale, 5 s from 10 rad/s"
        );
    }

    #[test]
    fn a_stale_reference_ramps_to_zero_velocity_and_its_position_follows() {
        let mut keeper = keeper(0.0);
        keeper.take(Reference { position: 1.0, velocity: 1.0, acceleration: 0.0 }, 0.0);
        for _ in 0..499 {
            assert_eq!(
                keeper.next(1e-3),
                Reference { position: 1.0, velocity: 1.0, acceleration: 0.0 }
            );
        }
        assert!(!keeper.is_stale());
        let ramp: Vec<_> = (0..700).map(|_| keeper.next(1e-3)).collect();
        assert!(keeper.is_stale());
        assert!(
            ramp.windows(2).all(|pair| (pair[0].velocity - pair[1].velocity - 2e-3).abs() < 1e-9
                || pair[1].velocity == 0.0)
        );
        let last = ramp[ramp.len() - 1];
        assert_eq!((last.velocity, last.acceleration), (0.0, 0.0));
        // v^2 / (2 a) from where it was.
        assert!((last.position - 1.25).abs() < 2e-3, "{}", last.position);
        keeper.take(Reference { velocity: -1.0, ..Reference::default() }, 0.0);
        assert_eq!(keeper.next(1e-3).velocity, -1.0);
    }

    #[test]
    fn before_the_first_reference_it_stands_where_it_is() {
        let mut keeper = keeper(0.7);
        keeper.take(Reference { velocity: f64::NAN, ..Reference::default() }, 0.0);
        assert_eq!(
            keeper.next(1e-3),
            Reference { position: 0.7, velocity: 0.0, acceleration: 0.0 }
        );
    }

    #[test]
    fn a_reference_that_waited_too_long_to_be_heard_moves_nothing() {
        let mut keeper = keeper(0.0);
        keeper.take(Reference { velocity: 1.0, ..Reference::default() }, 0.6);
        assert_eq!(keeper.next(1e-3).velocity, 0.0);
        keeper.take(Reference { velocity: 1.0, ..Reference::default() }, 0.4);
        let full = (0..300).filter(|_| keeper.next(1e-3).velocity == 1.0).count();
        assert!((99..=101).contains(&full), "{full}: what it waited counts");
    }
}
