//! Settings of the estimator as the parameters of the node that say them.

use std::collections::BTreeMap;

use friction_model::AnyModel;
use ros_node::{ParameterValue, parameters::ParameterStore};
use serde_json::Value;

use super::{declarations, parameters::ObserverSettings};
use crate::{EstimatorOptions, Technique, VelocitySource};

/// The parameters that make the node estimate with `model` and `options`, `position` if the
/// injected error is that of position: what a program sets that wants the node to do what it would
/// do itself. The period is left out, which cannot be set while the node runs.
///
/// # Errors
/// A sentence if no parameters say it: not every option of every technique is a parameter.
pub fn parameters_of(
    model: &AnyModel,
    options: &EstimatorOptions,
    position: bool,
) -> Result<BTreeMap<String, ParameterValue>, String> {
    let mut said = Said::default();
    let described = serde_json::to_value(model).map_err(|error| error.to_string())?;
    let name = model.name().as_str();
    said.text("model", name);
    if let Some(sides) = described.get("asymmetric") {
        said.nested("asymmetric", sides);
    } else if let Some(parameters) = described.get(name) {
        said.nested(name, parameters);
    }
    said.text("mode", if position { "position" } else { "velocity" });
    said.double("injection", options.injection);
    said.double("drive.gain", options.drive.gain);
    said.double("drive.time_constant", options.drive.time_constant);
    said.double("drive.volts_per_newton_metre", options.drive.volts_per_newton_metre);
    said.technique(&options.technique);
    said.velocity(&options.velocity);
    let said = said.0;

    // Read as the node will read them, they must come to the same.
    let names: Vec<String> = said.keys().cloned().collect();
    let store = ParameterStore::new(declarations(&names), &said, Box::new(|_, _| Ok(())))
        .map_err(|(name, reason)| format!("{name}: {reason}"))?;
    let read = ObserverSettings::read(store.values())?;
    if (read.model, read.options, read.position) == (*model, *options, position) {
        Ok(said)
    } else {
        Err(format!(
            "the node friction_observer has no parameters that say this: {name} by {:?}, velocity from {:?}; it knows the techniques with their usual options only",
            options.technique, options.velocity
        ))
    }
}

#[derive(Default)]
struct Said(BTreeMap<String, ParameterValue>);

impl Said {
    fn text(&mut self, name: &str, value: &str) {
        self.0.insert(name.to_owned(), ParameterValue::String(value.to_owned()));
    }

    fn double(&mut self, name: &str, value: f64) {
        self.0.insert(name.to_owned(), ParameterValue::Double(value));
    }

    /// What a file would have under `prefix`.
    fn nested(&mut self, prefix: &str, value: &Value) {
        let parameter = match value {
            Value::Object(entries) => {
                for (name, value) in entries {
                    self.nested(&format!("{prefix}.{name}"), value);
                }
                return;
            }
            Value::Number(number) if number.is_f64() => {
                ParameterValue::Double(number.as_f64().unwrap_or(0.0))
            }
            Value::Number(number) => ParameterValue::Integer(number.as_i64().unwrap_or(0)),
            Value::Array(all) => {
                ParameterValue::DoubleArray(all.iter().filter_map(Value::as_f64).collect())
            }
            Value::Null | Value::Bool(_) | Value::String(_) => return,
        };
        self.0.insert(prefix.to_owned(), parameter);
    }

    fn technique(&mut self, technique: &Technique) {
        let name = match technique {
            Technique::Feedback => "feedback",
            Technique::Feedforward => "feedforward",
            Technique::Both { share } => {
                self.double("share", *share);
                "both"
            }
            Technique::Adaptive(_) => "adaptive",
            Technique::AdaptiveParameters(_) => "adaptive_parameters",
            Technique::AdaptiveStiffness(_) => "adaptive_stiffness",
            Technique::DisturbanceObserver(options) => {
                self.double("disturbance_observer.bandwidth", options.bandwidth);
                self.double("disturbance_observer.limit", options.limit);
                "disturbance_observer"
            }
            Technique::Rbf(_) => "rbf",
        };
        self.text("technique", name);
    }

    fn velocity(&mut self, source: &VelocitySource) {
        let name = match source {
            VelocitySource::Tachometer => "tachometer",
            VelocitySource::TachometerLowPass { time_constant } => {
                self.double("velocity.time_constant", *time_constant);
                "tachometer_low_pass"
            }
            VelocitySource::EncoderTrackingLoop { bandwidth } => {
                self.double("velocity.bandwidth", *bandwidth);
                "encoder_tracking_loop"
            }
            VelocitySource::EncoderKalman { .. } => "encoder_kalman",
            VelocitySource::Fused { .. } => "fused",
        };
        self.text("velocity_source", name);
    }
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;
    use crate::adaptive::LevelOptions;
    use crate::{DisturbanceObserverOptions, RbfOptions};

    #[test]
    fn every_model_and_technique_with_its_usual_options_can_be_said() {
        for name in ModelName::ALL {
            let said =
                parameters_of(&AnyModel::test_bed(name), &EstimatorOptions::default(), false)
                    .unwrap();
            assert_eq!(said["model"], ParameterValue::String(name.to_string()));
        }
        let weaker = AnyModel::test_bed(ModelName::Gms).scaled("f_v", 0.5).unwrap();
        let both = AnyModel::asymmetric(&AnyModel::test_bed(ModelName::Gms), &weaker).unwrap();
        parameters_of(&both, &EstimatorOptions::default(), true).unwrap();
        for technique in [
            Technique::Feedforward,
            Technique::Both { share: 0.3 },
            Technique::Adaptive(LevelOptions::SRV02),
            Technique::Rbf(RbfOptions::SRV02),
            Technique::DisturbanceObserver(DisturbanceObserverOptions {
                bandwidth: 55.0,
                ..DisturbanceObserverOptions::SRV02
            }),
        ] {
            let velocity = VelocitySource::EncoderTrackingLoop { bandwidth: 80.0 };
            let options = EstimatorOptions { technique, velocity, ..EstimatorOptions::default() };
            parameters_of(&AnyModel::test_bed(ModelName::LuGre), &options, false).unwrap();
        }
    }

    #[test]
    fn what_no_parameter_says_is_refused() {
        let options = EstimatorOptions { feeds_controller: true, ..EstimatorOptions::default() };
        let said =
            parameters_of(&AnyModel::test_bed(ModelName::LuGre), &options, false).unwrap_err();
        assert!(said.contains("no parameters that say this"), "{said}");
        let source = VelocitySource::EncoderKalman { encoder_step: 1e-3, friction_walk: 2.0 };
        let options = EstimatorOptions { velocity: source, ..EstimatorOptions::default() };
        assert!(parameters_of(&AnyModel::test_bed(ModelName::LuGre), &options, false).is_err());
    }
}
