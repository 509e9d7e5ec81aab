//! Why nothing is exported, in a sentence.

use friction_model::ModelError;

use crate::shown::Shown;
use crate::{NotAVersion, Target, Version};

/// Nothing is exported.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// A name that is no target's.
    #[error("there is no target `{name}`; expected one of {}", Target::list())]
    Target {
        /// The name.
        name: String,
    },
    /// A version that is no number.
    #[error(transparent)]
    NotAVersion(#[from] NotAVersion),
    /// A version from before anything was known of the target, or after.
    #[error(
        "{target} {version} is not known here; known are {first} to {last}{}",
        if version > last { ": what a newer version changed is not known, so ask for the newest known and check" } else { "" }
    )]
    Version {
        /// The target.
        target: Target,
        /// The version asked for.
        version: Version,
        /// The earliest known.
        first: Version,
        /// The latest known.
        last: Version,
    },
    /// That version of the target holds no friction as a torque.
    #[error("{target} {version} cannot hold this friction: {why}")]
    NoFriction {
        /// The target.
        target: Target,
        /// Its version.
        version: Version,
        /// Why.
        why: &'static str,
    },
    /// Speeds that are no range.
    #[error(
        "the speeds must go from LOW to HIGH with 0 <= LOW <= HIGH, HIGH above 0 and at most 1e6, but are {low} to {high}"
    )]
    Speeds {
        /// The lowest.
        low: f64,
        /// The highest.
        high: f64,
    },
    /// The name of a joint that would not be one in the file.
    #[error(
        "a name in the target must be letters, digits, `_`, `-`, `.` and `/`, and begin with a letter or `_`, but is `{name}`"
    )]
    Joint {
        /// The name.
        name: String,
    },
    /// A number that cannot be.
    #[error("{what} must be {expected}, but is {value}")]
    Value {
        /// Which.
        what: &'static str,
        /// What it must be.
        expected: &'static str,
        /// What came.
        value: f64,
    },
    /// Something that this target needs is missing.
    #[error("{target} needs {what}")]
    Needs {
        /// The target.
        target: Target,
        /// What, and how to give it.
        what: &'static str,
    },
    /// Something was given that this target has no place for.
    #[error("{target} has no place for {what}; leave it out")]
    NoPlace {
        /// The target.
        target: Target,
        /// What was given.
        what: &'static str,
    },
    /// Friction in volts.
    #[error(
        "the friction in this file is in volts, and {target} takes N m; identify it with the motor's constants (--torque-source voltage), or export to ks_kv_ka, which takes volts"
    )]
    Volts {
        /// The target.
        target: Target,
    },
    /// Friction that drives.
    #[error(
        "the friction at {} is {}: it would drive the axis and not brake it, so no target gets it",
        Shown(*velocity),
        Shown(*friction)
    )]
    Negative {
        /// The speed \[rad/s or m/s\], with its sign.
        velocity: f64,
        /// The friction \[N m or N\] there.
        friction: f64,
    },
    /// Parameters that were never identified.
    #[error(
        "{} never identified: {}; identify with recordings that show it, or accept it as it stands (--accept-unidentified), which the file will then say",
        if doubts.len() == 1 { "a parameter was" } else { "parameters were" },
        doubts.join("; ")
    )]
    Unidentified {
        /// Each with what the file says of it.
        doubts: Vec<String>,
    },
    /// The target's friction is too far from the identified one.
    #[error(
        "{target} {version} would be wrong by {} % of the Coulomb level {part} (the bar is {bar} %), because it cannot hold {lost}; choose a target that holds it, narrow the range of speeds, or accept it (--accept-error), which the file will then say",
        Shown(*percent)
    )]
    Misleading {
        /// The target.
        target: Target,
        /// Its version.
        version: Version,
        /// Root mean square error \[% of the Coulomb level\].
        percent: f64,
        /// The largest that is exported unasked \[%\].
        bar: f64,
        /// Along what.
        part: &'static str,
        /// What is lost.
        lost: String,
    },
    /// Parameters that no model takes.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A model that gives no number somewhere.
    #[error("the model gives no finite friction at {} of the range of speeds", Shown(*velocity))]
    NotFinite {
        /// The speed, with its sign.
        velocity: f64,
    },
}
