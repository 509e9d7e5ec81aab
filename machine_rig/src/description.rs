//! What a machine is made of, as its file says it.

use std::path::Path;

use friction_model::{AnyModel, Motor};
use rig_driver::safety::{RigLimits, SafetyLimits};
use rig_driver::{Miswiring, RigError, Sensors, SimulationOptions};
use serde::{Deserialize, Serialize};

use crate::{Backlash, Breakdown, Forces, Stops};

/// Friction that goes from cold to warm: a factor `1 + change (1 - exp(-t/time_constant))`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Warming {
    /// Relative change in the end, from -0.9 to 9.
    pub change: f64,
    /// Time constant \[s\], above zero.
    pub time_constant: f64,
}

/// What the winding bears.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thermal {
    /// Voltage that the motor bears at rest for ever \[V\], above zero.
    pub continuous: f64,
    /// Time constant of the winding \[s\], above zero.
    pub time_constant: f64,
}

/// Which sensors there are beside the encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sensed {
    /// Velocity.
    pub tachometer: bool,
    /// Friction torque.
    pub torque: bool,
    /// Motor current.
    pub current: bool,
}

/// A machine. SI units, load side of the gear. What is left out is not there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// What it is called.
    pub name: String,
    /// The geared motor, with the inertia that turns with it.
    pub motor: Motor,
    /// Its friction.
    pub friction: AnyModel,
    /// Friction is greater forwards by this share, and smaller backwards; from -0.9 to 0.9.
    #[serde(default)]
    pub stickier: f64,
    /// How its friction warms up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warming: Option<Warming>,
    /// What else acts on the shaft.
    #[serde(default)]
    pub forces: Forces,
    /// A load behind backlash.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub backlash: Option<Backlash>,
    /// Ends of its travel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stops: Option<Stops>,
    /// Sensors and converters.
    #[serde(default)]
    pub sensors: Sensors,
    /// Which of the sensors there are.
    #[serde(default)]
    pub sensed: Sensed,
    /// The position that is told over the true one, above zero: a wrong number of counts in the
    /// user's file.
    #[serde(default = "one")]
    pub position_scale: f64,
    /// Cycles from a voltage to the motor.
    #[serde(default)]
    pub delay: u32,
    /// Period of the cycle \[s\].
    #[serde(default = "millisecond")]
    pub period: f64,
    /// Integration steps a period.
    #[serde(default = "ten")]
    pub substeps: u32,
    /// Largest magnitude of the voltage that its amplifier can put out \[V\].
    #[serde(default = "ten_volts")]
    pub voltage_range: f64,
    /// What its maker allows.
    #[serde(default)]
    pub limits: RigLimits,
    /// Mistakes in its wiring, as `--miswire` takes them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wiring: Option<String>,
    /// What its winding bears; as usual if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thermal: Option<Thermal>,
    /// What breaks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub breaks: Option<Breakdown>,
    /// Seed of its noise.
    #[serde(default)]
    pub seed: u64,
}

const fn one() -> f64 {
    1.0
}
const fn millisecond() -> f64 {
    1e-3
}
const fn ten() -> u32 {
    10
}
const fn ten_volts() -> f64 {
    10.0
}

/// A description that is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MachineError {
    /// The file cannot be read.
    #[error(
        "{path}: {why}; a machine is described in YAML or JSON, as docs/how-to/machines.md shows"
    )]
    Unreadable {
        /// The file.
        path: String,
        /// What is wrong.
        why: String,
    },
    /// It cannot be said in a file.
    #[error("the machine cannot be written: {why}")]
    Unwritable {
        /// What is wrong.
        why: String,
    },
    /// A number that cannot be.
    #[error("{name} is {value}, but must be {expected}")]
    OutOfRange {
        /// Which.
        name: &'static str,
        /// What came.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// What every rig is held to.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The wiring's text.
    #[error("wiring: {0}")]
    Wiring(String),
}

impl Machine {
    /// Reads a description.
    ///
    /// # Errors
    /// [`MachineError`] says what is wrong in the file.
    pub fn read(path: &Path) -> Result<Self, MachineError> {
        let unreadable =
            |why: String| MachineError::Unreadable { path: path.display().to_string(), why };
        let text = files::input::text(path).map_err(|error| unreadable(error.to_string()))?;
        let machine: Self =
            serde_saphyr::from_str(&text).map_err(|error| unreadable(error.to_string()))?;
        machine.check()?;
        Ok(machine)
    }

    /// The description as its file has it.
    ///
    /// # Errors
    /// [`MachineError::Unwritable`] for what JSON cannot hold, as an infinite range.
    pub fn text(&self) -> Result<String, MachineError> {
        let unwritable = |why: String| MachineError::Unwritable { why };
        let text =
            serde_json::to_string_pretty(self).map_err(|error| unwritable(error.to_string()))?;
        // An infinite number becomes null, which is none.
        let again: Result<Self, _> = serde_json::from_str(&text);
        again.map_err(|error| unwritable(error.to_string()))?;
        Ok(text + "\n")
    }

    /// Checks every number.
    ///
    /// # Errors
    /// [`MachineError`] names the first that cannot be.
    pub fn check(&self) -> Result<(), MachineError> {
        self.options()?.check()?;
        self.wiring()?;
        let refuse =
            |name, value, expected| Err(MachineError::OutOfRange { name, value, expected });
        let positive = |value: f64| value > 0.0 && value.is_finite();
        if !(-0.9..=0.9).contains(&self.stickier) {
            return refuse("stickier", self.stickier, "from -0.9 to 0.9");
        }
        if !positive(self.position_scale) {
            return refuse("position_scale", self.position_scale, "a finite number above zero");
        }
        if self.delay > 100 {
            return refuse("delay", f64::from(self.delay), "at most 100 cycles");
        }
        if let Some((name, value)) = self.forces.wrong() {
            return refuse(name, value, "a finite number, zero or more where it is a strength");
        }
        if let Some(Warming { change, time_constant }) = self.warming {
            if !(-0.9..=9.0).contains(&change) {
                return refuse("warming.change", change, "from -0.9 to 9");
            }
            if !positive(time_constant) {
                return refuse("warming.time_constant", time_constant, "a finite time above zero");
            }
        }
        if let Some(Backlash { width, inertia, stiffness }) = self.backlash {
            if !(width >= 0.0 && width.is_finite()) {
                return refuse("backlash.width", width, "a finite angle, zero or more");
            }
            if !positive(inertia) {
                return refuse("backlash.inertia", inertia, "a finite number above zero");
            }
            let step = self.period / f64::from(self.substeps);
            let stiffest = 0.25 * inertia.min(self.motor.inertia) / (step * step);
            if !(positive(stiffness) && stiffness <= stiffest) {
                return refuse(
                    "backlash.stiffness",
                    stiffness,
                    "above zero, and so soft that the integration follows it: more `substeps` help",
                );
            }
        }
        if let Some(stops) = self.stops.filter(|stops| !stops.is_sound()) {
            return refuse(
                "stops.low",
                stops.low,
                "below zero, where the shaft begins, and `high` above it",
            );
        }
        if let Some(Thermal { continuous, time_constant }) = self.thermal {
            if !positive(continuous) {
                return refuse("thermal.continuous", continuous, "a finite voltage above zero");
            }
            if !positive(time_constant) {
                return refuse("thermal.time_constant", time_constant, "a finite time above zero");
            }
        }
        if let Some(Breakdown { after, .. }) = self.breaks
            && !(after >= 0.0 && after.is_finite())
        {
            return refuse("breaks.after", after, "a finite time, zero or more");
        }
        Ok(())
    }

    /// As the test bed would be described: drive, sensors, converters and period.
    ///
    /// # Errors
    /// [`MachineError`] for a voltage limit that cannot be.
    pub fn options(&self) -> Result<SimulationOptions, MachineError> {
        let voltage_limit = SafetyLimits::voltage_within(self.limits.voltage, self.voltage_range)?;
        Ok(SimulationOptions {
            drive: self.motor,
            sensors: self.sensors,
            voltage_limit,
            voltage_range: self.voltage_range,
            period: self.period,
            substeps: self.substeps,
            seed: self.seed,
            ..SimulationOptions::default()
        })
    }

    /// The mistakes in its wiring.
    pub(crate) fn wiring(&self) -> Result<Option<Miswiring>, MachineError> {
        let read =
            |text: &String| text.parse().map_err(|error| MachineError::Wiring(format!("{error}")));
        self.wiring.as_ref().map(read).transpose()
    }
}
