//! What friction is: every model one file, for simulation and for real time.
//!
//! A model is a value with validated parameters that implements [`FrictionModel`]. The same value
//! serves two masters:
//!
//! * a **simulator** asks for the force and the rates of the states ([`FrictionModel::evaluate`])
//!   as often as its integrator likes, and commits once an accepted step
//!   ([`FrictionModel::commit`]); [`rk4`] does that for a prescribed velocity;
//! * a **real-time observer** holds a [`Stepper`] and calls it once a period; the fixed-step form
//!   is stable at any period up to 10 ms, allocates nothing and cannot panic.
//!
//! ```
//! use friction_model::{LuGre, LuGreParameters, Stepper, TimeStep};
//!
//! // A small servo: N m, rad, s.
//! let friction = LuGre::try_from(LuGreParameters {
//!     f_s: 0.10,     // breaks away at
//!     f_c: 0.09,     // slides at
//!     v_s: 0.14,     // falls from one to the other around this speed
//!     delta: 2.0,    // shape of that fall
//!     sigma0: 16.5,  // stiffness of the bristles
//!     sigma1: 0.25,  // their damping
//!     v_d: None,
//!     f_v: 0.04,     // viscous
//! })?;
//! let mut contact = Stepper::new(friction, TimeStep::new(1e-3)?);
//! for _ in 0..1000 {
//!     contact.step(0.5);
//! }
//! let torque: f64 = contact.step(0.5);
//! assert!((torque - (0.09 + 0.04 * 0.5)).abs() < 1e-6);
//! # Ok::<(), friction_model::ModelError>(())
//! ```
//!
//! | to | see |
//! |---|---|
//! | step a model in a control loop | [`Stepper`] |
//! | integrate it under a given motion, or with a mass | [`rk4`], [`Body`] |
//! | choose a model by name while the program runs, or from a file | [`AnyModel`], [`ModelName`] |
//! | know its parameters, their units and ranges | [`ParameterSet`], [`Parameter`] |
//! | write a model of your own | [`FrictionModel`], [`parameters!`], [`memoryless!`], [`built_from!`] |
//! | give each direction its friction, or let it grow with the load | [`Asymmetric`], [`LoadDependent`] |
//! | check that it is a friction model | [`invariants`] |
//! | compute in single precision | [`Real`] |
//! | know how the friction hangs on parameters | [`Dual`], [`AnyParameters::visit_in`] |
//! | start from published values | [`presets`] |
//!
//! # Features
//! * `std` (default): the mathematics of the standard library. Without it the crate is `no_std`,
//!   allocates nothing and takes its mathematics from `libm`.
//! * `serde` (default): parameters and models from and to files.
//!
//! # Conventions
//! `v` is the relative velocity, `z` the bristle deflection, and the friction `F`
//! *opposes* motion, so that `m x'' = F_e - F`. Quantities are SI: N, m, s for linear examples and
//! N m, rad, s for the test bed; the formulas are the same. Equation numbers in the model files are
//! those of the 2017 thesis on position and velocity drives subject to friction (A. C. Nnaji), with
//! its misprints corrected where a file says so.

#![cfg_attr(not(feature = "std"), no_std)]
#![deny(rustdoc::broken_intra_doc_links)]

// The macros name this crate as others do, in it and outside it.
extern crate self as friction_model;

/// The code in the README is run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(feature = "serde")]
#[doc(hidden)]
pub use serde as __serde;

mod any_model;
pub mod arithmetic;
mod armstrong;
mod asymmetric;
mod bengisu_akay;
mod bliman_sorine;
mod body;
mod bristle;
mod catalogue;
mod coulomb;
mod coulomb_viscous;
mod dahl;
mod declaration;
mod delay_line;
mod dual;
mod elasto_plastic;
mod elements;
mod error;
mod finite;
mod gms;
mod hysteresis;
pub mod invariants;
mod karnopp;
mod leuven;
pub mod load_dependent;
mod lugre;
mod model;
pub mod motor;
mod name;
mod parameter;
pub mod presets;
mod proposed;
mod proposed_linear;
mod range;
mod rate_dependent_stiction;
mod rbf_network;
mod real;
mod reset_integrator;
pub mod rk4;
mod scheme;
mod stepper;
mod stiction;
mod stribeck;
mod stribeck_curve;
mod two_line;
mod unit;
mod value;
mod virgin_curve;
mod viscous;
mod wojewoda;
mod xiong;

pub use arithmetic::MAX_SPEED;
pub use armstrong::{Armstrong, ArmstrongMemory, ArmstrongParameters};
pub use asymmetric::Asymmetric;
pub use bengisu_akay::{BengisuAkay, BengisuAkayParameters};
pub use bliman_sorine::{BlimanSorine, BlimanSorineParameters};
pub use body::{Body, Drive, Moment};
pub use bristle::{Bristle, BristleMemory, BristleParameters, MAX_BONDS};
pub use catalogue::{
    AnyModel, AnyParameters, AnyStepper, AsymmetricModel, AsymmetricParameters, AsymmetricStepper,
    BothWays, ModelName, ModelVisitor, VisitorIn,
};
pub use coulomb::{Coulomb, CoulombParameters};
pub use coulomb_viscous::{CoulombViscous, CoulombViscousParameters};
pub use dahl::{Dahl, DahlParameters};
#[doc(hidden)]
pub use declaration::{__shown, __shown_length};
pub use dual::Dual;
pub use elasto_plastic::{ElastoPlastic, ElastoPlasticParameters};
pub use elements::Elements;
pub use error::ModelError;
pub use gms::{Gms, GmsParameters};
pub use hysteresis::{Course, Hysteresis, VirginCurve};
pub use karnopp::{Karnopp, KarnoppParameters};
pub use leuven::{Leuven, LeuvenParameters};
pub use load_dependent::LoadDependent;
pub use lugre::{LuGre, LuGreParameters};
pub use model::{
    ContinuousState, Evaluation, FrictionModel, FromParameters, Holding, Internals, Regime, State,
    TimeStep,
};
pub use motor::{Motor, MotorError, TorqueSource};
pub use parameter::{Parameter, ParameterSet};
pub use proposed::{Branch, NonDrift, Proposed, ProposedDiscrete, ProposedParameters};
pub use proposed_linear::ProposedLinear;
pub use range::Range;
pub use rate_dependent_stiction::{RateDependentStiction, RateDependentStictionParameters};
pub use rbf_network::{RbfNetwork, RbfNetworkParameters};
pub use real::{Real, Translate};
pub use reset_integrator::{ResetIntegrator, ResetIntegratorParameters};
pub use scheme::Scheme;
pub use stepper::{RunningContact, Stepper};
pub use stiction::{Stiction, StictionParameters};
pub use stribeck::{Stribeck, StribeckParameters};
pub use stribeck_curve::StribeckCurve;
pub use two_line::{TwoLine, TwoLineParameters};
pub use unit::Unit;
pub use value::Value;
pub use virgin_curve::{Line, Sine};
pub use viscous::{Viscous, ViscousParameters};
pub use wojewoda::{Wojewoda, WojewodaMemory, WojewodaParameters};
pub use xiong::{Xiong, XiongDiscrete, XiongParameters};
