//! What is decided on the way: where the micro-damping comes from, and the exponent of the dip.

use friction_model::{AnyModel, ModelName};

/// Where the joint refinement has the micro-damping from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Damping {
    /// It stays what was computed.
    Computed,
    /// It is one of the free parameters.
    Estimated,
    /// It was computed, and is estimated where the recordings contradict that.
    Either,
}

/// What is known of the exponent of the dip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Exponent {
    /// Nothing was asked.
    NotAsked,
    /// The points leave the usual one open.
    Usual,
    /// The points refuse the usual one.
    Other,
}

impl Exponent {
    /// Where its value comes from, in words.
    pub fn source(self) -> &'static str {
        match self {
            Self::NotAsked => {
                "the usual exponent: only steady points through a dip are asked for another"
            }
            Self::Usual => "the usual exponent, which the steady points leave open",
            Self::Other => "the exponent with which the steady points fit best",
        }
    }
}

/// Whether the model has an exponent of the dip. Dahl's is another: the shape of its stress-strain
/// curve.
pub(super) fn has_exponent(name: ModelName) -> bool {
    name != ModelName::Dahl && AnyModel::test_bed(name).parameter("delta").is_some()
}
