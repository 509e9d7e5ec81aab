//! Everything a controller is made of.

use serde::{Deserialize, Serialize};

use crate::{
    AccelerationFeedback, ControlMode, DerivativeOn, Dither, GuardOptions, Impulse, Load, PidGains,
    PlantInverse, VelocityLaw,
};

/// Friction compensation: the observer's estimate, as volts, added to the command.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compensation {
    /// Whether friction is compensated at all.
    pub enabled: bool,
    /// Voltage that overcomes 1 N m of friction, R_a / (A K_m) \[V/(N m)\].
    pub volts_per_newton_metre: f64,
    /// Fraction of the estimate that is compensated; 1 for all of it, less for under-compensation,
    /// at most 2.
    pub scale: f64,
}

impl Compensation {
    /// Volts added per newton metre of estimated friction \[V/(N m)\].
    #[must_use]
    pub fn weight(&self) -> f64 {
        if self.enabled { self.scale * self.volts_per_newton_metre } else { 0.0 }
    }
}

/// Everything a controller is made of.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ControllerOptions {
    /// What is regulated.
    pub mode: ControlMode,
    /// Period of the control cycle \[s\].
    pub period: f64,
    /// Law and gains of the velocity controller.
    pub velocity: VelocityLaw,
    /// Gains of the position controller.
    pub pid: PidGains,
    /// What the PID differentiates.
    pub derivative_on: DerivativeOn,
    /// Time constant of the PID's derivative filter \[s\].
    pub derivative_filter: f64,
    /// Error up to which the integral of the PID stands still while the reference does \[rad\], zero
    /// or more: friction then holds the shaft where it is, and no integral winds up until it slips.
    pub resting_angle: f64,
    /// How much of the inverse of the drive is fed forward.
    pub inverse: PlantInverse,
    /// What the place of the reference asks for, in the position mode.
    pub load: Load,
    /// Friction compensation.
    pub compensation: Compensation,
    /// Feedback of the estimated acceleration.
    pub acceleration: Option<AccelerationFeedback>,
    /// Dither.
    pub dither: Option<Dither>,
    /// The knocker's impulses.
    pub impulse: Option<Impulse>,
    /// Guard against over-compensation.
    pub guard: Option<GuardOptions>,
    /// Missing measurements in a row that give zero volts without a fault.
    pub tolerated_cycles: u32,
    /// Time in which a change of the compensation is faded in \[s\], zero or more.
    pub fade: f64,
    /// Largest magnitude of the command \[V\].
    pub voltage_limit: f64,
}

impl ControllerOptions {
    /// Cycles in which a change is faded in, at least one.
    pub(crate) fn fade_cycles(&self) -> u32 {
        (self.fade / self.period).round().clamp(1.0, f64::from(u32::MAX)) as u32
    }
}
