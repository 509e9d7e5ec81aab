//! The ROS part of a command line, as rcl reads it.
//!
//! Between `--ros-args` and `--` (or the end) stand remappings (`-r`), parameters (`-p`,
//! `--params-file`), log levels and the enclave. They may come several times. Of parameters with
//! the same pattern of nodes the later replaces the earlier; of several patterns that fit a node,
//! the one that was first met last counts.

use std::{collections::BTreeMap, path::PathBuf};

use ::parameters::{
    ParameterValue,
    file::{NodeParameters, Parameters, parse_value},
};

use crate::{
    LogLevel,
    remap::{RemapRule, Remaps},
};

/// What `--help` of every executable says of them.
pub const ROS_ARGUMENTS_HELP: &str = "\
ROS arguments, behind --ros-args and up to -- or the end:
  -r, --remap [NODE:]FROM:=TO       another name for a topic or service; __node and __ns for the node
  -p, --param [NODE:]NAME:=VALUE    a parameter; the value as in YAML: 1.0 is a double, 1 an integer
      --params-file FILE            parameters from a YAML file
      --log-level [LOGGER:=]LEVEL   debug, info, warn, error or fatal
      --enable-rosout-logs, --disable-rosout-logs, --enable-stdout-logs, --disable-stdout-logs
  -e, --enclave PATH                the enclave in the keystore, where security is on; /NAME of the program unless given
Environment: ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE (LOCALHOST unless set), ROS_NAMESPACE,
  ROS_SECURITY_ENABLE, ROS_SECURITY_STRATEGY, ROS_SECURITY_KEYSTORE, ROS_SECURITY_ENCLAVE_OVERRIDE (docs/how-to/secure-the-network.md)
";

/// The command line was not understood, or a file that it names cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}; --help shows what there is")]
pub struct ArgumentError(String);

/// What a command line says to ROS.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Arguments {
    /// Other names.
    pub remaps: Remaps,
    /// Parameters for nodes by pattern, in their order.
    pub parameters: Parameters,
    /// Level of every logger.
    pub log_level: Option<LogLevel>,
    /// Levels of single loggers.
    pub logger_levels: BTreeMap<String, LogLevel>,
    /// Whether log lines are published on `/rosout`.
    pub rosout_disabled: bool,
    /// Whether log lines are written to the terminal.
    pub terminal_disabled: bool,
    /// Arguments that ROS understands and that change nothing here; each node says so.
    pub ignored: Vec<String>,
    /// The enclave: who the process is, where security is on.
    pub enclave: Option<String>,
    /// The process only looks who is there: it joins in the clear, whatever the environment says of
    /// security. No argument sets this.
    pub in_the_clear: bool,
    /// Namespace of nodes that the command line does not put into another.
    pub namespace: Option<String>,
    /// Every argument that is not for ROS, in its order, without the program's name.
    pub user: Vec<String>,
}

/// The words behind the program's name on this process's command line.
#[must_use]
pub fn command_line() -> Vec<String> {
    std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect()
}

impl Arguments {
    /// Reads the words of a command line, without the program's name, and the environment of this
    /// process.
    ///
    /// # Errors
    /// [`ArgumentError`].
    pub fn in_process(given: impl IntoIterator<Item = String>) -> Result<Self, ArgumentError> {
        let mut arguments = Self::parse(given)?;
        arguments.namespace =
            std::env::var("ROS_NAMESPACE").ok().filter(|namespace| !namespace.is_empty());
        Ok(arguments)
    }

    /// The same, with that enclave if the command line names none.
    #[must_use]
    pub fn or_enclave(mut self, enclave: &str) -> Self {
        self.enclave.get_or_insert_with(|| enclave.to_owned());
        self
    }

    /// Reads arguments, without the program's name. Parameter files are read from disk.
    ///
    /// # Errors
    /// [`ArgumentError`] names the argument.
    pub fn parse(given: impl IntoIterator<Item = String>) -> Result<Self, ArgumentError> {
        let mut arguments = Self::default();
        let mut given = given.into_iter();
        let mut for_ros = false;
        while let Some(argument) = given.next() {
            match argument.as_str() {
                "--ros-args" => for_ros = true,
                "--" if for_ros => for_ros = false,
                _ if for_ros => arguments.take(&argument, &mut given).map_err(ArgumentError)?,
                _ => arguments.user.push(argument),
            }
        }
        Ok(arguments)
    }

    fn take(&mut self, flag: &str, rest: &mut impl Iterator<Item = String>) -> Result<(), String> {
        let mut value = |what: &str| {
            rest.next()
                .filter(|value| value != "--ros-args" && value != "--")
                .ok_or_else(|| format!("`{flag}` wants {what} behind it"))
        };
        match flag {
            "-r" | "--remap" => {
                let rule = RemapRule::parse(&value("FROM:=TO")?);
                self.remaps.push(rule.map_err(|error| error.to_string())?);
            }
            "-p" | "--param" => self.parameter(&value("NAME:=VALUE")?)?,
            "--params-file" => self.file(&value("a file")?)?,
            "--log-level" => self.level(&value("a level")?)?,
            "-e" | "--enclave" => self.enclave = Some(value("a path")?),
            "--enable-rosout-logs" => self.rosout_disabled = false,
            "--disable-rosout-logs" => self.rosout_disabled = true,
            "--enable-stdout-logs" => self.terminal_disabled = false,
            "--disable-stdout-logs" => self.terminal_disabled = true,
            // There is no other logger to switch.
            "--enable-external-lib-logs" | "--disable-external-lib-logs" => {}
            // Launch files pass them on. Nothing is logged to files here.
            "--log-config-file" | "--log-file-name" => {
                let named = value("a file")?;
                self.ignored.push(format!("{flag} {named}"));
            }
            other => return Err(format!("`{other}` behind --ros-args is unknown")),
        }
        Ok(())
    }

    fn parameter(&mut self, text: &str) -> Result<(), String> {
        let wrong =
            || format!("`{text}` is no parameter; expected NAME:=VALUE or NODE:NAME:=VALUE");
        let (left, value) = text.split_once(":=").ok_or_else(wrong)?;
        let (pattern, name) = match left.split_once(':') {
            Some((node, name)) if !node.is_empty() => {
                (format!("/{}", node.trim_start_matches('/')), name)
            }
            Some(_) => return Err(wrong()),
            None => ("/**".to_owned(), left),
        };
        let is_name = |c: char| c.is_ascii_alphanumeric() || "_./-~".contains(c);
        if name.is_empty() || !name.chars().all(is_name) {
            return Err(wrong());
        }
        let value = parse_value(value).map_err(|e| format!("in the parameter `{text}`: {e}"))?;
        let values = BTreeMap::from([(name.to_owned(), value)]);
        self.parameters.give(NodeParameters { pattern, values });
        Ok(())
    }

    fn file(&mut self, path: &str) -> Result<(), String> {
        let text = std::fs::read_to_string(PathBuf::from(path))
            .map_err(|error| format!("the parameter file {path} cannot be read: {error}"))?;
        let found = Parameters::parse(&text)
            .map_err(|error| format!("in the parameter file {path}: {error}"))?;
        found.nodes().iter().cloned().for_each(|given| self.parameters.give(given));
        Ok(())
    }

    fn level(&mut self, text: &str) -> Result<(), String> {
        let (logger, level) = match text.split_once(":=") {
            Some((logger, level)) => (Some(logger), level),
            None => (None, text),
        };
        let level = level.parse().map_err(|_| {
            format!("`{level}` is no log level; there are debug, info, warn, error and fatal")
        })?;
        match logger {
            None => self.log_level = Some(level),
            Some(logger) => _ = self.logger_levels.insert(logger.to_owned(), level),
        }
        Ok(())
    }

    /// What is given for the node of that absolute name.
    #[must_use]
    pub fn overrides(&self, node: &str) -> BTreeMap<String, ParameterValue> {
        self.parameters.of_node(node)
    }

    /// Level of the logger of that name: its own, that of the nearest one above, or the one of all.
    #[must_use]
    pub fn level_of(&self, logger: &str) -> LogLevel {
        let mut name = logger;
        loop {
            if let Some(level) = self.logger_levels.get(name) {
                return *level;
            }
            match name.rsplit_once('.') {
                Some((above, _)) => name = above,
                None => return self.log_level.unwrap_or(LogLevel::Info),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Arguments, String> {
        Arguments::parse(text.split_whitespace().map(str::to_owned)).map_err(|e| e.to_string())
    }

    /// As in rcl's `test_arguments.cpp`: `--ros-args` and `--` may alternate, and the rest is the
    /// user's.
    #[test]
    fn ros_arguments_stand_between_their_marks() {
        let arguments =
            parse("a --ros-args -r x:=y -- b --ros-args --ros-args -p p:=1 -- -- c --help")
                .unwrap();
        assert_eq!(arguments.user, ["a", "b", "--", "c", "--help"]);
        assert_eq!(arguments.overrides("/n")["p"], ParameterValue::Integer(1));
        let node = arguments.remaps.node("n", "/").unwrap();
        assert_eq!(arguments.remaps.resolve(&node, crate::Named::Topic, "x").unwrap(), "/y");
        assert_eq!(parse("-r x:=y").unwrap().user, ["-r", "x:=y"]);
    }

    #[test]
    fn parameters_count_in_their_order_and_for_their_node() {
        let arguments =
            parse("--ros-args -p a:=1 -p n:a:=2.5 -p m:a:=3 -p b.c:=[x,z] -e /e --log-level warn")
                .unwrap();
        let of_n = arguments.overrides("/n");
        assert_eq!(of_n["a"], ParameterValue::Double(2.5));
        assert_eq!(of_n["b.c"], ParameterValue::StringArray(vec!["x".into(), "z".into()]));
        assert_eq!(arguments.overrides("/o")["a"], ParameterValue::Integer(1));
        assert_eq!(
            (arguments.enclave.as_deref(), arguments.log_level),
            (Some("/e"), Some(LogLevel::Warn))
        );
    }

    #[test]
    fn levels_of_loggers_are_inherited() {
        let arguments = parse("--ros-args --log-level axis:=debug --log-level ERROR").unwrap();
        assert_eq!(arguments.level_of("axis.controller"), LogLevel::Debug);
        assert_eq!(arguments.level_of("rig"), LogLevel::Error);
    }

    #[test]
    fn files_for_logs_are_taken_and_told_to_change_nothing() {
        let arguments = parse("--ros-args --log-config-file a.yaml --log-file-name b").unwrap();
        assert_eq!(arguments.ignored, ["--log-config-file a.yaml", "--log-file-name b"]);
        assert!(parse("--ros-args --log-config-file").unwrap_err().contains("a file"));
    }

    #[test]
    fn what_is_not_understood_is_refused_and_named() {
        for wrong in [
            "--ros-args x",
            "--ros-args x:=y",
            "--ros-args -r",
            "--ros-args -p a",
            "--ros-args -p :a:=1",
            "--ros-args -p a:=",
            "--ros-args -p a:=[1,2.0]",
            "--ros-args --params-file /no/such",
            "--ros-args --log-level loud",
            "--ros-args -r --",
            "--ros-args --remap a",
            "--ros-args --verbose",
        ] {
            let message = parse(wrong).unwrap_err();
            assert!(message.contains('`') || message.contains("/no/such"), "{wrong}: {message}");
        }
    }
}
