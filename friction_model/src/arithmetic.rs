//! What the formulas of models are written with, beside the functions of floating-point numbers.

use crate::Real;

/// Velocities beyond this magnitude are cut to it by the fixed-step form \[m/s or rad/s\].
pub const MAX_SPEED: f64 = 1e6;

/// A velocity that the fixed-step forms can be stepped with.
#[inline(always)]
#[must_use]
pub fn bounded<T: Real>(velocity: T) -> T {
    if velocity.is_nan() { T::ZERO } else { saturate(T::of(MAX_SPEED), velocity) }
}

/// The mean of two velocities, each [`bounded`].
#[inline]
#[must_use]
pub fn mean<T: Real>(from: T, to: T) -> T {
    T::HALF * (bounded(from) + bounded(to))
}

/// `int_0^h exp(-a t) dt`: what is left after `h` \[s\] of a rate of one into a state that relaxes
/// at `a` \[1/s\], zero or more.
#[inline]
#[must_use]
pub fn relaxed<T: Real>(a: T, h: T) -> T {
    let x = a * h;
    // The quotient loses digits below this, where the series is exact.
    if x < T::of(1e-8) { h } else { -(-x).exp_m1() / a }
}

/// `a b + c`: with one rounding where the program is built for a processor that has an instruction
/// for it, as C compilers do.
#[inline]
#[must_use]
pub fn fused<T: Real>(a: T, b: T, c: T) -> T {
    #[cfg(all(feature = "std", target_feature = "fma"))]
    return a.mul_add(b, c);
    #[cfg(not(all(feature = "std", target_feature = "fma")))]
    return a * b + c;
}

/// `sgn v` with `sgn 0 = 0`.
#[inline]
#[must_use]
pub fn sign<T: Real>(v: T) -> T {
    if v == T::ZERO { T::ZERO } else { v.signum() }
}

/// `sat(b, x)`: `x` cut to `[-b, b]`, for `b >= 0`.
#[inline(always)]
#[must_use]
pub fn saturate<T: Real>(b: T, x: T) -> T {
    between(-b, b, x)
}

/// `x` cut to `[low, high]`. Unlike `f64::clamp` it cannot panic, and unlike `f64::min` and `max`,
/// which must sort out what is not a number, each comparison is one instruction.
#[inline(always)]
#[must_use]
pub fn between<T: Real>(low: T, high: T, x: T) -> T {
    let x = if x < high { x } else { high };
    if x > low { x } else { low }
}
