//! Friction parameters from recordings: conditioning, least squares, uncertainty.
//!
//! The crate is pure: it sees arrays of numbers and returns numbers. Reading files is somebody else's work.
//!
//! * [`conditioning`]: from sampled position and force to velocity, acceleration and force without phase shift.
//! * [`rigid_axis`]: inertia, viscous and Coulomb friction of a driven axis by linear least squares.
//! * [`static_curve`]: the Stribeck curve through steady points (velocity, torque) by nonlinear least squares.
//! * [`torque_source`]: friction torque from a sensor, or from a motor's voltage or current, with its uncertainty.
//! * [`two_line`]: two straight lines through steady points by linear least squares.
//! * [`rbf_network`]: a network of radial basis functions through steady points by linear least squares.
//! * [`zero_phase`]: the low-pass filters behind the conditioning.
//! * [`confidence`]: Student's quantile, the factor between a standard error and an interval.

pub mod conditioning;
pub mod confidence;
mod error;
mod least_squares;
pub mod rbf_network;
pub mod rigid_axis;
pub mod static_curve;
mod steady_point;
pub mod torque_source;
pub mod two_line;
pub mod zero_phase;

pub use conditioning::{Conditioned, Conditioning, Signals, condition};
pub use error::IdentError;
pub use rbf_network::{Centres, RbfFit, RbfOptions, train_rbf_network};
pub use rigid_axis::{AxisFit, AxisModel, AxisTerm, Prediction, TermEstimate, fit_axis};
pub use static_curve::{
    SteadyPoint, StribeckEstimate, StribeckFit, StribeckOptions, StribeckParameter, StribeckValues,
    Unidentifiable, fit_stribeck,
};
pub use torque_source::{
    ChannelDeviations, ConstantError, DriveConstant, DriveConstants, DriveSignals, FrictionTorque,
    TorqueSource, Uncertain, friction_torque,
};
pub use two_line::{TwoLineFit, fit_two_line};
