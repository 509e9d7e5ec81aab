//! The parameters of a rig's driver, as ROS 2 and parameter files have them.

use std::fmt::Display;

use ::parameters::{Named, ParameterError, ValueRange, parameters};
use friction_model::{AnyModel, ModelName, Motor, TorqueSource};

use crate::calibration::LIMIT;
use crate::registry::{RigAddress, RigRegistry, RigSetup};
use crate::safety::{RigLimits, SafetyLimits, Travel};
use crate::{Calibration, HIGHEST_VOLTAGE, RigError, SimulationOptions, VOLTAGE_RANGE};

const CONFIGURED: &str = "taken when the node is configured";
const ACTIVATED: &str = "taken when the node is activated";
/// Times of a cycle \[s\].
const LOSS: ValueRange = ValueRange::Double(1e-4, SafetyLimits::LONGEST_LOSS);

parameters! {
    /// A simulated rig, but for its drive.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct SimulatedParameters {
        model: Named<ModelName> = Named(ModelName::Proposed),
            "Friction model of the simulated plant",
            choices(|| ModelName::ALL.map(ModelName::as_str).to_vec());
        seed: i64 = 1, "Seed of the simulated sensors' noise",
            range(ValueRange::Integer(0, i64::MAX));
        substeps: u32 = 2, "Integration steps of the simulated plant a period",
            range(ValueRange::Integer(1, 10_000));
    }
}

parameters! {
    /// The constants of the motor ([`Motor`], which knows nothing of nodes) as parameters.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct MotorParameters {
        motor_constant: f64, "Motor torque constant K_m", unit("N m/A"),
            range(ValueRange::POSITIVE), constraint(CONFIGURED);
        gear_ratio: f64, "Gear ratio A from motor to load",
            range(ValueRange::POSITIVE), constraint(CONFIGURED);
        armature_resistance: f64, "Armature resistance R_a", unit("ohm"),
            range(ValueRange::POSITIVE), constraint(CONFIGURED);
        inertia: f64, "Inertia at the load side", unit("kg m^2"),
            range(ValueRange::POSITIVE), constraint(CONFIGURED);
    }
}

impl From<Motor> for MotorParameters {
    fn from(motor: Motor) -> Self {
        let Motor { motor_constant, gear_ratio, armature_resistance, inertia } = motor;
        Self { motor_constant, gear_ratio, armature_resistance, inertia }
    }
}

impl From<MotorParameters> for Motor {
    fn from(said: MotorParameters) -> Self {
        let MotorParameters { motor_constant, gear_ratio, armature_resistance, inertia } = said;
        Self { motor_constant, gear_ratio, armature_resistance, inertia }
    }
}

parameters! {
    /// Limits of the rig, but for its voltage.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct SafetyParameters {
        slew: f64 = SafetyLimits::default().slew, "Fastest growth of the voltage's magnitude",
            unit("V/s"), range(ValueRange::POSITIVE), constraint(LIMIT);
        velocity: f64 = 0.0, "Largest speed of the shaft", unit("rad/s"),
            more("0 for what fits the rig"), range(ValueRange::NON_NEGATIVE), constraint(LIMIT);
        travel: bool = false, "Whether the travel is limited", constraint(LIMIT);
        travel_min: f64 = -1.0, "Lower end of the travel", unit("rad"), constraint(LIMIT);
        travel_max: f64 = 1.0, "Upper end of the travel", unit("rad"), constraint(LIMIT);
        travel_margin: f64 = 0.1, "How far beyond an end the shaft may coast", unit("rad"),
            range(ValueRange::NON_NEGATIVE), constraint(LIMIT);
        command_age: f64 = SafetyLimits::default().command_age,
            "Oldest command that still counts", unit("s"),
            range(ValueRange::Double(1e-4, SafetyLimits::OLDEST_COMMAND)), constraint(LIMIT);
        command_lost: f64 = SafetyLimits::default().command_lost,
            "Time without a command that is a fault", unit("s"), range(LOSS), constraint(LIMIT);
        cycle_late: f64 = SafetyLimits::default().cycle_late,
            "Longest cycle after which the motor goes on at once", unit("s"), range(LOSS),
            constraint(LIMIT);
        cycle_lost: f64 = SafetyLimits::default().cycle_lost,
            "Longest cycle that is no fault", unit("s"), more("a simulated rig does not mind"),
            range(LOSS), constraint(LIMIT);
    }
}

impl SafetyParameters {
    /// The limits that they say, with that of the voltage \[V\].
    fn limits(&self, voltage: f64) -> RigLimits {
        let travel =
            Travel { min: self.travel_min, max: self.travel_max, margin: self.travel_margin };
        RigLimits {
            voltage: Some(voltage),
            slew: Some(self.slew),
            velocity: Some(self.velocity).filter(|velocity| *velocity > 0.0),
            travel: self.travel.then_some(travel),
            command_age: Some(self.command_age),
            command_lost: Some(self.command_lost),
            cycle_late: Some(self.cycle_late),
            cycle_lost: Some(self.cycle_lost),
        }
    }

    /// The parameters that say these limits; what they leave out is as usual.
    fn of(limits: &RigLimits) -> Self {
        let usual = Self::default();
        let travel = limits.travel.unwrap_or(Travel {
            min: usual.travel_min,
            max: usual.travel_max,
            margin: usual.travel_margin,
        });
        Self {
            slew: limits.slew.unwrap_or(usual.slew),
            velocity: limits.velocity.unwrap_or(usual.velocity),
            travel: limits.travel.is_some(),
            travel_min: travel.min,
            travel_max: travel.max,
            travel_margin: travel.margin,
            command_age: limits.command_age.unwrap_or(usual.command_age),
            command_lost: limits.command_lost.unwrap_or(usual.command_lost),
            cycle_late: limits.cycle_late.unwrap_or(usual.cycle_late),
            cycle_lost: limits.cycle_lost.unwrap_or(usual.cycle_lost),
        }
    }
}

parameters! {
    /// Parameters of the node `rig_driver`.
    #[derive(Debug, Clone, PartialEq)]
    pub struct RigParameters {
        rig: String = "simulated".to_owned(), "Which rig",
            among(|| RigRegistry::installed().grammar()), constraint(LIMIT);
        allow_limits: bool = false,
            "Let limits of a real rig, and the rig itself, be changed after the start, while it is not active",
            read_only();
        state_folder: String = String::new(),
            "Where the motor's temperature is kept over a restart",
            more("empty for frictionlab in XDG_STATE_HOME"), read_only();
        autostart: bool = true, "Configure and activate when the program starts",
            more("false for real rigs unless given"), read_only();
        commander: String = String::new(),
            "Whole name of the only node that may command over /motor_voltage, as /controller",
            more("empty for the first after an activation"), constraint(ACTIVATED);
        torque_source: Named<TorqueSource> = Named(TorqueSource::Sensor),
            "What the effort in /joint_states is taken from",
            choices(|| RigParameters::SOURCES.map(TorqueSource::name).to_vec());
        torque_filter: f64 = 0.01, "Time constant of the filter of a reconstructed torque",
            unit("s"), range(ValueRange::Double(0.0, 1.0)), constraint(CONFIGURED);
        simulated: SimulatedParameters = SimulatedParameters::default();
        period: f64 = 1e-3, "Period of the control cycle of a simulated rig", unit("s"),
            more("real rigs have their own"), range(ValueRange::Double(1e-4, 0.01)),
            constraint(CONFIGURED);
        voltage_limit: f64 = 6.0, "Largest magnitude of the motor voltage", unit("V"),
            more("at most the range that the rig tells of itself"),
            range(ValueRange::Double(0.1, HIGHEST_VOLTAGE)), constraint(LIMIT);
        drive: MotorParameters = Motor::SRV02.into();
        safety: SafetyParameters = SafetyParameters::default();
        calibration: Calibration = Calibration::default();
    }
}

impl RigParameters {
    /// The torque sources that a rig has.
    pub const SOURCES: [TorqueSource; 3] =
        [TorqueSource::Sensor, TorqueSource::Voltage, TorqueSource::Current];

    /// The defaults where `rig` is the one that is given when the program starts, if any is: only a
    /// simulated one activates itself.
    #[must_use]
    pub fn for_rig(rig: &str) -> Self {
        let simulated = rig.parse::<RigAddress>().is_ok_and(|address| address.is_simulated());
        Self { autostart: rig.is_empty() || simulated, ..Self::default() }
    }

    /// The rig and what it is opened with, checked as a whole.
    ///
    /// # Errors
    /// [`ParameterError::Refused`] with the reason, for people.
    pub fn setup(&self) -> Result<(RigAddress, RigSetup), ParameterError> {
        let address: RigAddress = self.rig.parse().map_err(|error| {
            ParameterError::refused(format_args!("rig cannot be that: {error}"))
        })?;
        let simulation = SimulationOptions {
            drive: self.drive.into(),
            // A real rig tells its range when it is opened.
            voltage_limit: if address.is_simulated() {
                self.voltage_limit
            } else {
                self.voltage_limit.min(VOLTAGE_RANGE)
            },
            period: self.period,
            substeps: self.simulated.substeps,
            seed: self.simulated.seed.unsigned_abs(),
            ..SimulationOptions::default()
        };
        simulation.check().map_err(ParameterError::refused)?;
        let refused = |error: RigError| ParameterError::refused(error);
        self.calibration.check().map_err(RigError::from).map_err(refused)?;
        let limits = self.safety.limits(self.voltage_limit);
        // What no rig could have is told before one is opened.
        limits
            .on(SafetyLimits::default(), HIGHEST_VOLTAGE, false)
            .and_then(|limits| limits.check(simulation.period))
            .map_err(|error| ParameterError::refused(format_args!("safety: {error}")))?;
        let calibration = Some(self.calibration).filter(|given| *given != Calibration::default());
        let friction = AnyModel::test_bed(self.simulated.model.0);
        Ok((address, RigSetup { calibration, limits, simulation, friction, wiring: None }))
    }

    /// The parameters of a driver that opens `rig` with `setup`: what a program gives a driver that
    /// is to do what it would do itself. What no parameter says has its default.
    #[must_use]
    pub fn of(rig: impl Display, setup: &RigSetup) -> Self {
        let SimulationOptions { drive, period, substeps, seed, voltage_limit, .. } =
            setup.simulation;
        Self {
            rig: rig.to_string(),
            simulated: SimulatedParameters {
                model: Named(setup.friction.name()),
                seed: i64::try_from(seed).unwrap_or(i64::MAX),
                substeps,
            },
            period,
            voltage_limit: setup.limits.voltage.unwrap_or(voltage_limit),
            drive: drive.into(),
            safety: SafetyParameters::of(&setup.limits),
            calibration: setup.calibration.unwrap_or_default(),
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use ::parameters::{Declared, Values};

    use super::*;
    use crate::Sign;

    #[test]
    fn the_defaults_are_those_of_the_simulated_rig() {
        let (address, setup) = RigParameters::default().setup().unwrap();
        assert!(address.is_simulated());
        assert_eq!(setup, RigSetup { limits: setup.limits, ..RigSetup::default() });
        assert!(!RigParameters::for_rig("serial:/dev/ttyACM0").autostart);
    }

    #[test]
    fn whatever_a_program_opens_can_be_said() {
        let limits = RigLimits {
            voltage: Some(4.0),
            slew: Some(100.0),
            velocity: Some(3.0),
            travel: Some(Travel { min: -2.0, max: 1.0, margin: 0.2 }),
            command_age: Some(0.01),
            command_lost: Some(0.2),
            cycle_late: Some(0.005),
            cycle_lost: Some(0.05),
        };
        let drive = Motor { inertia: 3e-3, ..Motor::SRV02 };
        let simulation = SimulationOptions {
            drive,
            period: 2e-3,
            substeps: 4,
            seed: 9,
            voltage_limit: 4.0,
            ..SimulationOptions::default()
        };
        let calibration =
            Calibration { encoder_sign: Sign::Reversed, torque_zero: 0.1, ..Default::default() };
        let setup = RigSetup {
            calibration: Some(calibration),
            limits,
            simulation,
            friction: AnyModel::test_bed(ModelName::Gms),
            wiring: None,
        };
        let rig = RigAddress::simulated();
        let said = RigParameters::of(&rig, &setup).values();
        let given = said.iter().map(|(name, value)| (name.to_owned(), value.clone())).collect();
        let values = Values::given(&RigParameters::default().declarations(), &given).unwrap();
        let read = RigParameters::default().with(&values);
        assert_eq!(read.setup().unwrap(), (rig, setup));
    }
}
