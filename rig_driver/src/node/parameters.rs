//! Parameters of the node `rig_driver`, and the rig that they describe.

use friction_model::{AnyModel, ModelName, Motor, TorqueSource};
use ros_node::parameters::{Declaration, ValueRange, Values};

use super::{
    limits_guard::{ALLOW_LIMITS, is_limit},
    torque_estimate::SOURCES,
};
use crate::{
    Calibration, HIGHEST_VOLTAGE, Rig, RigError, Sign, SimulationOptions, VOLTAGE_RANGE,
    registry::{AddressError, RigAddress, RigRegistry, RigSetup},
    safety::{RigLimits, SafetyLimits, Supervised, Travel},
};

const POSITIVE: ValueRange = ValueRange::Double(f64::MIN_POSITIVE, f64::MAX);
const NON_NEGATIVE: ValueRange = ValueRange::Double(0.0, f64::MAX);
const CONFIGURED: &str = "taken when the node is configured";
const LIMIT: &str =
    "taken when the node is configured; on a real rig at the start only, see allow_limits";

/// Every parameter of the node. `rig` is the rig that is given when the program starts: only a
/// simulated one activates itself.
#[must_use]
pub fn declarations(rig: &str) -> Vec<Declaration> {
    let simulation = SimulationOptions::default();
    let limits = SafetyLimits::default();
    let drive = simulation.drive;
    let unit = Calibration::default();
    let taken = |name: &str| if is_limit(name) { LIMIT } else { CONFIGURED };
    let double = |name: &str, default, range, description: &str| {
        Declaration::double(name, default, description).range(range).constraint(taken(name))
    };
    vec![
        Declaration::text(
            "rig",
            "simulated",
            format!("Which rig: {}", RigRegistry::installed().grammar()),
        )
        .constraint(LIMIT),
        Declaration::boolean(
            ALLOW_LIMITS,
            false,
            "Let limits of a real rig, and the rig itself, be changed after the start, while it is not active",
        )
        .read_only(),
        Declaration::text(
            "state_folder",
            "",
            "Where the motor's temperature is kept over a restart; empty for frictionlab in XDG_STATE_HOME",
        )
        .read_only(),
        Declaration::boolean(
            "autostart",
            rig.is_empty() || is_simulated(rig),
            "Configure and activate when the program starts; false for real rigs unless given",
        )
        .read_only(),
        Declaration::text(
            "commander",
            "",
            "Whole name of the only node that may command over /motor_voltage, as /controller; empty for the first after an activation",
        )
        .constraint("taken when the node is activated"),
        Declaration::text("torque_source", "sensor", "What the effort in /joint_states is taken from")
            .choices(SOURCES.map(TorqueSource::name)),
        double(
            "torque_filter",
            0.01,
            ValueRange::Double(0.0, 1.0),
            "Time constant of the filter of a reconstructed torque [s]",
        ),
        Declaration::text("simulated.model", "proposed", "Friction model of the simulated plant")
            .choices(ModelName::ALL.map(ModelName::as_str)),
        Declaration::integer("simulated.seed", 1, "Seed of the simulated sensors' noise")
            .range(ValueRange::Integer(0, i64::MAX)),
        Declaration::integer(
            "simulated.substeps",
            i64::from(simulation.substeps),
            "Integration steps of the simulated plant a period",
        )
        .range(ValueRange::Integer(1, 10_000)),
        double(
            "period",
            simulation.period,
            ValueRange::Double(1e-4, 0.01),
            "Period of the control cycle of a simulated rig [s]; real rigs have their own",
        ),
        double(
            "voltage_limit",
            simulation.voltage_limit,
            ValueRange::Double(0.1, HIGHEST_VOLTAGE),
            "Largest magnitude of the motor voltage [V]; at most the range that the rig tells of itself",
        ),
        double("drive.motor_constant", drive.motor_constant, POSITIVE, "Motor torque constant K_m [N m/A]"),
        double("drive.gear_ratio", drive.gear_ratio, POSITIVE, "Gear ratio A from motor to load"),
        double(
            "drive.armature_resistance",
            drive.armature_resistance,
            POSITIVE,
            "Armature resistance R_a [ohm]",
        ),
        double("drive.inertia", drive.inertia, POSITIVE, "Inertia at the load side [kg m^2]"),
        double("safety.slew", limits.slew, POSITIVE, "Fastest growth of the voltage's magnitude [V/s]"),
        double(
            "safety.velocity",
            0.0,
            NON_NEGATIVE,
            "Largest speed of the shaft [rad/s]; 0 for what fits the rig",
        ),
        Declaration::boolean("safety.travel", false, "Whether the travel is limited").constraint(LIMIT),
        double("safety.travel_min", -1.0, ValueRange::Any, "Lower end of the travel [rad]"),
        double("safety.travel_max", 1.0, ValueRange::Any, "Upper end of the travel [rad]"),
        double("safety.travel_margin", 0.1, NON_NEGATIVE, "How far beyond an end the shaft may coast [rad]"),
        double(
            "safety.command_age",
            limits.command_age,
            ValueRange::Double(1e-4, SafetyLimits::OLDEST_COMMAND),
            "Oldest command that still counts [s]",
        ),
        double(
            "safety.command_lost",
            limits.command_lost,
            ValueRange::Double(1e-4, SafetyLimits::LONGEST_LOSS),
            "Time without a command that is a fault [s]",
        ),
        double(
            "safety.cycle_late",
            limits.cycle_late,
            ValueRange::Double(1e-4, SafetyLimits::LONGEST_LOSS),
            "Longest cycle after which the motor goes on at once [s]",
        ),
        double(
            "safety.cycle_lost",
            limits.cycle_lost,
            ValueRange::Double(1e-4, SafetyLimits::LONGEST_LOSS),
            "Longest cycle that is no fault [s]; a simulated rig does not mind",
        ),
        Declaration::integer("calibration.encoder_sign", 1, "Sign of encoder counts, 1 or -1")
            .range(ValueRange::Integer(-1, 1)),
        double(
            "calibration.tachometer_gain",
            unit.tachometer_gain,
            ValueRange::Any,
            "True velocity over the tachometer's",
        ),
        double(
            "calibration.tachometer_zero",
            unit.tachometer_zero,
            ValueRange::Any,
            "Tachometer's reading at rest [rad/s]",
        ),
        Declaration::integer("calibration.torque_sign", 1, "Sign of the friction torque, 1 or -1")
            .range(ValueRange::Integer(-1, 1)),
        double(
            "calibration.torque_zero",
            unit.torque_zero,
            ValueRange::Any,
            "Torque sensor's reading without torque [N m]",
        ),
        double(
            "calibration.deadband_forward",
            unit.deadband_forward,
            NON_NEGATIVE,
            "Lowest voltage that moves the shaft forwards [V]",
        ),
        double(
            "calibration.deadband_backward",
            unit.deadband_backward,
            NON_NEGATIVE,
            "Lowest magnitude of the voltage that moves it backwards [V]",
        ),
    ]
}

/// What the parameters say, read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RigSettings {
    address: RigAddress,
    setup: RigSetup,
    pub(super) torque_source: TorqueSource,
    pub(super) torque_filter: f64,
    /// The rig in words.
    pub(super) name: String,
    /// Where the motor's temperature is kept; empty for the place where programs keep such things.
    pub(super) state_folder: String,
}

impl RigSettings {
    /// Reads and checks the parameters as a whole.
    ///
    /// # Errors
    /// The reason, for people.
    pub(super) fn read(values: &Values) -> Result<Self, String> {
        let told = |error: RigError| error.to_string();
        let drive = Motor {
            motor_constant: values.double("drive.motor_constant"),
            gear_ratio: values.double("drive.gear_ratio"),
            armature_resistance: values.double("drive.armature_resistance"),
            inertia: values.double("drive.inertia"),
        };
        drive.check().map_err(|error| told(error.into()))?;
        let sign = |name: &str| {
            let sign = i8::try_from(values.integer(name)).unwrap_or(0);
            Sign::try_from(sign).map_err(|error| format!("{name}: {error}"))
        };
        let calibration = Calibration {
            encoder_sign: sign("calibration.encoder_sign")?,
            tachometer_gain: values.double("calibration.tachometer_gain"),
            tachometer_zero: values.double("calibration.tachometer_zero"),
            torque_sign: sign("calibration.torque_sign")?,
            torque_zero: values.double("calibration.torque_zero"),
            deadband_forward: values.double("calibration.deadband_forward"),
            deadband_backward: values.double("calibration.deadband_backward"),
        };
        calibration.check().map_err(told)?;
        let address: RigAddress = values
            .text("rig")
            .parse()
            .map_err(|error: AddressError| format!("rig cannot be that: {error}"))?;
        let voltage_limit = values.double("voltage_limit");
        let simulation = SimulationOptions {
            drive,
            // A real rig tells its range when it is opened.
            voltage_limit: if address.is_simulated() {
                voltage_limit
            } else {
                voltage_limit.min(VOLTAGE_RANGE)
            },
            period: values.double("period"),
            substeps: u32::try_from(values.integer("simulated.substeps")).unwrap_or(u32::MAX),
            seed: values.integer("simulated.seed").unsigned_abs(),
            ..SimulationOptions::default()
        };
        simulation.check().map_err(told)?;
        let velocity = values.double("safety.velocity");
        let limits = RigLimits {
            voltage: Some(voltage_limit),
            slew: Some(values.double("safety.slew")),
            velocity: Some(velocity).filter(|velocity| *velocity > 0.0),
            travel: values.boolean("safety.travel").then(|| Travel {
                min: values.double("safety.travel_min"),
                max: values.double("safety.travel_max"),
                margin: values.double("safety.travel_margin"),
            }),
            command_age: Some(values.double("safety.command_age")),
            command_lost: Some(values.double("safety.command_lost")),
            cycle_late: Some(values.double("safety.cycle_late")),
            cycle_lost: Some(values.double("safety.cycle_lost")),
        };
        // What no rig could have is told before one is opened.
        limits
            .on(SafetyLimits::default(), HIGHEST_VOLTAGE, false)
            .and_then(|limits| limits.check(simulation.period))
            .map_err(|error| format!("safety: {error}"))?;
        if values.boolean("use_sim_time") {
            return Err("use_sim_time must be false: the rig runs by the system's clock, and stamps what it measures with it".into());
        }
        let model: ModelName = values
            .text("simulated.model")
            .parse()
            .map_err(|error: friction_model::ModelError| error.to_string())?;
        Ok(Self {
            setup: RigSetup {
                calibration: Some(calibration).filter(|given| *given != Calibration::default()),
                limits,
                simulation,
                friction: AnyModel::test_bed(model),
                wiring: None,
            },
            torque_source: TorqueSource::named(values.text("torque_source")).unwrap_or_default(),
            torque_filter: values.double("torque_filter"),
            name: address.to_string(),
            address,
            state_folder: values.text("state_folder").to_owned(),
        })
    }

    /// Whether the rig is a simulated one.
    pub(super) fn is_simulated(&self) -> bool {
        self.address.is_simulated()
    }

    /// Names of limits in which `other` differs.
    pub(super) fn differing(&self, other: &Self) -> Vec<&'static str> {
        let (here, there) = (&self.setup.limits, &other.setup.limits);
        [
            ("rig", self.address != other.address),
            ("voltage_limit", here.voltage != there.voltage),
            ("safety.slew", here.slew != there.slew),
            ("safety.velocity", here.velocity != there.velocity),
            ("safety.travel", here.travel != there.travel),
            ("safety.command_age", here.command_age != there.command_age),
            ("safety.command_lost", here.command_lost != there.command_lost),
            ("safety.cycle_late", here.cycle_late != there.cycle_late),
            ("safety.cycle_lost", here.cycle_lost != there.cycle_lost),
            ("calibration", self.setup.calibration != other.setup.calibration),
        ]
        .into_iter()
        .filter_map(|(name, differs)| differs.then_some(name))
        .collect()
    }

    /// The motor that the parameters describe.
    pub(super) const fn motor(&self) -> Motor {
        self.setup.simulation.drive
    }

    /// Opens the rig with its motor at zero volts, under the safety layer, unconfigured.
    ///
    /// # Errors
    /// [`RigError`] says what is missing or refused.
    pub(super) fn open(&self) -> Result<Supervised<Box<dyn Rig + Send>>, RigError> {
        self.address.open(&self.setup)?.supervised()
    }
}

/// Whether `rig` is the address of a simulated rig.
pub(super) fn is_simulated(rig: &str) -> bool {
    rig.parse::<RigAddress>().is_ok_and(|address| address.is_simulated())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use ros_node::{ParameterValue, parameters::ParameterStore};

    use super::*;

    fn read(given: &[(&str, ParameterValue)]) -> Result<RigSettings, String> {
        let given: BTreeMap<_, _> =
            given.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
        let store = ParameterStore::new(declarations("simulated"), &given, Box::new(|_, _| Ok(())))
            .map_err(|error| error.to_string())?;
        RigSettings::read(store.values())
    }

    #[test]
    fn the_defaults_are_the_test_bed_under_its_limits() {
        let settings = read(&[]).unwrap();
        let default = SimulationOptions::default();
        assert_eq!(
            settings.setup,
            RigSetup { limits: settings.setup.limits, ..RigSetup::default() }
        );
        let rig = settings.open().unwrap();
        let limits = SafetyLimits::for_simulation(&default);
        assert_eq!(*rig.supervisor().limits(), SafetyLimits { cycle_lost: f64::MAX, ..limits });
        assert!(!rig.supervisor().state().moves());
    }

    #[test]
    fn what_cannot_be_is_refused_by_name() {
        let text = |value: &str| ParameterValue::String(value.to_owned());
        for (name, value, said) in [
            ("rig", text("usb"), "serial:/dev/ttyACM0"),
            ("rig", text("serial:"), "serial:/dev/ttyACM0"),
            ("rig", text("serial:/dev/x@fast"), "baud"),
            ("calibration.encoder_sign", ParameterValue::Integer(0), "encoder_sign"),
            ("calibration.tachometer_gain", ParameterValue::Double(0.0), "tachometer_gain"),
            ("safety.command_lost", ParameterValue::Double(0.001), "command_lost"),
            ("voltage_limit", ParameterValue::Double(11.0), "voltage_limit"),
        ] {
            let message = read(&[(name, value)]).unwrap_err();
            assert!(message.contains(said), "{name}: {message}");
        }
    }
}
