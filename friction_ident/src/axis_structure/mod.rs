//! An axis whose model is chosen: which of direction-wise friction, Stribeck effect, pre-sliding,
//! delay and position dependence the data support.
//!
//! ```text
//! force(t) = inertia a + f_v v + z (f_c + (f_s - f_c) exp(-(v/v_s)^2)) + offset        all at t + delay
//!          + sigma1 dz/dt, z here in m or rad                                       damping
//!          + spring xi + z (f_c_slope xi + f_c_curvature xi^2)                         position, xi from -1 to 1 along the axis
//!          + gravity_sin sin q + gravity_cos cos q                             gravity, q the angle
//!          + harmonic_cos cos(2 pi x / period) + harmonic_sin sin(2 pi x / period)     harmonic
//! ```
//!
//! `z` is the sign of the velocity, or with pre-sliding the deflection of Dahl's bristle over its
//! limit; with damping it resists being deflected, as LuGre's does. With `lag` it is LuGre's: its
//! limit is the Stribeck curve, and the level follows the velocity as far as the bristle moves.
//! With `asymmetric` the coefficients of the parts that push forward and backward are parameters
//! of their own, and no offset is left to be told from them.
//!
//! [`fit_structure`] estimates one structure by separable least squares, [`cross_validate`] tells
//! how well it predicts what it has not seen, [`growth`] says which to compare, [`choose`] decides.
//!
//! [`closed_loop`] runs an axis under the controller that made a recording.
//!
//! The sign is that of the sampled velocity: when a reversal happens is known to one sample, and a
//! curve near rest with a small `v_s` may follow the rest.
//!
//! What motion and driving force cannot tell: a delay of the actuator from a lead of the position
//! sensor; a gain error of the force scale from all other forces at once (only ratios to the gain
//! are known); the half sample that a held output adds to the delay from the drive's own.

mod alike;
mod at_bound;
mod bristle;
mod choice;
pub mod closed_loop;
mod cross_validation;
mod curved;
mod damped;
mod dip;
mod doubts;
mod elsewhere;
mod fit;
mod friction_curve;
pub mod growth;
mod lag;
mod late;
mod left_out;
mod naming;
mod parts;
mod profile;
mod projection;
mod regressors;
mod rivals;
mod rows;
mod said;
mod search;
mod shape;
mod sliding;
mod stability;
mod start;
mod unseen;
mod waves;

pub use crate::structure::{AxisStructure, UnknownStructure};
pub use choice::{Choice, Ranked, choose};
pub use cross_validation::{
    CrossValidation, Elsewhere, FirstSpeeds, blocks_for, cross_validate, cross_validate_beside,
};
pub use fit::{StructureFit, fit_structure, fit_validated};
pub use naming::AxisUnits;
pub(crate) use rows::{read as read_between, rows_of};
pub(crate) use shape::LONGEST_DELAY;
pub use shape::{Late, PositionScale, Shape};

#[cfg(test)]
mod tests;
