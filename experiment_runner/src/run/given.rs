//! Parameter files that are given: what several of them say together, and which says what.

use std::collections::BTreeMap;

use controller::ControllerOptions;
use friction_model::{AnyModel, ModelName};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::origin::{Origin, Origins};
use super::parameter_file::described;
use super::{Compensators, ControllerParameters};
use files::commented_yaml;

/// What parameter files say together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Given {
    /// The models; what no file names keeps the test bed's parameters.
    pub compensators: Compensators,
    /// The controller, as far as a file speaks of it.
    pub controller: ControllerParameters,
    /// Where each value comes from that is no default.
    pub origins: Origins,
    /// The controller as it is after the files so far, defaults included.
    tree: Map<String, Value>,
}

impl Given {
    /// Takes a file in: of a value that several files have the last counts. `name` is the file as
    /// it was named.
    ///
    /// # Errors
    /// A sentence about what is wrong in the text.
    pub fn take(&mut self, name: &str, text: &str) -> Result<(), String> {
        let tree = tree(text)?;
        let observer = node(&tree, "friction_observer").or_else(|| node(&tree, "**"));
        let controller = node(&tree, "controller");
        if observer.is_none() && controller.is_none() && node(&tree, "rig_driver").is_some() {
            return Err(
                "it speaks of the drive alone (`rig_driver`); the option --drive of `run` takes it"
                    .to_owned(),
            );
        }
        if observer.is_none() && controller.is_none() {
            return Err("there is no node `friction_observer` in it, and no `controller`; expected `/friction_observer: ros__parameters: ...`".to_owned());
        }
        let from = Origin::File { file: name.to_owned() };
        observer.map_or(Ok(()), |node| self.take_models(node, &from))?;
        controller.map_or(Ok(()), |node| self.take_controller(node, &from))
    }

    fn take_models(&mut self, node: &Value, from: &Origin) -> Result<(), String> {
        let entries = node
            .as_object()
            .ok_or("`ros__parameters` of friction_observer must be a map of parameters")?;
        for (key, value) in entries {
            if key == "model" {
                let name = value.as_str().ok_or("`model` must be the name of a model")?;
                name.parse::<ModelName>().map_err(|e| e.to_string())?;
            } else if key == "asymmetric" {
                let both = value.as_object().ok_or("`asymmetric` must be a map of models")?;
                for (name, sides) in both {
                    let name: ModelName =
                        name.parse().map_err(|e: friction_model::ModelError| e.to_string())?;
                    self.take_sides(name, sides, from)?;
                }
            } else {
                let name: ModelName =
                    key.parse().map_err(|e: friction_model::ModelError| e.to_string())?;
                self.take_model(name, value, from)?;
            }
        }
        Ok(())
    }

    /// One parameter set for both directions.
    fn take_model(&mut self, name: ModelName, value: &Value, from: &Origin) -> Result<(), String> {
        let mut before = described(&self.compensators.get(name)).map_err(|e| e.to_string())?;
        if before.get("asymmetric").is_some() {
            // What one direction had is no start for both.
            before = described(&AnyModel::test_bed(name)).map_err(|e| e.to_string())?;
        }
        let base = before.get_mut(name.as_str()).map(Value::take).unwrap_or_default();
        let path = format!("friction_observer.{name}");
        self.origins.clear(&format!("friction_observer.asymmetric.{name}"));
        self.set_model(name.as_str(), &base, value, |merged| json!({ name.as_str(): merged }))?;
        self.came_from(&path, value, from);
        Ok(())
    }

    /// A parameter set for each direction.
    fn take_sides(&mut self, name: ModelName, sides: &Value, from: &Origin) -> Result<(), String> {
        let before = described(&self.compensators.get(name)).map_err(|e| e.to_string())?;
        let both = before.get("asymmetric").and_then(|models| models.get(name.as_str()));
        let base = match (both, before.get(name.as_str())) {
            (Some(sides), _) => sides.clone(),
            (None, Some(one)) => json!({ "forward": one, "backward": one }),
            (None, None) => Value::Null,
        };
        let path = format!("friction_observer.asymmetric.{name}");
        if both.is_none() {
            let symmetric = format!("friction_observer.{name}");
            for side in ["forward", "backward"] {
                let own = commented_yaml::leaves(base[side].as_object().unwrap_or(&Map::new()))
                    .into_iter()
                    .map(|(leaf, _)| {
                        (
                            format!("{path}.{side}.{leaf}"),
                            self.origins.of(&format!("{symmetric}.{leaf}")),
                        )
                    })
                    .collect::<Vec<_>>();
                own.into_iter().for_each(|(leaf, origin)| self.origins.set(leaf, origin));
            }
            self.origins.clear(&symmetric);
        }
        let wrapped = |merged| json!({ "asymmetric": { name.as_str(): merged } });
        self.set_model("asymmetric", &base, sides, wrapped)?;
        self.came_from(&path, sides, from);
        Ok(())
    }

    /// Takes a model in whose parameters are those of `base` but for what `value` says; where these
    /// do not go together, those of `value` alone.
    fn set_model(
        &mut self,
        key: &str,
        base: &Value,
        value: &Value,
        wrapped: impl Fn(Value) -> Value,
    ) -> Result<(), String> {
        let read = |tree: Value| {
            serde_json::from_value::<AnyModel>(wrapped(tree))
                .map_err(|e| format!("in `{key}`: {e}"))
        };
        let alone = read(value.clone());
        let model = match (read(merged(base, value)), alone) {
            (Ok(model), _) | (Err(_), Ok(model)) => model,
            (Err(error), Err(_)) => return Err(error),
        };
        self.compensators.set(model);
        Ok(())
    }

    fn take_controller(&mut self, node: &Value, from: &Origin) -> Result<(), String> {
        let entries = node
            .as_object()
            .ok_or("`ros__parameters` of controller must be a map of parameters")?;
        if entries.contains_key("lag") && entries.contains_key("pi") {
            return Err(
                "in `controller`: both `lag` and `pi` are given; velocity has one law, leave one out"
                    .to_owned(),
            );
        }
        if self.tree.is_empty()
            && let Ok(Value::Object(defaults)) =
                serde_json::to_value(ControllerParameters::of(&ControllerOptions::default()))
        {
            self.tree = defaults;
        }
        for (key, value) in entries {
            for (law, other) in [("lag", "pi"), ("pi", "lag")] {
                if key == law {
                    self.tree.remove(other);
                    self.origins.clear(&format!("controller.{other}"));
                }
            }
            let gains = ["lag", "pi", "pid"].contains(&key.as_str());
            let before = self.tree.get(key).cloned().unwrap_or_default();
            let path = format!("controller.{key}");
            if gains {
                self.tree.insert(key.clone(), merged(&before, value));
                self.came_from(&path, value, from);
            } else {
                self.tree.insert(key.clone(), value.clone());
                self.origins.clear(&path);
                self.origins.set(path, from.clone());
            }
        }
        self.controller = ControllerParameters::read(&Value::Object(self.tree.clone()))?;
        Ok(())
    }

    /// Notes that every value of `value`, which stands at `path`, comes from there.
    fn came_from(&mut self, path: &str, value: &Value, from: &Origin) {
        let Some(map) = value.as_object() else { return };
        for (leaf, _) in commented_yaml::leaves(map) {
            self.origins.set(format!("{path}.{leaf}"), from.clone());
        }
    }
}

/// `base` with the values of `over` in place of its own, map by map.
fn merged(base: &Value, over: &Value) -> Value {
    match (base, over) {
        (Value::Object(base), Value::Object(over)) => {
            let mut both = base.clone();
            for (key, value) in over {
                let before = both.get(key).cloned().unwrap_or_default();
                both.insert(key.clone(), merged(&before, value));
            }
            Value::Object(both)
        }
        _ => over.clone(),
    }
}

/// Parameters of each node of a file.
type Tree = BTreeMap<String, Node>;

#[derive(Debug, Deserialize)]
struct Node {
    #[serde(rename = "ros__parameters")]
    parameters: Value,
}

fn tree(text: &str) -> Result<Tree, String> {
    serde_saphyr::from_str(text)
        .map_err(|e| format!("{e}\n(expected `/NODE:` and under it `ros__parameters:`)"))
}

fn node<'a>(tree: &'a Tree, name: &str) -> Option<&'a Value> {
    tree.iter()
        .find(|(found, _)| found.trim_start_matches('/') == name)
        .map(|(_, node)| &node.parameters)
}

/// Reads the controller of a parameter file; none if the file says nothing of it.
///
/// # Errors
/// A sentence about what is wrong in the text.
pub fn read_controller(text: &str) -> Result<Option<ControllerParameters>, String> {
    let tree = tree(text)?;
    node(&tree, "controller").map(ControllerParameters::read).transpose()
}

/// Reads the models of a parameter file; those it does not name keep the test bed's parameters, all
/// of them if the file is of the controller alone.
///
/// # Errors
/// A sentence about what is wrong in the text.
pub fn read(text: &str) -> Result<Compensators, String> {
    let mut given = Given::default();
    given.take("the file", text)?;
    Ok(given.compensators)
}

#[cfg(test)]
mod tests {
    use friction_ident::StribeckValues;

    use super::super::parameter_file::render;
    use super::*;
    use crate::run::options::tests::options;

    #[test]
    fn a_file_with_a_mistake_says_where() {
        for (text, said) in [
            ("a: 1", "ros__parameters"),
            ("/rig_driver:\n  ros__parameters:\n    x: 1.0\n", "--drive"),
            ("/plotter:\n  ros__parameters:\n    x: 1.0\n", "friction_observer"),
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

    /// The files that the commands write, each of which changes something.
    fn files() -> [(&'static str, String); 3] {
        let found = StribeckValues { f_s: 0.2, f_c: 0.1, v_s: 0.3, f_v: 0.05, delta: 2.0 };
        let models = Compensators::default().with_static(&found).unwrap();
        let run =
            render(&options(), &models, ModelName::Proposed, None, "runs/all-1").unwrap().text;
        let design = "/controller:\n  ros__parameters:\n    pi:\n      k_p: 2.0\n      k_i: 30.0\n"
            .to_owned();
        let identify = "/friction_observer:\n  ros__parameters:\n    model: lugre\n    lugre:\n      f_s: 0.3\n      f_c: 0.15\n";
        [("run", run), ("design", design), ("identify", identify.to_owned())]
    }

    #[test]
    fn files_of_run_design_and_identify_go_together_in_any_order() {
        let files = files();
        for (i, (first, earlier)) in files.iter().enumerate() {
            for (second, later) in files.iter().skip(i + 1).chain(&files[..i]) {
                let mut given = Given::default();
                given.take(first, earlier).unwrap();
                given.take(second, later).unwrap();
                let wins =
                    |name: &str, over: &str| *second == name || (*first == name && *second != over);
                let all = [*first, *second];
                let mut options = ControllerOptions::default();
                given.controller.apply(&mut options);
                let pi = matches!(options.velocity, controller::VelocityLaw::Pi(gains) if gains.k_i == 30.0);
                assert_eq!(pi, all.contains(&"design") && wins("design", "run"), "{all:?}");
                let lugre = given.compensators.get(ModelName::LuGre);
                let level = match all {
                    _ if all.contains(&"identify") && wins("identify", "run") => 0.3,
                    _ if all.contains(&"run") => 0.2,
                    _ => AnyModel::test_bed(ModelName::LuGre).parameter("f_s").unwrap(),
                };
                assert_eq!(lugre.parameter("f_s"), Some(level), "{all:?}");
                // What the later file does not name stays.
                if all.contains(&"run") {
                    assert_eq!(lugre.parameter("f_v"), Some(0.05), "{all:?}");
                    assert_eq!(
                        given.compensators.get(ModelName::Proposed).parameter("f_s"),
                        Some(0.2)
                    );
                }
                // Each origin names the file whose value it is.
                for (path, origin) in given.origins.iter() {
                    let Origin::File { file } = origin else { panic!("{path}: {origin:?}") };
                    assert!(all.contains(&file.as_str()), "{path}: {file}");
                }
                let of = |path: &str| given.origins.of(path).to_string();
                if level == 0.3 {
                    assert_eq!(of("friction_observer.lugre.f_s"), "from identify");
                }
                if pi {
                    assert_eq!(of("controller.pi.k_i"), "from design");
                    assert_eq!(given.origins.of("controller.lag.k_p"), Origin::Default);
                }
            }
        }
    }

    #[test]
    fn of_one_value_the_last_file_counts_and_the_others_stay() {
        let file = |body: &str| format!("/controller:\n  ros__parameters:\n{body}");
        let mut given = Given::default();
        given.take("a", &file("    pid: {k_p: 6.0, k_i: 11.0, k_d: 0.1}\n")).unwrap();
        given.take("b", &file("    pid: {k_i: 12.0}\n    compensation_scale: 0.5\n")).unwrap();
        let pid = given.controller.pid.unwrap();
        assert_eq!((pid.k_p, pid.k_i, pid.k_d), (6.0, 12.0, 0.1));
        assert_eq!(given.origins.of("controller.pid.k_p").to_string(), "from a");
        assert_eq!(given.origins.of("controller.pid.k_i").to_string(), "from b");
        let message = given.take("c", &file("    pid: {k_i: -1.0}\n")).unwrap_err();
        assert!(message.contains("k_i"), "{message}");
    }

    #[test]
    fn a_model_for_each_direction_and_one_for_both_replace_one_another() {
        let file = |body: &str| format!("/friction_observer:\n  ros__parameters:\n{body}");
        let sides = file(
            "    asymmetric:\n      lugre:\n        forward: {f_v: 0.01}\n        backward: {f_v: 0.02}\n",
        );
        let both = file("    lugre: {f_v: 0.03}\n");
        let mut given = Given::default();
        given.take("both", &both).unwrap();
        given.take("sides", &sides).unwrap();
        let described = described(&given.compensators.get(ModelName::LuGre)).unwrap();
        assert_eq!(described["asymmetric"]["lugre"]["backward"]["f_v"], 0.02);
        given.take("both", &both).unwrap();
        assert_eq!(given.compensators.get(ModelName::LuGre).parameter("f_v"), Some(0.03));
        assert_eq!(given.origins.iter().count(), 1, "{:?}", given.origins);
    }
}
