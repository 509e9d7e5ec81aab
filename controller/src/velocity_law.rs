//! Which linear law regulates velocity, chosen in the parameters.

use serde::{Deserialize, Serialize};

use crate::{ControllerError, LagCompensator, LagGains, PiController, PiGains};

/// The linear law of velocity with its gains.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, strum::EnumDiscriminants)]
#[serde(rename_all = "snake_case")]
#[strum_discriminants(
    name(VelocityLawName),
    doc = "Which linear law of velocity, without its gains.",
    derive(strum::EnumString, strum::IntoStaticStr, strum::VariantNames),
    strum(serialize_all = "snake_case")
)]
pub enum VelocityLaw {
    /// Lag compensator: a stated error remains of a constant reference.
    Lag(LagGains),
    /// PI: no error remains of a constant reference.
    Pi(PiGains),
}

impl Default for VelocityLaw {
    /// The thesis's lag compensator.
    fn default() -> Self {
        Self::Lag(LagGains::THESIS)
    }
}

/// A velocity law running at a fixed period.
#[derive(Debug, Clone)]
pub(crate) enum VelocityController {
    Lag(LagCompensator),
    Pi(PiController),
}

impl VelocityController {
    pub(crate) fn new(law: VelocityLaw, dt: f64) -> Result<Self, ControllerError> {
        Ok(match law {
            VelocityLaw::Lag(gains) => Self::Lag(LagCompensator::new(gains, dt)?),
            VelocityLaw::Pi(gains) => Self::Pi(PiController::new(gains, dt)?),
        })
    }

    #[inline]
    pub(crate) fn output(&self, error: f64) -> f64 {
        match self {
            Self::Lag(lag) => lag.output(error),
            Self::Pi(pi) => pi.output(error),
        }
    }

    #[inline]
    pub(crate) fn update(&mut self, error: f64, limited: f64) {
        match self {
            Self::Lag(lag) => lag.update(error, limited),
            Self::Pi(pi) => pi.update(error, limited),
        }
    }

    pub(crate) fn preload(&mut self, output: f64, error: f64) {
        match self {
            Self::Lag(lag) => lag.preload(output, error),
            Self::Pi(pi) => pi.preload(output, error),
        }
    }

    pub(crate) fn reset(&mut self) {
        match self {
            Self::Lag(lag) => lag.reset(),
            Self::Pi(pi) => pi.reset(),
        }
    }
}
