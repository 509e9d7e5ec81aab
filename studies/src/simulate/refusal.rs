//! Why a simulation ends before its motion does.

use std::io;

use friction_model::MAX_SPEED;
use recording::RecordingError;

/// What stopped a simulation.
#[derive(Debug, thiserror::Error)]
pub enum Stopped {
    /// The model cannot be evaluated along the motion.
    #[error(transparent)]
    Refused(#[from] SimulateError),
    /// The motion cannot be read.
    #[error(transparent)]
    Motion(#[from] RecordingError),
    /// The result cannot be written.
    #[error(transparent)]
    Write(#[from] io::Error),
}

/// Why a model cannot be evaluated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// A step that the scheme does not accept.
    #[error("--dt must be {expected}, but is {dt} s")]
    Step {
        /// What was expected.
        expected: &'static str,
        /// What came \[s\].
        dt: f64,
    },
    /// A load gain that is no gain.
    #[error("--load-gain must be a finite number, zero or more, but is {0}")]
    LoadGain(f64),
    /// A load gain without loads.
    #[error(
        "--load-gain needs the load at each time, but the file has no column load_Nm or load_N"
    )]
    NoLoad,
    /// Too many steps from one row to the next.
    #[error(
        "{duration} s from one row to the next in steps of {dt} s are {steps:.1e} steps, but at most 1e9 are accepted; choose a longer --dt"
    )]
    TooLong {
        /// Time between the rows \[s\].
        duration: f64,
        /// Longest step \[s\].
        dt: f64,
        /// Number of steps.
        steps: f64,
    },
    /// A tolerance that is none.
    #[error("--tolerance must lie between 1e-12 and 0.1, but is {0}")]
    Tolerance(f64),
    /// A velocity that no model is asked for.
    #[error(
        "the velocity is {velocity} at {time} s, but at most {MAX_SPEED:e} either way is accepted; look at the unit of the column"
    )]
    TooFast {
        /// When \[s\].
        time: f64,
        /// The velocity there.
        velocity: f64,
    },
    /// No step of Runge and Kutta holds the tolerance.
    #[error(
        "at {time} s no step holds the tolerance of {tolerance}: {dt} s was halved, to {shortest:.1e} s, until 8192 steps were tried or none could be shorter. The model is too stiff there for --scheme rk4; use --scheme mean, a shorter --dt or a larger --tolerance"
    )]
    Stiff {
        /// When \[s\].
        time: f64,
        /// Longest step \[s\].
        dt: f64,
        /// The shortest that was tried \[s\].
        shortest: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// A number of the result is none.
    #[error("the {what} is {value} at {time} s: these parameters cannot be evaluated there")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// What came.
        value: f64,
        /// When \[s\].
        time: f64,
    },
}
