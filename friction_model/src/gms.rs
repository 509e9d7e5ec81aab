//! The generalised Maxwell-slip model, GMS (Lampaert, Al-Bender, Swevers 2003): elements that stick
//! and slip side by side.
//!
//! ```text
//! element i sticks:  z_i' = v                                            until |z_i| reaches W_i(v) = alpha_i g(v) / sigma0_i
//! element i slips:   z_i' = C_i ( sgn v - sigma0_i z_i / (alpha_i g(v)) )        until v changes sign      (thesis eq. 2.28, corrected)
//! F = sum_i ( sigma0_i z_i + sigma1_i z_i' ) + f_v v,     sum_i alpha_i = 1
//! ```
//!
//! The printed 2.28 has the wrong fixed point for `v < 0`. `C_i` is a speed here; the original's
//! common attraction `C_0` \[N/s\] is `C_i = C_0 alpha_i / sigma0_i`.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s`, `f_c`, `v_s`, `delta` | | | Stribeck curve `g`, see [`StribeckCurve`] |
//! | `alpha` | - | > 0, sum 1 | share of each element |
//! | `sigma0` | N/m or N m/rad | > 0 | stiffness of each element |
//! | `sigma1` | N s/m or N m s/rad | >= 0 | micro-damping of each element |
//! | `c` | m/s or rad/s | > 0 | attraction of each element: how fast it follows the Stribeck curve in slip |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! In pre-sliding each element is a stop, so the hysteresis has non-local memory: inner loops close
//! and are wiped out, and it does not drift. In sliding it lags. The `sigma1 z'` term jumps when an
//! element begins to slip or sticks: with the thesis's chapter 3 set the force peaks at 2.08 N,
//! above `F_s` = 1.5 N, and the loop of frictional lag runs the wrong way round. That is the model,
//! not an error of integration; with `sigma1 = 0` neither happens.
//!
//! Fixed-step form: the exact solution of each regime for a held velocity, with the change from
//! stick to slip at the end of the period it falls in. In the derivative form too, elements change
//! regime at the end of an accepted step: an integrator that does not search for it is of first
//! order.
//!
//! `N` is the room for elements; parameter sets with fewer are filled up with elements that carry
//! nothing.

use crate::arithmetic::{bounded, relaxed, saturate, sign};
use crate::finite::finite;
use crate::stribeck_curve::SHAPE;
use crate::{
    Elements, Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime,
    State, StribeckCurve, TimeStep, built_from, parameters,
};

parameters! {
    /// Parameters of [`Gms`] as files carry them; the lists have one number an element, at most 16.
    GmsParameters<T> {
        /// Static friction F_s \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Stribeck velocity v_s \[m/s or rad/s\], above zero.
        v_s: T, Speed, Range::Positive;
        /// Shape exponent of the Stribeck curve, above 0 and at most 10; 2 if left out.
        #[serde(default = "StribeckCurve::gaussian")]
        delta: T, None, SHAPE;
        /// Share alpha of each element, above zero; they sum to 1.
        alpha: Elements<16, T>, None, Range::Positive;
        /// Stiffness sigma_0 of each element \[N/m or N m/rad\], above zero.
        sigma0: Elements<16, T>, Stiffness, Range::Positive;
        /// Micro-damping sigma_1 of each element \[N s/m or N m s/rad\], zero or more.
        sigma1: Elements<16, T>, Damping, Range::NonNegative;
        /// Attraction C of each element \[m/s or rad/s\], above zero.
        c: Elements<16, T>, Speed, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// GMS with valid parameters and room for `N` elements. State: `[z_i]`, and in which direction each
/// element slips.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gms<const N: usize, T: Real = f64> {
    parameters: GmsParameters<T>,
    curve: StribeckCurve<T>,
    elements: [Element<T>; N],
}

/// One element; all zero for one that carries nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Element<T: Real = f64> {
    sigma0: T,
    sigma1: T,
    /// `alpha / sigma0`: W per unit of g.
    width: T,
    /// `sigma0 / alpha`.
    inverse_width: T,
    c: T,
}

built_from!([T: Real, const N: usize] Gms<N, T>, GmsParameters<T>);

impl<T: Real, const N: usize> TryFrom<GmsParameters<T>> for Gms<N, T> {
    type Error = ModelError;

    fn try_from(p: GmsParameters<T>) -> Result<Self, ModelError> {
        let model = Self::NAME;
        p.check(model)?;
        let curve = StribeckCurve::new(model, p.f_s, p.f_c, p.v_s, p.delta)?;
        crate::elements::check(
            model,
            N,
            "alpha",
            &p.alpha,
            &[("sigma0", &p.sigma0), ("sigma1", &p.sigma1), ("c", &p.c)],
        )?;
        let mut elements = [Element::default(); N];
        let lists = p.alpha.iter().zip(p.sigma0.iter()).zip(p.sigma1.iter().zip(p.c.iter()));
        for (element, ((&alpha, &sigma0), (&sigma1, &c))) in elements.iter_mut().zip(lists) {
            *element =
                Element { sigma0, sigma1, width: alpha / sigma0, inverse_width: sigma0 / alpha, c };
            let usable = element.width > T::ZERO && element.inverse_width.is_finite();
            p.require(
                model,
                usable,
                "sigma0",
                sigma0,
                "such that alpha / sigma0 is a finite width",
            )?;
        }
        finite(Self { parameters: p, curve, elements })
    }
}

impl<T: Real, const N: usize> FrictionModel<T> for Gms<N, T> {
    const NAME: &'static str = "gms";
    type Parameters = GmsParameters<T>;
    type Continuous = [T; N];
    /// Direction in which each element slips: -1, 1, or 0 while it sticks.
    type Memory = [T; N];
    /// The period \[s\].
    type Discrete = T;

    fn parameters(&self) -> &GmsParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<[T; N], [T; N]> {
        State { continuous: [T::ZERO; N], memory: [T::ZERO; N] }
    }

    #[inline]
    fn evaluate(&self, z: &[T; N], slips: &[T; N], velocity: T) -> Evaluation<[T; N], T> {
        self.at(velocity)(z, slips)
    }

    #[inline]
    fn at(&self, velocity: T) -> impl Fn(&[T; N], &[T; N]) -> Evaluation<[T; N], T> {
        let inverse_g = T::ONE / self.curve.level(velocity);
        let direction = sign(velocity);
        move |z, slips| {
            let mut force = self.parameters.f_v * velocity;
            let mut rates = [velocity; N];
            for (((element, &z), &slips), rate) in
                self.elements.iter().zip(z).zip(slips).zip(&mut rates)
            {
                if slips * direction > T::ZERO {
                    *rate = element.c * (direction - z * element.inverse_width * inverse_g);
                }
                force += element.sigma0 * z + element.sigma1 * *rate;
            }
            Evaluation { force, rates }
        }
    }

    #[inline]
    fn commit(&self, state: &mut State<[T; N], [T; N]>, velocity: T, _: T) {
        let g = self.curve.level(velocity);
        let direction = sign(velocity);
        for ((element, z), slips) in
            self.elements.iter().zip(&mut state.continuous).zip(&mut state.memory)
        {
            if *slips == T::ZERO {
                if direction != T::ZERO && direction * *z >= element.width * g {
                    *slips = direction;
                    *z = direction * element.width * g;
                }
            } else if *slips != direction {
                *slips = T::ZERO;
            }
        }
    }

    fn discretise(&self, dt: TimeStep) -> T {
        T::of(dt.seconds())
    }

    #[inline]
    fn step(&self, &dt: &T, state: &mut State<[T; N], [T; N]>, velocity: T) -> T {
        let v = bounded(velocity);
        let g = self.curve.level(v);
        let inverse_g = T::ONE / g;
        let direction = sign(v);
        let mut force = self.parameters.f_v * v;
        for ((element, z), slips) in
            self.elements.iter().zip(&mut state.continuous).zip(&mut state.memory)
        {
            if *slips * direction > T::ZERO {
                // Rate at which the element relaxes towards W [1/s].
                let relaxation = element.c * element.inverse_width * inverse_g;
                let rest = direction * element.width * g;
                force += element.sigma0 * *z
                    + element.sigma1 * (element.c * direction - relaxation * *z);
                *z = rest + (*z - rest) * (-relaxation * dt).exp();
            } else {
                force += element.sigma0 * *z + element.sigma1 * v;
                *z += v * dt;
                let width = element.width * g;
                let slides = direction != T::ZERO && direction * *z >= width;
                *slips = if slides { direction } else { T::ZERO };
                *z = if slides { direction * width } else { *z };
            }
        }
        force
    }

    #[inline]
    fn inject(&self, dt: TimeStep, state: &mut State<[T; N], [T; N]>, velocity: T, rate: T) -> T {
        let p = &self.parameters;
        let inverse_g = T::ONE / self.curve.level(velocity);
        let mut damping = T::ZERO;
        for ((element, z), slips) in
            self.elements.iter().zip(&mut state.continuous).zip(&state.memory)
        {
            let relaxation = if *slips == T::ZERO {
                T::ZERO
            } else {
                element.c * element.inverse_width * inverse_g
            };
            *z = saturate(
                element.width * p.f_s,
                *z + rate * relaxed(relaxation, T::of(dt.seconds())),
            );
            damping += element.sigma1;
        }
        damping * rate
    }

    fn steady_state(&self, velocity: T) -> T {
        self.curve.signed_level(velocity) + self.parameters.f_v * velocity
    }

    /// The mean deflection, weighted by the shares; slip once all elements slip.
    fn internals(&self, state: &State<[T; N], [T; N]>, velocity: T) -> Internals<T> {
        let alpha = &self.parameters.alpha;
        let deflection = alpha.iter().zip(&state.continuous).map(|(&alpha, &z)| alpha * z).sum();
        let direction = sign(velocity);
        let all = state.memory.iter().take(alpha.len()).all(|&slips| slips * direction > T::ZERO);
        let regime = if all { Regime::Slip } else { Regime::Stick };
        Internals { deflection, gamma: self.curve.level(velocity), regime }
    }

    /// Which elements slip, and where to.
    fn switches(&self, slips: &[T; N], f: &mut dyn FnMut(T)) {
        slips.iter().take(self.parameters.alpha.len()).for_each(|&slips| f(slips));
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn stored_energy(&self, state: &State<[T; N], [T; N]>) -> Option<T> {
        Some(
            self.elements
                .iter()
                .zip(&state.continuous)
                .map(|(element, &z)| T::HALF * element.sigma0 * z * z)
                .sum(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stepper;
    use crate::presets::Presets;

    #[test]
    fn reaches_the_stribeck_curve() {
        fn check<const N: usize>(model: Gms<N>) {
            for v in [0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.5, -0.02] {
                let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
                for _ in 0..200_000 {
                    stepper.step(v);
                }
                assert!((stepper.step(v) - model.steady_state(v)).abs() < 1e-9, "v {v}");
            }
        }
        check(Gms::test_bed());
        check(Gms::chapter_3());
    }

    /// Room for elements that are not there changes nothing.
    #[test]
    fn empty_elements_carry_nothing() {
        let dt = TimeStep::new(1e-3).unwrap();
        let mut four = Stepper::new(Gms::test_bed(), dt);
        let mut sixteen = Stepper::new(Gms::<16>::try_from(GmsParameters::test_bed()).unwrap(), dt);
        for k in 0..5000 {
            let v = 0.3 * (0.003 * f64::from(k)).sin() + 0.1 * (0.02 * f64::from(k)).sin();
            assert_eq!(four.step(v), sixteen.step(v));
            assert!(sixteen.state().continuous[4..].iter().all(|z| z.abs() < 1e3));
        }
    }

    #[test]
    fn lists_must_match_and_shares_sum_to_one() {
        let p = GmsParameters { c: [0.3; 3].into(), ..GmsParameters::test_bed() };
        let message = Gms::<4>::try_from(p).unwrap_err().to_string();
        assert!(message.contains("c has 3 elements, but 4 are expected"), "{message}");
        let p = GmsParameters { alpha: [0.3; 4].into(), ..GmsParameters::test_bed() };
        let message = Gms::<4>::try_from(p).unwrap_err().to_string();
        assert!(message.contains("gms.alpha must be such that all sum to 1"), "{message}");
        assert!(
            Gms::<4>::try_from(GmsParameters::chapter_3()).is_err(),
            "ten elements do not fit in four places"
        );
    }
}
