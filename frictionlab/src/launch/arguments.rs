//! The arguments of the launch files, as `NAME:=VALUE`.

use std::path::{Path, PathBuf};

use super::LaunchError;
use files::first_free;
use rig_driver::RigRegistry;
use rig_setup::RigChoice;
use work::destination::RUNS;

/// What to start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum LaunchFile {
    /// One axis: what `friction.launch.py` starts
    #[default]
    Friction,
    /// Two axes, /axis_1 and /axis_2: what `two_axes.launch.py` starts
    TwoAxes,
}

/// Arguments of one axis. What is not given is as the parameter files say.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct AxisArguments {
    /// Which rig.
    pub rig: Option<String>,
    /// Friction model that estimates.
    pub model: Option<String>,
    /// What is regulated: velocity or position.
    pub mode: Option<String>,
    /// Namespace of the axis, without slashes at its ends.
    pub namespace: Option<String>,
    /// One more parameter file.
    pub params_file: Option<AxisFile>,
    /// Folder of a bag.
    pub record: Option<PathBuf>,
    /// Level of every log.
    pub log_level: String,
}

/// A parameter file beside each node's own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AxisFile {
    /// One of the user's.
    Given(PathBuf),
    /// What the second simulated axis has of its own.
    SecondAxis,
}

/// Arguments of a launch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LaunchArguments {
    /// Every axis.
    pub axes: Vec<AxisArguments>,
    /// Folder for the nodes' own parameter files; none for a temporary one.
    pub files: Option<PathBuf>,
}

/// Names and meaning of the arguments of one axis, as `--help` shows them.
pub const AXIS_ARGUMENTS: [(&str, &str); 8] = [
    ("rig", "which rig the nodes drive; `frictionlab rig list` finds those there are"),
    ("model", "friction model that estimates; `frictionlab models` lists them"),
    ("mode", "what is regulated: velocity or position"),
    ("namespace", "namespace of the axis, as in axis_1"),
    (
        "params_file",
        "one more parameter file for all nodes, such as parameters.yaml of an identification",
    ),
    ("record", "folder of a bag that must not exist yet, or true for the first free runs/launch-N"),
    ("log_level", "debug, info, warn, error or fatal"),
    (
        "files",
        "folder with the nodes' own parameter files, made if it is not there, for you to edit",
    ),
];

/// Arguments of `two-axes` that each axis has for itself, with `_1` or `_2` behind the name.
const PER_AXIS: [&str; 3] = ["rig", "model", "params_file"];
const LOG_LEVELS: [&str; 5] = ["debug", "info", "warn", "error", "fatal"];
const MODES: [&str; 2] = ["velocity", "position"];

impl LaunchArguments {
    /// Reads `NAME:=VALUE`; the last of a name counts, an empty value is none.
    ///
    /// # Errors
    /// [`LaunchError::Argument`] names the argument and what was expected.
    pub fn read(file: LaunchFile, given: &[String]) -> Result<Self, LaunchError> {
        let mut axes = match file {
            LaunchFile::Friction => vec![AxisArguments::default()],
            LaunchFile::TwoAxes => vec![
                AxisArguments {
                    namespace: Some("axis_1".into()),
                    rig: Some("simulated".into()),
                    ..Default::default()
                },
                AxisArguments {
                    namespace: Some("axis_2".into()),
                    rig: Some("simulated".into()),
                    params_file: Some(AxisFile::SecondAxis),
                    ..Default::default()
                },
            ],
        };
        axes.iter_mut().for_each(|axis| axis.log_level = "info".to_owned());
        let mut files = None;
        for text in given {
            let (name, value) = text.split_once(":=").ok_or_else(|| {
                LaunchError::Argument(format!(
                    "`{text}` is no argument; expected NAME:=VALUE, as in rig:=simulated"
                ))
            })?;
            let value = Some(value.trim()).filter(|value| !value.is_empty());
            if name == "files" {
                files = value.map(PathBuf::from);
                continue;
            }
            let (axis, field) = target(file, name)?;
            for axis in
                axes.iter_mut().enumerate().filter(|(index, _)| axis.is_none_or(|of| of == *index))
            {
                axis.1.set(field, value)?;
            }
        }
        if let Some(first) =
            axes.iter().find(|axis| axis.record.is_some()).filter(|_| axes.len() > 1)
        {
            let folder = first.record.clone().unwrap_or_default();
            for axis in &mut axes {
                axis.record = axis.namespace.as_ref().map(|namespace| folder.join(namespace));
            }
        }
        Ok(Self { axes, files })
    }
}

/// Which axis (none for all) and which of its arguments a name means.
fn target(file: LaunchFile, name: &str) -> Result<(Option<usize>, &str), LaunchError> {
    let known = |name: &str| AXIS_ARGUMENTS.iter().any(|(known, _)| *known == name);
    match file {
        LaunchFile::Friction if known(name) => return Ok((None, name)),
        LaunchFile::TwoAxes => {
            for (index, suffix) in ["_1", "_2"].into_iter().enumerate() {
                if let Some(field) =
                    name.strip_suffix(suffix).filter(|field| PER_AXIS.contains(field))
                {
                    return Ok((Some(index), field));
                }
            }
            if known(name) && name != "namespace" && !PER_AXIS.contains(&name) {
                return Ok((None, name));
            }
        }
        LaunchFile::Friction => {}
    }
    let names: Vec<String> = match file {
        LaunchFile::Friction => AXIS_ARGUMENTS.iter().map(|(name, _)| (*name).to_owned()).collect(),
        LaunchFile::TwoAxes => {
            let both = ["mode", "record", "log_level", "files"].map(str::to_owned);
            PER_AXIS
                .iter()
                .flat_map(|name| [format!("{name}_1"), format!("{name}_2")])
                .chain(both)
                .collect()
        }
    };
    Err(LaunchError::Argument(format!(
        "there is no argument `{name}`; expected one of {}",
        names.join(", ")
    )))
}

impl AxisArguments {
    fn set(&mut self, name: &str, value: Option<&str>) -> Result<(), LaunchError> {
        let wrong = |value: &str, expected: &str| {
            Err(LaunchError::Argument(format!("{name}:={value} is not known; expected {expected}")))
        };
        let owned = value.map(str::to_owned);
        match (name, value) {
            ("rig", Some(rig)) => {
                let rig_named = rig
                    .parse::<RigChoice>()
                    .map_err(|error| LaunchError::Argument(error.to_string()))?;
                if matches!(rig_named, RigChoice::Nodes { .. }) {
                    let rigs = RigRegistry::installed().grammar();
                    return wrong(rig, &format!("{rigs}: this starts the nodes"));
                }
                self.rig = owned;
            }
            ("rig", None) => self.rig = None,
            ("model", Some(model)) => {
                model
                    .parse::<friction_model::ModelName>()
                    .map_err(|error| LaunchError::Argument(error.to_string()))?;
                self.model = owned;
            }
            ("model", None) => self.model = None,
            ("mode", Some(mode)) if !MODES.contains(&mode) => {
                return wrong(mode, &MODES.join(" or "));
            }
            ("mode", _) => self.mode = owned,
            ("namespace", Some(text)) => {
                let namespace = text.trim_matches('/');
                let identity = ros_node::NodeIdentity::new("rig_driver", namespace);
                identity.map_err(|error| LaunchError::Argument(error.to_string()))?;
                self.namespace = Some(namespace.to_owned());
            }
            ("namespace", None) => self.namespace = None,
            ("params_file", Some(file)) => {
                if !Path::new(file).is_file() {
                    return Err(LaunchError::Argument(format!("params_file:={file} is no file")));
                }
                self.params_file = Some(AxisFile::Given(file.into()));
            }
            ("params_file", None) => self.params_file = None,
            ("record", None | Some("false")) => self.record = None,
            ("record", Some("true")) => self.record = Some(first_free(Path::new(RUNS), "launch")),
            ("record", Some(folder)) => {
                if Path::new(folder).exists() {
                    return Err(LaunchError::Argument(format!(
                        "record:={folder} exists already; name a new folder"
                    )));
                }
                self.record = Some(folder.into());
            }
            ("log_level", Some(level)) if !LOG_LEVELS.contains(&level) => {
                return wrong(level, &LOG_LEVELS.join(", "));
            }
            ("log_level", level) => self.log_level = level.unwrap_or("info").to_owned(),
            _ => {}
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(file: LaunchFile, given: &[&str]) -> Result<LaunchArguments, String> {
        let given: Vec<String> = given.iter().map(|text| (*text).to_owned()).collect();
        LaunchArguments::read(file, &given).map_err(|error| error.to_string())
    }

    #[test]
    fn arguments_are_those_of_the_launch_files() {
        let given = [
            "rig:=serial:/dev/ttyACM0@115200",
            "model:=lugre",
            "mode:=position",
            "namespace:=/axis_1/",
            "log_level:=debug",
        ];
        let read = read(LaunchFile::Friction, &given).unwrap();
        let axis = &read.axes[0];
        assert_eq!(axis.rig.as_deref(), Some("serial:/dev/ttyACM0@115200"));
        assert_eq!(
            (axis.model.as_deref(), axis.mode.as_deref()),
            (Some("lugre"), Some("position"))
        );
        assert_eq!((axis.namespace.as_deref(), axis.log_level.as_str()), (Some("axis_1"), "debug"));
        assert_eq!(read.axes.len(), 1);
    }

    #[test]
    fn two_axes_have_arguments_of_their_own() {
        let read = read(
            LaunchFile::TwoAxes,
            &["rig_2:=quanser", "mode:=position", "record:=/nowhere/bags"],
        )
        .unwrap();
        assert_eq!(read.axes[0].rig.as_deref(), Some("simulated"));
        assert_eq!(read.axes[1].rig.as_deref(), Some("quanser"));
        assert_eq!(read.axes[1].params_file, Some(AxisFile::SecondAxis));
        assert!(read.axes.iter().all(|axis| axis.mode.as_deref() == Some("position")));
        assert_eq!(read.axes[1].record.as_deref(), Some(Path::new("/nowhere/bags/axis_2")));
    }

    #[test]
    fn what_no_node_could_mean_is_refused_and_named() {
        for (given, said) in [
            ("seriel", "NAME:=VALUE"),
            ("rig:=seriel:/dev/ttyACM0", "serial:PORT"),
            ("rig:=serial:", "serial:/dev/ttyACM0"),
            ("rig:=nodes", "this starts the nodes"),
            ("model:=newton", "coulomb"),
            ("mode:=torque", "velocity or position"),
            ("params_file:=/nowhere.yaml", "/nowhere.yaml is no file"),
            ("record:=/", "exists already"),
            ("log_level:=loud", "debug"),
            ("namespace:=a b", "a b"),
            ("rig_1:=simulated", "there is no argument `rig_1`"),
        ] {
            let message = read(LaunchFile::Friction, &[given]).unwrap_err();
            assert!(message.contains(said), "{given}: {message}");
        }
        assert!(read(LaunchFile::TwoAxes, &["rig:=simulated"]).unwrap_err().contains("rig_1"));
    }
}
