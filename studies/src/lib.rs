//! What is computed from models, one room a study: [`features`] of friction, the [`truth_matrix`]
//! of identification, [`monte_carlo`] of compensation under wrong parameters, [`design`] of a
//! controller, [`export`] to simulators, [`simulate`], friction along a recorded motion, and [`sweep`](mod@sweep), that of many parameter
//! sets.

pub mod design;
pub mod export;
pub mod features;
pub mod monte_carlo;
pub mod simulate;
pub mod sweep;
pub mod truth_matrix;
