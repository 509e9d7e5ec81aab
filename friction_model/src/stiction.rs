//! Stiction: classical friction with a static level above the kinetic one.
//!
//! ```text
//! F = F_c sgn v + f_v v    v != 0      (thesis eq. 2.8)
//! F = sat(F_s, F_e)        v = 0: friction balances the applied force up to F_s
//! ```
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s` | N or N m | >= `f_c` | static friction |
//! | `f_c` | N or N m | > 0 | kinetic friction |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! It reproduces breakaway at `F_s` and stick-slip: a mass pulled by a spring at a constant speed
//! sticks and slips with a period in closed form. The drop from `F_s` to `F_c` comes at once, so
//! that slow sliding is always at `F_c`: it has no falling characteristic, no pre-sliding
//! displacement, no lag and no memory.
//!
//! Use it where the drop matters and the Stribeck velocity is far below the speeds of interest. A
//! solver that treats `sgn v` as a plain function chatters about zero velocity and misses the
//! sticking; [`crate::Body`] handles it as an event.
//!
//! Fixed-step form: the formula itself, with 0 at `v = 0`, where the applied force would have to be
//! known (see [`FrictionModel::holding`]).

use crate::arithmetic::sign;
use crate::finite::finite;
use crate::{
    FrictionModel, Holding, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    built_from, memoryless, parameters,
};

parameters! {
    /// Parameters of [`Stiction`] as files carry them.
    StictionParameters<T> {
        /// Static friction F_s \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// Stiction with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stiction<T: Real = f64> {
    parameters: StictionParameters<T>,
}

impl<T: Real> TryFrom<StictionParameters<T>> for Stiction<T> {
    type Error = ModelError;

    fn try_from(p: StictionParameters<T>) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        let condition = "at most f_s: kinetic friction does not exceed static friction";
        p.require(name, p.f_c <= p.f_s, "f_c", p.f_c, condition)?;
        finite(Self { parameters: p })
    }
}

built_from!([T: Real] Stiction<T>, StictionParameters<T>);

impl<T: Real> FrictionModel<T> for Stiction<T> {
    const NAME: &'static str = "stiction";
    memoryless!([T] StictionParameters<T>);

    #[inline]
    fn steady_state(&self, velocity: T) -> T {
        self.parameters.f_c * sign(velocity) + self.parameters.f_v * velocity
    }

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

    fn holding(&self, _: T) -> Option<Holding<T>> {
        Some(Holding::up_to(self.parameters.f_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, Drive};

    #[test]
    fn slides_at_the_kinetic_level_and_holds_up_to_the_static_one() {
        let model = Stiction::test_bed();
        for v in [1e-12, 0.03, 4.0] {
            assert!((model.steady_state(v) - (0.0925 + 0.0403 * v)).abs() < 1e-15, "{v}");
            assert_eq!(model.steady_state(-v), -model.steady_state(v));
        }
        let holding = model.holding(0.0).unwrap();
        assert_eq!(
            [0.05, 0.2, -0.05, -0.2].map(|f| holding.force(f)),
            [0.05, 0.0994, -0.05, -0.0994]
        );
        let message = Stiction::try_from(StictionParameters { f_s: 1.0, f_c: 1.5, f_v: 0.0 })
            .unwrap_err()
            .to_string();
        assert!(message.starts_with("stiction.f_c must be at most f_s"), "{message}");
    }

    /// Held at 1.5 N, and once away 0.5 N go into the mass: `v = 0.5 t / m`.
    #[test]
    fn the_force_drops_at_breakaway() {
        let mut body = Body::<_, 0>::new(Stiction::chapter_3(), 1.0);
        for _ in 0..100 {
            body.advance(1e-3, |_| Drive::from(1.5));
        }
        assert_eq!((body.moment().velocity, body.friction(1.5)), (0.0, 1.5));
        let push = 1.5 + 1e-9;
        for _ in 0..1000 {
            body.advance(1e-3, |_| Drive::from(push));
        }
        assert!((body.moment().velocity - 0.5).abs() < 1e-8, "{:?}", body.moment());
        assert_eq!(body.friction(push), 1.0);
    }
}
