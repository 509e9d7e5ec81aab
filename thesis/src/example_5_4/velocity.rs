//! Velocity regulation under an output disturbance.

use friction_model::ModelError;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use super::closed_loop::{ClosedLoop, LinearPart, Shift};
use super::models::{ExampleModel, with_contact};
use experiment_runner::tracking::SquareMean;

/// `J w' = u - F`, output `w + d`, `u = -(P e + I int e) + F^` with `e = w + d`, `d = H(s) n` with
/// `H(s) = (1/40) s^2 / (s + 0.2)^4` (thesis eq. 5.77).
///
/// The thesis says neither J nor how its white noise was sampled. J = 1 kg m^2 is well determined
/// by its printed errors; the noise, of unit variance, is held for half a second, which they leave
/// open between 0.5 and 2 s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityExample {
    /// Inertia J [kg m^2].
    pub inertia: f64,
    /// Proportional gain P [N m s/rad].
    pub p: f64,
    /// Integral gain I [N m/rad].
    pub i: f64,
    /// How long a noise sample is held \[s\].
    pub hold: f64,
    /// Length of a run \[s\].
    pub duration: f64,
    /// Integration step \[s\].
    pub step: f64,
}

impl Default for VelocityExample {
    fn default() -> Self {
        Self { inertia: 1.0, p: 4.0, i: 16.0, hold: 0.5, duration: 100.0, step: 1e-3 }
    }
}

/// Figures of one run of an example.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ExampleRun {
    /// Mean square error by the trapezoidal rule [(rad/s)^2 or rad^2].
    pub mse: f64,
    /// Largest error [rad/s or rad].
    pub max_error: f64,
}

impl VelocityExample {
    /// One run: friction `plant` on the axis, `observer` in the loop with the injection gain
    /// `injection`, noise of `seed`.
    ///
    /// # Errors
    /// [`ModelError`] never for the parameters of the example, which a test builds.
    pub fn run(
        &self,
        plant: Option<ExampleModel>,
        observer: Option<ExampleModel>,
        injection: f64,
        seed: u64,
    ) -> Result<ExampleRun, ModelError> {
        let axis = Axis { inertia: self.inertia, p: self.p, i: self.i, noise: 0.0 };
        with_contact!(plant, contact => with_contact!(observer, seen => {
            Ok(self.drive(ClosedLoop::new(axis, [0.0; 6], contact, seen, injection), seed))
        }))
    }

    fn drive<P, O>(&self, mut closed: ClosedLoop<Axis, P, O, 6>, seed: u64) -> ExampleRun
    where
        P: friction_model::FrictionModel,
        O: friction_model::FrictionModel<Continuous: Shift>,
    {
        let mut noise = Pcg64Mcg::seed_from_u64(seed);
        let held = (self.hold / self.step).round().max(1.0) as u64;
        let mut error = SquareMean::default();
        error.add(closed.error());
        for k in 0..(self.duration / self.step).round() as u64 {
            if k.is_multiple_of(held) {
                closed.linear.noise = StandardNormal.sample(&mut noise);
            }
            closed.advance(self.step);
            error.add(closed.error());
        }
        ExampleRun { mse: error.mean(), max_error: error.max() }
    }
}

/// States: four of the disturbance's filter, the velocity, the integral of the error.
#[derive(Debug, Clone, Copy)]
struct Axis {
    inertia: f64,
    p: f64,
    i: f64,
    noise: f64,
}

impl LinearPart<6> for Axis {
    #[inline]
    fn velocity(&self, x: &[f64; 6]) -> f64 {
        x[4]
    }

    #[inline]
    fn error(&self, x: &[f64; 6]) -> f64 {
        // s^2 / (s + 0.2)^4 of the noise is the third state of the controllable form.
        x[4] + x[2] / 40.0
    }

    #[inline]
    fn rates(&self, x: &[f64; 6], friction: f64, estimate: f64) -> [f64; 6] {
        let error = self.error(x);
        let &[a, b, c, d, _, integral] = x;
        // (s + 0.2)^4 = s^4 + 0.8 s^3 + 0.24 s^2 + 0.032 s + 0.0016
        let filter = self.noise - 0.0016 * a - 0.032 * b - 0.24 * c - 0.8 * d;
        let command = estimate - self.p * error - self.i * integral;
        [b, c, d, filter, (command - friction) / self.inertia, error]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The disturbance's transfer function at one frequency, by the filter's own state equations.
    #[test]
    fn the_disturbance_is_filtered_as_printed() {
        let axis = Axis { inertia: 1.0, p: 0.0, i: 0.0, noise: 1.0 };
        // Static response of the controllable form: a = 1/.0016, all else zero, so that a constant
        // noise gives no disturbance.
        let rest = [1.0 / 0.0016, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert!(axis.rates(&rest, 0.0, 0.0).iter().all(|rate| rate.abs() < 1e-12));
        assert_eq!(axis.error(&rest), 0.0);
        // At w = 0.2 every pole has the gain 1/(0.2 sqrt 2): |H| = 0.04/40 / (0.08)^2 = 0.15625.
        let (w, h) = (0.2f64, 0.01);
        let frictionless = || super::super::models::frictionless().unwrap();
        let mut closed = ClosedLoop::new(axis, [0.0; 6], frictionless(), frictionless(), 0.0);
        let mut largest = 0f64;
        for k in 0..40_000 {
            closed.linear.noise = (w * (f64::from(k) + 0.5) * h).sin();
            closed.advance(h);
            if k > 30_000 {
                largest = largest.max(closed.error().abs());
            }
        }
        assert!((largest - 0.15625).abs() < 1e-4, "{largest}");
    }
}
