//! A whole run on the test bed: characterise, identify, compensate, compare; bag, parameters,
//! report and record.
//!
//! [`execute`] is what `frictionlab run` calls. The same options and seed give the same bag and the
//! same figures, on any number of cores.

mod appendix;
mod bench;
mod characterisation;
mod characterisation_page;
#[cfg(test)]
mod characterisation_tests;
mod comparison_page;
#[cfg(test)]
mod compensation_tests;
mod compensators;
mod controller_parameters;
mod differences;
mod error;
mod excited;
mod execute;
mod given;
mod journal;
mod options;
mod origin;
mod page;
mod parameter_file;
#[cfg(test)]
mod provenance_tests;
mod recorder;
mod results;
#[cfg(test)]
mod resume_tests;
mod sequence_page;
#[cfg(test)]
mod supervision_tests;
pub mod terminal;
mod trace;
mod tracked;

pub use appendix::{Appended, Appendix, Beside};
pub use characterisation::{BreakawayFigures, Characterisation, ClosureFigures, LagFigures};
pub use compensators::Compensators;
pub use controller_parameters::ControllerParameters;
pub use error::RunError;
pub use execute::{Beginning, Outcome, check, check_options, execute, execute_in};
pub use given::{Given, read as read_parameter_file, read_controller};
pub use journal::Journal;
pub use options::{Experiment, Pace, ProfileUsed, RecordPolicy, RunOptions, shipped};
pub use origin::{Origin, Origins};
#[cfg(feature = "ros")]
pub use parameter_file::render_bed as render_parameter_file;
pub use results::{Comparison, Identification, RunResults, Session, Status, TaskComparison};
