//! How the friction torque is estimated.

use serde::{Deserialize, Serialize};

use crate::ObserverError;
use crate::error::within;

/// Where the estimate comes from.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Technique {
    /// A model driven by the measured velocity (thesis section 5.2).
    #[default]
    Feedback,
    /// A model driven by the velocity that the reference asks for: knows the friction before the shaft moves, and nothing of what it really does.
    Feedforward,
    /// Both of them, weighted.
    Both {
        /// Weight of the feedforward estimate, from 0 to 1; the feedback estimate has the rest.
        share: f64,
    },
}

impl Technique {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the field.
    pub fn check(&self) -> Result<(), ObserverError> {
        match self {
            Self::Feedback | Self::Feedforward => Ok(()),
            Self::Both { share } => within("share", *share, 0.0..=1.0, "from 0 to 1"),
        }
    }
}
