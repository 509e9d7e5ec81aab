//! Levels of log lines.

use std::{fmt, str::FromStr};

/// How much a log line matters. The numbers are those of `rcl_interfaces/msg/Log`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum LogLevel {
    /// For those who look for a mistake.
    Debug = 10,
    /// What happens.
    Info = 20,
    /// What somebody should look at.
    Warn = 30,
    /// What does not work.
    Error = 40,
    /// What ends the program.
    Fatal = 50,
}

impl FromStr for LogLevel {
    type Err = ();

    /// Reads the name, in capitals or not, as rcl does.
    fn from_str(text: &str) -> Result<Self, ()> {
        match text.to_ascii_lowercase().as_str() {
            "debug" => Ok(Self::Debug),
            "info" => Ok(Self::Info),
            "warn" => Ok(Self::Warn),
            "error" => Ok(Self::Error),
            "fatal" => Ok(Self::Fatal),
            _ => Err(()),
        }
    }
}

impl fmt::Display for LogLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Debug => "DEBUG",
            Self::Info => "INFO",
            Self::Warn => "WARN",
            Self::Error => "ERROR",
            Self::Fatal => "FATAL",
        })
    }
}
