//! What the formulas of models are written with, beside the functions of floating-point numbers.

#[cfg(not(feature = "std"))]
use num_traits::Float as _;

use crate::MAX_SPEED;

/// A velocity that the fixed-step forms can be stepped with.
#[inline]
#[must_use]
pub fn bounded(velocity: f64) -> f64 {
    if velocity.is_nan() { 0.0 } else { velocity.clamp(-MAX_SPEED, MAX_SPEED) }
}

/// `int_0^h exp(-a t) dt`: what is left after `h` [s] of a rate of one into a state that relaxes at
/// `a` [1/s], zero or more.
#[inline]
#[must_use]
pub fn relaxed(a: f64, h: f64) -> f64 {
    let x = a * h;
    // The quotient loses digits below this, where the series is exact.
    if x < 1e-8 { h } else { -(-x).exp_m1() / a }
}

/// `a b + c`: with one rounding where the program is built for a processor that has an instruction
/// for it, as C compilers do.
#[inline]
#[must_use]
pub fn fused(a: f64, b: f64, c: f64) -> f64 {
    #[cfg(all(feature = "std", target_feature = "fma"))]
    return a.mul_add(b, c);
    #[cfg(not(all(feature = "std", target_feature = "fma")))]
    return a * b + c;
}

/// `sgn v` with `sgn 0 = 0`.
#[inline]
#[must_use]
pub fn sign(v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { v.signum() }
}

/// `sat(b, x)`: `x` cut to `[-b, b]`, for `b >= 0`.
#[inline]
#[must_use]
pub fn saturate(b: f64, x: f64) -> f64 {
    between(-b, b, x)
}

/// `x` cut to `[low, high]`. Unlike `f64::clamp` it cannot panic, and unlike `f64::min` and `max`,
/// which must sort out what is not a number, each comparison is one instruction.
#[inline]
#[must_use]
pub fn between(low: f64, high: f64, x: f64) -> f64 {
    let x = if x < high { x } else { high };
    if x > low { x } else { low }
}
