//! Any model, chosen while the program runs.

use serde::{Deserialize, Serialize};

use crate::{
    Coulomb, FrictionModel, Internals, LuGre, ModelName, Proposed, Stepper, Stribeck, TimeStep, Viscous,
};

/// A friction model chosen by name. In files: the name, with the parameters under it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AnyModel {
    /// Coulomb's model.
    Coulomb(Coulomb),
    /// Viscous friction.
    Viscous(Viscous),
    /// The static Stribeck model.
    Stribeck(Stribeck),
    /// LuGre.
    LuGre(LuGre),
    /// The thesis's proposed model.
    Proposed(Proposed),
}

/// Runs the same expression on whichever model there is.
macro_rules! each {
    ($any:ident, $self:expr, $model:ident => $body:expr) => {
        match $self {
            $any::Coulomb($model) => $body,
            $any::Viscous($model) => $body,
            $any::Stribeck($model) => $body,
            $any::LuGre($model) => $body,
            $any::Proposed($model) => $body,
        }
    };
}

impl AnyModel {
    /// The model of that name with the parameters of the thesis's test bed.
    #[must_use]
    pub fn test_bed(name: ModelName) -> Self {
        match name {
            ModelName::Coulomb => Self::Coulomb(Coulomb::test_bed()),
            ModelName::Viscous => Self::Viscous(Viscous::test_bed()),
            ModelName::Stribeck => Self::Stribeck(Stribeck::test_bed()),
            ModelName::LuGre => Self::LuGre(LuGre::test_bed()),
            ModelName::Proposed => Self::Proposed(Proposed::test_bed()),
        }
    }

    /// Which model it is.
    #[must_use]
    pub const fn name(&self) -> ModelName {
        match self {
            Self::Coulomb(_) => ModelName::Coulomb,
            Self::Viscous(_) => ModelName::Viscous,
            Self::Stribeck(_) => ModelName::Stribeck,
            Self::LuGre(_) => ModelName::LuGre,
            Self::Proposed(_) => ModelName::Proposed,
        }
    }

    /// The force after a long time at constant `velocity`, see [`FrictionModel::steady_state`].
    #[must_use]
    pub fn steady_state(&self, velocity: f64) -> f64 {
        each!(AnyModel, self, model => model.steady_state(velocity))
    }

    /// Starts the model at rest with the period `dt`.
    #[must_use]
    pub fn start(&self, dt: TimeStep) -> AnyStepper {
        match *self {
            Self::Coulomb(model) => AnyStepper::Coulomb(Stepper::new(model, dt)),
            Self::Viscous(model) => AnyStepper::Viscous(Stepper::new(model, dt)),
            Self::Stribeck(model) => AnyStepper::Stribeck(Stepper::new(model, dt)),
            Self::LuGre(model) => AnyStepper::LuGre(Stepper::new(model, dt)),
            Self::Proposed(model) => AnyStepper::Proposed(Stepper::new(model, dt)),
        }
    }
}

/// A running model of any kind: a [`Stepper`] chosen while the program runs.
#[derive(Debug, Clone)]
#[expect(
    clippy::large_enum_variant,
    reason = "the reversal stack lives in place: the step path does not allocate"
)]
pub enum AnyStepper {
    /// Coulomb's model.
    Coulomb(Stepper<Coulomb>),
    /// Viscous friction.
    Viscous(Stepper<Viscous>),
    /// The static Stribeck model.
    Stribeck(Stepper<Stribeck>),
    /// LuGre.
    LuGre(Stepper<LuGre>),
    /// The thesis's proposed model.
    Proposed(Stepper<Proposed>),
}

impl AnyStepper {
    /// The friction now at `velocity`; the state then advances by one period. See [`Stepper::step`].
    #[inline]
    pub fn step(&mut self, velocity: f64) -> f64 {
        each!(AnyStepper, self, stepper => stepper.step(velocity))
    }

    /// Back to rest.
    pub fn reset(&mut self) {
        each!(AnyStepper, self, stepper => stepper.reset());
    }

    /// The inner quantities at `velocity`.
    #[inline]
    #[must_use]
    pub fn internals(&self, velocity: f64) -> Internals {
        each!(AnyStepper, self, stepper => stepper.internals(velocity))
    }

    /// Which model runs.
    #[must_use]
    pub const fn name(&self) -> ModelName {
        match self {
            Self::Coulomb(_) => ModelName::Coulomb,
            Self::Viscous(_) => ModelName::Viscous,
            Self::Stribeck(_) => ModelName::Stribeck,
            Self::LuGre(_) => ModelName::LuGre,
            Self::Proposed(_) => ModelName::Proposed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_reads_back_from_a_file() {
        for name in ModelName::ALL {
            let model = AnyModel::test_bed(name);
            assert_eq!(model.name(), name);
            let text = serde_json::to_string(&model).unwrap();
            assert!(text.starts_with(&format!("{{\"{name}\":")), "{text}");
            assert_eq!(serde_json::from_str::<AnyModel>(&text).unwrap(), model);
        }
    }

    #[test]
    fn a_file_with_an_impossible_parameter_is_refused_with_the_reason() {
        let text = r#"{"lugre":{"f_s":1.0,"f_c":1.0,"v_s":0.1,"sigma0":-5.0,"sigma1":0.1,"f_v":0.0}}"#;
        let message = serde_json::from_str::<AnyModel>(text).unwrap_err().to_string();
        assert!(message.contains("lugre.sigma0") && message.contains("-5"), "{message}");
    }

    #[test]
    fn a_chosen_model_steps_as_the_model_itself() {
        let dt = TimeStep::new(1e-3).unwrap();
        let mut any = AnyModel::test_bed(ModelName::Proposed).start(dt);
        let mut own = Stepper::new(Proposed::test_bed(), dt);
        for k in 0..2000 {
            let v = 0.3 * (0.0031 * f64::from(k)).sin();
            assert_eq!(any.step(v), own.step(v));
        }
    }
}
