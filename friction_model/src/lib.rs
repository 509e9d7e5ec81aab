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
//! Conventions: `v` is the relative velocity, `z` the bristle deflection, and the friction `F`
//! *opposes* motion, so that `m x'' = F_e - F`. Quantities are SI: N, m, s for linear examples and
//! N m, rad, s for the test bed; the formulas are the same. Equation numbers in the model files are
//! those of the 2017 thesis on position and velocity drives subject to friction (A. C. Nnaji), with
//! its misprints corrected where a file says so.

#![cfg_attr(not(feature = "std"), no_std)]

// The macros name this crate as others do, in it and outside it.
extern crate self as friction_model;

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
mod elasto_plastic;
mod elements;
mod error;
mod gms;
mod hysteresis;
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
mod rate_dependent_stiction;
mod rbf_network;
mod real;
mod reset_integrator;
pub mod rk4;
mod stepper;
mod stiction;
mod stribeck;
mod stribeck_curve;
mod two_line;
mod virgin_curve;
mod viscous;
mod wojewoda;
mod xiong;

pub use armstrong::{Armstrong, ArmstrongMemory, ArmstrongParameters};
pub use asymmetric::Asymmetric;
pub use bengisu_akay::{BengisuAkay, BengisuAkayParameters};
pub use bliman_sorine::{BlimanSorine, BlimanSorineParameters};
pub use body::{Body, Drive, Moment};
pub use bristle::{Bristle, BristleMemory, BristleParameters, MAX_BONDS};
pub use catalogue::{
    AnyModel, AnyParameters, AnyStepper, AsymmetricModel, AsymmetricParameters, AsymmetricStepper,
    BothWays, ModelName, ModelVisitor,
};
pub use coulomb::{Coulomb, CoulombParameters};
pub use coulomb_viscous::{CoulombViscous, CoulombViscousParameters};
pub use dahl::{Dahl, DahlParameters};
pub use elasto_plastic::{ElastoPlastic, ElastoPlasticParameters};
pub use elements::Elements;
pub use error::ModelError;
pub use gms::{Gms, GmsParameters};
pub use hysteresis::{Hysteresis, VirginCurve};
pub use karnopp::{Karnopp, KarnoppParameters};
pub use leuven::{Leuven, LeuvenParameters};
pub use load_dependent::LoadDependent;
pub use lugre::{LuGre, LuGreParameters};
pub use model::{
    ContinuousState, Evaluation, FrictionModel, FromParameters, Holding, Internals, MAX_SPEED,
    Regime, State, TimeStep,
};
pub use motor::{Motor, MotorError, TorqueSource};
pub use parameter::{Parameter, ParameterSet, Range, Unit, Value};
pub use proposed::{Branch, NonDrift, Proposed, ProposedDiscrete, ProposedParameters};
pub use proposed_linear::ProposedLinear;
pub use rate_dependent_stiction::{RateDependentStiction, RateDependentStictionParameters};
pub use rbf_network::{RbfNetwork, RbfNetworkParameters};
pub use real::{Cast, Real};
pub use reset_integrator::{ResetIntegrator, ResetIntegratorParameters};
pub use stepper::Stepper;
pub use stiction::{Stiction, StictionParameters};
pub use stribeck::{Stribeck, StribeckParameters};
pub use stribeck_curve::StribeckCurve;
pub use two_line::{TwoLine, TwoLineParameters};
pub use virgin_curve::{Line, Sine};
pub use viscous::{Viscous, ViscousParameters};
pub use wojewoda::{Wojewoda, WojewodaMemory, WojewodaParameters};
pub use xiong::{Xiong, XiongDiscrete, XiongParameters};
