//! Karnopp's model (1985): a band of speeds around zero counts as standing still.
//!
//! ```text
//! F = [F_c + (F_s - F_c) exp(-|v/v_s|^delta)] sgn v + f_v v      |v| > D_v       (slip)
//! F = sat(F_s, T)                                                |v| <= D_v      (stick, v is taken for 0)
//! ```
//!
//! Thesis eq. 2.13 in its torque form, with the Stribeck curve of eq. 2.11 in slip. `T` is the sum
//! of all other forces on the inertia; for a motor the driving torque minus the load. As long as
//! `|T| <= F_s` a body in the band has no acceleration.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s`, `f_c`, `v_s`, `delta` | | | Stribeck curve, see [`StribeckCurve`] |
//! | `d_v` | m/s or rad/s | > 0 | half width `D_v` of the band |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! It reproduces sticking, breakaway and stick-slip in a simulation with fixed steps that looks for
//! no event. It has no pre-sliding displacement, no lag and no memory, and it does not resolve
//! motion within the band: a speed that stays below `D_v` is lost. The friction while sticking
//! belongs to the whole machine, because it needs `T`.
//!
//! Use it in simulations that cannot stop at an event. Choose `D_v > max|a| dt`, with the largest
//! acceleration near zero speed and the step of the simulation: a body that comes to rest must not
//! jump across the band in one step. Wider than that only costs accuracy: a slip that ends with the
//! deceleration `a` ends `D_v / a` too early. [`crate::Body`] detects the change of sign as well,
//! so that with it a band too narrow does no harm.
//!
//! The derivative form gives the sliding force at every speed, because a simulator that knows `T`
//! asks [`FrictionModel::holding`] whether the body sticks before it asks for that force.
//! Fixed-step form: the sliding force outside the band. Inside it the answer would be
//! `sat(F_s, T)`; the fixed-step form does not know `T` and returns 0, as the other static models
//! do at `v = 0`.

use crate::finite::finite;
use crate::stribeck_curve::SHAPE;
use crate::{
    FrictionModel, Holding, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    StribeckCurve, built_from, memoryless, parameters,
};

parameters! {
    /// Parameters of [`Karnopp`] as files carry them.
    KarnoppParameters<T> {
        /// Static friction F_s \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Stribeck velocity v_s \[m/s or rad/s\], above zero.
        v_s: T, Speed, Range::Positive;
        /// Shape exponent of the Stribeck curve, above 0 and at most 10; 2 if left out.
        #[serde(default = "StribeckCurve::gaussian")]
        delta: T, None, SHAPE;
        /// Speed D_v up to which the contact counts as standing still \[m/s or rad/s\], above zero.
        d_v: T, Speed, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// Karnopp's model with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Karnopp<T: Real = f64> {
    parameters: KarnoppParameters<T>,
    curve: StribeckCurve<T>,
}

impl<T: Real> Karnopp<T> {
    fn sticks(&self, velocity: T) -> bool {
        velocity.abs() <= self.parameters.d_v
    }

    /// The force of a contact that slides, at any speed.
    #[inline]
    fn sliding(&self, velocity: T) -> T {
        self.curve.signed_level(velocity) + self.parameters.f_v * velocity
    }
}

impl<T: Real> TryFrom<KarnoppParameters<T>> for Karnopp<T> {
    type Error = ModelError;

    fn try_from(p: KarnoppParameters<T>) -> Result<Self, ModelError> {
        p.check(Self::NAME)?;
        let curve = StribeckCurve::new(Self::NAME, p.f_s, p.f_c, p.v_s, p.delta)?;
        finite(Self { parameters: p, curve })
    }
}

built_from!([T: Real] Karnopp<T>, KarnoppParameters<T>);

impl<T: Real> FrictionModel<T> for Karnopp<T> {
    const NAME: &'static str = "karnopp";
    memoryless!([T] KarnoppParameters<T>, sliding);

    /// Zero within the band.
    #[inline]
    fn steady_state(&self, velocity: T) -> T {
        if self.sticks(velocity) { T::ZERO } else { self.sliding(velocity) }
    }

    fn internals(&self, _: &State<[T; 0], ()>, velocity: T) -> Internals<T> {
        let (gamma, regime) = if self.sticks(velocity) {
            (self.parameters.f_s, Regime::Stick)
        } else {
            (self.curve.level(velocity), Regime::Slip)
        };
        Internals { deflection: T::ZERO, gamma, regime }
    }

    /// Zero within the band.
    #[inline]
    fn viscous(&self, velocity: T) -> T {
        if self.sticks(velocity) { T::ZERO } else { self.parameters.f_v * velocity }
    }

    fn holding(&self, _: T) -> Option<Holding<T>> {
        Some(Holding { band: self.parameters.d_v, ..Holding::up_to(self.parameters.f_s) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, Drive, Stribeck};

    #[test]
    fn is_the_stribeck_curve_outside_the_band_and_silent_within() {
        let (model, curve) = (Karnopp::test_bed(), Stribeck::test_bed());
        for v in [1.001e-3, -0.03, 0.1407, 4.0] {
            assert_eq!(model.steady_state(v), curve.steady_state(v));
            assert_eq!(model.internals(&model.rest(), v).regime, Regime::Slip);
        }
        for v in [0.0, 1e-9, -1e-3] {
            assert_eq!((model.steady_state(v), model.viscous(v)), (0.0, 0.0));
            assert_eq!(model.internals(&model.rest(), v).regime, Regime::Stick);
            // Once a body leaves, the band has no say: friction opposes the motion from the first
            // moment.
            assert_eq!(model.evaluate(&[], &(), v).force, curve.steady_state(v));
        }
        assert!(Karnopp::try_from(KarnoppParameters { d_v: 0.0, ..*model.parameters() }).is_err());
    }

    #[test]
    fn in_the_band_friction_balances_what_is_applied_up_to_the_static_level() {
        let holding = Karnopp::chapter_3().holding(0.0).unwrap();
        for velocity in [0.0, 5e-5, -1e-4] {
            assert!(holding.holds(velocity, 1.5) && holding.holds(velocity, -1.5));
            assert!(!holding.holds(velocity, 1.5001));
        }
        assert!(!holding.holds(1.001e-4, 0.0));
        assert_eq!(
            [0.7, -1.5, 2.0, -9.0].map(|applied| holding.force(applied)),
            [0.7, -1.5, 1.5, -1.5]
        );
    }

    /// A sliding body that slows down into the band stays where it enters it, and has no
    /// acceleration from then on.
    #[test]
    fn a_body_that_enters_the_band_is_held() {
        let model = Karnopp::chapter_3();
        let band = model.parameters().d_v;
        let mut body = Body::<_, 0>::new(model, 1.0);
        while body.moment().velocity < 0.05 {
            body.advance(1e-4, |_| Drive::from(2.0));
        }
        let applied = 0.7;
        while body.moment().velocity > band {
            body.advance(1e-4, |_| Drive::from(applied));
        }
        let entered = *body.moment();
        assert!(entered.velocity > 0.0, "the band is wide enough not to be jumped across");
        assert_eq!(body.friction(applied), applied);
        for _ in 0..1000 {
            body.advance(1e-4, |_| Drive::from(applied));
            assert_eq!((body.moment().velocity, body.moment().position), (0.0, entered.position));
            assert_eq!(body.friction(applied), applied);
        }
        body.advance(1e-4, |_| Drive::from(-1.6));
        assert!(body.moment().velocity < 0.0, "beyond the static level it leaves");
    }
}
