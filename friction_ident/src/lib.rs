#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! * [`conditioning`]: from sampled position and force to velocity, acceleration and force without
//!   phase shift.
//! * [`rigid_axis`]: inertia, viscous and Coulomb friction of a driven axis by linear least
//!   squares.
//! * [`axis_structure`]: the same axis with the structure of its friction chosen by
//!   cross-validation.
//! * [`adequacy`]: whether such a model explains the recording, or lacks something.
//! * [`drive`]: gain, time constant, delay, deadband and inertia of a motor from its voltage and
//!   motion.
//! * [`static_curve`]: the Stribeck curve through steady points (velocity, torque) by nonlinear
//!   least squares.
//! * [`torque_source`]: friction torque from a sensor, or from a motor's voltage or current, with
//!   its uncertainty.
//! * [`two_line`]: two straight lines through steady points by linear least squares.
//! * [`pre_sliding`]: stiffness, breakaway displacement and level from slow paths of displacement
//!   and torque.
//! * [`micro_damping`]: the micro-damping that a chosen damping ratio asks for.
//! * [`frictional_lag`]: the lag, from sliding in one direction at varying speed.
//! * [`quantiser`]: the step of an encoder, and the path between its counts.
//! * [`rbf_network`]: a network of radial basis functions through steady points by linear least
//!   squares.
//! * [`zero_phase`]: the low-pass filters behind the conditioning.
//! * [`bounded`]: nonlinear least squares within bounds.
//! * [`estimate`]: a parameter with its error, interval and verdict.
//! * [`derived`]: parameters computed from estimated ones, with their errors.
//! * [`residual_whiteness`]: how many independent samples a residual is worth.
//! * [`robust_covariance`]: standard errors under coloured residuals and model error.
//! * [`free_parameters`]: which numbers of a model are estimated, in which coordinates.
//! * [`ParameterId`]: which number of a model is meant.
//! * [`stretch`]: pieces of a recording of friction, and what each shows.
//! * [`model_choice`]: which of several models to use.
//! * [`output_error`]: any model fitted to any motion.
//! * [`staged`]: a model with all its parameters, stage by stage.
//! * [`starting_model`]: where the searches begin.
//! * [`damped_model`]: a model with its micro-damping computed from the inertia.
//! * [`motion_band`]: up to which frequency a recorded position is motion.
//! * [`position_load`]: what acts beside friction: an offset, a spring, gravity.
//! * [`posterior`]: parameters drawn together, as likely as the recordings leave them.
//! * [`uncertain`]: a number and its standard error.
//! * [`information`]: information criteria, and which of two models predicts better.
//! * [`synthetic`]: what the experiments show of a known friction.
//! * [`truth_matrix`]: which model fits the friction of which.
//! * [`profile`]: confidence intervals from the profile of the likelihood.
//! * [`servo`]: a position-controlled servo with a pendulum, its friction by search over
//!   simulations.
//! * [`stiction_cycle`]: friction in volts from an axis that sticks and slips.
//! * [`cma_es`]: search without derivatives.
//! * [`savitzky_golay`]: smoothing and differentiation by local polynomials.
//! * [`outliers`]: samples that cannot be true, replaced and reported.
//! * [`statistics`]: quantiles, means and scatter, Student's factor between an error and an interval.

#![deny(rustdoc::broken_intra_doc_links)]

pub mod adequacy;
pub mod axis_structure;
mod axis_term;
pub mod bounded;
pub mod cma_es;
pub mod conditioning;
pub mod damped_model;
pub mod derived;
pub mod drift;
pub mod drive;
mod error;
pub mod estimate;
mod finite;
pub mod free_parameters;
pub mod frictional_lag;
pub mod information;
mod least_squares;
pub mod micro_damping;
pub mod model_choice;
pub mod motion_band;
pub mod near_rest;
pub mod one_speed;
pub mod outliers;
pub mod output_error;
mod parameter_id;
mod place;
pub mod position_load;
pub mod posterior;
pub mod pre_sliding;
pub mod profile;
pub mod quantiser;
pub mod rbf_network;
pub mod residual_whiteness;
mod rest;
pub mod rigid_axis;
pub mod robust_covariance;
pub mod savitzky_golay;
pub mod servo;
pub mod staged;
pub mod starting_model;
pub mod static_curve;
pub mod statistics;
mod steady_point;
pub mod stiction_cycle;
pub mod stretch;
mod structure;
pub mod synthetic;
pub mod torque_source;
mod trust_region;
pub mod truth_matrix;
pub mod two_line;
pub mod uncertain;
pub mod zero_phase;

pub use axis_term::AxisTerm;
pub use bounded::Ending;
pub use conditioning::{
    Conditioned, Conditioning, Differences, Rest, Signals, condition, condition_stretches,
};
pub use error::IdentError;
pub use estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Unknown, Verdict};
pub use free_parameters::FreeParameters;
pub use outliers::{Cleaned, Hampel, Replaced};
pub use output_error::{Measured, OutputErrorFit, Predictor, fit_output_error};
pub use parameter_id::{ParameterId, Side};
pub use place::Place;
pub use position_load::{LoadShape, PositionLoad};
pub use rbf_network::{Centres, RbfFit, RbfOptions, train_rbf_network};
pub use rigid_axis::{
    AxisFit, AxisModel, Load, LoadChoice, Prediction, TermEstimate, choose_load, fit_axis,
    fit_axis_freely,
};
pub use savitzky_golay::SavitzkyGolay;
pub use staged::{
    FrictionData, Identified, Stage, StagedOptions, choose_position_load, identify_model,
    refine_jointly,
};
pub use static_curve::{
    SteadyPoint, StribeckEstimate, StribeckFit, StribeckOptions, StribeckParameter, StribeckValues,
    Unidentifiable, fit_stribeck,
};
pub use stretch::{Stretch, StretchKind};
pub use torque_source::{
    ChannelDeviations, ConstantError, DriveConstant, DriveConstants, DriveSignals, FrictionTorque,
    TorqueSource, friction_torque,
};
pub use two_line::{TwoLineFit, fit_two_line};
pub use uncertain::Uncertain;
