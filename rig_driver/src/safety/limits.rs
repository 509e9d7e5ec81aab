//! What the supervisor allows.

use friction_model::Motor;
use serde::{Deserialize, Serialize};

use crate::RigError;

/// Limits of a rig. SI units, load side of the gear.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SafetyLimits {
    /// Largest magnitude of the motor voltage \[V\], above zero.
    pub voltage: f64,
    /// Fastest growth of its magnitude [V/s], above zero. Falling to zero is never slowed.
    pub slew: f64,
    /// Largest speed of the shaft [rad/s], above zero.
    pub velocity: f64,
    /// Where the shaft may be; none for a shaft that may turn for ever.
    pub travel: Option<Travel>,
    /// Oldest command that still counts \[s\], above zero and at most
    /// [`OLDEST_COMMAND`](Self::OLDEST_COMMAND).
    pub command_age: f64,
    /// Time without a command after which the motor has to be activated again \[s\], not below
    /// `command_age` and at most [`LONGEST_LOSS`](Self::LONGEST_LOSS).
    pub command_lost: f64,
    /// Longest cycle after which the motor goes on at once \[s\], above the period.
    pub cycle_late: f64,
    /// Longest cycle after which the motor need not be activated again \[s\], not below
    /// `cycle_late`.
    pub cycle_lost: f64,
    /// Temperature model of the winding; none to go without.
    pub motor: Option<MotorThermal>,
    /// Whether the shaft has to stand still where the motor has zero volts; none where a load or a
    /// hand may turn it.
    pub standstill: Option<Standstill>,
    /// What the sensors are held to.
    pub sensors: SensorChecks,
}

/// Ends of the travel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Travel {
    /// Lower end \[rad\].
    pub min: f64,
    /// Upper end \[rad\], above the lower one.
    pub max: f64,
    /// How far beyond an end the shaft may coast \[rad\], zero or more.
    pub margin: f64,
}

/// When a shaft that turns at zero volts is a fault. What still loses a tenth of its speed in 0.1 s
/// coasts and is none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Standstill {
    /// Time at zero volts in which the shaft may coast \[s\], above zero and at most 10 s.
    pub after: f64,
    /// Speed above which it turns [rad/s], above zero.
    pub velocity: f64,
}

/// The winding as one thermal mass: `C dT/dt = i^2 R_a - (T - T_ambient) / R_th`, with the time
/// constant `R_th C`.
///
/// It begins at ambient temperature unless it is told better
/// ([`Supervised::warm`](super::Supervised::warm)), as the node tells it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorThermal {
    /// Armature resistance R_a \[ohm\], above zero.
    pub armature_resistance: f64,
    /// Back-EMF constant at the load, A K_m [V s/rad], above zero.
    pub back_emf: f64,
    /// Thermal resistance from winding to ambient R_th [K/W], above zero.
    pub thermal_resistance: f64,
    /// Time constant of the winding \[s\], above zero.
    pub time_constant: f64,
    /// Ambient temperature [degrees C].
    pub ambient: f64,
    /// Hottest winding allowed [degrees C], above ambient by more than 10 K.
    pub limit: f64,
}

/// How well encoder and tachometer have to agree over a window:
/// `|w_t - w_e| <= absolute + relative |w_e|`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Agreement {
    /// Length of the window over which both are averaged \[s\], above zero.
    pub window: f64,
    /// Part of the tolerance that does not depend on speed [rad/s], above zero.
    pub absolute: f64,
    /// Part in proportion to the speed, zero or more.
    pub relative: f64,
}

/// What the sensors are held to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorChecks {
    /// Encoder against tachometer; none on a rig that has only one of them, or whose signs are
    /// still to be found.
    pub agreement: Option<Agreement>,
    /// End of the torque sensor's range [N m], above zero; none on a rig without one.
    pub torque_range: Option<f64>,
    /// Cycles after which a noisy channel that never changes counts as frozen, two or more; none
    /// for ideal sensors.
    pub frozen_cycles: Option<u32>,
}

impl Default for SafetyLimits {
    /// The SRV-02 of the thesis with its motor's nominal 6 V, and its tachometer's range as speed
    /// limit.
    ///
    /// The thermal constants are assumed (24 K/W, 20 s, 100 degrees C: a stalled motor at 6 V is
    /// stopped after about 0.26 of a time constant); take those of your motor's data sheet.
    fn default() -> Self {
        Self {
            voltage: 6.0,
            slew: 2000.0,
            velocity: 9.5,
            travel: None,
            command_age: 0.02,
            command_lost: 0.5,
            cycle_late: 0.02,
            cycle_lost: 0.5,
            motor: Some(MotorThermal {
                armature_resistance: Motor::SRV02.armature_resistance,
                back_emf: Motor::SRV02.back_emf(),
                thermal_resistance: 24.0,
                time_constant: 20.0,
                ambient: 25.0,
                limit: 100.0,
            }),
            standstill: Some(Standstill { after: 0.5, velocity: 0.5 }),
            sensors: SensorChecks {
                agreement: Some(Agreement { window: 0.05, absolute: 0.3, relative: 0.2 }),
                torque_range: Some(22.9),
                frozen_cycles: Some(200),
            },
        }
    }
}

impl SafetyLimits {
    /// Largest `command_age` \[s\]: so long after the last command the motor is at zero volts,
    /// whatever is set.
    pub const OLDEST_COMMAND: f64 = 0.1;
    /// Largest `command_lost`, `cycle_late` and `cycle_lost` of a real rig \[s\]: after so long it
    /// has to be activated again, whatever is set.
    pub const LONGEST_LOSS: f64 = 1.0;

    /// The voltage limit \[V\] of a rig with a voltage range of `range` \[V\]: what was `asked`
    /// for, else the usual 6 V. The usual limit and what lies below it are cut to a range that is
    /// smaller.
    ///
    /// # Errors
    /// [`RigError::BeyondRange`] if more was asked for than the rig can put out;
    /// [`RigError::OutOfRange`] if it is no limit.
    pub fn voltage_within(asked: Option<f64>, range: f64) -> Result<f64, RigError> {
        let usual = Self::default().voltage;
        let limit = asked.unwrap_or(usual);
        if !(limit > 0.0 && limit.is_finite()) {
            let expected = "a finite number above zero".into();
            return Err(RigError::OutOfRange { name: "voltage_limit", value: limit, expected });
        }
        if limit > range && limit > usual {
            return Err(RigError::BeyondRange { limit, range });
        }
        Ok(limit.min(range))
    }

    /// The same without the check of encoder against tachometer: while signs and gains are still to
    /// be found.
    #[must_use]
    pub const fn before_calibration(mut self) -> Self {
        self.sensors.agreement = None;
        self
    }

    /// Checks every field for a rig with cycles of `period` \[s\].
    ///
    /// # Errors
    /// [`RigError::OutOfRange`] names the field.
    pub fn check(&self, period: f64) -> Result<(), RigError> {
        for (name, value) in [
            ("period", period),
            ("voltage", self.voltage),
            ("slew", self.slew),
            ("velocity", self.velocity),
        ] {
            above_zero(name, value)?;
        }
        let Self { command_age, command_lost, cycle_late, cycle_lost, .. } = *self;
        let age = command_age > 0.0 && command_age <= Self::OLDEST_COMMAND;
        hold(age, "command_age", command_age, "above 0 and at most 0.1 s")?;
        let lost = command_lost >= command_age && command_lost <= Self::LONGEST_LOSS;
        hold(lost, "command_lost", command_lost, "at least command_age and at most 1 s")?;
        hold(cycle_late > period, "cycle_late", cycle_late, "longer than the period")?;
        hold(cycle_lost >= cycle_late, "cycle_lost", cycle_lost, "at least cycle_late")?;
        self.travel.map_or(Ok(()), |travel| travel.check())?;
        self.motor.map_or(Ok(()), |motor| motor.check())?;
        self.standstill.map_or(Ok(()), |standstill| standstill.check())?;
        self.sensors.check(period)
    }
}

impl Travel {
    fn check(&self) -> Result<(), RigError> {
        let Self { min, max, margin } = *self;
        let ends = min.is_finite() && max.is_finite() && min < max;
        hold(ends, "travel.max", max, "a finite number above travel.min")?;
        let positive = margin >= 0.0 && margin.is_finite();
        hold(positive, "travel.margin", margin, "a finite number, zero or more")
    }
}

impl MotorThermal {
    fn check(&self) -> Result<(), RigError> {
        for (name, value) in [
            ("motor.armature_resistance", self.armature_resistance),
            ("motor.back_emf", self.back_emf),
            ("motor.thermal_resistance", self.thermal_resistance),
            ("motor.time_constant", self.time_constant),
        ] {
            above_zero(name, value)?;
        }
        let Self { ambient, limit, .. } = *self;
        hold(ambient.is_finite(), "motor.ambient", ambient, "a finite number")?;
        let warmer = limit.is_finite() && limit > ambient + 10.0;
        hold(warmer, "motor.limit", limit, "above motor.ambient by more than 10 K")
    }
}

impl Standstill {
    fn check(&self) -> Result<(), RigError> {
        let after = self.after > 0.0 && self.after <= 10.0;
        hold(after, "standstill.after", self.after, "above 0 and at most 10 s")?;
        above_zero("standstill.velocity", self.velocity)
    }
}

impl SensorChecks {
    fn check(&self, period: f64) -> Result<(), RigError> {
        if let Some(Agreement { window, absolute, relative }) = self.agreement {
            let long = window >= period && window <= 10.0;
            let expected = "at least the period and at most 10 s";
            hold(long, "sensors.agreement.window", window, expected)?;
            above_zero("sensors.agreement.absolute", absolute)?;
            let positive = relative >= 0.0 && relative.is_finite();
            let expected = "a finite number, zero or more";
            hold(positive, "sensors.agreement.relative", relative, expected)?;
        }
        self.torque_range.map_or(Ok(()), |range| above_zero("sensors.torque_range", range))?;
        let cycles = self.frozen_cycles.unwrap_or(u32::MAX);
        hold(cycles >= 2, "sensors.frozen_cycles", f64::from(cycles), "two or more")
    }
}

/// Refuses a value that does not `hold`.
fn hold(
    holds: bool,
    name: &'static str,
    value: f64,
    expected: &'static str,
) -> Result<(), RigError> {
    if holds {
        return Ok(());
    }
    Err(RigError::OutOfRange { name, value, expected: expected.into() })
}

fn above_zero(name: &'static str, value: f64) -> Result<(), RigError> {
    hold(value > 0.0 && value.is_finite(), name, value, "a finite number above zero")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_valid_and_limits_out_of_range_are_refused_by_name() {
        let limits = SafetyLimits::default();
        limits.check(1e-3).unwrap();
        let motor = |change: fn(&mut MotorThermal)| {
            let mut motor = limits.motor.unwrap();
            change(&mut motor);
            SafetyLimits { motor: Some(motor), ..limits }
        };
        for (wrong, name) in [
            (SafetyLimits { voltage: f64::NAN, ..limits }, "voltage"),
            (SafetyLimits { slew: 0.0, ..limits }, "slew"),
            (SafetyLimits { velocity: f64::INFINITY, ..limits }, "velocity"),
            (SafetyLimits { command_age: 0.0, ..limits }, "command_age"),
            (SafetyLimits { command_age: 0.11, ..limits }, "command_age"),
            (SafetyLimits { command_lost: 1.1, ..limits }, "command_lost"),
            (SafetyLimits { command_lost: f64::NAN, ..limits }, "command_lost"),
            (SafetyLimits { cycle_late: 1e-3, ..limits }, "cycle_late"),
            (SafetyLimits { cycle_lost: 0.01, ..limits }, "cycle_lost"),
            (
                SafetyLimits { travel: Some(Travel { min: 1.0, max: 1.0, margin: 0.0 }), ..limits },
                "travel.max",
            ),
            (
                SafetyLimits {
                    standstill: Some(Standstill { after: 0.0, velocity: 1.0 }),
                    ..limits
                },
                "standstill.after",
            ),
            (
                SafetyLimits {
                    standstill: Some(Standstill { after: 1.0, velocity: f64::NAN }),
                    ..limits
                },
                "standstill.velocity",
            ),
            (motor(|motor| motor.limit = 30.0), "motor.limit"),
            (motor(|motor| motor.time_constant = -1.0), "motor.time_constant"),
        ] {
            let text = wrong.check(1e-3).unwrap_err().to_string();
            assert!(text.starts_with(name), "{text}");
        }
    }
}
