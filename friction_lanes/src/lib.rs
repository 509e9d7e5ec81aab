//! Many parameter sets of one friction model along one motion, sixteen at once.
//!
//! A lane is one set: its parameters and its state. The lanes of a block are stepped together by
//! loops without a branch or a call, which the compiler makes into the widest instructions that the
//! processor has; they are chosen when the program runs. Thousands of sets are one call of
//! [`forces`], which callers may spread over threads.
//!
//! ```
//! use friction_lanes::forces;
//! use friction_model::{AnyModel, ModelName, Scheme, TimeStep};
//!
//! let model = AnyModel::test_bed(ModelName::Proposed);
//! let models: Vec<_> = (1..=20)
//!     .map(|k| model.scaled("sigma", 0.1 * f64::from(k)))
//!     .collect::<Result<_, _>>()?;
//! let velocity: Vec<f64> = (0..500).map(|k| 0.3 * (0.02 * f64::from(k)).sin()).collect();
//! let mut rows = vec![0.0; models.len() * velocity.len()];
//! let how = (TimeStep::new(1e-3)?, Scheme::Mean);
//! forces(&models, &velocity, how, &mut rows, || false);
//! // The friction [N m] of the third set at the last velocity.
//! assert!(rows[3 * velocity.len() - 1].is_finite());
//! # Ok::<(), friction_model::ModelError>(())
//! ```
//!
//! # How exact
//! A lane computes what [`Stepper`](friction_model::Stepper) does, in the same order. Exponentials,
//! sines and powers are not the standard library's ([`elementary`]), but agree with those to rounding,
//! and so do the forces. Only where a switch stands at its threshold to the last digit does rounding
//! decide when it is thrown, in lanes as in the scalar step: an element of GMS that begins to slip,
//! and the deflection of the proposed model that turns back.

/// The code in the README is run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod along;
mod block;
mod contact;
mod curve;
pub mod elementary;
mod gms;
mod lugre;
mod proposed;
mod xiong;

pub use along::{WIDTH, forces};
