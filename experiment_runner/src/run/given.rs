//! Parameter files that are given: what several of them say together, and which says what.

use std::collections::{BTreeMap, BTreeSet};

use controller::{ControllerOptions, ControllerParameters, VelocityLawName};
use files::ros_parameters::tree;
use friction_model::{AnyModel, ModelName};
use friction_observer::parameters::declarations as observer_declarations;
use parameters::file::Parameters;
use parameters::{Declaration, Declared, ParameterError, ParameterValue, Values};
use serde_json::{Value, json};

use super::Compensators;
use super::origin::{Origin, Origins};

/// What parameter files say together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Given {
    /// The models; what no file names keeps the test bed's parameters.
    pub compensators: Compensators,
    /// Where each value comes from that is no default.
    pub origins: Origins,
    /// Parameters that were given another value than the usual one and do not count: every
    /// experiment sets them itself. With their nodes, as in `controller.mode`.
    pub set_aside: BTreeSet<String>,
    /// The controller's parameters, as far as a file speaks of them.
    controller: ByName,
    /// The observer's own, those of its models left out.
    observer: ByName,
}

/// Values by the names of their parameters.
type ByName = BTreeMap<String, ParameterValue>;

impl Given {
    /// Parameters of the controller that every experiment, or the rig, sets itself.
    pub(super) const SET_BY_THE_RUN: [&str; 10] = [
        "mode",
        "compensation",
        "volts_per_newton_metre",
        "voltage_limit",
        "period",
        "autostart",
        "reference_timeout",
        "reference_deceleration",
        "estimate_timeout",
        "estimate_wait",
    ];

    /// Takes a file in: of a value that several files have the last counts. `name` is the file as
    /// it was named.
    ///
    /// # Errors
    /// A sentence about what is wrong in the text.
    pub fn take(&mut self, name: &str, text: &str) -> Result<(), GivenError> {
        let file = Parameters::parse(text).map_err(|error| GivenError(error.to_string()))?;
        let given: Vec<String> = file.of_node("/friction_observer").into_keys().collect();
        let observer = of_node(&file, "friction_observer", &observer_declarations(&given))?;
        let declared = ControllerParameters::default().declarations();
        let controller = of_node(&file, "controller", &declared)?;
        if observer.is_empty() && controller.is_empty() {
            return Err(GivenError::nothing(&file));
        }
        let from = Origin::File { file: name.to_owned() };
        self.take_observer(&observer, &from)?;
        self.take_controller(controller, &from)
    }

    /// `base` with what the files say of the controller, but for what every experiment sets itself.
    ///
    /// # Errors
    /// [`ParameterError`] if the values do not go together.
    pub fn controller(
        &self,
        base: &ControllerOptions,
    ) -> Result<ControllerOptions, ParameterError> {
        let mut said = ControllerParameters::of(base);
        for (law, group) in [(VelocityLawName::Lag, "lag."), (VelocityLawName::Pi, "pi.")] {
            if self.controller.keys().any(|name| name.starts_with(group)) {
                said.velocity_law = law;
            }
        }
        let mut values = Values::default();
        for (name, value) in &self.controller {
            if !Self::SET_BY_THE_RUN.contains(&name.as_str()) {
                values.set(name.clone(), value.clone());
            }
        }
        let said = said.with(&values);
        let guard = said.guard.then(|| base.guard.unwrap_or_default());
        Ok(ControllerOptions { guard, ..said.options()? })
    }

    /// What the files say of the node `controller`, also what every experiment sets itself: for whoever
    /// runs the nodes.
    #[must_use]
    pub const fn of_controller(&self) -> &BTreeMap<String, ParameterValue> {
        &self.controller
    }

    /// What they say of the node `friction_observer`, but for the parameters of its models.
    #[must_use]
    pub const fn of_observer(&self) -> &BTreeMap<String, ParameterValue> {
        &self.observer
    }

    /// What the files say that does not count, in a sentence; none if everything does.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        let aside: Vec<&str> = self.set_aside.iter().map(String::as_str).collect();
        (!aside.is_empty()).then(|| {
            format!(
                "the parameter files also set {}; an experiment sets these itself, so they do not count",
                aside.join(", ")
            )
        })
    }

    fn take_observer(&mut self, given: &ByName, from: &Origin) -> Result<(), GivenError> {
        let usual = Values::defaults(&observer_declarations(&[]));
        let mut models = ByName::new();
        for (name, value) in given {
            let group = name.split_once('.').map(|(group, _)| group);
            if group
                .is_some_and(|group| group == "asymmetric" || group.parse::<ModelName>().is_ok())
            {
                models.insert(name.clone(), value.clone());
                continue;
            }
            self.observer.insert(name.clone(), value.clone());
            if name != "model" && usual.get(name) != Some(value) {
                self.set_aside.insert(format!("friction_observer.{name}"));
            }
        }
        let mut models = tree(&models);
        // As in the node, a parameter set for each direction counts above one for both.
        let sides = models.remove("asymmetric");
        let named =
            |name: &str| name.parse::<ModelName>().map_err(|error| GivenError(error.to_string()));
        for (name, value) in &models {
            self.take_model(named(name)?, value, from)?;
        }
        for (name, value) in sides.as_ref().and_then(Value::as_object).into_iter().flatten() {
            self.take_sides(named(name)?, value, from)?;
        }
        Ok(())
    }

    /// One parameter set for both directions.
    fn take_model(
        &mut self,
        name: ModelName,
        value: &Value,
        from: &Origin,
    ) -> Result<(), GivenError> {
        let mut before = described(&self.compensators.get(name));
        if before.get("asymmetric").is_some() {
            // What one direction had is no start for both.
            before = described(&AnyModel::test_bed(name));
        }
        let base = before.get_mut(name.as_str()).map(Value::take).unwrap_or_default();
        let path = format!("friction_observer.{name}");
        self.origins.clear(&format!("friction_observer.asymmetric.{name}"));
        self.set_model(name.as_str(), &base, value, |merged| json!({ name.as_str(): merged }))?;
        self.came_from(&path, value, from);
        Ok(())
    }

    /// A parameter set for each direction.
    fn take_sides(
        &mut self,
        name: ModelName,
        sides: &Value,
        from: &Origin,
    ) -> Result<(), GivenError> {
        let before = described(&self.compensators.get(name));
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
                for leaf in leaves(&base[side]) {
                    let origin = self.origins.of(&format!("{symmetric}.{leaf}"));
                    self.origins.set(format!("{path}.{side}.{leaf}"), origin);
                }
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
    ) -> Result<(), GivenError> {
        let read = |tree: Value| {
            serde_json::from_value::<AnyModel>(wrapped(tree))
                .map_err(|e| GivenError(format!("in `{key}`: {e}")))
        };
        let alone = read(value.clone());
        let model = match (read(merged(base, value)), alone) {
            (Ok(model), _) | (Err(_), Ok(model)) => model,
            (Err(error), Err(_)) => return Err(error),
        };
        self.compensators.set(model);
        Ok(())
    }

    fn take_controller(&mut self, given: ByName, from: &Origin) -> Result<(), GivenError> {
        let has = |group: &str| given.keys().any(|name| name.starts_with(group));
        if has("lag.") && has("pi.") && !given.contains_key("velocity_law") {
            return Err(GivenError(
                "in `controller`: both `lag` and `pi` are given; velocity has one law, leave one out or choose by velocity_law"
                    .to_owned(),
            ));
        }
        for (law, other) in [("lag", "pi"), ("pi", "lag")] {
            if has(&format!("{law}.")) && !has(&format!("{other}.")) {
                let another =
                    |name: &str| name == "velocity_law" || name.starts_with(&format!("{other}."));
                self.controller.retain(|name, _| !another(name));
                self.origins.clear(&format!("controller.{other}"));
                self.origins.clear("controller.velocity_law");
            }
        }
        let usual = ControllerParameters::default().values();
        for (name, value) in given {
            let read_out = ["voltage_limit", "volts_per_newton_metre"].contains(&name.as_str());
            if Self::SET_BY_THE_RUN.contains(&name.as_str()) {
                if !read_out && usual.get(&name) != Some(&value) {
                    self.set_aside.insert(format!("controller.{name}"));
                }
            } else {
                self.origins.set(format!("controller.{name}"), from.clone());
            }
            self.controller.insert(name, value);
        }
        self.controller(&ControllerOptions::default())
            .map(drop)
            .map_err(|error| GivenError(format!("in `controller`: {error}")))
    }

    /// Notes that every value of `value`, which stands at `path`, comes from there.
    fn came_from(&mut self, path: &str, value: &Value, from: &Origin) {
        for leaf in leaves(value) {
            self.origins.set(format!("{path}.{leaf}"), from.clone());
        }
    }
}

/// What is wrong in a parameter file, in a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct GivenError(String);

impl GivenError {
    /// The file says nothing of the nodes that are wanted.
    fn nothing(file: &Parameters) -> Self {
        if !file.of_node("/rig_driver").is_empty() {
            return Self(
                "it speaks of the drive alone (`rig_driver`); the option --drive of `run` takes it"
                    .to_owned(),
            );
        }
        let nodes: Vec<&str> = file.nodes().iter().map(|node| node.pattern.as_str()).collect();
        Self(format!(
            "there is no node `friction_observer` in it, and no `controller`, but {}; expected `/friction_observer: ros__parameters: ...`",
            nodes.join(", ")
        ))
    }
}

/// What the file gives the node of that name, each value held to its declaration.
pub(crate) fn of_node(
    file: &Parameters,
    node: &str,
    declared: &[Declaration],
) -> Result<ByName, GivenError> {
    let taken = file.taken_by(&format!("/{node}"), declared);
    taken.map_err(|error| GivenError(format!("in `{node}`: {error}")))
}

fn described(model: &AnyModel) -> Value {
    // Every model that was built can be described.
    serde_json::to_value(model).unwrap_or_default()
}

/// The dotted paths of the values in a tree of maps.
fn leaves(tree: &Value) -> Vec<String> {
    let Some(map) = tree.as_object() else { return Vec::new() };
    let mut found = Vec::new();
    for (key, value) in map {
        match value {
            Value::Object(_) => {
                found.extend(leaves(value).into_iter().map(|leaf| format!("{key}.{leaf}")));
            }
            Value::Null => {}
            _ => found.push(key.clone()),
        }
    }
    found
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

/// Reads the models of a parameter file; those it does not name keep the test bed's parameters, all
/// of them if the file is of the controller alone.
///
/// # Errors
/// [`GivenError`] says what is wrong in the text.
pub fn read(text: &str) -> Result<Compensators, GivenError> {
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
            let message = read(text).unwrap_err().to_string();
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
                let options = given.controller(&ControllerOptions::default()).unwrap();
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
        let options = given.controller(&ControllerOptions::default()).unwrap();
        let pid = options.pid;
        assert_eq!((pid.k_p, pid.k_i, pid.k_d), (6.0, 12.0, 0.1));
        assert_eq!(given.origins.of("controller.pid.k_p").to_string(), "from a");
        assert_eq!(given.origins.of("controller.pid.k_i").to_string(), "from b");
        let message = given.take("c", &file("    pid: {k_i: -1.0}\n")).unwrap_err().to_string();
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
        let described = described(&given.compensators.get(ModelName::LuGre));
        assert_eq!(described["asymmetric"]["lugre"]["backward"]["f_v"], 0.02);
        given.take("both", &both).unwrap();
        assert_eq!(given.compensators.get(ModelName::LuGre).parameter("f_v"), Some(0.03));
        assert_eq!(given.origins.iter().count(), 1, "{:?}", given.origins);
    }

    #[test]
    fn a_file_of_the_controller_speaks_the_nodes_language() {
        let file = |body: &str| format!("/controller:\n  ros__parameters:\n{body}");
        let read = |body: &str| {
            let mut given = Given::default();
            given.take("x", &file(body))?;
            let options = given.controller(&ControllerOptions::default());
            Ok::<_, GivenError>((options.unwrap(), given.set_aside))
        };
        let lag = "    lag: {k_p: 1.0, t_i: 0.1, gamma: 0.1}\n";
        let pi = "    pi: {k_p: 1.0, k_i: 20.0}\n";
        let (options, aside) = read(&format!(
            "{pi}    inverse: gain\n    drive: {{gain: 2.0}}\n    guard: false\n    mode: position\n    voltage_limit: 3.0\n"
        ))
        .unwrap();
        let gains = controller::PiGains { k_p: 1.0, k_i: 20.0 };
        assert_eq!(options.velocity, controller::VelocityLaw::Pi(gains));
        assert!(
            matches!(options.inverse, controller::PlantInverse::Gain(drive) if drive.gain == 2.0)
        );
        assert_eq!((options.guard, options.voltage_limit), (None, 6.0));
        assert_eq!(aside.into_iter().collect::<Vec<_>>(), ["controller.mode"]);
        for (body, said) in [
            (format!("{lag}{pi}"), "one law"),
            ("    pi: {k_p: -1.0, k_i: 1.0}\n".to_owned(), "pi.k_p must be above 0"),
            ("    pi: {k_p: 1, k_i: 1.0}\n".to_owned(), "write 1.0"),
            ("    speed: 1.0\n".to_owned(), "no parameter `speed`"),
            ("    compensaton: true\n".to_owned(), "is `compensation` meant?"),
            ("    pid: {kp: 1.0}\n".to_owned(), "is `pid.k_p` meant?"),
        ] {
            let message = read(&body).unwrap_err().to_string();
            assert!(message.contains(said), "{message}");
        }
    }
}
