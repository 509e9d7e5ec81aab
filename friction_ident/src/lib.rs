//! Friction parameters from recordings: conditioning, least squares, uncertainty.
//!
//! The crate is pure: it sees arrays of numbers and returns numbers. Reading files is somebody else's work.
//!
//! * [`conditioning`]: from sampled position and force to velocity, acceleration and force without phase shift.
//! * [`rigid_axis`]: inertia, viscous and Coulomb friction of a driven axis by linear least squares.
//! * [`static_curve`]: the Stribeck curve through steady points (velocity, torque) by nonlinear least squares.
//! * [`two_line`]: two straight lines through steady points by linear least squares.
//! * [`rbf_network`]: a network of radial basis functions through steady points by linear least squares.
//! * [`zero_phase`]: the low-pass filters behind the conditioning.
//! * [`bounded`]: nonlinear least squares within bounds.
//! * [`estimate`]: a parameter with its error, interval and verdict.
//! * [`residual_whiteness`]: how many independent samples a residual is worth.
//! * [`servo`]: a position-controlled servo with a pendulum, its friction by search over simulations.
//! * [`stiction_cycle`]: friction in volts from an axis that sticks and slips.
//! * [`cma_es`]: search without derivatives.
//! * [`confidence`]: Student's quantile, the factor between a standard error and an interval.

pub mod bounded;
pub mod cma_es;
pub mod conditioning;
pub mod confidence;
mod error;
pub mod estimate;
mod least_squares;
pub mod rbf_network;
pub mod residual_whiteness;
pub mod rigid_axis;
pub mod servo;
pub mod static_curve;
mod steady_point;
pub mod stiction_cycle;
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
