//! One way from an unknown motor to a compensated one, stage by stage.
//!
//! Each [`Stage`] is a module: it drives the rig through [`Axis`](axis::Axis), which puts every
//! voltage under the safety layer and counts rig time, and returns what it found. [`run()`] does
//! them in order and keeps each result in the [`Dossier`], a folder of JSON files, so that a
//! commission that was stopped goes on where it was.
//!
//! An encoder and a voltage are enough. Friction is therefore told in volts: the voltage at the
//! motor that overcomes it. Back-EMF and viscous friction are one slope then, 1/K.

pub mod axis;
pub mod bed;
pub mod board;
pub mod control;
pub mod dossier;
pub mod drive;
pub mod ends;
mod error;
pub mod feedback;
pub mod friction;
pub mod hand_over;
pub mod hunting;
pub mod identified;
mod interval;
pub mod level;
pub mod loop_design;
pub mod margin;
pub mod meet;
pub mod model;
mod noticed;
pub mod pareto;
pub mod proof;
pub mod protocols;
pub mod reach;
mod rows;
pub mod run;
mod stage;
pub mod structure;
pub mod travel;
pub mod trial;
pub mod velocity_design;

pub use board::Board;
pub use dossier::Dossier;
pub use error::CommissionError;
pub use interval::Ranged;
pub use run::{Asked, Outcome, run, run_watched};
pub use stage::Stage;
