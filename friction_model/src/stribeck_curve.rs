//! The level at which a contact slides, as a function of speed.

use crate::{ModelError, Range, Real, Unit};

/// The Stribeck curve `g(v) = F_c + (F_s - F_c) exp(-|v/v_s|^delta)` in units of force, thesis eqs.
/// 2.9 to 2.11 with the absolute value inside the power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StribeckCurve<T: Real = f64> {
    f_s: T,
    f_c: T,
    inverse_v_s: T,
    v_s: T,
    delta: T,
}

impl<T: Real> StribeckCurve<T> {
    /// The shape exponent of the Gaussian form, which parameter files may leave out.
    #[must_use]
    pub const fn gaussian() -> T {
        T::TWO
    }

    /// A curve from the static level `f_s` and the kinetic level `f_c` \[N or N m\], the Stribeck
    /// velocity `v_s` \[m/s or rad/s\] and the shape exponent `delta` (2 for the Gaussian form).
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`], naming `model`, unless `0 < f_c <= f_s`, `v_s > 0` and
    /// `0 < delta <= 10`.
    pub fn new(model: &'static str, f_s: T, f_c: T, v_s: T, delta: T) -> Result<Self, ModelError> {
        let positive =
            [("f_s", f_s, Unit::Force), ("f_c", f_c, Unit::Force), ("v_s", v_s, Unit::Speed)];
        let refusal = |parameter, value: T, unit, expected| ModelError::OutOfRange {
            model,
            parameter,
            value: value.double(),
            unit,
            expected,
        };
        for (parameter, value, unit) in positive {
            if !Range::Positive.holds(value) {
                return Err(refusal(parameter, value, unit, Range::Positive));
            }
        }
        if f_c > f_s {
            let expected =
                Range::Such("at most f_s: kinetic friction does not exceed static friction");
            return Err(refusal("f_c", f_c, Unit::Force, expected));
        }
        if T::ONE / v_s == T::infinity() {
            return Err(refusal("v_s", v_s, Unit::Speed, Range::Such("large enough to divide by")));
        }
        if !SHAPE.holds(delta) {
            return Err(refusal("delta", delta, Unit::None, SHAPE));
        }
        Ok(Self { f_s, f_c, inverse_v_s: T::ONE / v_s, v_s, delta })
    }

    /// `g(v)`, between `f_c` and `f_s`.
    #[inline(always)]
    #[must_use]
    pub fn level(&self, velocity: T) -> T {
        let r = velocity * self.inverse_v_s;
        let power = if self.delta == T::TWO { r * r } else { r.abs().powf(self.delta) };
        self.f_c + (self.f_s - self.f_c) * (-power).exp()
    }

    /// `s(v) = sgn(v) g(v)`.
    #[inline]
    #[must_use]
    pub fn signed_level(&self, velocity: T) -> T {
        if velocity == T::ZERO { T::ZERO } else { self.level(velocity).copysign(velocity) }
    }

    /// Static level F_s \[N or N m\].
    #[must_use]
    pub const fn f_s(&self) -> T {
        self.f_s
    }

    /// Kinetic level F_c \[N or N m\].
    #[must_use]
    pub const fn f_c(&self) -> T {
        self.f_c
    }

    /// Stribeck velocity v_s \[m/s or rad/s\].
    #[must_use]
    pub const fn v_s(&self) -> T {
        self.v_s
    }

    /// Shape exponent.
    #[must_use]
    pub const fn delta(&self) -> T {
        self.delta
    }
}

/// Shape exponents.
pub(crate) const SHAPE: Range = Range::Within(0.0, 10.0);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matches_the_formula_for_any_exponent() {
        for delta in [0.5, 1.0, 2.0, 3.0] {
            let curve = StribeckCurve::new("stribeck", 1.5, 1.0, 0.01, delta).unwrap();
            for v in [-0.05f64, -0.01, 0.0, 0.003, 0.01, 0.02] {
                let expected = 1.0 + 0.5 * (-(v.abs() / 0.01).powf(delta)).exp();
                assert!((curve.level(v) - expected).abs() < 1e-15, "delta {delta}, v {v}");
            }
        }
    }

    #[test]
    fn refuses_a_kinetic_level_above_the_static_one() {
        let message = StribeckCurve::new("lugre", 1.0, 1.5, 0.01, 2.0).unwrap_err().to_string();
        assert!(message.starts_with("lugre.f_c must be at most f_s"), "{message}");
    }
}
