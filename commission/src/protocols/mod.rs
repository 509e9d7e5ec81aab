//! The fixed protocols of the thesis, to hold the designed experiment against.
//!
//! [`test_bed`] sets the intervals of `run characterise` beside those of blocks that are chosen one
//! by one, on the simulated test bed; [`steps`] drives the same constant velocities, scaled, on any
//! machine.

pub mod steps;
pub mod test_bed;
