//! What can go wrong with a live run.

use std::io;

use ros_node::{Lost, RosNodeError};

use rig_driver::RigError;

use recording::bag::BagError;

use files::OutputError;

use rig_setup::RigSetupError;

use experiment_runner::run::RunError;

use experiment_runner::test_bed::TestBedError;

/// A live run that cannot start or go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LiveError {
    /// The length of the run is none.
    #[error(
        "--duration must be above 0 and at most 10000000 s, but is {0} s; leave it out to run until ctrl-C"
    )]
    Duration(f64),
    /// The loop cannot be put together.
    #[error(transparent)]
    TestBed(#[from] TestBedError),
    /// The rig could not be opened.
    #[error(transparent)]
    Setup(#[from] RigSetupError),
    /// `--rate` names another rate than the device's own.
    #[error("the device's cycle is {period} s, which is {} Hz, and --rate asks for {asked} Hz; leave --rate out", 1.0 / period)]
    Rate {
        /// Period of the device's cycle \[s\].
        period: f64,
        /// Rate asked for \[Hz\].
        asked: f64,
    },
    /// No parameters of the nodes say these options.
    #[error("{0}")]
    Parameters(String),
    /// The arguments behind `--ros-args` are wrong.
    #[error("{0}")]
    Arguments(String),
    /// The rig did not become active.
    #[error("the rig does not start, and is at zero volts: {0}")]
    Start(String),
    /// What is to be kept beside the bag cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The parameters cannot be written into the bag.
    #[error(transparent)]
    ParameterFile(Box<RunError>),
    /// The bag cannot be written.
    #[error(transparent)]
    Bag(#[from] BagError),
    /// ROS 2 cannot be joined.
    #[error(transparent)]
    Ros(#[from] RosNodeError),
    /// The view cannot be opened.
    #[error(transparent)]
    View(#[from] crate::viewing::NodesViewError),
    /// The rig refused a command while running.
    #[error("the rig stopped the run and is at zero volts: {0}")]
    Rig(RigError),
    /// The middleware died under the nodes.
    #[error(
        "{0}: the nodes would hear no emergency stop. The motor is at zero volts and the bag is whole as far as it goes; start again"
    )]
    Deaf(Lost),
    /// A node of the same name was there before.
    #[error("{0}. The motor is at zero volts")]
    Elder(String),
    /// A thread does not start.
    #[error("a thread cannot be started: {source}; the system may be out of threads or memory")]
    Thread {
        /// What the system said.
        source: io::Error,
    },
    /// A thread ended by a panic: a mistake of this program.
    #[error(
        "the {thread} thread panicked: a mistake of this program, please report it with the text above"
    )]
    Panicked {
        /// Which.
        thread: &'static str,
    },
}

impl LiveError {
    /// Whether the user can mend it: an option, a folder, an environment variable.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Duration(_) | Self::Rate { .. } | Self::Parameters(_) | Self::Arguments(_) => {
                true
            }
            Self::TestBed(error) => error.is_bad_input(),
            Self::Setup(error) => error.is_bad_input(),
            Self::Output(error) => error.is_bad_input(),
            Self::ParameterFile(error) => error.is_bad_input(),
            Self::Bag(error) => error.is_bad_input(),
            Self::Ros(error) => error.is_bad_input(),
            Self::View(error) => error.is_bad_input(),
            Self::Start(_)
            | Self::Rig(_)
            | Self::Deaf(_)
            | Self::Elder(_)
            | Self::Thread { .. }
            | Self::Panicked { .. } => false,
        }
    }
}
