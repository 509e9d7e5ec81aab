//! Friction parameters from recordings: conditioning, least squares, uncertainty.
//!
//! The crate is pure: it sees arrays of numbers and returns numbers. Reading files is somebody else's work.
//!
//! * [`conditioning`]: from sampled position and force to velocity, acceleration and force without phase shift.
//! * [`rigid_axis`]: inertia, viscous and Coulomb friction of a driven axis by linear least squares.
//! * [`static_curve`]: the Stribeck curve through steady points (velocity, torque) by nonlinear least squares.
//! * [`two_line`]: two straight lines through steady points by linear least squares.
//! * [`pre_sliding`]: stiffness, breakaway displacement and level from slow paths of displacement and torque.
//! * [`micro_damping`]: the micro-damping that a chosen damping ratio asks for.
//! * [`frictional_lag`]: the lag, from sliding in one direction at varying speed.
//! * [`quantiser`]: the path between the counts of an encoder.
//! * [`rbf_network`]: a network of radial basis functions through steady points by linear least squares.
//! * [`zero_phase`]: the low-pass filters behind the conditioning.
//! * [`bounded`]: nonlinear least squares within bounds.
//! * [`estimate`]: a parameter with its error, interval and verdict.
//! * [`derived`]: parameters computed from estimated ones, with their errors.
//! * [`residual_whiteness`]: how many independent samples a residual is worth.
//! * [`profile`]: confidence intervals from the profile of the likelihood.
//! * [`confidence`]: Student's quantile, the factor between a standard error and an interval.

pub mod bounded;
pub mod conditioning;
pub mod confidence;
pub mod derived;
mod error;
pub mod estimate;
pub mod frictional_lag;
mod least_squares;
pub mod micro_damping;
pub mod pre_sliding;
pub mod profile;
pub mod quantiser;
pub mod rbf_network;
pub mod residual_whiteness;
pub mod rigid_axis;
pub mod static_curve;
mod steady_point;
pub mod two_line;
pub mod zero_phase;

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
