//! The parameters of an observer, as ROS 2 and parameter files have them: the technique, the
//! velocity, and every model's own parameters.

mod of_models;

use std::collections::BTreeMap;

use ::parameters::{
    Declaration, Declared, Named, ParameterError, ParameterValue, ValueRange, Values, choices,
    parameters,
};
use friction_model::{AnyModel, ModelName, Scheme, TimeStep};

pub use of_models::model_parameters;

use crate::adaptive::{LevelOptions, ParameterOptions, StiffnessOptions};
use crate::{
    DisturbanceObserverOptions, EstimatorOptions, FrictionEstimator, FuzzyOptions, NominalDrive,
    RbfOptions, SuperTwistingOptions, Technique, TechniqueName, VelocitySource, VelocitySourceName,
};

/// What the controller regulates, of which the error is injected.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[strum(serialize_all = "snake_case")]
pub enum Regulated {
    /// Velocity.
    #[default]
    Velocity,
    /// Position.
    Position,
}

choices!(TechniqueName, VelocitySourceName, Regulated);

parameters! {
    /// Options of the filters of the velocity.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct VelocityParameters {
        time_constant: f64, "Time constant of the low-pass filter of the tachometer", unit("s"),
            range(ValueRange::Double(0.00001, 1.0));
        bandwidth: f64, "Bandwidth of the encoder's tracking loop", unit("rad/s"),
            range(ValueRange::Double(1.0, 10_000.0));
    }
}

parameters! {
    /// Parameters of the node `friction_observer`, but for those of the models.
    #[derive(Debug, Clone, PartialEq)]
    pub struct ObserverParameters {
        model: Named<ModelName> = Named(ModelName::Proposed), "Friction model that estimates",
            choices(|| ModelName::ALL.map(ModelName::as_str).to_vec());
        technique: TechniqueName = TechniqueName::Feedback, "How the friction is estimated";
        mode: Regulated = Regulated::Velocity,
            "What the controller regulates: the error that is injected is of that";
        period: f64 = 0.001, "Period of the joint states", unit("s"),
            range(ValueRange::Double(0.0001, 0.01)), read_only();
        injection: f64 = 0.0,
            "Error injection gain k of the observer on the measured velocity",
            range(ValueRange::Double(-1000.0, 1000.0));
        scheme: Named<Scheme> = Named(Scheme::Held),
            "How the model takes the velocity between two joint states",
            choices(|| vec!["held", "mean"]);
        share: f64 = 0.5, "Share of the feedforward estimate in technique both",
            range(ValueRange::Double(0.0, 1.0));
        velocity_source: VelocitySourceName = VelocitySourceName::Tachometer,
            "Which velocity the estimator believes";
        velocity: VelocityParameters = VelocityParameters { time_constant: 0.005, bandwidth: 60.0 };
        ahead: f64 = 0.0,
            "Share of the feedforward estimate beside techniques without a model",
            range(ValueRange::Double(0.0, 1.0));
        disturbance_observer: DisturbanceObserverOptions = DisturbanceObserverOptions::SRV02;
        super_twisting: SuperTwistingOptions = SuperTwistingOptions::SRV02;
        fuzzy: FuzzyOptions = FuzzyOptions::SRV02;
        drive: NominalDrive = NominalDrive::SRV02;
        autostart: bool = true, "Configure and activate when the program starts", read_only();
    }
}

/// Every parameter of an observer, for whoever gives those of these names: the observer's own, and
/// each model's under its name. Parameters for each direction of motion, as in
/// `asymmetric.lugre.forward.f_s`, exist for the models to which they are given.
#[must_use]
pub fn declarations(given: &[String]) -> Vec<Declaration> {
    let mut declared = ObserverParameters::default().declarations();
    of_models::declare(given, &mut declared);
    declared
}

/// What the parameters of an observer say, read and checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObserverSettings {
    /// The model.
    pub model: AnyModel,
    /// How it is used.
    pub options: EstimatorOptions,
    /// Period of the joint states.
    pub dt: TimeStep,
    /// What the controller regulates.
    pub regulated: Regulated,
}

impl ObserverSettings {
    /// Reads and checks the parameters as a whole; every model is checked, not only the one that
    /// runs.
    ///
    /// # Errors
    /// [`ParameterError::Refused`] with the reason of the model or of the estimator.
    pub fn read(values: &Values) -> Result<Self, ParameterError> {
        let said = ObserverParameters::default().with(values);
        let Named(chosen) = said.model;
        let mut model = AnyModel::test_bed(chosen);
        for name in ModelName::ALL {
            let read = of_models::read(name, values)?;
            if name == chosen {
                model = read;
            }
        }
        let options = EstimatorOptions {
            technique: said.technique(),
            injection: said.injection,
            ahead: said.ahead,
            scheme: said.scheme.0,
            velocity: said.velocity(),
            feeds_controller: false,
            drive: said.drive,
        };
        let dt = TimeStep::new(said.period).map_err(ParameterError::refused)?;
        // What cannot be built is refused here, and not in the middle of the loop.
        FrictionEstimator::new(&model, options, dt).map_err(ParameterError::refused)?;
        Ok(Self { model, options, dt, regulated: said.mode })
    }
}

impl ObserverParameters {
    fn technique(&self) -> Technique {
        match self.technique {
            TechniqueName::Feedback => Technique::Feedback,
            TechniqueName::Feedforward => Technique::Feedforward,
            TechniqueName::Both => Technique::Both { share: self.share },
            TechniqueName::Adaptive => Technique::Adaptive(LevelOptions::SRV02),
            TechniqueName::AdaptiveParameters => {
                Technique::AdaptiveParameters(ParameterOptions::SRV02)
            }
            TechniqueName::AdaptiveStiffness => {
                Technique::AdaptiveStiffness(StiffnessOptions::SRV02)
            }
            TechniqueName::DisturbanceObserver => {
                Technique::DisturbanceObserver(self.disturbance_observer)
            }
            TechniqueName::Rbf => Technique::Rbf(RbfOptions::SRV02),
            TechniqueName::SuperTwisting => Technique::SuperTwisting(self.super_twisting),
            TechniqueName::Fuzzy => Technique::Fuzzy(self.fuzzy),
        }
    }

    fn velocity(&self) -> VelocitySource {
        let VelocityParameters { time_constant, bandwidth } = self.velocity;
        match self.velocity_source {
            VelocitySourceName::Tachometer => VelocitySource::Tachometer,
            VelocitySourceName::TachometerLowPass => {
                VelocitySource::TachometerLowPass { time_constant }
            }
            VelocitySourceName::EncoderTrackingLoop => {
                VelocitySource::EncoderTrackingLoop { bandwidth }
            }
            VelocitySourceName::EncoderKalman => VelocitySource::ENCODER_KALMAN,
            VelocitySourceName::Fused => VelocitySource::FUSED,
        }
    }

    /// The parameters that say these settings, but for the model's own; what no parameter says has
    /// its default.
    #[must_use]
    pub fn of(model: ModelName, options: &EstimatorOptions, regulated: Regulated) -> Self {
        let mut said = Self {
            model: Named(model),
            technique: options.technique.into(),
            mode: regulated,
            injection: options.injection,
            ahead: options.ahead,
            scheme: Named(options.scheme),
            velocity_source: options.velocity.into(),
            drive: options.drive,
            ..Self::default()
        };
        match options.technique {
            Technique::Both { share } => said.share = share,
            Technique::DisturbanceObserver(options) => said.disturbance_observer = options,
            Technique::SuperTwisting(options) => said.super_twisting = options,
            Technique::Fuzzy(options) => said.fuzzy = options,
            _ => {}
        }
        match options.velocity {
            VelocitySource::TachometerLowPass { time_constant } => {
                said.velocity.time_constant = time_constant;
            }
            VelocitySource::EncoderTrackingLoop { bandwidth } => {
                said.velocity.bandwidth = bandwidth;
            }
            _ => {}
        }
        said
    }

    /// The values that make a node estimate with `model` and `options`: what a program sets that
    /// wants the node to do what it would do itself. The period is left out, which cannot be set
    /// while the node runs.
    ///
    /// # Errors
    /// [`ParameterError::Refused`] if no parameters say it: not every option of every technique is
    /// a parameter.
    pub fn saying(
        model: &AnyModel,
        options: &EstimatorOptions,
        regulated: Regulated,
    ) -> Result<BTreeMap<String, ParameterValue>, ParameterError> {
        let own = Self::of(model.name(), options, regulated).values();
        let mut said: BTreeMap<String, ParameterValue> = own
            .iter()
            .filter(|(name, _)| !["period", "autostart"].contains(name))
            .map(|(name, value)| (name.to_owned(), value.clone()))
            .collect();
        said.extend(model_parameters(model)?);

        // Read as the node will read them, they must come to the same.
        let names: Vec<String> = said.keys().cloned().collect();
        let read = ObserverSettings::read(&Values::given(&declarations(&names), &said)?)?;
        if (read.model, read.options, read.regulated) == (*model, *options, regulated) {
            Ok(said)
        } else {
            Err(ParameterError::refused(format!(
                "the node friction_observer has no parameters that say this: {} by {:?}, velocity from {:?}; it knows the techniques with their usual options only",
                model.name(),
                options.technique,
                options.velocity
            )))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(given: &BTreeMap<String, ParameterValue>) -> Result<Values, ParameterError> {
        let names: Vec<String> = given.keys().cloned().collect();
        let values = Values::given(&declarations(&names), given)?;
        ObserverSettings::read(&values)?;
        Ok(values)
    }

    #[test]
    fn a_value_that_the_model_refuses_is_refused_with_the_models_reason() {
        let f_s = values(&BTreeMap::new()).unwrap().double("lugre.f_s");
        let given = |all: &[(&str, f64)]| {
            let all = all.iter().map(|(name, x)| ((*name).to_owned(), ParameterValue::Double(*x)));
            values(&all.collect())
        };
        let said = given(&[("lugre.f_c", 2.0 * f_s)]).unwrap_err().to_string();
        assert!(said.contains("f_c"), "{said}");
        given(&[("lugre.f_c", 2.0 * f_s), ("lugre.f_s", 3.0 * f_s)]).unwrap();
        let said = given(&[("lugre.sigma0", -1.0)]).unwrap_err().to_string();
        assert!(said.contains("above 0"), "{said}");
        assert!(given(&[("lugre.sigma0", f64::NAN)]).is_err());
    }

    #[test]
    fn parameters_for_each_direction_are_taken_where_they_are_given() {
        let symmetric = AnyModel::test_bed(ModelName::LuGre);
        let mut given =
            BTreeMap::from([("model".to_owned(), ParameterValue::String("lugre".into()))]);
        for (name, value) in model_parameters(&symmetric).unwrap() {
            let (_, row) = name.split_once('.').unwrap();
            let ParameterValue::Double(value) = value else { panic!("{name}") };
            for (side, factor) in [("forward", 1.0), ("backward", 1.5)] {
                let factor = if row == "f_v" { factor } else { 1.0 };
                let name = format!("asymmetric.lugre.{side}.{row}");
                given.insert(name, ParameterValue::Double(value * factor));
            }
        }
        let settings = ObserverSettings::read(&values(&given).unwrap()).unwrap();
        assert_eq!(settings.model.steady_state(1.0), symmetric.steady_state(1.0));
        assert!(settings.model.steady_state(-1.0) < symmetric.steady_state(-1.0));
    }

    #[test]
    fn every_model_and_technique_with_its_usual_options_can_be_said() {
        for name in ModelName::ALL {
            let options = EstimatorOptions::default();
            let said = ObserverParameters::saying(
                &AnyModel::test_bed(name),
                &options,
                Regulated::Velocity,
            )
            .unwrap();
            assert_eq!(said["model"], ParameterValue::String(name.to_string()));
        }
        let weaker = AnyModel::test_bed(ModelName::Gms).scaled("f_v", 0.5).unwrap();
        let both = AnyModel::asymmetric(&AnyModel::test_bed(ModelName::Gms), &weaker).unwrap();
        ObserverParameters::saying(&both, &EstimatorOptions::default(), Regulated::Position)
            .unwrap();
        for technique in [
            Technique::Feedforward,
            Technique::Both { share: 0.3 },
            Technique::Adaptive(LevelOptions::SRV02),
            Technique::Rbf(RbfOptions::SRV02),
            Technique::SuperTwisting(SuperTwistingOptions::SRV02_POSITION),
            Technique::Fuzzy(FuzzyOptions { limit: 0.2, ..FuzzyOptions::SRV02 }),
            Technique::DisturbanceObserver(DisturbanceObserverOptions {
                bandwidth: 55.0,
                ..DisturbanceObserverOptions::SRV02
            }),
        ] {
            let velocity = VelocitySource::EncoderTrackingLoop { bandwidth: 80.0 };
            let options = EstimatorOptions { technique, velocity, ..EstimatorOptions::default() };
            let model = AnyModel::test_bed(ModelName::LuGre);
            ObserverParameters::saying(&model, &options, Regulated::Velocity).unwrap();
        }
    }

    #[test]
    fn what_no_parameter_says_is_refused() {
        let model = AnyModel::test_bed(ModelName::LuGre);
        let source = VelocitySource::EncoderKalman { encoder_step: 1e-3, friction_walk: 2.0 };
        for options in [
            EstimatorOptions { feeds_controller: true, ..EstimatorOptions::default() },
            EstimatorOptions { velocity: source, ..EstimatorOptions::default() },
        ] {
            let said = ObserverParameters::saying(&model, &options, Regulated::Velocity);
            let said = said.unwrap_err().to_string();
            assert!(said.contains("no parameters that say this"), "{said}");
        }
    }
}
