//! Models and observers, from names and values, and from parameter files.

use std::ffi::CStr;

use friction_model::{AnyModel, AnyParameters, ModelName, Parameter, Scheme, TimeStep};
use friction_observer::parameters::{ObserverSettings, declarations};
use friction_observer::{EstimatorOptions, FrictionEstimator, Technique, VelocitySource};
use parameters::{Values, file, nearest};
use serde_json::{Map, Value, json};

use crate::catalogue::{self, Form, form};
use crate::code::{Failure, FrictionCode};

/// The node that parameter files are for.
pub const NODE: &str = "/friction_observer";

/// An observer, and what it was made of.
#[derive(Debug)]
pub struct Observer {
    /// What runs.
    pub estimator: FrictionEstimator,
    /// Its model.
    pub model: AnyModel,
    /// Its period.
    pub dt: TimeStep,
    /// Its model's name.
    pub name: &'static CStr,
}

impl Observer {
    /// An observer at rest.
    ///
    /// # Errors
    /// [`FrictionCode::BadParameter`] with the option that is out of range.
    pub fn new(model: AnyModel, options: EstimatorOptions, dt: TimeStep) -> Result<Self, Failure> {
        let estimator = FrictionEstimator::new(&model, options, dt)
            .map_err(|wrong| Failure::new(FrictionCode::BadParameter, wrong))?;
        Ok(Self { estimator, model, dt, name: catalogue::name(model.name()) })
    }

    /// An observer that follows the measured velocity with `model`.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn following(model: AnyModel, scheme: Scheme, dt: TimeStep) -> Result<Self, Failure> {
        Self::new(model, EstimatorOptions { scheme, ..EstimatorOptions::default() }, dt)
    }

    /// The observer that a parameter file describes for `node`, called once every `period` \[s\],
    /// or as the file says where that is zero.
    ///
    /// # Errors
    /// [`FrictionCode::BadFile`], [`FrictionCode::BadParameter`], [`FrictionCode::BadPeriod`].
    pub fn from_file(text: &str, node: &str, period: f64) -> Result<Self, Failure> {
        let refused = |code| move |wrong: &dyn ToString| Failure::new(code, wrong.to_string());
        let file = file::Parameters::parse(text)
            .map_err(|wrong| refused(FrictionCode::BadFile)(&wrong))?;
        let names: Vec<String> = file.of_node(node).into_keys().collect();
        if names.is_empty() {
            return Err(Failure::new(FrictionCode::BadFile, nobody(&file, node)));
        }
        let bad = refused(FrictionCode::BadParameter);
        let declared = declarations(&names);
        let given = file.taken_by(node, &declared).map_err(|wrong| bad(&wrong))?;
        let values = Values::given(&declared, &given).map_err(|wrong| bad(&wrong))?;
        let said = ObserverSettings::read(&values).map_err(|wrong| bad(&wrong))?;
        let dt = if period == 0.0 { said.dt } else { time_step(period)? };
        Self::new(said.model, said.options, dt)
    }

    /// Whether what it does depends on the voltage that was applied.
    pub fn needs_voltage(&self) -> bool {
        let options = self.estimator.options();
        let velocity = matches!(
            options.velocity,
            VelocitySource::EncoderKalman { .. } | VelocitySource::Fused { .. }
        );
        velocity
            || match options.technique {
                Technique::Feedback
                | Technique::Feedforward
                | Technique::Both { .. }
                | Technique::SuperTwisting(_)
                | Technique::Fuzzy(_) => false,
                Technique::Adaptive(_)
                | Technique::AdaptiveParameters(_)
                | Technique::AdaptiveStiffness(_)
                | Technique::DisturbanceObserver(_)
                | Technique::Rbf(_) => true,
            }
    }

    /// Whether what it does depends on the reference's velocity, or on the error.
    pub fn needs_reference(&self) -> bool {
        let options = self.estimator.options();
        options.injection != 0.0
            || match options.technique {
                Technique::Feedback => false,
                Technique::DisturbanceObserver(_) => options.ahead > 0.0,
                Technique::Adaptive(level) => level.share > 0.0,
                Technique::AdaptiveParameters(parameters) => parameters.share > 0.0,
                Technique::AdaptiveStiffness(_) => false,
                Technique::Feedforward
                | Technique::Both { .. }
                | Technique::Rbf(_)
                | Technique::SuperTwisting(_)
                | Technique::Fuzzy(_) => true,
            }
    }
}

fn nobody(file: &file::Parameters, node: &str) -> String {
    let known: Vec<&str> = file.nodes().iter().map(|given| given.pattern.as_str()).collect();
    let has = if known.is_empty() { "no node".to_owned() } else { known.join(", ") };
    format!(
        "the file says nothing of the node {node}; it has {has}; expected the parameters.yaml of an identification"
    )
}

/// A period.
///
/// # Errors
/// [`FrictionCode::NotFinite`], [`FrictionCode::BadPeriod`].
pub fn time_step(period: f64) -> Result<TimeStep, Failure> {
    if !period.is_finite() {
        let said = format!("the period must be a finite number, but is {period}");
        return Err(Failure::new(FrictionCode::NotFinite, said));
    }
    TimeStep::new(period).map_err(|wrong| Failure::new(FrictionCode::BadPeriod, wrong))
}

/// The model of that name with those values. Values of one name make a list; `forward.` and
/// `backward.` before a name give one direction its own.
///
/// # Errors
/// [`FrictionCode::UnknownModel`], [`FrictionCode::BadParameter`], [`FrictionCode::NotFinite`].
pub fn model(name: &str, values: &[(&str, f64)]) -> Result<AnyModel, Failure> {
    let name: ModelName =
        name.parse().map_err(|wrong| Failure::new(FrictionCode::UnknownModel, wrong))?;
    let mut sides = [Side::default(), Side::default()];
    let mut two = false;
    for (given, value) in values {
        let (of, row): (&[usize], _) = match given.split_once('.') {
            Some(("forward", row)) => (&[0], row),
            Some(("backward", row)) => (&[1], row),
            _ => (&[0, 1], *given),
        };
        two |= of.len() == 1;
        for side in of {
            sides[*side].take(name, row, *value)?;
        }
    }
    let [forward, backward] = sides;
    let forward = forward.whole(name)?;
    let of = name.as_str();
    let written = if two {
        let backward = backward.whole(name)?;
        json!({ "asymmetric": { of: { "forward": forward, "backward": backward } } })
    } else {
        json!({ of: forward })
    };
    serde_json::from_value(written).map_err(|wrong| Failure::new(FrictionCode::BadParameter, wrong))
}

/// The values of one direction.
#[derive(Default)]
struct Side(Map<String, Value>);

impl Side {
    fn take(&mut self, model: ModelName, name: &str, value: f64) -> Result<(), Failure> {
        let usual = AnyParameters::test_bed(model);
        let Some(row) = usual.table().iter().find(|row| row.name == name) else {
            return Err(Failure::new(FrictionCode::BadParameter, unknown(&usual, name)));
        };
        if !value.is_finite() {
            let said = format!("{model}.{name} must be {}, but is {value}", row.range);
            return Err(Failure::new(FrictionCode::NotFinite, said));
        }
        let form = form(&usual, name);
        let number = match form {
            Form::Whole if value.fract() != 0.0 || value.abs() > 1e9 => {
                let said = format!("{model}.{name} must be a whole number, but is {value}");
                return Err(Failure::new(FrictionCode::BadParameter, said));
            }
            Form::Whole => json!(value as i64),
            Form::Number | Form::List => json!(value),
        };
        match (form, self.0.get_mut(name)) {
            (Form::List, Some(Value::Array(list))) => list.push(number),
            (Form::List, _) => _ = self.0.insert(name.to_owned(), json!([number])),
            (_, None) => _ = self.0.insert(name.to_owned(), number),
            (_, Some(_)) => {
                let said = format!("{model}.{name} is given twice, but is no list");
                return Err(Failure::new(FrictionCode::BadParameter, said));
            }
        }
        Ok(())
    }

    /// All of them, none missing.
    fn whole(self, model: ModelName) -> Result<Map<String, Value>, Failure> {
        let missing = |row: &&Parameter| !row.optional && !self.0.contains_key(row.name);
        let usual = AnyParameters::test_bed(model);
        match usual.table().iter().find(missing) {
            None => Ok(self.0),
            Some(row) => Err(Failure::new(
                FrictionCode::BadParameter,
                format!("{model}.{} is missing: {}", row.name, row.meaning),
            )),
        }
    }
}

fn unknown(model: &AnyParameters, name: &str) -> String {
    let names: Vec<&str> = model.table().iter().map(|row| row.name).collect();
    let meant = nearest(name, names.iter().copied())
        .map_or_else(String::new, |near| format!(" Did you mean {near}?"));
    format!(
        "{} has no parameter {name:?}; expected some of: {}.{meant}",
        model.name(),
        names.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const LUGRE: [(&str, f64); 7] = [
        ("f_s", 0.1),
        ("f_c", 0.09),
        ("v_s", 0.14),
        ("delta", 2.0),
        ("sigma0", 16.5),
        ("sigma1", 0.25),
        ("f_v", 0.04),
    ];

    #[test]
    fn what_is_wrong_is_named() {
        let with = |more: &[(&'static str, f64)]| model("lugre", &[&LUGRE[..], more].concat());
        assert_eq!(with(&[]).unwrap().name(), ModelName::LuGre);
        for (given, code, words) in [
            (with(&[("f_z", 1.0)]), FrictionCode::BadParameter, "expected some of: f_s"),
            (with(&[("f_s", 1.0)]), FrictionCode::BadParameter, "given twice"),
            (with(&[("v_d", f64::NAN)]), FrictionCode::NotFinite, "NaN"),
            (with(&[("v_d", -1.0)]), FrictionCode::BadParameter, "v_d must be"),
            (model("lugre", &LUGRE[1..]), FrictionCode::BadParameter, "f_s is missing"),
            (model("lugree", &[]), FrictionCode::UnknownModel, "lugree"),
        ] {
            let failure = given.unwrap_err();
            assert_eq!(failure.code, code, "{failure}");
            assert!(failure.message.contains(words), "{failure}");
        }
    }

    #[test]
    fn each_direction_can_have_its_own() {
        let rest = LUGRE.iter().filter(|(name, _)| *name != "f_c").copied();
        let both: Vec<_> = rest.chain([("forward.f_c", 0.05), ("backward.f_c", 0.08)]).collect();
        let model = model("lugre", &both).unwrap();
        assert!((model.steady_state(2.0) - (0.05 + 0.08)).abs() < 1e-9);
        assert!((model.steady_state(-2.0) + (0.08 + 0.08)).abs() < 1e-9);
    }

    #[test]
    fn a_file_is_read_as_the_node_reads_it() {
        let text = |more: &str| {
            format!("/**/friction_observer:\n  ros__parameters:\n    model: lugre\n{more}")
        };
        let observer = Observer::from_file(&text("    period: 0.002\n"), NODE, 0.0).unwrap();
        assert_eq!(observer.model, AnyModel::test_bed(ModelName::LuGre));
        assert_eq!(observer.dt.seconds(), 0.002);
        assert_eq!(Observer::from_file(&text(""), NODE, 5e-4).unwrap().dt.seconds(), 5e-4);
        for (given, code, words) in [
            (
                "controller: {ros__parameters: {a: 1}}".to_owned(),
                FrictionCode::BadFile,
                "/controller",
            ),
            (String::new(), FrictionCode::BadFile, ""),
            ("a: [".to_owned(), FrictionCode::BadFile, ""),
            (text("    lugre: {f_c: -1.0}\n"), FrictionCode::BadParameter, "f_c"),
            (text("    techniqe: feedback\n"), FrictionCode::BadParameter, "technique"),
        ] {
            let failure = Observer::from_file(&given, NODE, 0.0).unwrap_err();
            assert_eq!(failure.code, code, "{failure}");
            assert!(failure.message.contains(words), "{failure}");
        }
        let needs = |technique: &str| {
            let text = text(&format!("    technique: {technique}\n"));
            let observer = Observer::from_file(&text, NODE, 0.0).unwrap();
            (observer.needs_voltage(), observer.needs_reference())
        };
        assert_eq!(needs("feedback"), (false, false));
        assert_eq!(needs("feedforward"), (false, true));
        assert_eq!(needs("disturbance_observer"), (true, false));
        let failure = Observer::from_file(&text(""), NODE, 0.5).unwrap_err();
        assert_eq!(failure.code, FrictionCode::BadPeriod);
    }
}
