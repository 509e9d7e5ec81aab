//! Describing function: the gain that friction shows to a sinusoidal displacement.
//!
//! Under `e = A sin(w t)` the steady force has a fundamental `b1 sin(w t) + a1 cos(w t)`, and
//!
//! ```text
//! N(A, w) = (b1 + j a1) / A        b1 = (2/T) int_0^T F sin(w t) dt,   a1 = (2/T) int_0^T F cos(w t) dt
//! ```
//!
//! (thesis eqs. 3.46 to 3.50). `b1` is in phase with the displacement and acts like a spring, `a1`
//! is in phase with the velocity and acts like a damper. A cycle dissipates `pi A a1`, the area of
//! the loop in the plane of force over displacement. So a contact that dissipates has `Im N > 0`:
//! **friction leads the displacement**.
//!
//! [`measure`] finds N for any model by simulation, at the frequency asked for, because dynamic
//! models depend on it. [`closed_form`] has the formulas for Coulomb, viscous and
//! elastic-perfectly-plastic friction and for the hysteresis of the thesis's own model.
//!
//! What it can tell: the first harmonic, hence oscillations of a loop whose linear part removes the
//! others (see [`crate::limit_cycle`]). What it cannot: sticking, and anything that is not nearly a
//! sine.

pub mod closed_form;

use core::f64::consts::{PI, TAU};

use friction_model::{FrictionModel, TimeStep, rk4};
use num_complex::Complex;
use serde::{Deserialize, Serialize};

/// An input that describing functions and limit cycles cannot be computed for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{what} must be {expected}, but is {value}")]
pub struct HarmonicError {
    /// What is wrong, with its unit.
    pub what: &'static str,
    /// What was expected.
    pub expected: &'static str,
    /// What came.
    pub value: f64,
}

/// `value`, if it is finite and above zero.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, HarmonicError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(HarmonicError { what, expected: "a finite number above zero", value })
    }
}

/// Fundamental of the steady force under `A sin(w t)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Harmonic {
    /// Amplitude A of the displacement \[m or rad\].
    pub amplitude: f64,
    /// Angular frequency w \[rad/s\].
    pub angular_frequency: f64,
    /// b1, the part in phase with the displacement \[N or N m\].
    pub in_phase: f64,
    /// a1, the part in phase with the velocity \[N or N m\].
    pub quadrature: f64,
}

impl Harmonic {
    /// `N = (b1 + j a1) / A` \[N/m or N m/rad\].
    #[must_use]
    pub fn gain(&self) -> Complex<f64> {
        Complex::new(self.in_phase, self.quadrature) / self.amplitude
    }

    /// Energy dissipated in a cycle, `pi A a1` \[J\].
    #[must_use]
    pub fn dissipated(&self) -> f64 {
        PI * self.amplitude * self.quadrature
    }
}

/// How the states advance from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// The model's fixed-step form under the velocity in the middle of the step: stable for every
    /// model.
    FixedStep,
    /// Classical Runge-Kutta. It must be stable at this step, see [`friction_model::rk4::step`].
    RungeKutta,
}

/// How finely and how long [`measure`] looks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sampling {
    /// Steps in a period, rounded up to a multiple of four so that no sample meets a reversal. With
    /// the fixed-step form there are at least as many as its longest step of 10 ms needs.
    pub steps: u32,
    /// Periods that pass before the one that is analysed.
    pub settling: u32,
    /// How the states advance.
    pub scheme: Scheme,
}

impl Default for Sampling {
    /// 4000 steps in a period, the fifth period, fixed-step form.
    fn default() -> Self {
        Self { steps: 4000, settling: 4, scheme: Scheme::FixedStep }
    }
}

/// Describing function of `model` under `amplitude` \[m or rad\] times `sin(w t)` with `w` the
/// `angular_frequency` \[rad/s\].
///
/// The contact starts at rest and unloaded. Samples lie in the middle of the steps, where the
/// velocity is never exactly zero; the sums over them converge with the square of the step, for
/// continuous and for switching forces alike.
///
/// # Errors
/// [`HarmonicError`] unless amplitude and frequency are finite and above zero.
pub fn measure<M: FrictionModel>(
    model: &M,
    amplitude: f64,
    angular_frequency: f64,
    sampling: &Sampling,
) -> Result<Harmonic, HarmonicError> {
    positive("the amplitude [m or rad]", amplitude)?;
    positive("the angular frequency [rad/s]", angular_frequency)?;
    let period = TAU / angular_frequency;
    let longest = match sampling.scheme {
        Scheme::FixedStep => 0.01,
        Scheme::RungeKutta => f64::INFINITY,
    };
    let steps = f64::from(sampling.steps).max(period / longest).max(4.0);
    let steps = 4.0 * (steps / 4.0).ceil();
    let h = period / steps;
    let velocity =
        |sample: f64| amplitude * angular_frequency * (TAU * (sample + 0.5) / steps).cos();

    let discrete = match sampling.scheme {
        Scheme::FixedStep => {
            Some(model.discretise(TimeStep::new(h).map_err(|_| HarmonicError {
                what: "the angular frequency [rad/s]",
                expected: "low enough for a step above zero",
                value: angular_frequency,
            })?))
        }
        Scheme::RungeKutta => None,
    };
    let steps = steps as u64;
    let mut state = model.rest();
    let (mut in_phase, mut quadrature) = (0.0, 0.0);
    for period in 0..=u64::from(sampling.settling) {
        let analysed = period == u64::from(sampling.settling);
        for k in 0..steps {
            let k = k as f64;
            let now = velocity(k);
            if analysed {
                let force = model.evaluate(&state.continuous, &state.memory, now).force;
                let (sin, cos) = (TAU * (k + 0.5) / steps as f64).sin_cos();
                in_phase += force * sin;
                quadrature += force * cos;
            }
            match &discrete {
                Some(discrete) => {
                    model.step(discrete, &mut state, velocity(k + 0.5));
                }
                None => {
                    rk4::step(model, &mut state, [now, velocity(k + 0.5), velocity(k + 1.0)], h);
                }
            }
        }
    }
    let scale = 2.0 / steps as f64;
    Ok(Harmonic {
        amplitude,
        angular_frequency,
        in_phase: scale * in_phase,
        quadrature: scale * quadrature,
    })
}

#[cfg(test)]
mod tests {
    use friction_model::{
        AnyModel, Coulomb, CoulombParameters, LuGre, ModelName, ModelVisitor, Proposed,
        ProposedParameters, Viscous, ViscousParameters,
    };

    use super::closed_form::{SineHysteresis, coulomb, viscous};
    use super::*;

    fn assert_near(got: Complex<f64>, expected: Complex<f64>, tolerance: f64) {
        assert!((got - expected).norm() < tolerance * expected.norm(), "{got} is not {expected}");
    }

    #[test]
    fn measured_coulomb_and_viscous_friction_are_the_closed_forms() {
        let relay = Coulomb::try_from(CoulombParameters { f_c: 0.7 }).unwrap();
        let damper = Viscous::try_from(ViscousParameters { f_v: 0.3 }).unwrap();
        for (amplitude, w) in [(0.1, 1.0), (2.0, 0.05), (1e-4, 300.0)] {
            for scheme in [Scheme::FixedStep, Scheme::RungeKutta] {
                let sampling = Sampling { scheme, ..Sampling::default() };
                let n = |model: &dyn Fn() -> Harmonic| model().gain();
                let got = n(&|| measure(&relay, amplitude, w, &sampling).unwrap());
                assert_near(got, coulomb(0.7, amplitude), 1e-6);
                let got = n(&|| measure(&damper, amplitude, w, &sampling).unwrap());
                assert_near(got, viscous(0.3, w), 1e-12);
                // int F dx over a cycle, with F = f_v x'.
                let lost = measure(&damper, amplitude, w, &sampling).unwrap().dissipated();
                let expected = PI * 0.3 * w * amplitude * amplitude;
                assert!((lost - expected).abs() < 1e-12 * expected);
            }
        }
    }

    /// With `F_c = F_s` there is no lag, and with a small `sigma` the contact follows its
    /// hysteresis, slip included.
    #[test]
    fn the_proposed_model_moved_slowly_shows_its_hysteresis() {
        let (f_s, z_b) = (1.0, 1e-3);
        let model = Proposed::try_from(ProposedParameters {
            f_s,
            f_c: f_s,
            v_s: 0.01,
            delta: 2.0,
            sigma: 0.01,
            tau: 0.002,
            z_b,
            f_v: 0.0,
        })
        .unwrap();
        let closed = SineHysteresis { f_s, z_b };
        for ratio in [0.25, 0.9, 1.2, 5.0] {
            let amplitude = ratio * z_b;
            let sampling = Sampling { steps: 20_000, settling: 2, scheme: Scheme::FixedStep };
            let got = measure(&model, amplitude, 1.0, &sampling).unwrap();
            assert_near(got.gain(), closed.gain(amplitude), 2e-4);
        }
    }

    #[test]
    fn both_schemes_agree_on_a_dynamic_model() {
        let model = LuGre::test_bed();
        let fixed = measure(&model, 0.02, 3.0, &Sampling::default()).unwrap();
        let rk4 = Sampling { scheme: Scheme::RungeKutta, ..Sampling::default() };
        let rk4 = measure(&model, 0.02, 3.0, &rk4).unwrap();
        assert_near(fixed.gain(), rk4.gain(), 1e-5);
        assert!(fixed.quadrature > 0.0 && fixed.in_phase > 0.0);
    }

    struct Dissipates;

    impl ModelVisitor for Dissipates {
        type Output = ();

        fn visit<M: FrictionModel>(self, model: M) {
            // 6e-3 rad is the breakaway deflection; slow enough that models with damping stay
            // passive.
            for amplitude in [2e-3, 2e-2, 0.5] {
                let found = measure(&model, amplitude, 1.0, &Sampling::default()).unwrap();
                // Bristles that are springs, and no more, dissipate nothing until they slip.
                let none = -1e-9 * found.in_phase.abs();
                let least = if amplitude > 0.1 { f64::MIN_POSITIVE } else { none };
                assert!(found.quadrature >= least, "{}: {found:?}", M::NAME);
            }
        }
    }

    #[test]
    fn no_model_drives_the_motion() {
        for name in ModelName::ALL {
            AnyModel::test_bed(name).visit(Dissipates);
        }
    }

    #[test]
    fn impossible_inputs_are_refused() {
        let model = Coulomb::test_bed();
        for (amplitude, w) in
            [(0.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (1.0, 0.0), (1.0, f64::INFINITY)]
        {
            let error = measure(&model, amplitude, w, &Sampling::default()).unwrap_err();
            assert!(error.to_string().contains("above zero"), "{error}");
        }
    }
}
