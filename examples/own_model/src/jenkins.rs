//! Jenkins's element: a spring in series with a Coulomb slider.
//!
//! ```text
//! z' = v while |k z| < f_c or the motion unloads the spring, else 0,    F = k z + f_v v
//! ```

use friction_model::arithmetic::{bounded, saturate, sign};
use friction_model::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Regime, State, TimeStep,
    built_from, parameters,
};

parameters! {
    /// Parameters of [`Jenkins`] as files carry them.
    JenkinsParameters {
        /// Level F_c at which it slides \[N or N m\], above zero.
        f_c: f64, Force, Range::Positive;
        /// Stiffness k of the spring \[N/m or N m/rad\], above zero.
        k: f64, Stiffness, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: f64, Damping, Range::NonNegative;
    }
}

/// Jenkins's element with valid parameters. State: the extension of the spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jenkins {
    parameters: JenkinsParameters,
    /// Extension at which it slides \[m or rad\].
    limit: f64,
}

impl TryFrom<JenkinsParameters> for Jenkins {
    type Error = ModelError;

    fn try_from(p: JenkinsParameters) -> Result<Self, ModelError> {
        p.check(Self::NAME)?;
        let limit = p.f_c / p.k;
        let usable = limit > 0.0 && limit.is_finite();
        p.require(Self::NAME, usable, "k", p.k, "such that f_c / k is a finite extension")?;
        Ok(Self { parameters: p, limit })
    }
}

built_from!(Jenkins, JenkinsParameters);

impl FrictionModel for Jenkins {
    const NAME: &'static str = "jenkins";
    type Parameters = JenkinsParameters;
    type Continuous = [f64; 1];
    type Memory = ();
    /// The period \[s\].
    type Discrete = f64;

    fn parameters(&self) -> &JenkinsParameters {
        &self.parameters
    }

    fn rest(&self) -> State<[f64; 1], ()> {
        State { continuous: [0.0], memory: () }
    }

    fn evaluate(&self, &[z]: &[f64; 1], (): &(), velocity: f64) -> Evaluation<[f64; 1]> {
        let slides = z.abs() >= self.limit && z * velocity > 0.0;
        let rate = if slides { 0.0 } else { velocity };
        Evaluation { force: self.parameters.k * z + self.viscous(velocity), rates: [rate] }
    }

    fn commit(&self, state: &mut State<[f64; 1], ()>, _: f64, _: f64) {
        state.continuous = state.continuous.map(|z| saturate(self.limit, z));
    }

    fn discretise(&self, dt: TimeStep) -> f64 {
        dt.seconds()
    }

    fn step(&self, dt: &f64, state: &mut State<[f64; 1], ()>, velocity: f64) -> f64 {
        let v = bounded(velocity);
        let [z] = state.continuous;
        state.continuous = [saturate(self.limit, z + v * dt)];
        self.parameters.k * z + self.viscous(v)
    }

    fn inject(&self, dt: TimeStep, state: &mut State<[f64; 1], ()>, _: f64, rate: f64) -> f64 {
        state.continuous = state.continuous.map(|z| saturate(self.limit, z + rate * dt.seconds()));
        0.0
    }

    fn steady_state(&self, velocity: f64) -> f64 {
        self.parameters.f_c * sign(velocity) + self.viscous(velocity)
    }

    fn internals(&self, state: &State<[f64; 1], ()>, velocity: f64) -> Internals {
        let [z] = state.continuous;
        let slides = z.abs() >= self.limit && z * velocity > 0.0;
        let regime = if slides { Regime::Slip } else { Regime::Stick };
        Internals { deflection: z, gamma: self.parameters.f_c, regime }
    }

    fn viscous(&self, velocity: f64) -> f64 {
        self.parameters.f_v * velocity
    }

    fn stored_energy(&self, state: &State<[f64; 1], ()>) -> Option<f64> {
        let [z] = state.continuous;
        Some(0.5 * self.parameters.k * z * z)
    }
}

#[cfg(test)]
mod tests {
    use friction_model::invariants;

    use super::*;

    #[test]
    fn it_keeps_what_every_friction_model_keeps() {
        let p = JenkinsParameters { f_c: 0.1, k: 16.0, f_v: 0.04 };
        invariants::check(&Jenkins::try_from(p).unwrap()).unwrap();
    }
}
