//! Setting a rig up: which there are, whether their signs and gains are right, and the calibration
//! that makes them so.
//!
//! Everything here drives the rig under the safety layer. The steps ([`procedure`]) are the same
//! for a check and for a calibration.

mod bench_rig;
mod choice;
mod come_back;
mod description;
mod ends;
mod error;
mod findings;
mod heat;
mod jog;
mod parameters;
mod procedure;
mod profile;
mod session;
mod strokes;
mod terminal;
mod unseen;

pub use bench_rig::{BenchRig, REST, Reopen};
pub use choice::RigChoice;
pub use come_back::{PATIENCE, come_back, counted_on};
pub use description::require_device;
pub use ends::{Ends, Moves, Search, find_ends, find_moves};
pub use error::{NotReopened, RigFileError, RigSetupError, SectionError};
pub use findings::{Findings, Level, Verdict};
pub use heat::Heat;
pub use jog::JogSummary;
pub use parameters::{of_rig_driver, read as read_calibration, render as render_calibration};
pub use procedure::{Procedure, run as run_procedure};
pub use profile::{DriveSheet, PROFILE, RigProfile};
pub use rig_driver::registry::{Opened, Pace, RigDescription, RigSetup, Scales, SensorsPresent};
pub use rig_driver::safety::RigLimits;
pub use session::Session;
pub use strokes::Room;
pub use terminal::{Display, findings_table};
