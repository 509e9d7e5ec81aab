//! Parameter files of one model: an example to start from, and the reader that accepts every form
//! in use.

use std::collections::BTreeSet;
use std::fmt::Write;

use friction_model::{AnyModel, ModelError, ModelName};
use serde_json::{Map, Value, json};

use super::sheet::{explained, range};
use super::{Preset, values};
use crate::run::{GivenError, of_node};
use files::ros_parameters::file;
use friction_observer::parameters::{ObserverSettings, declarations};
use parameters::file::{FileError, Parameters, number};
use parameters::{ParameterError, ParameterValue, Values, with_nearest};

/// A parameter file in YAML with every parameter of the model and what it means.
#[must_use]
pub fn example(name: ModelName, preset: Preset) -> String {
    let parameters = preset.parameters(name);
    let values = values(&parameters);
    let (title, set) = (name.title(), preset.title());
    let mut text = format!(
        "# {title}: the thesis's {set}. Printed by frictionlab {}; to evaluate it along a motion:\n\
         #   frictionlab simulate --params THIS_FILE --velocity IN.csv --out OUT.csv\n{name}:\n",
        env!("CARGO_PKG_VERSION")
    );
    let rows: Vec<_> = parameters
        .table()
        .iter()
        .map(|row| {
            let line = match values.get(row.name) {
                Some(value) if !value.is_null() => format!("  {}: {}", row.name, yaml(value)),
                _ => format!("  # {}:", row.name),
            };
            let unit = match preset {
                Preset::TestBed => row.unit.rotary(),
                Preset::Chapter3 => row.unit.linear(),
            };
            let (meaning, conditions) = explained(row.meaning);
            let said = range(row, &conditions);
            let said = if unit.is_empty() { said } else { format!("{unit}; {said}") };
            (line, format!("{meaning} [{said}]"))
        })
        .collect();
    // A long list has its comment above it; the others stand beside each other.
    let is_short = |line: &str| line.chars().count() <= 40;
    let width = rows
        .iter()
        .map(|(line, _)| line.chars().count())
        .filter(|&width| width <= 40)
        .max()
        .unwrap_or(0);
    for (line, comment) in rows {
        // Writing to a string cannot fail.
        let _ = if is_short(&line) {
            writeln!(text, "{line:<width$}  # {comment}")
        } else {
            writeln!(text, "  # {comment}\n{line}")
        };
    }
    text
}

/// A value as YAML: whole numbers without, others with a point, so that ROS takes neither for the
/// other.
fn yaml(value: &Value) -> String {
    match value {
        Value::Array(list) => format!("[{}]", list.iter().map(yaml).collect::<Vec<_>>().join(", ")),
        Value::Number(whole) if !whole.is_f64() => whole.to_string(),
        other => other.as_f64().map_or_else(|| other.to_string(), number),
    }
}

/// A parameter file that does not tell the model that is wanted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelFileError {
    /// A ROS 2 parameter file with a mistake.
    #[error(transparent)]
    File(#[from] FileError),
    /// No YAML.
    #[error("{0}")]
    Yaml(String),
    /// No map, or an empty one.
    #[error("expected parameters under a model's name, as in `lugre: {{f_s: ...}}`")]
    Nothing,
    /// Parameters of nobody knows which model.
    #[error(
        "it names no model (its keys are: {keys}); put the parameters under the model's name, or give --model NAME"
    )]
    Nameless {
        /// What stands there, with commas.
        keys: String,
    },
    /// A ROS 2 parameter file without a model.
    #[error("it names no model; give --model NAME")]
    NoModel,
    /// A key beside models that is none.
    #[error("`{key}` is no model; expected one of: {}, asymmetric", ModelName::list())]
    NotAModel {
        /// The key.
        key: String,
    },
    /// Nothing says which of several models is meant.
    #[error("it has several models ({models}); choose one with --model NAME")]
    Several {
        /// Those there are, with commas.
        models: String,
    },
    /// Another model than those in the file is wanted.
    #[error("it has no parameters of `{wanted}`, but of: {models}")]
    Lacks {
        /// The model that is wanted.
        wanted: ModelName,
        /// Those there are, with commas.
        models: String,
    },
    /// A model that stands there twice.
    #[error("it has parameters of `{name}` more than once; leave one set of them")]
    Repeated {
        /// The model.
        name: ModelName,
    },
    /// Parameters that the model does not take.
    #[error("in `{name}`: {detail}")]
    Parameters {
        /// The model.
        name: ModelName,
        /// What is wrong with them.
        detail: String,
    },
    /// A ROS 2 parameter file of other nodes.
    #[error(
        "there is no node `friction_observer` with `ros__parameters` in this ROS 2 parameter file"
    )]
    NoNode,
    /// What the file gives the observer is not what it declares.
    #[error(transparent)]
    Given(#[from] GivenError),
    /// Values that do not go together.
    #[error(transparent)]
    Values(#[from] ParameterError),
    /// `model:` with something else than a name.
    #[error("`model` must be the name of a model")]
    NameNoText,
    /// `model:` with a name that there is not.
    #[error(transparent)]
    Name(ModelError),
    /// `asymmetric:` with something else than models.
    #[error(
        "`asymmetric` must be a map, as in `asymmetric: {{lugre: {{forward: {{...}}, backward: {{...}}}}}}`"
    )]
    AsymmetricNoMap,
    /// A name below `asymmetric:` that there is not.
    #[error("in `asymmetric`: {0}")]
    AsymmetricName(ModelError),
}

/// The model in a parameter file, in any of these forms:
///
/// * the parameters under the model's name, `lugre: {...}`, of one model or of several;
///   `model: NAME` beside them chooses;
/// * `asymmetric: {lugre: {forward: {...}, backward: {...}}}`;
/// * the bare parameters, or bare `forward: {...}` and `backward: {...}`, of the model `wanted`;
/// * a ROS 2 parameter file with one of the former for the node `friction_observer`, as
///   `frictionlab run` writes it.
///
/// `wanted` chooses the model, and comes before what the file chooses.
///
/// # Errors
/// [`ModelFileError`] says what is wrong in the text.
pub fn read(text: &str, wanted: Option<ModelName>) -> Result<AnyModel, ModelFileError> {
    if let Some(file) = file(text)? {
        return of_observer(&file, wanted);
    }
    let tree: Value = serde_saphyr::from_str(text)
        .map_err(|error| ModelFileError::Yaml(first_line(&error.to_string())))?;
    let tree = tree.as_object().filter(|tree| !tree.is_empty());
    let tree = tree.ok_or(ModelFileError::Nothing)?;
    let Entries { chosen, models, others } = Entries::of(tree)?;
    let wanted = wanted.or(chosen);
    if models.is_empty() {
        let keys = || others.keys().cloned().collect::<Vec<_>>().join(", ");
        let name = wanted.ok_or_else(|| ModelFileError::Nameless { keys: keys() })?;
        let both = others.contains_key("forward") && others.contains_key("backward");
        let tree = json!({ name.as_str(): others });
        return model(name, if both { json!({ "asymmetric": tree }) } else { tree });
    }
    if let Some(key) = others.keys().next() {
        return Err(ModelFileError::NotAModel { key: key.clone() });
    }
    let names = || models.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
    let of = |wanted: ModelName| models.iter().filter(move |(name, _)| *name == wanted);
    let name = match (wanted, &models[..]) {
        (Some(name), _) => name,
        (None, [(name, _), others @ ..]) if others.iter().all(|(other, _)| other == name) => *name,
        (None, _) => return Err(ModelFileError::Several { models: names() }),
    };
    match of(name).collect::<Vec<_>>()[..] {
        [(name, tree)] => model(*name, tree.clone()),
        [] => Err(ModelFileError::Lacks { wanted: name, models: names() }),
        _ => Err(ModelFileError::Repeated { name }),
    }
}

fn model(name: ModelName, tree: Value) -> Result<AnyModel, ModelFileError> {
    serde_json::from_value(tree).map_err(|error| ModelFileError::Parameters {
        name,
        detail: with_nearest(&error.to_string()),
    })
}

/// The model that the node `friction_observer` would have with this file: what is left out is the
/// test bed's.
fn of_observer(file: &Parameters, wanted: Option<ModelName>) -> Result<AnyModel, ModelFileError> {
    let names: Vec<String> = file.of_node("/friction_observer").into_keys().collect();
    let declared = declarations(&names);
    let given = of_node(file, "friction_observer", &declared)?;
    if given.is_empty() {
        return Err(ModelFileError::NoNode);
    }
    let parts = given.keys().map(|name| name.trim_start_matches("asymmetric."));
    let models: BTreeSet<ModelName> =
        parts.filter_map(|name| name.split_once('.')?.0.parse().ok()).collect();
    let chosen = match given.get("model") {
        Some(ParameterValue::String(name)) => name.parse().ok(),
        _ => None,
    };
    let list = || models.iter().map(|name| name.as_str()).collect::<Vec<_>>().join(", ");
    let name = match (wanted.or(chosen), models.iter().next()) {
        (Some(name), None) => name,
        (Some(name), Some(_)) if models.contains(&name) => name,
        (Some(name), Some(_)) => {
            return Err(ModelFileError::Lacks { wanted: name, models: list() });
        }
        (None, Some(name)) if models.len() == 1 => *name,
        (None, Some(_)) => return Err(ModelFileError::Several { models: list() }),
        (None, None) => return Err(ModelFileError::NoModel),
    };
    let mut values = Values::given(&declared, &given)?;
    values.set("model", ParameterValue::String(name.to_string()));
    Ok(ObserverSettings::read(&values)?.model)
}

/// What a tree says, sorted.
#[derive(Default)]
struct Entries {
    /// `model: NAME`.
    chosen: Option<ModelName>,
    /// Models, each as [`AnyModel`] reads it.
    models: Vec<(ModelName, Value)>,
    /// Keys that name no model.
    others: Map<String, Value>,
}

impl Entries {
    fn of(tree: &Map<String, Value>) -> Result<Self, ModelFileError> {
        let mut found = Self::default();
        for (key, value) in tree {
            if key == "model" {
                let name = value.as_str().ok_or(ModelFileError::NameNoText)?;
                found.chosen = Some(name.parse().map_err(ModelFileError::Name)?);
            } else if key == "asymmetric" {
                let sides = value.as_object().ok_or(ModelFileError::AsymmetricNoMap)?;
                for (key, value) in sides {
                    let name: ModelName = key.parse().map_err(ModelFileError::AsymmetricName)?;
                    found.models.push((name, json!({ "asymmetric": { name.as_str(): value } })));
                }
            } else if let Ok(name) = key.parse::<ModelName>() {
                found.models.push((name, json!({ name.as_str(): value })));
            } else {
                found.others.insert(key.clone(), value.clone());
            }
        }
        Ok(found)
    }
}

/// What the YAML reader says, without its picture of the place.
fn first_line(message: &str) -> String {
    message.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_example_reads_back() {
        for name in ModelName::ALL {
            for preset in [Preset::TestBed, Preset::Chapter3] {
                let text = example(name, preset);
                let expected = AnyModel::try_from(preset.parameters(name)).unwrap();
                assert_eq!(read(&text, None), Ok(expected), "{text}");
                // The bare parameters, for those who know which model.
                let bare = text
                    .lines()
                    .filter(|line| line.starts_with("  "))
                    .collect::<Vec<_>>()
                    .join("\n");
                assert_eq!(read(&bare, Some(name)), Ok(expected), "{bare}");
            }
        }
    }

    #[test]
    fn an_example_explains_itself() {
        let text = example(ModelName::LuGre, Preset::TestBed);
        let line =
            |start: &str| text.lines().find(|line| line.trim_start().starts_with(start)).unwrap();
        assert_eq!(
            line("f_s:").trim_start(),
            "f_s: 0.0994     # Static friction F_s [N m; > 0, at least f_c]"
        );
        assert!(line("# v_d:").contains("left out"), "optional parameters wait in comments");
        assert!(
            example(ModelName::LuGre, Preset::Chapter3)
                .contains("Bristle stiffness sigma_0 [N/m; > 0]")
        );
        let lists = example(ModelName::Gms, Preset::Chapter3);
        assert!(lists.contains("; they sum to 1 [> 0]\n  alpha: [0.0955, "), "{lists}");
        let whole = example(ModelName::Bristle, Preset::TestBed);
        assert!(
            whole.contains("  bonds: 100 "),
            "ROS takes whole numbers without a point for integers: {whole}"
        );
    }

    #[test]
    fn both_directions_and_ros_files_are_read() {
        let sides = "forward: {f_c: 0.2}, backward: {f_c: 0.3}";
        let both = read(&format!("asymmetric: {{coulomb: {{{sides}}}}}"), None).unwrap();
        assert_eq!((both.steady_state(1.0), both.steady_state(-1.0)), (0.2, -0.3));
        assert_eq!(read(&format!("{{{sides}}}"), Some(ModelName::Coulomb)), Ok(both));
        let ros = "/friction_observer:\n  ros__parameters:\n    model: viscous\n    coulomb: {f_c: 0.2}\n    viscous: {f_v: 0.1}\n/controller:\n  ros__parameters: {a: 1}\n";
        assert_eq!(read(ros, None).unwrap().name(), ModelName::Viscous);
        assert_eq!(read(ros, Some(ModelName::Coulomb)).unwrap().steady_state(1.0), 0.2);
    }

    #[test]
    fn a_file_with_a_mistake_says_what() {
        let coulomb = Some(ModelName::Coulomb);
        for (text, wanted, said) in [
            ("", None, &["expected parameters under a model's name"][..]),
            ("3", None, &["expected parameters"]),
            ("a: [", None, &["line 1 column 4", "bracket"]),
            ("f_c: 1.0", None, &["names no model", "f_c", "--model"]),
            ("coulomb: {f_c: 1.0, f_x: 2.0}", None, &["coulomb", "f_x", "expected"]),
            ("f_c: 1.0\nf_x: 2.0", coulomb, &["coulomb", "f_x"]),
            ("coulomb: {f_c: -1.0}", None, &["coulomb.f_c", "above zero", "-1"]),
            ("coulomb: {}", None, &["coulomb", "missing", "f_c"]),
            ("coulomb: 5", None, &["coulomb", "5"]),
            ("coulomb: {f_c: .nan}", None, &["line 1", "non-finite"]),
            ("coulomb: {f_c: 1.0}\nextra: {}", None, &["`extra` is no model", "lugre"]),
            ("coulomb: {f_c: 1.0}\nviscous: {f_v: 1.0}", None, &["coulomb, viscous", "--model"]),
            ("viscous: {f_v: 1.0}", coulomb, &["no parameters of `coulomb`", "viscous"]),
            ("model: lugri", None, &["lugri"]),
            ("asymmetric: 3", None, &["asymmetric"]),
            ("asymmetric: {lugri: 3}", None, &["lugri"]),
            (
                "coulomb: {f_c: 1.0}\nasymmetric: {coulomb: {forward: {f_c: 1.0}, backward: {f_c: 1.0}}}",
                None,
                &["more than once"],
            ),
            ("/controller: {ros__parameters: {a: 1}}", None, &["friction_observer"]),
        ] {
            let message = read(text, wanted).unwrap_err().to_string();
            assert_eq!(message.lines().count(), 1, "{message}");
            for part in said {
                assert!(message.contains(part), "{text:?} gave {message:?} without {part:?}");
            }
        }
    }
}
