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
//! * [`free_parameters`]: which numbers of a model are estimated, in which coordinates.
//! * [`stretch`]: pieces of a recording of friction, and what each shows.
//! * [`output_error`]: any model fitted to any motion.
//! * [`staged`]: a model with all its parameters, stage by stage.
//! * [`starting_model`]: where the searches begin.
//! * [`micro_damping`]: damping computed from the inertia.
//! * [`information`]: information criteria, and which of two models predicts better.
//! * [`savitzky_golay`]: smoothing and differentiation by local polynomials.
//! * [`encoder_steps`]: a position from between the steps of an encoder.
//! * [`outliers`]: samples that cannot be true, replaced and reported.
//! * [`confidence`]: Student's quantile, the factor between a standard error and an interval.

pub mod bounded;
pub mod conditioning;
pub mod confidence;
pub mod encoder_steps;
mod error;
pub mod estimate;
pub mod free_parameters;
pub mod information;
mod least_squares;
pub mod micro_damping;
pub mod outliers;
pub mod output_error;
pub mod rbf_network;
pub mod residual_whiteness;
pub mod rigid_axis;
pub mod savitzky_golay;
pub mod staged;
pub mod starting_model;
pub mod static_curve;
mod steady_point;
pub mod stretch;
pub mod two_line;
pub mod zero_phase;

pub use conditioning::{Conditioned, Conditioning, Signals, condition};
pub use error::IdentError;
pub use estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Unknown, Verdict};
pub use free_parameters::FreeParameters;
pub use outliers::{Cleaned, Hampel, Replaced};
pub use output_error::{Measured, OutputErrorFit, fit_output_error};
pub use rbf_network::{Centres, RbfFit, RbfOptions, train_rbf_network};
pub use rigid_axis::{AxisFit, AxisModel, AxisTerm, Prediction, TermEstimate, fit_axis};
pub use savitzky_golay::SavitzkyGolay;
pub use staged::{FrictionData, Given, Identified, Stage, StagedOptions, identify_model};
pub use static_curve::{
    SteadyPoint, StribeckEstimate, StribeckFit, StribeckOptions, StribeckParameter, StribeckValues,
    Unidentifiable, fit_stribeck,
};
pub use stretch::{Stretch, StretchKind};
pub use two_line::{TwoLineFit, fit_two_line};
