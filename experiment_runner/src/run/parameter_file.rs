//! `parameters.yaml`: models, controller and drive as a ROS 2 parameter file. Behind each value
//! stands where it comes from.

use std::collections::BTreeMap;

use controller::ControllerOptions;
use friction_model::{AnyModel, ModelName, Motor};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::origin::{Origin, Origins};
use super::{Compensators, ControllerParameters, Identification, RunError, RunOptions};
use crate::test_bed::TestBed;
use files::commented_yaml;
use rig_setup::RigChoice;

/// The file: node name, then `ros__parameters`.
#[derive(Debug, Serialize)]
struct File<'a> {
    #[serde(rename = "/friction_observer")]
    friction_observer: Node<BTreeMap<&'a str, Value>>,
    #[serde(rename = "/controller")]
    controller: Node<ControllerParameters>,
    #[serde(rename = "/rig_driver")]
    rig_driver: Node<RigNode<'a>>,
}

#[derive(Debug, Serialize)]
struct Node<P> {
    #[serde(rename = "ros__parameters")]
    parameters: P,
}

#[derive(Debug, Serialize)]
struct RigNode<'a> {
    drive: &'a Motor,
    voltage_limit: f64,
    period: f64,
}

/// A parameter file as text, and where each of its values comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// The file.
    pub text: String,
    /// Each value's origin.
    pub origins: Origins,
}

/// The file of a run: `chosen` is the observer's model, all models stand with their parameters.
/// `found` is what the run identified, if it did; `name` tells the run.
pub(super) fn render(
    options: &RunOptions,
    models: &Compensators,
    chosen: ModelName,
    found: Option<&Identification>,
    name: &str,
) -> Result<Written, RunError> {
    let mut origins = options.origins.clone();
    if options.rig != RigChoice::Simulated {
        for own in ["rig_driver.voltage_limit", "rig_driver.period"] {
            origins.set(own, Origin::Rig);
        }
    }
    render_bed((&options.test_bed, models, chosen), &origins, found, name)
}

/// The same for any run on a test bed; `origins` says where what it was given comes from.
///
/// # Errors
/// As for [`render`].
pub fn render_bed(
    (test_bed, models, chosen): (&TestBed, &Compensators, ModelName),
    origins: &Origins,
    found: Option<&Identification>,
    name: &str,
) -> Result<Written, RunError> {
    let mut observer = BTreeMap::from([("model", json!(chosen))]);
    let mut asymmetric = Map::new();
    for name in ModelName::ALL {
        let mut described = described(&models.get(name))?;
        if let Some(both) = described.get_mut("asymmetric").and_then(Value::as_object_mut) {
            asymmetric.append(both);
        } else {
            observer.insert(name.as_str(), described[name.as_str()].take());
        }
    }
    if !asymmetric.is_empty() {
        observer.insert("asymmetric", asymmetric.into());
    }
    let simulation = &test_bed.simulation;
    let file = File {
        friction_observer: Node { parameters: observer },
        controller: Node {
            parameters: ControllerParameters::of(&ControllerOptions {
                voltage_limit: simulation.voltage_limit,
                ..test_bed.controller
            }),
        },
        rig_driver: Node {
            parameters: RigNode {
                drive: &simulation.drive,
                voltage_limit: simulation.voltage_limit,
                period: simulation.period,
            },
        },
    };
    let tree = match serde_json::to_value(&file) {
        Ok(Value::Object(tree)) => tree,
        Ok(_) => return Err(describe(&"it is no map")),
        Err(error) => return Err(describe(&error)),
    };
    let mut known = origins.clone();
    known.set("controller.voltage_limit", origins.of("rig_driver.voltage_limit"));
    known.set("controller.volts_per_newton_metre", Origin::Drive);
    known.set("friction_observer.model", Origin::Option { option: "--model".to_owned() });
    let mut each = Origins::default();
    for (path, _) in commented_yaml::leaves(&tree) {
        let path = plain(&path);
        let origin =
            found.and_then(|found| identified(found, &path)).unwrap_or_else(|| known.of(&path));
        each.set(path, origin);
    }
    let yaml = commented_yaml::render(&tree, &|path| each.of(&plain(path)).to_string());
    let version = env!("CARGO_PKG_VERSION");
    let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let identified = if each.any_identified() {
        "static parameters of the models were identified by it"
    } else {
        "nothing was identified by it"
    };
    let text = format!(
        "# Parameters of {name}, frictionlab {version}; {identified}.\n# Behind each value stands where it comes from.\n{yaml}"
    );
    Ok(Written { text, origins: each })
}

/// Where a value comes from that the fit of the Stribeck curve touched.
fn identified(found: &Identification, path: &str) -> Option<Origin> {
    let within = path.strip_prefix("friction_observer.")?;
    let name = within.rsplit('.').next()?;
    let level = |name: &str| found.parameters.iter().find(|parameter| parameter.name == name);
    if let Some(parameter) = level(name) {
        let doubtful = parameter.estimate.unidentifiable.is_some();
        return Some(if doubtful { Origin::NotIdentifiable } else { Origin::Identified });
    }
    match name {
        "f_h" => Some(Origin::InProportion { to: "f_s".to_owned() }),
        "z_ba" => Some(Origin::InProportion { to: "f_c".to_owned() }),
        "delta" => Some(Origin::Fixed),
        _ => None,
    }
}

/// The path of a value without the node's slash and `ros__parameters`.
fn plain(path: &str) -> String {
    path.trim_start_matches('/').replacen(".ros__parameters", "", 1)
}

pub(super) fn described(model: &AnyModel) -> Result<Value, RunError> {
    serde_json::to_value(model).map_err(|error| describe(&error))
}

fn describe(error: &dyn std::fmt::Display) -> RunError {
    RunError::Describe { what: "YAML", detail: error.to_string() }
}

#[cfg(test)]
mod tests {
    use friction_ident::StribeckValues;

    use super::super::given::read;
    use super::*;
    use crate::run::options::tests::options;

    #[test]
    fn what_is_written_reads_back() {
        let found = StribeckValues { f_s: 0.2, f_c: 0.1, v_s: 0.3, f_v: 0.05, delta: 2.0 };
        let models = Compensators::default().with_static(&found).unwrap();
        let text = render(&options(), &models, ModelName::Proposed, None, "this run").unwrap().text;
        assert!(text.contains("/friction_observer:\n  ros__parameters:\n"), "{text}");
        assert!(text.contains("model: proposed"), "{text}");
        assert_eq!(read(&text).unwrap(), models);
    }

    #[test]
    fn asymmetric_models_are_written_and_read_back() {
        let mut models = Compensators::default();
        for name in [ModelName::LuGre, ModelName::Gms] {
            let weaker = AnyModel::test_bed(name).scaled("f_v", 0.5).unwrap();
            models.set(AnyModel::asymmetric(&AnyModel::test_bed(name), &weaker).unwrap());
        }
        let text = render(&options(), &models, ModelName::LuGre, None, "this run").unwrap().text;
        assert!(text.contains("    asymmetric:\n      lugre:\n        forward:\n"), "{text}");
        assert_eq!(read(&text).unwrap(), models);
    }

    #[test]
    fn every_value_of_the_file_says_where_it_comes_from() {
        let mut options = options();
        options.origins.set("controller.pid", Origin::File { file: "controller.yaml".to_owned() });
        let written =
            render(&options, &Compensators::default(), ModelName::Proposed, None, "runs/all-1")
                .unwrap();
        let mut values = 0;
        for line in written.text.lines().filter(|line| !line.starts_with('#')) {
            let (_, value) = line.split_once(':').unwrap();
            if !value.trim().is_empty() {
                values += 1;
                let (_, said) = value.split_once("  # ").unwrap_or_else(|| panic!("{line}"));
                assert!(!said.contains("identified"), "{line}");
            }
        }
        assert_eq!(values, written.origins.iter().count());
        assert!(written.text.contains("k_p: 5.7517  # from controller.yaml"), "{}", written.text);
        assert!(written.text.contains("nothing was identified by it"));
    }
}
