//! Stiction whose breakaway level falls with the rate of the applied force.
//!
//! ```text
//! F        = F_c sgn v + f_v v                                    v != 0      (thesis eq. 2.8)
//! F        = sat(Phi_s(r), F_e),  r = d|F_e|/dt                   v = 0
//! Phi_s(r) = F_c + (F_s - F_c) exp(-|r/t_s|^delta_t)                          (thesis eq. 2.12, printed with v_s for t_s)
//! ```
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s` | N or N m | >= `f_c` | breakaway level under an infinitely slow ramp |
//! | `f_c` | N or N m | > 0 | kinetic friction, and the breakaway level under an infinitely fast ramp |
//! | `t_s` | N/s or N m/s | > 0 | rate at which the excess over `f_c` has fallen to 1/e |
//! | `delta_t` | - | (0, 10], 2 if left out | shape exponent |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! It reproduces breakaway forces that fall as the ramp gets faster, from `F_s` to `F_c`, as
//! experiments with ramps show. Sliding is at the kinetic level: a curve of the velocity alone that
//! started above `F_c` would stop the contact again wherever a fast ramp had broken it loose below
//! that start. It has no falling characteristic, no pre-sliding displacement, no lag and no memory.
//! In LuGre and the proposed model the same effect comes out by itself, but smaller.
//!
//! Use it to study breakaway under ramps, or where the breakaway level was measured at several
//! rates. The rate of a measured force is noisy, and noise counts as a fast ramp: the level then
//! falls towards `F_c`.
//!
//! Fixed-step form: the sliding formula, with 0 at `v = 0`, where the applied force and its rate
//! would have to be known (see [`FrictionModel::holding`]).

use crate::arithmetic::sign;
use crate::finite::finite;
use crate::stribeck_curve::SHAPE;
use crate::{
    FrictionModel, Holding, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    StribeckCurve, built_from, memoryless, parameters,
};

parameters! {
    /// Parameters of [`RateDependentStiction`] as files carry them.
    RateDependentStictionParameters<T> {
        /// Breakaway level F_s under an infinitely slow ramp \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c, also the breakaway level under an infinitely fast ramp \[N or N
        /// m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Force rate t_s that scales the fall of the breakaway level \[N/s or N m/s\], above zero.
        t_s: T, ForceRate, Range::Positive;
        /// Shape exponent of the fall, above 0 and at most 10; 2 if left out.
        #[serde(default = "StribeckCurve::gaussian")]
        delta_t: T, None, SHAPE;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// Rate-dependent stiction with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateDependentStiction<T: Real = f64> {
    parameters: RateDependentStictionParameters<T>,
    /// `Phi_s`: the same function of the force rate as the Stribeck curve is of the velocity.
    breakaway: StribeckCurve<T>,
}

impl<T: Real> RateDependentStiction<T> {
    /// `Phi_s` \[N or N m\]: the applied force at which a contact at rest breaks away where that
    /// force changes at `force_rate` \[N/s or N m/s\]. A rate that is not a number counts as zero.
    #[inline]
    #[must_use]
    pub fn breakaway_level(&self, force_rate: T) -> T {
        self.breakaway.level(if force_rate.is_nan() { T::ZERO } else { force_rate })
    }
}

impl<T: Real> TryFrom<RateDependentStictionParameters<T>> for RateDependentStiction<T> {
    type Error = ModelError;

    fn try_from(p: RateDependentStictionParameters<T>) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        let divisor = "large enough to divide by";
        p.require(name, (T::ONE / p.t_s).is_finite(), "t_s", p.t_s, divisor)?;
        let breakaway = StribeckCurve::new(name, p.f_s, p.f_c, p.t_s, p.delta_t)?;
        finite(Self { parameters: p, breakaway })
    }
}

built_from!([T: Real] RateDependentStiction<T>, RateDependentStictionParameters<T>);

impl<T: Real> FrictionModel<T> for RateDependentStiction<T> {
    const NAME: &'static str = "rate_dependent_stiction";
    memoryless!([T] RateDependentStictionParameters<T>);

    #[inline]
    fn steady_state(&self, velocity: T) -> T {
        self.parameters.f_c * sign(velocity) + self.parameters.f_v * velocity
    }

    /// At rest `gamma` is the level of an infinitely slow ramp.
    fn internals(&self, _: &State<[T; 0], ()>, velocity: T) -> Internals<T> {
        let (gamma, regime) = if velocity == T::ZERO {
            (self.parameters.f_s, Regime::Stick)
        } else {
            (self.parameters.f_c, Regime::Slip)
        };
        Internals { deflection: T::ZERO, gamma, regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn holding(&self, force_rate: T) -> Option<Holding<T>> {
        Some(Holding::up_to(self.breakaway_level(force_rate)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::Presets;
    use crate::{Body, Drive};

    /// Rates \[N/s\] and breakaway levels \[N\] of chapter 3's parameters, computed independently.
    const LEVELS: [(f64, f64); 3] = [(0.05, 1.30327), (0.1, 1.18394), (0.2, 1.06767)];

    #[test]
    fn the_level_falls_from_the_static_to_the_kinetic_one_with_the_rate() {
        let model = RateDependentStiction::chapter_3();
        for (rate, level) in LEVELS {
            let holding = model.holding(rate).unwrap();
            assert!((holding.forward - level).abs() < 5e-6, "{rate}: {holding:?}");
            assert_eq!(model.holding(-rate), Some(Holding::up_to(holding.forward)));
        }
        for (rate, level) in [(0.0, 1.5), (f64::NAN, 1.5), (1e3, 1.0), (f64::INFINITY, 1.0)] {
            assert_eq!(model.breakaway_level(rate), level, "{rate}");
        }
        let gaussian = RateDependentStictionParameters { delta_t: 2.0, ..*model.parameters() };
        let gaussian = RateDependentStiction::try_from(gaussian).unwrap();
        assert!((gaussian.breakaway_level(0.05) - (1.0 + 0.5 * (-0.25f64).exp())).abs() < 1e-15);
    }

    /// The first applied force under which the body moves is the level of its ramp, to one step of
    /// the ramp; and it goes on moving.
    #[test]
    fn a_body_breaks_away_earlier_under_a_faster_ramp() {
        for (rate, level) in LEVELS {
            for direction in [1.0, -1.0] {
                let h = 1e-4;
                let mut body = Body::<_, 0>::new(RateDependentStiction::chapter_3(), 1.0);
                let mut applied = 0.0;
                while body.moment().velocity == 0.0 {
                    applied = direction * rate * body.moment().time;
                    body.advance(h, |at| Drive::from(direction * rate * at.time));
                    assert!(applied.abs() < 1.5, "holds beyond the static level");
                }
                assert_eq!(applied.signum(), direction);
                assert!(
                    applied.abs() > level - 5e-6 && applied.abs() < level + 5e-6 + rate * h,
                    "{rate} N/s: moves at {applied} N"
                );
                let left = body.moment().time;
                while body.moment().time < left + 1.0 {
                    body.advance(h, |at| Drive::from(direction * rate * at.time));
                }
                // m v' = F_e - F_c for one second.
                let gained = (applied.abs() - 1.0) + 0.5 * rate;
                assert!(
                    (body.moment().velocity.abs() - gained).abs() < 1e-3,
                    "{:?}",
                    body.moment()
                );
            }
        }
    }

    #[test]
    fn refuses_what_is_no_rate() {
        let p = RateDependentStictionParameters::chapter_3();
        for t_s in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-310] {
            let message =
                RateDependentStiction::try_from(RateDependentStictionParameters { t_s, ..p })
                    .unwrap_err()
                    .to_string();
            assert!(message.starts_with("rate_dependent_stiction.t_s must be"), "{message}");
        }
    }
}
