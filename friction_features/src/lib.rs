//! What tells friction models apart, computed.
//!
//! Each feature is an experiment with any model of the catalogue: a struct of settings with the
//! protocol of the thesis as its default, a function, and a result with figures, thinned curves to
//! draw, and the [`Evidence`] for the figures: the integration step, and what halving it last
//! changed.
//!
//! | feature | experiment | tells |
//! |---|---|---|
//! | [`stick_slip()`] | a mass pulled by a spring at constant speed | whether sliding is smooth, period and size of the jumps |
//! | [`non_drift()`] | a small oscillating load below breakaway | whether the contact creeps away |
//! | [`non_local_memory()`] | nested loops in pre-sliding | whether they close, are forgotten, and are congruent |
//! | [`breakaway()`] | a load that rises at a constant rate | static friction, its displacement, and how it depends on the rate |
//! | [`frictional_lag()`] | forward motion at changing speed | the loop of friction against velocity |
//! | [`steady_state()`] | constant speeds | the Stribeck curve, reached by both forms of a model |
//! | [`zero_crossing()`] | a reversal at constant acceleration | how friction changes sign |
//! | [`sensitivity()`] | half and twice each parameter | which parameters matter, and how much |
//! | [`describing_function`] | sinusoidal displacement | the first harmonic |
//! | [`limit_cycle`] | a position loop with integral action | hunting |
//!
//! A model that cannot show a feature says so: an `Option` is `None`, or the number is exactly
//! zero. [`features()`] does all but the last two at once.
//!
//! The crate is pure and deterministic: no files, clocks or threads. [`Contact`] hides a model's
//! type, so an experiment is compiled once. [`TimeScales`] gives the step that step halving
//! ([`settle()`]) starts with.
//!
//! ```
//! use friction_features::{Contact, Motion, StickSlipSettings, stick_slip};
//! use friction_model::{AnyModel, ModelName};
//!
//! let contact = Contact::new(&AnyModel::chapter_3(ModelName::Proposed));
//! let result = stick_slip(&contact, &StickSlipSettings::default());
//! assert_eq!(result.motion, Motion::StickSlip);
//! assert!((result.period.unwrap() - 7.9275).abs() < 1e-3);
//! ```

#![deny(rustdoc::broken_intra_doc_links)]

/// The code in the README is run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod breakaway;
mod contact;
pub mod describing_function;
mod features;
mod frictional_lag;
pub mod limit_cycle;
mod non_drift;
mod non_local_memory;
mod sensitivity;
mod settle;
mod steady_state;
mod stick_slip;
mod thinned;
mod time_scales;
mod zero_crossing;

pub use breakaway::{Breakaway, BreakawayCourse, BreakawaySettings, breakaway};
pub use contact::{Contact, FreeBody, Prescribed};
pub use features::{FeatureFigure, FeatureSettings, Features, features};
pub use frictional_lag::{
    FrictionalLag, FrictionalLagCourse, FrictionalLagSettings, frictional_lag,
};
pub use non_drift::{NonDrift, NonDriftCourse, NonDriftSettings, non_drift};
pub use non_local_memory::{
    NonLocalMemory, NonLocalMemoryCourse, NonLocalMemorySettings, non_local_memory,
};
pub use sensitivity::{
    Elasticities, ParameterSensitivity, Response, Sensitivity, SensitivitySettings, sensitivity,
};
pub use settle::{Evidence, Figure, Settling, settle};
pub use steady_state::{SteadyState, SteadyStateCurve, SteadyStateSettings, steady_state};
pub use stick_slip::{Motion, StickSlip, StickSlipCourse, StickSlipSettings, stick_slip};
pub use time_scales::TimeScales;
pub use zero_crossing::{ZeroCrossing, ZeroCrossingCourse, ZeroCrossingSettings, zero_crossing};
