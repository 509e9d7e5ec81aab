//! From sampled position and force to velocity, acceleration and force without phase shift.
//!
//! The position (or the velocity, where that is what was measured) goes through a zero-phase
//! Butterworth low-pass and is differentiated by central differences; the filter's and the
//! differences' troubles at both ends are cut off. The force is left as measured: filtering it
//! alone would shift nothing but would flatten the steps that Coulomb friction makes. Decimation
//! comes later, when the regression is set up, and treats every regressor and the force alike
//! ([`crate::rigid_axis`]). Cut at its rests, a recording may need a low-pass of the force all the same
//! ([`Conditioning::low_pass_force`]).
//!
//! A recording with gaps is conditioned stretch by stretch ([`condition_stretches`]): no filter,
//! difference or delay reaches across a gap.

mod coarser;
mod conditioned;
mod filter;
mod rests;
mod settings;
mod sticks;
mod stretches;
#[cfg(test)]
mod tests;

pub use conditioned::Conditioned;
pub(crate) use conditioned::Piece;
pub use filter::{Signals, condition};
pub use rests::Rest;
pub use settings::{Conditioning, Differences};
#[cfg(test)]
pub(crate) use sticks::Stick;
pub use stretches::condition_stretches;
