//! The address of a rig: `simulated`, `quanser:0`, `serial:/dev/ttyACM0`.

use std::fmt;
use std::sync::Arc;

use serde::{Serialize, Serializer};

use super::{Opened, Pace};
use crate::back_end::{BackEnd, RigFactory, RigSetup};
use crate::simulated::SimulatedFactory;
use crate::{Calibrated, Rig, RigError};

/// Which rig: its kind, and which of that kind.
#[derive(Clone)]
pub struct RigAddress {
    factory: Arc<dyn RigFactory>,
    place: Option<String>,
}

/// A text that names no rig.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is no rig: {why}; expected {expected}")]
pub struct AddressError {
    /// What came.
    pub text: String,
    /// What is wrong with it.
    pub why: String,
    /// What there is.
    pub expected: String,
}

impl RigAddress {
    pub(super) fn new(factory: Arc<dyn RigFactory>, place: Option<String>) -> Self {
        Self { factory, place }
    }

    /// The simulated test bed.
    #[must_use]
    pub fn simulated() -> Self {
        Self::new(Arc::new(SimulatedFactory), None)
    }

    /// Name of its kind, as `serial`.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        self.factory.name()
    }

    /// What stands behind the colon.
    #[must_use]
    pub fn place(&self) -> Option<&str> {
        self.place.as_deref()
    }

    /// Whether the rig is simulated.
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        self.factory.is_simulated()
    }

    /// Whether an explicit sequence may open it anew by itself after its line failed.
    #[must_use]
    pub fn comes_back(&self) -> bool {
        self.factory.comes_back()
    }

    /// Opens the rig with the motor at zero volts, corrected by the calibration of `setup`, with the
    /// limits that belong to it.
    ///
    /// # Errors
    /// [`RigError`] says what is missing or refused.
    pub fn open(&self, setup: &RigSetup) -> Result<Opened, RigError> {
        let BackEnd { rig, limits, sensors, about, description } =
            self.factory.open(self.place(), setup)?;
        let limits = setup.limits.on(limits, rig.voltage_range(), self.is_simulated())?;
        let pace = match (self.is_simulated(), rig.keeps_time()) {
            (true, _) => Pace::LockStep,
            (false, true) => Pace::Device,
            (false, false) => Pace::Clock,
        };
        let rig: Box<dyn Rig + Send> = match setup.calibration {
            Some(calibration) => Box::new(Calibrated::new(rig, calibration)?),
            None => rig,
        };
        Ok(Opened { rig, limits, pace, sensors, about, description })
    }
}

impl fmt::Display for RigAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.kind())?;
        self.place.as_ref().map_or(Ok(()), |place| write!(f, ":{place}"))
    }
}

impl fmt::Debug for RigAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RigAddress({self})")
    }
}

impl PartialEq for RigAddress {
    fn eq(&self, other: &Self) -> bool {
        (self.kind(), &self.place) == (other.kind(), &other.place)
    }
}

impl Eq for RigAddress {}

impl Serialize for RigAddress {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}
