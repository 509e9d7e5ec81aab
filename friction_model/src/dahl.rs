//! Dahl (1968): the stress-strain curve of a contact, and nothing else.
//!
//! ```text
//! dF/dx = sigma0 |1 - u|^delta sgn(1 - u),   u = (F_b / F_c) sgn v       (thesis eq. 2.17, which prints dF/dt and loses the sign factor)
//! F_b   = sigma0 z,   F = F_b + f_v v
//! ```
//!
//! With `delta = 1`: `z' = v - sigma0 |v| z / F_c`, that is LuGre without Stribeck effect and
//! micro-damping.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_c` | N or N m | > 0 | kinetic friction |
//! | `sigma0` | N/m or N m/rad | > 0 | stiffness at rest |
//! | `delta` | - | (0, 10], 1 if left out | shape of the curve: below 1 brittle, above 1 ductile |
//! | `f_v` | N s/m or N m s/rad | >= 0, 0 if left out | viscous coefficient |
//!
//! It gives pre-sliding displacement and a hysteresis that depends on the path alone, not on its
//! speed, and it dissipates over every closed cycle. It has no static level above the kinetic one,
//! so no stick-slip; inner loops do not close, and it drifts under small oscillating loads. Use it
//! where stiffness and one level are all that is known.
//!
//! Fixed-step form: exact for any travel `d = v dt`. With `w = 1 - u`, `w' = -(sigma0/F_c) w^delta`
//! along the path: `w <- w exp(-sigma0 |d| / F_c)` for `delta = 1`, else
//! `w <- [w^(1-delta) - (1-delta) sigma0 |d| / F_c]^(1/(1-delta))`, zero once the bracket of a
//! brittle contact is used up.

use crate::arithmetic::{bounded, fused, relaxed, saturate, sign};
use crate::finite::finite;
use crate::stribeck_curve::SHAPE;
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    TimeStep, built_from, parameters,
};

parameters! {
    /// Parameters of [`Dahl`] as files carry them.
    DahlParameters<T> {
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Stiffness at rest sigma_0 \[N/m or N m/rad\], above zero.
        sigma0: T, Stiffness, Range::Positive;
        /// Shape of the stress-strain curve, above 0 and at most 10; 1 if left out.
        #[serde(default = "DahlParameters::linear")]
        delta: T, None, SHAPE;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more; 0 if left out.
        #[serde(default)]
        f_v: T, Damping, Range::NonNegative;
    }
}

/// Dahl's model with valid parameters. State: `[z]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dahl<T: Real = f64> {
    parameters: DahlParameters<T>,
    /// `F_c / sigma0`: deflection in steady sliding \[m or rad\].
    z_c: T,
    inverse_z_c: T,
}

impl<T: Real> DahlParameters<T> {
    /// The exponent `delta` that files may leave out.
    #[must_use]
    pub const fn linear() -> T {
        T::ONE
    }
}

built_from!([T: Real] Dahl<T>, DahlParameters<T>);

impl<T: Real> TryFrom<DahlParameters<T>> for Dahl<T> {
    type Error = ModelError;

    fn try_from(p: DahlParameters<T>) -> Result<Self, ModelError> {
        p.check(Self::NAME)?;
        let z_c = p.f_c / p.sigma0;
        let usable = z_c > T::ZERO && (T::ONE / z_c).is_finite() && z_c.is_finite();
        p.require(
            Self::NAME,
            usable,
            "sigma0",
            p.sigma0,
            "such that f_c / sigma0 is a finite deflection",
        )?;
        finite(Self { parameters: p, z_c, inverse_z_c: T::ONE / z_c })
    }
}

impl<T: Real> Dahl<T> {
    /// How much of `w = 1 - u` is left after a travel of `strain = sigma0 |d| / F_c`, for an
    /// exponent other than 1.
    fn remaining(&self, w: T, strain: T) -> T {
        let e = T::ONE - self.parameters.delta;
        let left = w.powf(e) - e * strain;
        if left > T::ZERO { left.powf(T::ONE / e) } else { T::ZERO }
    }
}

impl<T: Real> FrictionModel<T> for Dahl<T> {
    const NAME: &'static str = "dahl";
    type Parameters = DahlParameters<T>;
    type Continuous = [T; 1];
    type Memory = ();
    /// The period \[s\].
    type Discrete = T;

    fn parameters(&self) -> &DahlParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<[T; 1], ()> {
        State { continuous: [T::ZERO], memory: () }
    }

    #[inline]
    fn evaluate(&self, state: &[T; 1], (): &(), velocity: T) -> Evaluation<[T; 1], T> {
        self.at(velocity)(state, &())
    }

    #[inline]
    fn at(&self, velocity: T) -> impl Fn(&[T; 1], &()) -> Evaluation<[T; 1], T> {
        let p = &self.parameters;
        // u per deflection, and how fast the rate falls with it for delta = 1 [1/s].
        let per_z = self.inverse_z_c * sign(velocity);
        let relaxation = velocity * per_z;
        move |&[z], ()| {
            let z_rate = if p.delta == T::ONE {
                fused(-relaxation, z, velocity)
            } else {
                let w = T::ONE - z * per_z;
                velocity * w.abs().powf(p.delta) * sign(w)
            };
            Evaluation { force: p.sigma0 * z + p.f_v * velocity, rates: [z_rate] }
        }
    }

    #[inline]
    fn commit(&self, state: &mut State<[T; 1], ()>, _: T, _: T) {
        let [z] = state.continuous;
        state.continuous = [saturate(self.z_c, z)];
    }

    fn discretise(&self, dt: TimeStep) -> T {
        T::of(dt.seconds())
    }

    #[inline]
    fn step(&self, &dt: &T, state: &mut State<[T; 1], ()>, velocity: T) -> T {
        let p = &self.parameters;
        let v = bounded(velocity);
        let [z] = state.continuous;
        let strain = v.abs() * self.inverse_z_c * dt;
        let z_end = self.z_c.copysign(v);
        if p.delta == T::ONE {
            state.continuous = [z_end + (z - z_end) * (-strain).exp()];
        } else if v != T::ZERO {
            let w = self.remaining(T::ONE - z / z_end, strain);
            state.continuous = [saturate(self.z_c, z_end * (T::ONE - w))];
        }
        p.sigma0 * z + p.f_v * v
    }

    #[inline]
    fn inject(&self, dt: TimeStep, state: &mut State<[T; 1], ()>, velocity: T, rate: T) -> T {
        let [z] = state.continuous;
        let moved = rate * relaxed(velocity.abs() * self.inverse_z_c, T::of(dt.seconds()));
        state.continuous = [saturate(self.z_c, z + moved)];
        T::ZERO
    }

    fn steady_state(&self, velocity: T) -> T {
        self.parameters.f_c * sign(velocity) + self.parameters.f_v * velocity
    }

    /// Slip once the bristle force is within 5 % of F_c in the direction of motion; Dahl's model
    /// itself knows no switch.
    fn internals(&self, state: &State<[T; 1], ()>, velocity: T) -> Internals<T> {
        let [z] = state.continuous;
        let regime =
            if z * sign(velocity) >= T::of(0.95) * self.z_c { Regime::Slip } else { Regime::Stick };
        Internals { deflection: z, gamma: self.parameters.f_c, regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn stored_energy(&self, state: &State<[T; 1], ()>) -> Option<T> {
        let [z] = state.continuous;
        Some(T::HALF * self.parameters.sigma0 * z * z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::Presets;
    use crate::{LuGre, LuGreParameters, Stepper, rk4};

    fn with_exponent(delta: f64) -> Dahl {
        DahlParameters { delta, ..DahlParameters::test_bed() }.try_into().unwrap()
    }

    /// One long step equals a thousand steps of the derivative form, for ductile and brittle
    /// curves.
    #[test]
    fn the_fixed_step_is_exact_for_any_exponent() {
        for delta in [0.5, 1.0, 1.5, 2.0, 3.0] {
            let model = with_exponent(delta);
            let mut stepper = Stepper::new(model, TimeStep::new(0.01).unwrap());
            let mut state = model.rest();
            for v in [0.2, 0.3, -0.25, 0.1, -0.4, 0.05] {
                stepper.step(v);
                for _ in 0..1000 {
                    rk4::step(&model, &mut state, [v; 3], 1e-5);
                }
                let (exact, integrated) = (stepper.state().continuous[0], state.continuous[0]);
                assert!(
                    (exact - integrated).abs() < 1e-9 * model.z_c,
                    "delta {delta}, v {v}: {exact}, {integrated}"
                );
            }
        }
    }

    #[test]
    fn with_exponent_one_it_is_lugre_without_stribeck_and_damping() {
        let p = DahlParameters::test_bed();
        let lugre: LuGre = LuGreParameters {
            f_s: p.f_c,
            f_c: p.f_c,
            sigma0: p.sigma0,
            sigma1: 0.0,
            f_v: p.f_v,
            ..LuGreParameters::test_bed()
        }
        .try_into()
        .unwrap();
        let dt = TimeStep::new(1e-3).unwrap();
        let (mut a, mut b) = (Stepper::new(Dahl::test_bed(), dt), Stepper::new(lugre, dt));
        for k in 0..3000 {
            let v = 0.2 * (0.004 * f64::from(k)).sin();
            assert!((a.step(v) - b.step(v)).abs() < 1e-15);
        }
    }

    /// A brittle contact slides fully after a finite travel of `F_c / (sigma0 (1 - delta))`.
    #[test]
    fn a_brittle_contact_breaks_after_finite_travel() {
        let model = with_exponent(0.5);
        let travel = model.z_c / (1.0 - 0.5);
        for (part, sliding) in [(0.99, false), (1.01, true)] {
            let mut stepper = Stepper::new(model, TimeStep::new(1e-2).unwrap());
            stepper.step(part * travel / 1e-2);
            assert_eq!(stepper.state().continuous[0] == model.z_c, sliding, "{part}");
        }
    }
}
