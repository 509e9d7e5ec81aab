//! What a message may say of one shaft. Finite numbers beyond are slips of units, or malice: they
//! would fill the states of the linear laws for longer than anybody waits.

use crate::Reference;

/// Largest speed [rad/s]: a thousand turns a minute, ten times what the drive reaches.
const SPEED: f64 = 105.0;
/// Largest acceleration [rad/s^2]: that speed within a millisecond.
const ACCELERATION: f64 = 105e3;
/// Largest position \[rad\], reached after two and a half hours at that speed.
const POSITION: f64 = 1e6;

/// Whether a reference is one. Not a number is none.
pub(super) fn is_reference(reference: &Reference) -> bool {
    reference.position.abs() <= POSITION
        && reference.velocity.abs() <= SPEED
        && reference.acceleration.abs() <= ACCELERATION
}

/// Where a joint stands in a joint state's lists: without any names the first is meant.
pub(super) fn index_of(joint: &str, names: &[String]) -> Option<usize> {
    names.iter().position(|name| name == joint).or(names.is_empty().then_some(0))
}

/// Whether a joint state is to be left out. What is no number is not: the controller counts it, and
/// stops after a few.
pub(super) fn is_beyond(position: f64, velocity: f64) -> bool {
    position.is_finite()
        && velocity.is_finite()
        && !(position.abs() <= POSITION && velocity.abs() <= SPEED)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_no_shaft_are_left_out() {
        let at = |position, velocity, acceleration| {
            is_reference(&Reference { position, velocity, acceleration })
        };
        assert!(at(0.0, 0.0, 0.0) && at(-1e5, 10.0, -1e3));
        for bad in [f64::NAN, f64::INFINITY, -1e308, 1e7] {
            assert!(!at(bad, 0.0, 0.0) && !at(0.0, bad, 0.0) && !at(0.0, 0.0, bad), "{bad}");
        }
        assert!(is_beyond(0.0, 1e308) && is_beyond(-1e7, 0.0));
        assert!(
            !is_beyond(f64::NAN, 0.0) && !is_beyond(0.0, f64::INFINITY) && !is_beyond(1.0, -9.5)
        );
    }
}
