//! `parameters.yaml`: models, controller and drive as a ROS 2 parameter file.

use std::collections::BTreeMap;

use controller::ControllerOptions;
use friction_model::{AnyModel, ModelName};
use rig_driver::DriveParameters;
use serde::{Deserialize, Serialize};

use super::{Compensators, ControllerParameters, RunError, RunOptions};
use crate::test_bed::TestBed;

/// The file: node name, then `ros__parameters`.
#[derive(Debug, Serialize)]
struct File<'a> {
    #[serde(rename = "/friction_observer")]
    friction_observer: Node<BTreeMap<&'a str, Entry>>,
    #[serde(rename = "/controller")]
    controller: Node<ControllerParameters>,
    #[serde(rename = "/rig_driver")]
    rig_driver: Node<RigNode<'a>>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Node<P> {
    #[serde(rename = "ros__parameters")]
    parameters: P,
}

/// `model: proposed`, or `proposed: {...}`.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(untagged)]
enum Entry {
    Choice(ModelName),
    Parameters(serde_json::Value),
}

#[derive(Debug, Serialize)]
struct RigNode<'a> {
    drive: &'a DriveParameters,
    voltage_limit: f64,
    period: f64,
}

/// Where the parameters come from, if nothing was identified.
pub(crate) const GIVEN: &str = "the parameters this run was given";

/// The file as text: `chosen` is the observer's model, all models stand with their parameters.
pub(super) fn render(
    options: &RunOptions,
    models: &Compensators,
    chosen: ModelName,
) -> Result<String, RunError> {
    let origin = if options.experiment.identifies() {
        "static parameters identified by this run; stiffness, damping and lag as given to it"
    } else {
        GIVEN
    };
    render_bed(&options.test_bed, models, chosen, origin)
}

/// The same for any run on `test_bed`; `origin` says where the parameters come from.
///
/// # Errors
/// As for [`render`].
pub(crate) fn render_bed(
    test_bed: &TestBed,
    models: &Compensators,
    chosen: ModelName,
    origin: &str,
) -> Result<String, RunError> {
    let mut observer = BTreeMap::from([("model", Entry::Choice(chosen))]);
    let mut asymmetric = serde_json::Map::new();
    for name in ModelName::ALL {
        let model = models.get(name);
        let mut described = serde_json::to_value(model).map_err(|e| describe(&e))?;
        if let Some(both) = described.get_mut("asymmetric").and_then(serde_json::Value::as_object_mut) {
            asymmetric.append(both);
        } else {
            observer.insert(name.as_str(), Entry::Parameters(described[name.as_str()].take()));
        }
    }
    if !asymmetric.is_empty() {
        observer.insert("asymmetric", Entry::Parameters(asymmetric.into()));
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
                drive: simulation.drive.parameters(),
                voltage_limit: simulation.voltage_limit,
                period: simulation.period,
            },
        },
    };
    let yaml = serde_saphyr::to_string(&file).map_err(|e| describe(&e))?;
    Ok(format!("# frictionlab {}: {origin}.\n{yaml}", env!("CARGO_PKG_VERSION")))
}

fn describe(error: &dyn std::fmt::Display) -> RunError {
    RunError::Describe { what: "YAML", detail: error.to_string() }
}

/// Parameters of each node of a file.
type Tree = BTreeMap<String, Node<serde_json::Value>>;

fn tree(text: &str) -> Result<Tree, String> {
    serde_saphyr::from_str(text)
        .map_err(|e| format!("{e}\n(expected `/NODE:` and under it `ros__parameters:`)"))
}

fn node<'a>(tree: &'a Tree, name: &str) -> Option<&'a serde_json::Value> {
    tree.iter().find(|(found, _)| found.trim_start_matches('/') == name).map(|(_, node)| &node.parameters)
}

/// Reads the controller of a parameter file; none if the file says nothing of it.
///
/// # Errors
/// A sentence about what is wrong in the text.
pub fn read_controller(text: &str) -> Result<Option<ControllerParameters>, String> {
    let tree = tree(text)?;
    node(&tree, "controller").map(ControllerParameters::read).transpose()
}

/// Reads the models of a parameter file; those it does not name keep the test bed's parameters, all of them if the file is of the
/// controller alone.
///
/// # Errors
/// A sentence about what is wrong in the text.
pub fn read(text: &str) -> Result<Compensators, String> {
    let tree = tree(text)?;
    let Some(node) = node(&tree, "friction_observer").or_else(|| node(&tree, "**")) else {
        return if node(&tree, "controller").is_some() {
            Ok(Compensators::default())
        } else {
            Err("there is no node `friction_observer` in it, and no `controller`; expected `/friction_observer: ros__parameters: ...`".to_owned())
        };
    };
    let entries =
        node.as_object().ok_or("`ros__parameters` of friction_observer must be a map of parameters")?;
    let mut models = Compensators::default();
    for (key, value) in entries {
        if key == "model" {
            let name = value.as_str().ok_or("`model` must be the name of a model")?;
            name.parse::<ModelName>().map_err(|e| e.to_string())?;
            continue;
        }
        let take = |file: serde_json::Value| {
            serde_json::from_value::<AnyModel>(file).map_err(|e| format!("in `{key}`: {e}"))
        };
        if key == "asymmetric" {
            let both = value.as_object().ok_or("`asymmetric` must be a map of models")?;
            for (name, sides) in both {
                models.set(take(serde_json::json!({ "asymmetric": { name: sides } }))?);
            }
        } else {
            let name: ModelName = key.parse().map_err(|e: friction_model::ModelError| e.to_string())?;
            models.set(take(serde_json::json!({ name.as_str(): value }))?);
        }
    }
    Ok(models)
}

#[cfg(test)]
mod tests {
    use friction_ident::StribeckValues;

    use super::*;
    use crate::run::options::tests::options;

    #[test]
    fn what_is_written_reads_back() {
        let found = StribeckValues { f_s: 0.2, f_c: 0.1, v_s: 0.3, f_v: 0.05, delta: 2.0 };
        let models = Compensators::default().with_static(&found).unwrap();
        let text = render(&options(), &models, ModelName::Proposed).unwrap();
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
        let text = render(&options(), &models, ModelName::LuGre).unwrap();
        assert!(text.contains("    asymmetric:\n      lugre:\n        forward:\n"), "{text}");
        assert_eq!(read(&text).unwrap(), models);
    }

    #[test]
    fn a_file_with_a_mistake_says_where() {
        for (text, said) in [
            ("a: 1", "ros__parameters"),
            ("/rig_driver:\n  ros__parameters:\n    x: 1.0\n", "friction_observer"),
            ("/friction_observer:\n  ros__parameters:\n    model: lugri\n", "lugri"),
            ("/friction_observer:\n  ros__parameters:\n    lugre:\n      f_s: -1.0\n", "lugre"),
            (
                "/friction_observer:\n  ros__parameters:\n    stribeck: {f_s: 1.0, f_c: 2.0, v_s: 0.1, f_v: 0.0}\n",
                "f_c",
            ),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(said), "{text}: {message}");
        }
    }
}
