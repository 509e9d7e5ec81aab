//! Friction parameters from recordings: conditioning, least squares, uncertainty.
//!
//! The crate is pure: it sees arrays of numbers and returns numbers. Reading files is somebody else's work.
//!
//! * [`conditioning`]: from sampled position and force to velocity, acceleration and force without phase shift.
//! * [`rigid_axis`]: inertia, viscous and Coulomb friction of a driven axis by linear least squares.
//! * [`axis_structure`]: the same axis with the structure of its friction chosen by cross-validation.
//! * [`drive`]: gain, time constant, delay, deadband and inertia of a motor from its voltage and motion.
//! * [`static_curve`]: the Stribeck curve through steady points (velocity, torque) by nonlinear least squares.
//! * [`two_line`]: two straight lines through steady points by linear least squares.
//! * [`rbf_network`]: a network of radial basis functions through steady points by linear least squares.
//! * [`zero_phase`]: the low-pass filters behind the conditioning.
//! * [`bounded`]: nonlinear least squares within bounds.
//! * [`estimate`]: a parameter with its error, interval and verdict.
//! * [`residual_whiteness`]: how many independent samples a residual is worth.
//! * [`confidence`]: Student's quantile, the factor between a standard error and an interval.

pub mod axis_structure;
pub mod bounded;
pub mod conditioning;
pub mod confidence;
pub mod drive;
mod error;
pub mod estimate;
mod least_squares;
pub mod rbf_network;
pub mod residual_whiteness;
pub mod rigid_axis;
pub mod static_curve;
mod steady_point;
pub mod two_line;
pub mod zero_phase;

pub use bounded::Ending;
pub use conditioning::{Conditioned, Conditioning, Signals, condition};
pub use error::IdentError;
pub use estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Unknown, Verdict};
pub use rbf_network::{Centres, RbfFit, RbfOptions, train_rbf_network};
pub use rigid_axis::{AxisFit, AxisModel, AxisTerm, Prediction, TermEstimate, fit_axis};
pub use static_curve::{
    SteadyPoint, StribeckEstimate, StribeckFit, StribeckOptions, StribeckParameter, StribeckValues,
    Unidentifiable, fit_stribeck,
};
pub use two_line::{TwoLineFit, fit_two_line};
