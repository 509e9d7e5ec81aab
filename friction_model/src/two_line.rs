//! The two-line model (Marton and Lantos 2007; "Lorinc" in the thesis): the Stribeck curve as two
//! straight lines.
//!
//! ```text
//! F = a_1 sgn v + b_1 v    0 < |v| <= v_sw
//! F = a_2 sgn v + b_2 v    |v| > v_sw            v_sw = (a_1 - a_2) / (b_2 - b_1)
//! F = sat(a_1, F_e)        v = 0
//! ```
//!
//! Thesis eq. 2.14: in each region `F = Phi^T xi` with the parameters `Phi = [a, b]` and the
//! regressor `xi = [sgn v, v]`, so that both lines are linear in their parameters. They meet at the
//! switch speed `v_sw`, where nothing jumps.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `a1` | N or N m | > 0 | level from which the first line starts: static friction |
//! | `b1` | N s/m or N m s/rad | any | slope of the first line; negative where friction falls with speed |
//! | `a2` | N or N m | > 0 | level at which the second line would start: kinetic friction |
//! | `b2` | N s/m or N m s/rad | >= 0 | slope of the second line: viscous friction |
//!
//! The lines must meet at a speed above zero: `a1 > a2` with `b2 > b1` (the Stribeck case), or both
//! the other way round. With these ranges friction keeps its sign at every speed: at `v_sw` it is
//! `a2 + b2 v_sw > 0`, below it lies between that and `a1`, and above it does not fall. A negative
//! `b2` is refused because the second line has no end: it would push at high speeds.
//!
//! It reproduces the falling and the rising part of the sliding characteristic and sticking up to
//! `a1`. It cuts the bend between them: as tangents of a Tustin curve
//! ([`TwoLineParameters::from_tustin`]) the lines lie below it, by almost `(F_s - F_c)/e` at `v_s`.
//! It has no pre-sliding displacement, no lag and no memory.
//!
//! Use it for identification and adaptation by linear least squares, and where exponentials are too
//! dear.
//!
//! Fixed-step form: the formula itself, with 0 at `v = 0`, where the applied force would have to be
//! known (see [`FrictionModel::holding`]).

use crate::arithmetic::sign;
use crate::finite::finite;
use crate::{
    FrictionModel, Holding, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    StribeckCurve, Unit, built_from, memoryless, parameters,
};

parameters! {
    /// Parameters of [`TwoLine`] as files carry them.
    TwoLineParameters<T> {
        /// Level a_1 from which the first line starts \[N or N m\], above zero.
        a1: T, Force, Range::Positive;
        /// Slope b_1 of the first line \[N s/m or N m s/rad\], of any sign.
        b1: T, Damping, Range::Any;
        /// Level a_2 at which the second line would start \[N or N m\], above zero.
        a2: T, Force, Range::Positive;
        /// Slope b_2 of the second line \[N s/m or N m s/rad\], zero or more.
        b2: T, Damping, Range::NonNegative;
    }
}

impl<T: Real> TwoLineParameters<T> {
    /// The tangents of the Tustin curve `F_c + (F_s - F_c) exp(-v/v_s) + f_v v` at standstill and
    /// at `v_max` \[m/s or rad/s\]: levels `f_s` and `f_c` \[N or N m\], Stribeck velocity `v_s`
    /// \[m/s or rad/s\], viscous coefficient `f_v` \[N s/m or N m s/rad\].
    ///
    /// ```
    /// use friction_model::{TwoLine, TwoLineParameters};
    /// let lines = TwoLineParameters::<f64>::from_tustin(0.0994, 0.0925, 0.1407, 0.0403, 4.0)?;
    /// assert!((TwoLine::try_from(lines)?.switch_speed() - 0.1407).abs() < 1e-5);
    /// # Ok::<(), friction_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] unless `f_s > f_c > 0`, `v_s > 0`, `f_v >= 0` and `v_max > 0`,
    /// and where the tangents are no two-line model: at a `v_max` so low that the curve still falls
    /// there.
    pub fn from_tustin(f_s: T, f_c: T, v_s: T, f_v: T, v_max: T) -> Result<Self, ModelError> {
        let model = TwoLine::<T>::NAME;
        StribeckCurve::new(model, f_s, f_c, v_s, T::ONE)?;
        let rest = [
            ("f_v", f_v, Unit::Damping, Range::NonNegative),
            ("v_max", v_max, Unit::Speed, Range::Positive),
        ];
        for (parameter, value, unit, expected) in rest {
            if !expected.holds(value) {
                let value = value.double();
                return Err(ModelError::OutOfRange { model, parameter, value, unit, expected });
            }
        }
        let dip = f_s - f_c;
        let left = dip * (-v_max / v_s).exp();
        let lines = Self {
            a1: f_s,
            b1: f_v - dip / v_s,
            a2: f_c + left * (T::ONE + v_max / v_s),
            b2: f_v - left / v_s,
        };
        lines.switch_speed()?;
        Ok(lines)
    }

    /// The speed at which the lines meet \[m/s or rad/s\].
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for parameters that are no two-line model.
    pub fn switch_speed(&self) -> Result<T, ModelError> {
        self.check(TwoLine::<T>::NAME)?;
        let speed = (self.a1 - self.a2) / (self.b2 - self.b1);
        let condition = "such that the lines meet at a speed above zero: below a1 if b1 is below b2, else above a1";
        let meet = speed > T::ZERO && (self.a2 + self.b2 * speed).is_finite();
        self.require(TwoLine::<T>::NAME, meet, "a2", self.a2, condition)?;
        Ok(speed)
    }
}

/// The two-line model with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoLine<T: Real = f64> {
    parameters: TwoLineParameters<T>,
    switch_speed: T,
}

impl<T: Real> TwoLine<T> {
    /// The speed v_sw at which the lines meet \[m/s or rad/s\].
    #[must_use]
    pub const fn switch_speed(&self) -> T {
        self.switch_speed
    }

    /// The line that counts at `velocity`.
    #[inline]
    fn line(&self, velocity: T) -> (T, T) {
        let p = &self.parameters;
        if velocity.abs() <= self.switch_speed { (p.a1, p.b1) } else { (p.a2, p.b2) }
    }
}

impl<T: Real> TryFrom<TwoLineParameters<T>> for TwoLine<T> {
    type Error = ModelError;

    fn try_from(parameters: TwoLineParameters<T>) -> Result<Self, ModelError> {
        let switch_speed = parameters.switch_speed()?;
        finite(Self { parameters, switch_speed })
    }
}

built_from!([T: Real] TwoLine<T>, TwoLineParameters<T>);

impl<T: Real> FrictionModel<T> for TwoLine<T> {
    const NAME: &'static str = "two_line";
    memoryless!([T] TwoLineParameters<T>);

    #[inline]
    fn steady_state(&self, velocity: T) -> T {
        let (a, b) = self.line(velocity);
        a * sign(velocity) + b * velocity
    }

    /// `gamma` is the force without its viscous part.
    fn internals(&self, _: &State<[T; 0], ()>, velocity: T) -> Internals<T> {
        let (a, b) = self.line(velocity);
        let gamma = a + (b - self.parameters.b2) * velocity.abs();
        let regime = if velocity == T::ZERO { Regime::Stick } else { Regime::Slip };
        Internals { deflection: T::ZERO, gamma, regime }
    }

    /// `b_2 v`: the slope at high speeds is the viscous coefficient of the curve that the lines
    /// stand for.
    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.b2 * velocity
    }

    fn holding(&self, _: T) -> Option<Holding<T>> {
        Some(Holding::up_to(self.parameters.a1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MAX_SPEED;
    use crate::presets::Presets;

    fn tustin(v: f64) -> f64 {
        0.0925 + 0.0069 * (-v / 0.1407).exp() + 0.0403 * v
    }

    /// Table 4.13's parameters; the figures were computed independently.
    #[test]
    fn the_tangents_of_the_tustin_curve_have_the_known_figures() {
        let p = TwoLineParameters::<f64>::from_tustin(0.0994, 0.0925, 0.1407, 0.0403, 4.0).unwrap();
        let model = TwoLine::try_from(p).unwrap();
        assert_eq!(p.a1, 0.0994);
        assert!((p.b1 + 0.0087405).abs() < 5e-8, "{p:?}");
        assert!((p.a2 - 0.0925).abs() < 1e-10 && (p.b2 - 0.0403).abs() < 1e-10, "{p:?}");
        assert!((model.switch_speed() - 0.1407).abs() < 5e-6, "{}", model.switch_speed());
        let (mut worst, mut at) = (0.0, 0.0);
        for k in 1..=400_000 {
            let v = 1e-5 * f64::from(k);
            let below = tustin(v) - model.steady_state(v);
            assert!(below > -1e-15, "tangents of a convex curve lie below it: {below} at {v}");
            if below > worst {
                (worst, at) = (below, v);
            }
        }
        assert!((worst - 0.0025384).abs() < 5e-8, "{worst}");
        assert!((at - 0.1407).abs() < 2e-5, "{at}");
        let preset = TwoLineParameters::test_bed();
        for (preset, exact) in [(preset.a2, p.a2), (preset.b1, p.b1), (preset.b2, p.b2)] {
            assert!((preset - exact).abs() < 1e-10, "{preset} {exact}");
        }
    }

    #[test]
    fn nothing_jumps_where_the_lines_meet() {
        for model in [TwoLine::test_bed(), TwoLine::chapter_3()] {
            let v = model.switch_speed();
            let (at, above) = (model.steady_state(v), model.steady_state(v * (1.0 + 1e-15)));
            assert!((above / at - 1.0).abs() < 1e-14, "{at} {above}");
            let p = model.parameters();
            assert_eq!(model.steady_state(0.5 * v), p.a1 + p.b1 * 0.5 * v);
            assert_eq!(model.steady_state(-3.0 * v), -(p.a2 + p.b2 * 3.0 * v));
            assert_eq!(model.holding(0.0), Some(Holding::up_to(p.a1)));
        }
    }

    #[test]
    fn friction_keeps_its_sign_at_every_speed() {
        let cases = [
            TwoLineParameters::test_bed(),
            TwoLineParameters::chapter_3(),
            // Falling to almost nothing, then rising.
            TwoLineParameters { a1: 1.0, b1: -10.0, a2: 1e-9, b2: 0.001 },
            // Rising steeply, then less so.
            TwoLineParameters { a1: 0.1, b1: 2.0, a2: 0.5, b2: 0.0 },
        ];
        for p in cases {
            let model = TwoLine::try_from(p).unwrap();
            for k in -600..=600 {
                let v = 10f64.powf(0.01 * f64::from(k));
                let force = model.steady_state(v);
                assert!(force > 0.0 && model.steady_state(-v) == -force, "{p:?} at {v}: {force}");
                assert!(force - model.viscous(v) > 0.0, "{p:?} at {v}");
            }
            assert!(model.steady_state(MAX_SPEED).is_finite());
        }
    }

    #[test]
    fn lines_that_push_or_never_meet_are_refused() {
        let p = TwoLineParameters::test_bed();
        let refused = [
            ("a1", TwoLineParameters { a1: 0.0, ..p }),
            ("a2", TwoLineParameters { a2: -0.01, ..p }),
            // Friction would vanish at 30 rad/s, and push beyond.
            ("b2", TwoLineParameters { b2: -0.003, ..p }),
            // Parallel, the same line twice, and lines that meet only at a negative speed.
            ("a2", TwoLineParameters { b1: p.b2, ..p }),
            ("a2", TwoLineParameters { b1: p.b2, a1: p.a2, ..p }),
            ("a2", TwoLineParameters { a2: 0.11, ..p }),
        ];
        for (parameter, p) in refused {
            let message = TwoLine::try_from(p).unwrap_err().to_string();
            assert!(message.starts_with(&format!("two_line.{parameter} must be")), "{message}");
        }
        let tangents =
            |f_s, v_s, v_max| TwoLineParameters::<f64>::from_tustin(f_s, 0.09, v_s, 0.04, v_max);
        for (parameter, outcome) in [
            ("f_c", tangents(0.08, 0.14, 4.0)),
            ("a2", tangents(0.09, 0.14, 4.0)),
            ("v_s", tangents(0.1, 0.0, 4.0)),
            ("v_max", tangents(0.1, 0.14, -4.0)),
            // The curve still falls at 0.01 rad/s.
            ("b2", tangents(0.1, 0.14, 0.01)),
        ] {
            let message = outcome.unwrap_err().to_string();
            assert!(message.starts_with(&format!("two_line.{parameter} must be")), "{message}");
        }
    }
}
