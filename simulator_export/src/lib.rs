//! Identified friction as the configuration of simulators, robots and firmware.
//!
//! Text in, text out: [`Given`] is the friction of one joint with what its parameter file says of
//! it, [`export`] writes it for a [`Target`] in one of its versions. Each file says who wrote it,
//! from what, for which version, what the target cannot hold, and the torque error that this costs
//! over the identified range of speeds ([`Cost`]). What would mislead is a [`Refusal`].
//!
//! ```
//! use friction_model::{AnyModel, ModelName};
//! use simulator_export::{Given, Options, Refusal, Target, export};
//!
//! let model = AnyModel::test_bed(ModelName::LuGre);
//! let file = "# Speeds of the recordings: 0.05 to 3.0 rad/s\nlugre: {}\n";
//! let given = Given::new(model, "parameters.yaml", file, None, None)?;
//! // The file does not say that anybody identified these numbers.
//! let refused = export(&given, Target::Mjcf, None, &Options::default());
//! assert!(matches!(refused, Err(Refusal::Unidentified { .. })));
//!
//! let options = Options { accept_unidentified: true, ..Options::default() };
//! let exported = export(&given, Target::Mjcf, None, &options)?;
//! assert!(exported.text.contains("<dcmotor"));
//! assert_eq!(exported.cost.sliding.rms, 0.0);
//! # Ok::<(), Refusal>(())
//! ```
//!
//! | what | where |
//! |---|---|
//! | targets, versions, what each holds | [`Target`], [`Release`], [`Holds`] |
//! | comments of parameter files | [`annotations`] |
//! | the friction that a target computes | [`Contact`] |
//! | what a conversion costs | [`Cost`] |
//!
//! The crate reads no files and knows no clock.

/// The code in the README is run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod annotations;
mod axis;
mod choice;
mod contact;
mod cost;
mod export;
mod facts;
mod fit;
mod formats;
mod given;
mod head;
mod lost;
mod options;
mod refusal;
mod shown;
mod speeds;
mod target;
mod version;

pub use axis::Axis;
pub use choice::{release, target};
pub use contact::Contact;
pub use cost::{Cost, Errors};
pub use export::{Exported, SLIDING_BAR, SWINGS_BAR, export};
pub use facts::{Facts, Holds, Release};
pub use given::{Cogging, Given, Source};
pub use options::{Motor, Options, Reference, Volts};
pub use refusal::Refusal;
pub use speeds::{Speeds, SpeedsFrom};
pub use target::Target;
pub use version::{NotAVersion, Version};
