//! A kind of rig.

use std::fmt;

use super::{RigDescription, RigSetup, SensorsPresent};
use crate::safety::SafetyLimits;
use crate::{Rig, RigError};

/// A kind of rig: how it is named, found and opened.
pub trait RigFactory: fmt::Debug + Send + Sync {
    /// The word before the colon of an address, as `serial`.
    fn name(&self) -> &'static str;

    /// What it is, in a line.
    fn about(&self) -> &'static str;

    /// What may stand behind the colon.
    fn place(&self) -> Place;

    /// The text behind the colon in its normal form, as addresses are compared and written; it
    /// fits [`place`](Self::place) already.
    ///
    /// # Errors
    /// [`PlaceError`] says what is wrong with it.
    fn normal(&self, place: &str) -> Result<String, PlaceError> {
        Ok(place.to_owned())
    }

    /// Whether the rig is simulated: in lock-step with whoever drives it, and nobody can be hurt.
    fn is_simulated(&self) -> bool {
        false
    }

    /// Whether an explicit sequence may open it anew by itself after its line failed.
    fn comes_back(&self) -> bool {
        false
    }

    /// What of this kind the machine has at the moment. Nothing is opened.
    fn listed(&self) -> Vec<Listed>;

    /// Opens the rig at `place`, in its normal form, with the motor at zero volts. Calibration and
    /// the limits of `setup` are not its business, but for a voltage limit that the back end has of
    /// its own.
    ///
    /// # Errors
    /// [`RigError`] says what is missing or refused.
    fn open(&self, place: Option<&str>, setup: &RigSetup) -> Result<BackEnd, RigError>;
}

/// What may stand behind the colon of an address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Nothing: there is one.
    None,
    /// Which one, if it is not the usual one.
    Optional {
        /// What it is, as `CARD`.
        what: &'static str,
        /// The usual one.
        usual: &'static str,
    },
    /// Which one.
    Required {
        /// What it is, as `PORT[@BAUD]`.
        what: &'static str,
        /// One for example, as `/dev/ttyACM0`.
        example: &'static str,
    },
}

/// What is wrong with the text behind the colon, in a few words.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PlaceError(pub String);

/// A rig that a factory opened, before calibration and limits.
pub struct BackEnd {
    /// The rig, its motor at zero volts.
    pub rig: Box<dyn Rig + Send>,
    /// What the safety layer usually allows on it.
    pub limits: SafetyLimits,
    /// Which sensors it has of those that a rig may lack.
    pub sensors: SensorsPresent,
    /// What a real rig says of itself, in a line.
    pub about: Option<String>,
    /// What it says of itself, number by number.
    pub description: Option<RigDescription>,
}

/// Something of a kind of rig that this machine has, or a word on why it has nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// Its address; of a kind as a whole its name.
    pub address: String,
    /// What it is.
    pub about: String,
    /// Whether it can be opened.
    pub standing: Standing,
}

/// Whether something that is listed can be opened, as far as that can be seen from outside.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Standing {
    /// Nothing is in the way.
    Ready,
    /// There is nothing of this kind.
    Absent,
    /// This user may not open it.
    Refused {
        /// What the system says.
        why: String,
        /// How to mend it.
        mend: &'static str,
    },
}

impl Listed {
    /// Something that can be opened.
    #[must_use]
    pub fn ready(address: impl Into<String>, about: impl Into<String>) -> Self {
        Self { address: address.into(), about: about.into(), standing: Standing::Ready }
    }

    /// Nothing of that kind, and why.
    #[must_use]
    pub fn absent(kind: &str, why: impl Into<String>) -> Self {
        Self { address: kind.to_owned(), about: why.into(), standing: Standing::Absent }
    }
}
