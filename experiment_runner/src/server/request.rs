//! Requests as the command line would have them.

use std::path::Path;

use clap::builder::ValueParser;
use clap::{Arg, Args, Command};
use msgs::friction_msgs::{IdentifyRequest, RunExperimentGoal, Setting, StartExperimentRequest};
use rig_driver::safety::SafetyLimits;

use super::Refusal;
use super::permissions::Permissions;
use crate::asked::RunArgs;
use crate::asked::rig::choose;
use crate::errand::Prepared;
use crate::experiments;
use crate::run::RunOptions;
use crate::run::experiment::Selection;
use identification::asked::IdentifyArgs;
use rig_setup::RigChoice;

/// Options of `frictionlab run` that a request has fields for, that are about the terminal, or that
/// are for whoever starts the runner.
pub(super) const NOT_OF_RUN: [&str; 10] = [
    "experiment",
    "model",
    "repetitions",
    "out",
    "force",
    "quiet",
    "json",
    "verbose",
    "jobs",
    "rig-file",
];
/// The same of `frictionlab identify`.
const NOT_OF_IDENTIFY: [&str; 10] =
    ["files", "beside", "model", "validate", "out", "force", "quiet", "json", "verbose", "jobs"];

/// An experiment that was asked for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ExperimentRequest {
    /// Name of the experiment.
    pub experiment: String,
    /// Models that compensate; empty for the usual ones.
    pub models: Vec<String>,
    /// Repetitions; 0 for the protocol's own.
    pub repetitions: u32,
    /// Options by name.
    pub overrides: Vec<Setting>,
    /// Name of the folder for the results, in the folder of runs; none for one that the runner
    /// makes.
    pub folder: Option<String>,
    /// End what runs.
    pub preempt: bool,
}

impl From<RunExperimentGoal> for ExperimentRequest {
    fn from(goal: RunExperimentGoal) -> Self {
        let RunExperimentGoal {
            experiment,
            models,
            repetitions,
            overrides,
            output_folder,
            preempt,
        } = goal;
        let folder = folder(&output_folder);
        Self { experiment, models, repetitions, overrides, folder, preempt }
    }
}

impl From<StartExperimentRequest> for ExperimentRequest {
    fn from(request: StartExperimentRequest) -> Self {
        let StartExperimentRequest {
            experiment,
            models,
            repetitions,
            overrides,
            output_folder,
            preempt,
        } = request;
        let folder = folder(&output_folder);
        Self { experiment, models, repetitions, overrides, folder, preempt }
    }
}

fn folder(text: &str) -> Option<String> {
    (!text.trim().is_empty()).then(|| text.to_owned())
}

impl ExperimentRequest {
    /// What is to be run, on the `usual` rig unless the request names one. No file outside of what
    /// is permitted was read then.
    ///
    /// # Errors
    /// [`Refusal::BadRequest`] names the experiment, model, option, rig or file at fault and what
    /// was expected.
    pub fn options(
        &self,
        usual: &RigChoice,
        permissions: &Permissions,
    ) -> Result<RunOptions, Refusal> {
        let Some(experiment) = experiments::selection(&self.experiment) else {
            let mut known: Vec<_> =
                experiments::selections().iter().map(Selection::as_str).collect();
            known.extend(permissions.errands().0.iter().map(|errand| errand.name()));
            return Err(Refusal::BadRequest(format!(
                "there is no experiment `{}`; expected one of {}",
                self.experiment,
                known.join(", ")
            )));
        };
        let mut line = vec![experiment.as_str().to_owned()];
        if !self.models.is_empty() {
            line.push(format!("--model={}", self.models.join(",")));
        }
        if self.repetitions > 0 {
            line.push(format!("--repetitions={}", self.repetitions));
        }
        if !self.overrides.iter().any(|setting| option(&setting.name) == "rig") {
            line.push(format!("--rig={usual}"));
        }
        line.extend(settings(&run_command(), &NOT_OF_RUN, &self.overrides, permissions)?);
        let mut args: RunArgs = parse(&line)?;
        let rig = permissions.rig(args.rig.clone().unwrap_or_else(|| usual.clone()))?;
        args.rig_file = permissions.profile_of(&rig).map(Path::to_owned);
        raises_no_limit(&rig, args.rig_file.as_deref(), args.voltage_limit)?;
        args.rig = Some(rig);
        crate::asked::options(&args, permissions.besides())
            .map_err(|error| Refusal::BadRequest(format!("{error:#}")))
    }
}

/// Work beside experiments that was asked for.
pub struct Asked {
    /// Its name.
    pub name: &'static str,
    /// What is to be done.
    pub prepared: Box<dyn Prepared>,
}

impl ExperimentRequest {
    /// The work beside experiments that is asked for; none for an experiment.
    ///
    /// # Errors
    /// As for [`options`](Self::options).
    pub fn errand(
        &self,
        usual: &RigChoice,
        permissions: &Permissions,
    ) -> Result<Option<Asked>, Refusal> {
        let Some(errand) = permissions.errands().named(&self.experiment) else { return Ok(None) };
        if !self.models.is_empty() || self.repetitions > 0 {
            return Err(Refusal::BadRequest(format!(
                "{} takes no models and no repetitions: leave both out",
                errand.name()
            )));
        }
        let value = |name: &str| {
            let found = self.overrides.iter().find(|setting| option(&setting.name) == name);
            found.map(|setting| setting.value.trim())
        };
        let named = value("rig").map(str::parse::<RigChoice>).transpose();
        let named = named.map_err(|error| Refusal::BadRequest(error.to_string()))?;
        let rig = permissions.rig(named.unwrap_or_else(|| usual.clone()))?;
        let profile = permissions.profile_of(&rig);
        raises_no_limit(&rig, profile, value("voltage-limit").and_then(|text| text.parse().ok()))?;
        let mut given: Vec<Setting> = self.overrides.clone();
        given.retain(|setting| !["rig", "resume"].contains(&option(&setting.name).as_str()));
        let mut line = settings(&errand.command(), errand.reserved(), &given, permissions)?;
        if let Some(name) = value("resume") {
            line.push(format!("--resume={}", text(&permissions.begun(name)?)?));
        }
        let prepared = errand.prepare(&line, &rig, profile).map_err(Refusal::BadRequest)?;
        Ok(Some(Asked { name: errand.name(), prepared }))
    }
}

/// Refuses what would raise the limits of a real rig: they are those of its profile, or the usual
/// ones.
fn raises_no_limit(
    rig: &RigChoice,
    profile: Option<&Path>,
    asked: Option<f64>,
) -> Result<(), Refusal> {
    let Some(asked) = asked.filter(|_| rig.is_opened()) else { return Ok(()) };
    let chosen =
        choose(Some(rig), profile).map_err(|error| Refusal::BadRequest(error.to_string()))?;
    let limit = chosen.limits(None).voltage.unwrap_or(SafetyLimits::default().voltage);
    if asked <= limit {
        return Ok(());
    }
    Err(Refusal::BadRequest(format!(
        "voltage_limit must be at most {limit} V on this rig, but is {asked}: a request does not raise the limits of a real rig"
    )))
}

/// The options of `frictionlab identify` that a request stands for. The recordings are there, and
/// no file outside of what is permitted was read.
///
/// # Errors
/// [`Refusal::BadRequest`] names the option, file or folder at fault and what was expected.
pub fn identify_args(
    request: &IdentifyRequest,
    permissions: &Permissions,
) -> Result<IdentifyArgs, Refusal> {
    let bag = permissions.recording(&request.bag_path)?;
    let command = IdentifyArgs::augment_args(Command::new("identify"));
    let mut line = settings(&command, &NOT_OF_IDENTIFY, &request.overrides, permissions)?;
    if !request.models.is_empty() {
        line.push(format!("--model={}", request.models.join(",")));
    }
    for name in &request.validation_bags {
        line.push(format!("--validate={}", text(&permissions.recording(name)?)?));
    }
    if let Some(name) = folder(&request.output_folder) {
        let folder = permissions.output(&name)?;
        only_identifications(&folder)?;
        // An earlier identification's, which was named, is replaced.
        line.extend([format!("--out={}", text(&folder)?), "--force".to_owned()]);
    }
    line.extend(["--quiet".to_owned(), "--".to_owned(), text(&bag)?.to_owned()]);
    let mut args: IdentifyArgs = parse(&line)?;
    args.to.runs = Some(permissions.beside(&bag).to_owned());
    Ok(args)
}

/// Refuses a folder that holds something else than an earlier identification: its `parameters.yaml`
/// would be replaced.
fn only_identifications(folder: &Path) -> Result<(), Refusal> {
    let empty = folder.read_dir().map_or(!folder.exists(), |mut entries| entries.next().is_none());
    if empty || folder.join("identification.json").is_file() {
        return Ok(());
    }
    Err(Refusal::BadRequest(format!(
        "the output_folder {} holds something else than an identification: name a new one",
        folder.display()
    )))
}

/// A path on a command line.
fn text(path: &Path) -> Result<&str, Refusal> {
    path.to_str().ok_or_else(|| {
        Refusal::BadRequest(format!("the name {} is no text in UTF-8; rename it", path.display()))
    })
}

/// The options of `frictionlab run` as the command line knows them.
pub(super) fn run_command() -> Command {
    RunArgs::augment_args(Command::new("run"))
}

/// Reads a command line.
///
/// # Errors
/// [`Refusal::BadRequest`] says in a sentence what was wrong.
pub fn parse<A: Args>(line: &[String]) -> Result<A, Refusal> {
    work::line::parse(line).map_err(|error| Refusal::BadRequest(error.0))
}

/// An option's name, however it is written: `voltage_limit` and `--voltage-limit` are one.
fn option(name: &str) -> String {
    name.trim().trim_start_matches('-').replace('_', "-")
}

/// Whether an option names a file.
fn is_path(arg: &Arg) -> bool {
    arg.get_value_parser().type_id() == ValueParser::path_buf().type_id()
}

/// The settings as command line. Every file that one of them names is one that requests may use, by
/// its path without links.
fn settings(
    command: &Command,
    reserved: &[&str],
    given: &[Setting],
    permissions: &Permissions,
) -> Result<Vec<String>, Refusal> {
    let named = |arg: &&Arg, name: &str| arg.get_long() == Some(name) && !reserved.contains(&name);
    let mut line = Vec::with_capacity(given.len());
    for Setting { name, value } in given {
        let name = option(name);
        let Some(arg) = command.get_arguments().find(|arg| named(arg, &name)) else {
            let known: Vec<&str> = command
                .get_arguments()
                .filter_map(Arg::get_long)
                .filter(|long| !reserved.contains(long))
                .collect();
            return Err(Refusal::BadRequest(format!(
                "there is no option `{name}`; expected one of {}",
                known.join(", ")
            )));
        };
        match (arg.get_action().takes_values(), value.trim()) {
            (true, value) if is_path(arg) => {
                line.push(format!("--{name}={}", text(&permissions.text(value)?)?));
            }
            (true, value) => line.push(format!("--{name}={value}")),
            // As Python writes them.
            (false, "True") => line.push(format!("--{name}")),
            (false, "False") => {}
            (false, "" | "true") => line.push(format!("--{name}")),
            (false, "false") => {}
            (false, other) => {
                return Err(Refusal::BadRequest(format!(
                    "the option `{name}` is a switch: true or false was expected, but `{other}` came"
                )));
            }
        }
    }
    Ok(line)
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;

    /// Both axes, and no file.
    fn permitted() -> Permissions {
        let rigs = ["simulated", "nodes", "nodes:/axis_2"].map(|name| name.parse().unwrap());
        Permissions::new("/axis_1", rigs.into(), "no-such-folder".into(), None)
    }

    fn setting(name: &str, value: &str) -> Setting {
        Setting { name: name.into(), value: value.into() }
    }

    fn request(experiment: &str, overrides: &[(&str, &str)]) -> ExperimentRequest {
        ExperimentRequest {
            experiment: experiment.into(),
            overrides: overrides.iter().map(|(name, value)| setting(name, value)).collect(),
            ..Default::default()
        }
    }

    #[test]
    fn a_request_is_what_the_command_line_would_be() {
        let asked = ExperimentRequest {
            models: vec!["lugre".into(), "dahl".into()],
            repetitions: 3,
            ..request(
                "position-tracking",
                &[("seed", "7"), ("quick", ""), ("voltage_limit", "4.5")],
            )
        };
        let options = asked.options(&RigChoice::Simulated, &permitted()).unwrap();
        assert_eq!(options.experiment.as_str(), "position-tracking");
        assert_eq!(options.models, [ModelName::LuGre, ModelName::Dahl]);
        assert_eq!((options.seed, options.position_tracking.repetitions), (7, 3));
        assert_eq!(options.test_bed.simulation.voltage_limit, 4.5);
        assert_eq!(options.constant_velocity.duration, 6.0, "--quick");
        let slow = request("all", &[("quick", "false")])
            .options(&RigChoice::Simulated, &permitted())
            .unwrap();
        assert_eq!(slow.constant_velocity.duration, 15.0);
    }

    #[test]
    fn a_request_does_not_raise_the_limit_of_a_real_rig() {
        let rig: RigChoice = "serial:/dev/nothing".parse().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("rig.yaml");
        std::fs::write(&file, "rig: serial:/dev/nothing\nlimits: {voltage: 4.0}\n").unwrap();
        let without = Permissions::new("/axis_1", vec![rig.clone()], "no-such-folder".into(), None);
        let with = without.clone().with_profile(Some((rig.clone(), file)));
        let asked = |volts: &str, permissions: &Permissions| {
            request("position-tracking", &[("voltage_limit", volts)]).options(&rig, permissions)
        };
        for (volts, permissions, allowed) in [
            ("6", &without, true),
            ("6.5", &without, false),
            ("4", &with, true),
            ("6", &with, false),
        ] {
            assert_eq!(asked(volts, permissions).is_ok(), allowed, "{volts} V");
        }
        assert_eq!(
            request("position-tracking", &[]).options(&rig, &with).unwrap().limits.voltage,
            Some(4.0)
        );
        let said = request("position-tracking", &[("rig_file", "mine.yaml")])
            .options(&rig, &with)
            .unwrap_err();
        assert!(said.to_string().contains("there is no option `rig-file`"), "{said}");
    }

    #[test]
    fn the_rig_is_the_usual_one_unless_the_request_names_another() {
        let nodes = RigChoice::Nodes { namespace: None };
        let rig = |overrides: &[(&str, &str)]| {
            request("position-tracking", overrides).options(&nodes, &permitted()).unwrap().rig
        };
        assert_eq!(
            rig(&[("quick", "true")]),
            RigChoice::Nodes { namespace: Some("/axis_1".into()) }
        );
        assert_eq!(rig(&[("rig", "simulated")]), RigChoice::Simulated);
        assert_eq!(
            rig(&[("--rig", "nodes:/axis_2")]),
            RigChoice::Nodes { namespace: Some("/axis_2".into()) }
        );
    }

    #[test]
    fn every_mistake_is_named_with_what_was_expected() {
        for (asked, said) in [
            (request("positon-tracking", &[]), ["positon-tracking", "velocity-tracking"]),
            (request("", &[]), ["no experiment ``", "characterise"]),
            (request("--help", &[]), ["--help", "all"]),
            (request("all", &[("sed", "7")]), ["`sed`", "seed"]),
            (request("all", &[("out", "/tmp")]), ["`out`", "seed"]),
            (request("all", &[("seed", "seven")]), ["seven", "--seed"]),
            (request("all", &[("quick", "perhaps")]), ["switch", "perhaps"]),
            (request("all", &[("plant", "lugri")]), ["lugri", "lugre"]),
            (request("sequence", &[]), ["protocol", "sequence"]),
            (
                request("all", &[("protocol", "nowhere.yaml")]),
                ["nowhere.yaml", "none of that name"],
            ),
            (ExperimentRequest { repetitions: 100_000, ..request("all", &[]) }, ["100000", "1000"]),
            (
                ExperimentRequest { models: vec!["newton".into()], ..request("all", &[]) },
                ["newton", "coulomb"],
            ),
        ] {
            let Err(Refusal::BadRequest(message)) =
                asked.options(&RigChoice::Simulated, &permitted())
            else {
                panic!("{asked:?} was taken")
            };
            for said in said {
                assert!(message.contains(said), "{asked:?}: {message}");
            }
            assert!(!message.contains("Usage") && !message.contains('\n'), "{message}");
        }
    }

    #[test]
    fn an_identification_needs_its_bag_and_known_options() {
        let root = tempfile::tempdir().unwrap();
        let runs = root.path().canonicalize().unwrap();
        std::fs::create_dir_all(runs.join("all-1/bag")).unwrap();
        std::fs::write(runs.join("all-1/parameters.yaml"), "precious").unwrap();
        let permitted = Permissions::new("/", vec![], runs.clone(), None);
        let asked = IdentifyRequest {
            bag_path: "all-1/bag".into(),
            models: vec!["lugre".into()],
            overrides: vec![setting("no-joint", "true"), setting("damping-ratio", "0.5")],
            ..Default::default()
        };
        let args = identify_args(&asked, &permitted).unwrap();
        assert_eq!((args.to.out, args.to.runs), (None, Some(runs.join("all-1"))));
        let refused =
            |asked: IdentifyRequest| identify_args(&asked, &permitted).unwrap_err().to_string();
        let nowhere = IdentifyRequest { bag_path: "nowhere/bag".into(), ..asked.clone() };
        assert!(refused(nowhere).contains("nowhere/bag"));
        let over = IdentifyRequest { output_folder: "all-1".into(), ..asked.clone() };
        assert!(refused(over).contains("something else than an identification"));
        let wrong = IdentifyRequest { overrides: vec![setting("dampingratio", "1")], ..asked };
        assert!(refused(wrong).contains("damping-ratio"));
    }
}
