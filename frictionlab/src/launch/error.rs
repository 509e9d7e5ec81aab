//! Why nothing was started, or what was started ended.

use std::{io, path::PathBuf};

use files::is_of_the_path;

/// A launch that did not begin, or did not go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LaunchError {
    /// An argument is none, or its value cannot be.
    #[error("{0}")]
    Argument(String),
    /// A program is not there.
    #[error(
        "there is no program {name} beside frictionlab ({}) or on the PATH; install it, or name its folder in PATH",
        beside.display()
    )]
    NoProgram {
        /// The program.
        name: &'static str,
        /// Where it was looked for.
        beside: PathBuf,
    },
    /// A parameter file cannot be written.
    #[error("the parameter files cannot be written to {}: {source}; name another folder with files:=DIR", folder.display())]
    Files {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A program does not start.
    #[error("{} does not start: {source}", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A node of the loop ended by itself.
    #[error("{name} has ended by itself ({how}), and the others with it; its last lines say why")]
    Died {
        /// The node.
        name: String,
        /// Its exit code or signal.
        how: String,
    },
}

impl LaunchError {
    /// Whether the person who typed the command can mend it.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Argument(_) => true,
            Self::Files { source, .. } => is_of_the_path(source),
            Self::NoProgram { .. } | Self::Start { .. } | Self::Died { .. } => false,
        }
    }
}
