//! A whole run on the test bed: characterise, identify, compensate, compare; bag, parameters,
//! report and record.
//!
//! [`execute`] is what `frictionlab run` calls. The same options and seed give the same bag and the
//! same figures, on any number of cores.

mod appendix;
pub(crate) mod bench;
mod characterisation;
mod characterisation_page;
mod comparison_page;
mod compensators;
mod differences;
mod error;
pub mod excited;
mod execute;
pub mod experiment;
mod given;
mod journal;
pub(crate) mod made;
pub mod mean_record;
pub(crate) mod options;
mod origin;
mod page;
mod parameter_file;
pub(crate) mod recorder;
pub(crate) mod results;
mod sequence_page;
pub(crate) mod sorted;
pub mod terminal;
mod trace;
pub(crate) mod tracked;

pub use appendix::{Appended, Appendix, Beside};
pub use characterisation::{BreakawayFigures, Characterisation, ClosureFigures, LagFigures};
pub use compensators::Compensators;
pub use error::RunError;
pub use execute::{Beginning, Outcome, check, check_options, execute, execute_in};
pub(crate) use given::of_node;
pub use given::{Given, GivenError, read as read_parameter_file};
pub use journal::Journal;
pub use options::{Pace, ProfileUsed, RecordPolicy, RunOptions};
pub use origin::{Origin, Origins};
#[cfg(feature = "ros")]
pub use parameter_file::render_bed as render_parameter_file;
pub use results::{Comparison, Identification, RunResults, Session, Status, TaskComparison};

/// Name of the selection that leaves its steady points in a table of their own.
pub const CHARACTERISE: &str = "characterise";
