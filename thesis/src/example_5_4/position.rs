//! A step of position under PID.

use friction_model::{FrictionModel, ModelError};

use super::closed_loop::{ClosedLoop, LinearPart, Shift};
use super::models::{ExampleModel, with_contact};
use super::velocity::ExampleRun;
use experiment_runner::compensation::limit_cycle::LimitCycle;
use experiment_runner::tracking::SquareMean;

/// `J theta'' = u - F`, `u = P e + I int e + D e' + F^` with `e = 1 - theta`; the axis starts at
/// rest at 0.
///
/// The thesis does not say J; the loop is stable for J < D P / I = 0.0125 kg m^2 only, and J =
/// 0.0023 gives its printed figure without friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionExample {
    /// Inertia J [kg m^2].
    pub inertia: f64,
    /// Proportional gain P [N m/rad].
    pub p: f64,
    /// Integral gain I [N m/(rad s)].
    pub i: f64,
    /// Derivative gain D [N m s/rad].
    pub d: f64,
    /// Length of a run \[s\].
    pub duration: f64,
    /// Integration step \[s\]; beyond 2.78 J / sigma = 0.1 ms RK4 is unstable while the bristles
    /// stick.
    pub step: f64,
}

impl Default for PositionExample {
    fn default() -> Self {
        Self { inertia: 0.0023, p: 0.1, i: 0.4, d: 0.05, duration: 20.0, step: 8e-5 }
    }
}

impl PositionExample {
    /// One run: friction `plant` on the axis, `observer` in the loop with the injection gain
    /// `injection`; the figures, and the limit cycle of the last three fifths if there is one.
    ///
    /// # Errors
    /// [`ModelError`] never for the parameters of the example, which a test builds.
    pub fn run(
        &self,
        plant: Option<ExampleModel>,
        observer: Option<ExampleModel>,
        injection: f64,
    ) -> Result<(ExampleRun, Option<LimitCycle>), ModelError> {
        let axis = Axis { inertia: self.inertia, p: self.p, i: self.i, d: self.d };
        with_contact!(plant, contact => with_contact!(observer, seen => {
            Ok(self.drive(ClosedLoop::new(axis, [0.0; 3], contact, seen, injection)))
        }))
    }

    fn drive<P, O>(&self, mut closed: ClosedLoop<Axis, P, O, 3>) -> (ExampleRun, Option<LimitCycle>)
    where
        P: FrictionModel,
        O: FrictionModel<Continuous: Shift>,
    {
        /// Steps between the samples that a limit cycle is looked for in.
        const EVERY: u64 = 125;
        let mut error = SquareMean::default();
        error.add(closed.error());
        let mut path = vec![closed.error()];
        for k in 1..=(self.duration / self.step).round() as u64 {
            closed.advance(self.step);
            error.add(closed.error());
            if k.is_multiple_of(EVERY) {
                path.push(closed.error());
            }
        }
        let figures = ExampleRun { mse: error.mean(), max_error: error.max() };
        (figures, LimitCycle::find(&path, EVERY as f64 * self.step, 1e-3))
    }
}

/// States: position, velocity, integral of the error.
#[derive(Debug, Clone, Copy)]
struct Axis {
    inertia: f64,
    p: f64,
    i: f64,
    d: f64,
}

impl LinearPart<3> for Axis {
    #[inline]
    fn velocity(&self, x: &[f64; 3]) -> f64 {
        x[1]
    }

    #[inline]
    fn error(&self, x: &[f64; 3]) -> f64 {
        x[0] - 1.0
    }

    #[inline]
    fn rates(&self, x: &[f64; 3], friction: f64, estimate: f64) -> [f64; 3] {
        let &[_, velocity, integral] = x;
        let error = self.error(x);
        let command = estimate - self.p * error - self.i * integral - self.d * velocity;
        [velocity, (command - friction) / self.inertia, error]
    }
}
