//! Which processes with which arguments: the same that the launch files start.

use std::path::{Path, PathBuf};

use super::{
    LaunchError,
    arguments::{AxisArguments, AxisFile, LaunchArguments},
};

/// Nodes of an axis, in the order in which they start.
const NODES: [&str; 4] = ["rig_driver", "friction_observer", "controller", "experiment_runner"];
/// Topics of an axis that a bag has; `/diagnostics` is shared.
const TOPICS: [&str; 7] = [
    "joint_states",
    "rig_measurement",
    "reference",
    "motor_voltage",
    "friction_estimate",
    "controller_state",
    "experiment_status",
];

/// What the end of a process means to the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Without it there is no loop: its end ends the others.
    Loop,
    /// The others go on without it. It writes files, and gets more time to end.
    Writer,
}

/// What a process runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Program {
    /// `frictionlab` itself, which has the nodes in it: what is launched is as old as what
    /// launches.
    Own,
    /// A program of this name.
    Named(&'static str),
}

impl Program {
    /// As one types it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Own => "frictionlab",
            Self::Named(name) => name,
        }
    }

    /// Where it is: this program itself, or one beside it, or on the PATH.
    ///
    /// # Errors
    /// [`LaunchError::NoProgram`].
    pub fn find(self) -> Result<PathBuf, LaunchError> {
        let own = std::env::current_exe();
        let name = match (self, &own) {
            (Self::Own, Ok(own)) => return Ok(own.clone()),
            _ => self.name(),
        };
        let beside = own
            .ok()
            .and_then(|own| own.parent().map(Path::to_owned))
            .unwrap_or_else(|| PathBuf::from("."));
        let path = std::env::var_os("PATH").unwrap_or_default();
        let is_program = |file: &PathBuf| {
            file.is_file() && rustix::fs::access(file, rustix::fs::Access::EXEC_OK).is_ok()
        };
        std::iter::once(beside.clone())
            .chain(std::env::split_paths(&path))
            .map(|folder| folder.join(name))
            .find(is_program)
            .ok_or(LaunchError::NoProgram { name, beside })
    }
}

/// One process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Process {
    /// What its lines begin with, as in `axis_1/rig_driver`.
    pub label: String,
    /// The program, not yet looked for.
    pub program: Program,
    /// Its arguments.
    pub arguments: Vec<String>,
    /// What its end means.
    pub part: Part,
}

impl Process {
    /// The command as one would type it.
    #[must_use]
    pub fn command_line(&self) -> String {
        let plain =
            |text: &str| text.chars().all(|c| c.is_ascii_alphanumeric() || "_-./:=@,+".contains(c));
        let quoted = |text: &String| {
            if plain(text) && !text.is_empty() {
                text.clone()
            } else {
                format!("'{}'", text.replace('\'', "'\\''"))
            }
        };
        std::iter::once(self.program.name().to_owned())
            .chain(self.arguments.iter().map(quoted))
            .collect::<Vec<_>>()
            .join(" ")
    }
}

/// The same processes where there is no `ros2`: frictionlab itself records.
#[must_use]
pub fn without_ros(mut processes: Vec<Process>, arguments: &LaunchArguments) -> Vec<Process> {
    let axes = arguments.axes.iter().filter_map(|axis| Some((axis, axis.record.as_deref()?)));
    for (process, (axis, folder)) in
        processes.iter_mut().filter(|of| of.program != Program::Own).zip(axes)
    {
        let namespace =
            axis.namespace.iter().flat_map(|name| ["--namespace".to_owned(), name.clone()]);
        process.program = Program::Own;
        process.arguments = ["bag".to_owned(), "record".to_owned(), folder.display().to_string()]
            .into_iter()
            .chain(namespace)
            .collect();
    }
    processes
}

/// All processes, with the nodes' own files in the folder `config`.
#[must_use]
pub fn processes(arguments: &LaunchArguments, config: &Path) -> Vec<Process> {
    arguments.axes.iter().flat_map(|axis| axis_processes(axis, config)).collect()
}

fn axis_processes(axis: &AxisArguments, config: &Path) -> Vec<Process> {
    // The recorder first: it is there when the rig wakes.
    let recorder = axis.record.as_deref().map(|folder| recorder(axis, folder));
    recorder.into_iter().chain(NODES.map(|name| node(name, axis, config))).collect()
}

fn label(axis: &AxisArguments, name: &str) -> String {
    axis.namespace
        .as_ref()
        .map_or_else(|| name.to_owned(), |namespace| format!("{namespace}/{name}"))
}

fn node(name: &'static str, axis: &AxisArguments, config: &Path) -> Process {
    let words = ["node", name, "--ros-args", "--log-level", &axis.log_level];
    let mut arguments = words.map(str::to_owned).to_vec();
    let mut add = |flag: &str, value: String| arguments.extend([flag.to_owned(), value]);
    if let Some(namespace) = &axis.namespace {
        add("-r", format!("__ns:=/{namespace}"));
    }
    let extra = axis.params_file.as_ref().map(|file| match file {
        AxisFile::Given(path) => path.clone(),
        AxisFile::SecondAxis => config.join("axis_2.yaml"),
    });
    for file in std::iter::once(config.join(format!("{name}.yaml"))).chain(extra) {
        add("--params-file", file.display().to_string());
    }
    // On a real rig its experiments run too. A simulated one of their own needs no real time.
    let experiments =
        axis.rig.as_ref().filter(|rig| *rig != "simulated").map(|_| "nodes".to_owned());
    let sets: &[(&str, &Option<String>)] = match name {
        "rig_driver" => &[("rig", &axis.rig)],
        "friction_observer" => &[("model", &axis.model), ("mode", &axis.mode)],
        "controller" => &[("mode", &axis.mode)],
        _ => &[("rig", &experiments)],
    };
    for (parameter, value) in sets {
        if let Some(value) = value {
            add("-p", format!("{parameter}:={value}"));
        }
    }
    let part = if name == "experiment_runner" { Part::Writer } else { Part::Loop };
    Process { label: label(axis, name), program: Program::Own, arguments, part }
}

/// `ros2 bag record` of the axis's topics, and of `/diagnostics`, which all axes share.
fn recorder(axis: &AxisArguments, folder: &Path) -> Process {
    let prefix =
        axis.namespace.as_ref().map_or_else(String::new, |namespace| format!("/{namespace}"));
    let arguments = ["bag", "record", "--storage", "mcap", "--output"]
        .map(str::to_owned)
        .into_iter()
        .chain([folder.display().to_string(), "--topics".to_owned()])
        .chain(TOPICS.map(|topic| format!("{prefix}/{topic}")))
        .chain(["/diagnostics".to_owned()])
        .collect();
    Process {
        label: label(axis, "recorder"),
        program: Program::Named("ros2"),
        arguments,
        part: Part::Writer,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::launch::LaunchFile;

    fn plan(file: LaunchFile, given: &[&str]) -> Vec<Process> {
        let given: Vec<String> = given.iter().map(|text| (*text).to_owned()).collect();
        processes(&LaunchArguments::read(file, &given).unwrap(), Path::new("config"))
    }

    #[test]
    fn files_come_before_what_the_arguments_set() {
        let plan =
            plan(LaunchFile::Friction, &["model:=lugre", "mode:=position", "namespace:=axis_1"]);
        assert_eq!(
            plan[1].command_line(),
            "frictionlab node friction_observer --ros-args --log-level info -r __ns:=/axis_1 --params-file config/friction_observer.yaml -p model:=lugre -p mode:=position"
        );
        assert_eq!(
            plan.iter().map(|process| process.label.as_str()).collect::<Vec<_>>(),
            [
                "axis_1/rig_driver",
                "axis_1/friction_observer",
                "axis_1/controller",
                "axis_1/experiment_runner"
            ]
        );
        assert_eq!(plan.iter().filter(|process| process.part == Part::Loop).count(), 3);
    }

    #[test]
    fn experiments_run_on_a_real_rig_that_is_launched() {
        let runner =
            |given: &[&str]| plan(LaunchFile::Friction, given).pop().unwrap().command_line();
        assert!(runner(&["rig:=serial:/dev/ttyACM0"]).ends_with("-p rig:=nodes"));
        assert!(runner(&["rig:=simulated"]).ends_with("experiment_runner.yaml"));
        assert!(runner(&[]).ends_with("experiment_runner.yaml"));
    }

    #[test]
    fn the_recorder_is_first_and_takes_the_axis_and_what_is_shared() {
        let plan = plan(LaunchFile::Friction, &["record:=/nowhere/bag", "namespace:=axis_2"]);
        let line = plan[0].command_line();
        assert!(line.starts_with(
            "ros2 bag record --storage mcap --output /nowhere/bag --topics /axis_2/joint_states"
        ));
        assert!(line.ends_with(" /diagnostics"));
        assert_eq!(self::plan(LaunchFile::TwoAxes, &[]).len(), 8);
        let given = ["record:=/nowhere/bags".to_owned()];
        let both = LaunchArguments::read(LaunchFile::TwoAxes, &given).unwrap();
        let own = without_ros(processes(&both, Path::new("config")), &both);
        assert_eq!(
            own[5].command_line(),
            "frictionlab bag record /nowhere/bags/axis_2 --namespace axis_2"
        );
    }

    #[test]
    fn what_has_spaces_is_quoted() {
        let process = Process {
            label: String::new(),
            program: Program::Named("p"),
            arguments: vec!["a b".into(), "it's".into()],
            part: Part::Loop,
        };
        assert_eq!(process.command_line(), r"p 'a b' 'it'\''s'");
    }

    #[test]
    fn a_program_that_is_nowhere_is_named() {
        let message = Program::Named("no_such_program_anywhere").find().unwrap_err().to_string();
        assert!(
            message.contains("there is no program no_such_program_anywhere beside"),
            "{message}"
        );
        assert!(Program::Named("sh").find().is_ok());
        assert_eq!(Program::Own.find().ok(), std::env::current_exe().ok());
    }
}
