//! Numbers from sensors, kept within what can be computed with.

use friction_model::MAX_SPEED;

/// `x` cut to a magnitude of 1e6; zero if it is not a number.
#[inline]
pub(crate) fn held(x: f64) -> f64 {
    if x.is_nan() { 0.0 } else { x.clamp(-MAX_SPEED, MAX_SPEED) }
}

/// `x` if it is finite, cut to a magnitude of 1e6.
#[inline]
pub(crate) fn believed(x: f64) -> Option<f64> {
    x.is_finite().then(|| x.clamp(-MAX_SPEED, MAX_SPEED))
}
