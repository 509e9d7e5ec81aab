//! Parameters of the node `friction_observer`: the model, every model's own parameters, and the
//! technique.

use friction_model::{AnyModel, AnyParameters, ModelError, ModelName, Parameter, Range, TimeStep};
use ros_node::{
    ParameterValue,
    parameters::{Declaration, ValueRange, Values},
};
use serde_json::{Map, Value, json};

use crate::adaptive::{LevelOptions, ParameterOptions, StiffnessOptions};
use crate::{
    DisturbanceObserverOptions, EstimatorOptions, FrictionEstimator, NominalDrive, RbfOptions,
    Technique, VelocitySource,
};

const POSITIVE: ValueRange = ValueRange::Double(f64::MIN_POSITIVE, f64::MAX);
const SIDES: [&str; 2] = ["forward", "backward"];

/// Every parameter of the node, for what the command line gives: parameters for each direction
/// exist for the models to which they are given.
#[must_use]
pub fn declarations(given: &[String]) -> Vec<Declaration> {
    let options = EstimatorOptions::default();
    let drive = NominalDrive::SRV02;
    let mut declared = vec![
        Declaration::text("model", "proposed", "Friction model that estimates")
            .choices(ModelName::ALL.map(ModelName::as_str)),
        Declaration::text("technique", "feedback", "How the friction is estimated").choices([
            "feedback",
            "feedforward",
            "both",
            "adaptive",
            "adaptive_parameters",
            "adaptive_stiffness",
            "disturbance_observer",
            "rbf",
        ]),
        Declaration::text(
            "mode",
            "velocity",
            "What the controller regulates: the error that is injected is of that",
        )
        .choices(["velocity", "position"]),
        Declaration::double("period", 1e-3, "Period of the joint states [s]")
            .range(ValueRange::Double(1e-4, 0.01))
            .read_only(),
        Declaration::double(
            "injection",
            options.injection,
            "Error injection gain k of the observer on the measured velocity",
        )
        .range(ValueRange::Double(-1e3, 1e3)),
        Declaration::double("share", 0.5, "Share of the feedforward estimate in technique both")
            .range(ValueRange::Double(0.0, 1.0)),
        Declaration::text("velocity_source", "tachometer", "Which velocity the estimator believes")
            .choices([
                "tachometer",
                "tachometer_low_pass",
                "encoder_tracking_loop",
                "encoder_kalman",
                "fused",
            ]),
        Declaration::double(
            "velocity.time_constant",
            0.005,
            "Time constant of the low-pass filter of the tachometer [s]",
        )
        .range(ValueRange::Double(1e-5, 1.0)),
        Declaration::double(
            "velocity.bandwidth",
            60.0,
            "Bandwidth of the encoder's tracking loop [rad/s]",
        )
        .range(ValueRange::Double(1.0, 1e4)),
        Declaration::double(
            "disturbance_observer.bandwidth",
            DisturbanceObserverOptions::SRV02.bandwidth,
            "Bandwidth of the disturbance observer's filter [rad/s]",
        )
        .range(ValueRange::Double(0.1, 1e4)),
        Declaration::double(
            "disturbance_observer.limit",
            DisturbanceObserverOptions::SRV02.limit,
            "Largest magnitude of its estimate [N m]",
        )
        .range(POSITIVE),
        Declaration::double(
            "drive.gain",
            drive.gain,
            "Velocity gain K that is believed of the drive [rad/s per V]",
        )
        .range(POSITIVE),
        Declaration::double(
            "drive.time_constant",
            drive.time_constant,
            "Time constant T that is believed of the drive [s]",
        )
        .range(POSITIVE),
        Declaration::double(
            "drive.volts_per_newton_metre",
            drive.volts_per_newton_metre,
            "Voltage that overcomes 1 N m of friction [V/(N m)]",
        )
        .range(POSITIVE),
        Declaration::boolean("autostart", true, "Configure and activate when the program starts")
            .read_only(),
    ];
    for name in ModelName::ALL {
        declare_model(name, name.as_str(), given, &mut declared);
        let prefix = format!("asymmetric.{name}");
        if given.iter().any(|given| given.starts_with(&format!("{prefix}."))) {
            for side in SIDES {
                declare_model(name, &format!("{prefix}.{side}"), given, &mut declared);
            }
        }
    }
    declared
}

/// The parameters of one model under a prefix. A parameter that may be left out exists only if it
/// has a value or is given one.
fn declare_model(name: ModelName, prefix: &str, given: &[String], declared: &mut Vec<Declaration>) {
    let parameters = AnyParameters::test_bed(name);
    let written = written(&parameters);
    for row in parameters.table() {
        let full = format!("{prefix}.{}", row.name);
        let default = match written.get(row.name) {
            Some(Value::Array(_)) => ParameterValue::DoubleArray(parameters.values(row.name)),
            Some(Value::Number(number)) if !number.is_f64() => {
                ParameterValue::Integer(number.as_i64().unwrap_or(0))
            }
            Some(Value::Number(number)) => ParameterValue::Double(number.as_f64().unwrap_or(0.0)),
            _ if given.contains(&full) => ParameterValue::Double(0.0),
            _ => continue,
        };
        declared.push(declare_row(full, default, row));
    }
}

fn declare_row(full: String, default: ParameterValue, row: &Parameter) -> Declaration {
    let whole = matches!(default, ParameterValue::Integer(_));
    let declaration = Declaration::new(full, default, row.meaning);
    let range = match row.range {
        Range::Any => return declaration,
        Range::Such(words) => return declaration.constraint(words),
        Range::Positive => (f64::MIN_POSITIVE, f64::MAX),
        Range::NonNegative => (0.0, f64::MAX),
        Range::Within(low, high) => (low.next_up(), high),
        Range::FromTo(low, high) => (low, high),
    };
    declaration.range(if whole {
        ValueRange::Integer(range.0.ceil().max(0.0) as i64, range.1.min(f64::from(u32::MAX)) as i64)
    } else {
        ValueRange::Double(range.0, range.1)
    })
}

/// A model's parameters as files carry them.
fn written(parameters: &AnyParameters) -> Map<String, Value> {
    match serde_json::to_value(parameters) {
        Ok(Value::Object(mut all)) => match all.remove(parameters.name().as_str()) {
            Some(Value::Object(values)) => values,
            _ => Map::new(),
        },
        _ => Map::new(),
    }
}

/// What the parameters say, read and checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ObserverSettings {
    pub(super) model: AnyModel,
    pub(super) options: EstimatorOptions,
    pub(super) dt: TimeStep,
    /// The injected error is that of position.
    pub(super) position: bool,
}

impl ObserverSettings {
    /// Reads and checks the parameters as a whole; every model is checked, not only the one that
    /// runs.
    ///
    /// # Errors
    /// The reason, for people.
    pub(super) fn read(values: &Values) -> Result<Self, String> {
        let chosen: ModelName =
            values.text("model").parse().map_err(|e: ModelError| e.to_string())?;
        let mut model = AnyModel::test_bed(chosen);
        for name in ModelName::ALL {
            let read = read_model(name, values)?;
            if name == chosen {
                model = read;
            }
        }
        let options = EstimatorOptions {
            technique: technique(values),
            injection: values.double("injection"),
            velocity: velocity(values),
            feeds_controller: false,
            drive: NominalDrive {
                gain: values.double("drive.gain"),
                time_constant: values.double("drive.time_constant"),
                volts_per_newton_metre: values.double("drive.volts_per_newton_metre"),
            },
        };
        let dt = TimeStep::new(values.double("period")).map_err(|error| error.to_string())?;
        // What cannot be built is refused here, and not in the middle of the loop.
        FrictionEstimator::new(&model, options, dt).map_err(|error| error.to_string())?;
        Ok(Self { model, options, dt, position: values.text("mode") == "position" })
    }
}

fn technique(values: &Values) -> Technique {
    match values.text("technique") {
        "feedforward" => Technique::Feedforward,
        "both" => Technique::Both { share: values.double("share") },
        "adaptive" => Technique::Adaptive(LevelOptions::SRV02),
        "adaptive_parameters" => Technique::AdaptiveParameters(ParameterOptions::SRV02),
        "adaptive_stiffness" => Technique::AdaptiveStiffness(StiffnessOptions::SRV02),
        "disturbance_observer" => Technique::DisturbanceObserver(DisturbanceObserverOptions {
            bandwidth: values.double("disturbance_observer.bandwidth"),
            limit: values.double("disturbance_observer.limit"),
            ..DisturbanceObserverOptions::SRV02
        }),
        "rbf" => Technique::Rbf(RbfOptions::SRV02),
        _ => Technique::Feedback,
    }
}

fn velocity(values: &Values) -> VelocitySource {
    match values.text("velocity_source") {
        "tachometer_low_pass" => VelocitySource::TachometerLowPass {
            time_constant: values.double("velocity.time_constant"),
        },
        "encoder_tracking_loop" => {
            VelocitySource::EncoderTrackingLoop { bandwidth: values.double("velocity.bandwidth") }
        }
        "encoder_kalman" => VelocitySource::ENCODER_KALMAN,
        "fused" => VelocitySource::FUSED,
        _ => VelocitySource::Tachometer,
    }
}

/// The model of that name with its parameters; for each direction, where such are declared.
fn read_model(name: ModelName, values: &Values) -> Result<AnyModel, String> {
    let side = |prefix: &str| {
        let mut read = Map::new();
        for row in AnyParameters::test_bed(name).table() {
            let value = match values.get(&format!("{prefix}.{}", row.name)) {
                Some(ParameterValue::Double(value)) => json!(value),
                Some(ParameterValue::Integer(value)) => json!(value),
                Some(ParameterValue::DoubleArray(all)) => json!(all),
                _ => continue,
            };
            read.insert(row.name.to_owned(), value);
        }
        read
    };
    let own = json!({ name.as_str(): side(name.as_str()) });
    let symmetric = serde_json::from_value::<AnyModel>(own).map_err(|error| error.to_string())?;
    let prefix = format!("asymmetric.{name}");
    let [forward, backward] = SIDES.map(|of| side(&format!("{prefix}.{of}")));
    if forward.is_empty() {
        return Ok(symmetric);
    }
    let both =
        json!({ "asymmetric": { name.as_str(): { "forward": forward, "backward": backward } } });
    serde_json::from_value(both).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use ros_node::parameters::{Change, ParameterStore};

    use super::*;

    fn store(given: &BTreeMap<String, ParameterValue>) -> Result<ParameterStore, (String, String)> {
        let names: Vec<String> = given.keys().cloned().collect();
        ParameterStore::new(
            declarations(&names),
            given,
            Box::new(|values, _| ObserverSettings::read(values).map(|_| ())),
        )
    }

    #[test]
    fn every_model_stands_with_the_test_beds_parameters() {
        let store = store(&BTreeMap::new()).unwrap();
        for name in ModelName::ALL {
            assert_eq!(
                read_model(name, store.values()).unwrap(),
                AnyModel::test_bed(name),
                "{name}"
            );
        }
    }

    #[test]
    fn a_value_that_the_model_refuses_is_refused_with_the_models_reason() {
        let mut store = store(&BTreeMap::new()).unwrap();
        let set =
            |name: &str, value| Change { name: name.into(), value: ParameterValue::Double(value) };
        let f_s = store.values().double("lugre.f_s");
        let said = store.set(&[set("lugre.f_c", 2.0 * f_s)]).unwrap_err();
        assert!(said.contains("f_c"), "{said}");
        store.set(&[set("lugre.f_c", 2.0 * f_s), set("lugre.f_s", 3.0 * f_s)]).unwrap();
        assert!(store.set(&[set("lugre.sigma0", -1.0)]).unwrap_err().contains("above 0"));
        assert!(store.set(&[set("lugre.sigma0", f64::NAN)]).is_err());
    }

    #[test]
    fn parameters_for_each_direction_are_taken_where_they_are_given() {
        let parameters = AnyParameters::test_bed(ModelName::LuGre);
        let mut given =
            BTreeMap::from([("model".to_owned(), ParameterValue::String("lugre".into()))]);
        for row in parameters.table() {
            for (side, factor) in [("forward", 1.0), ("backward", 1.5)] {
                if let [value] = parameters.values(row.name)[..] {
                    let factor = if row.name == "f_v" { factor } else { 1.0 };
                    let name = format!("asymmetric.lugre.{side}.{}", row.name);
                    given.insert(name, ParameterValue::Double(value * factor));
                }
            }
        }
        let store = store(&given).unwrap();
        let settings = ObserverSettings::read(store.values()).unwrap();
        let symmetric = AnyModel::test_bed(ModelName::LuGre);
        assert_eq!(settings.model.steady_state(1.0), symmetric.steady_state(1.0));
        assert!(settings.model.steady_state(-1.0) < symmetric.steady_state(-1.0));
    }

    /// The documentation shows the parameters of the code; `UPDATE_DOCS=1` writes them anew.
    #[test]
    fn the_documentation_shows_these_parameters() {
        let own: Vec<_> = declarations(&[])
            .into_iter()
            .filter(|parameter| {
                parameter
                    .name()
                    .split_once('.')
                    .is_none_or(|(model, _)| model.parse::<ModelName>().is_err())
            })
            .collect();
        let made = ros_node::parameters::markdown_table(&own);
        let (begin, end) = ("<!-- friction_observer -->\n", "<!-- end of friction_observer -->\n");
        for page in ["../docs/reference/parameters.md"] {
            let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
            let mut text = std::fs::read_to_string(&path).expect("the page is part of the project");
            let from =
                text.find(begin).expect("the page marks where the table begins") + begin.len();
            let to = text.find(end).expect("the page marks where the table ends");
            if std::env::var_os("UPDATE_DOCS").is_some() {
                text.replace_range(from..to, &made);
                std::fs::write(&path, text).expect("the page can be written");
            } else {
                assert_eq!(&text[from..to], made, "{page}: run the test with UPDATE_DOCS=1");
            }
        }
    }
}
