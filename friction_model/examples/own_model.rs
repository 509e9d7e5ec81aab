//! A model of one's own: a smooth Coulomb law, `F = f_c tanh(v / v_0) + f_v v`, outside the crate.
//!
//! It has parameters with units and ranges, reads from files, and runs wherever a model does.

use friction_model::{
    FrictionModel, Internals, ModelError, ParameterSet, Range, Regime, State, Stepper, TimeStep,
    built_from, memoryless, parameters,
};

parameters! {
    /// Parameters of [`SmoothCoulomb`].
    SmoothCoulombParameters {
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: f64, Force, Range::Positive;
        /// Speed v_0 at which three quarters of it are reached \[m/s or rad/s\], above zero.
        v_0: f64, Speed, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more; 0 if left out.
        #[serde(default)]
        f_v: f64, Damping, Range::NonNegative;
    }
}

/// A smooth Coulomb law with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothCoulomb {
    parameters: SmoothCoulombParameters,
}

impl TryFrom<SmoothCoulombParameters> for SmoothCoulomb {
    type Error = ModelError;

    fn try_from(parameters: SmoothCoulombParameters) -> Result<Self, ModelError> {
        parameters.check(Self::NAME)?;
        Ok(Self { parameters })
    }
}

built_from!(SmoothCoulomb, SmoothCoulombParameters);

impl FrictionModel for SmoothCoulomb {
    const NAME: &'static str = "smooth_coulomb";
    // No states: the steps are the steady state.
    memoryless!(SmoothCoulombParameters);

    fn steady_state(&self, velocity: f64) -> f64 {
        self.parameters.f_c * (velocity / self.parameters.v_0).tanh() + self.viscous(velocity)
    }

    fn internals(&self, _: &State<[f64; 0], ()>, velocity: f64) -> Internals {
        let regime =
            if velocity.abs() > self.parameters.v_0 { Regime::Slip } else { Regime::Stick };
        Internals { deflection: 0.0, gamma: self.parameters.f_c, regime }
    }

    fn viscous(&self, velocity: f64) -> f64 {
        self.parameters.f_v * velocity
    }
}

fn main() -> Result<(), ModelError> {
    let model = SmoothCoulomb::try_from(SmoothCoulombParameters { f_c: 1.0, v_0: 0.01, f_v: 0.5 })?;
    let mut contact = Stepper::new(model, TimeStep::new(1e-3)?);
    for velocity in [-0.1, -0.001, 0.0, 0.001, 0.1] {
        let force = contact.step(velocity);
        println!("{velocity:6.3} m/s: {force:6.3} N");
        assert!(force * velocity >= 0.0, "friction drives");
    }
    assert!((contact.step(0.1) - 1.05).abs() < 1e-6);

    let wrong = SmoothCoulombParameters { f_c: -1.0, v_0: 0.01, f_v: 0.0 };
    println!("{}", SmoothCoulomb::try_from(wrong).unwrap_err());
    Ok(())
}

#[test]
fn it_runs() -> Result<(), ModelError> {
    main()
}
