//! Parameters of the node `rig_driver`, and the rig that they describe.

use friction_model::{AnyModel, ModelName, Motor, TorqueSource};
use ros_node::parameters::{Declaration, ValueRange, Values};

use super::{
    limits_guard::{ALLOW_LIMITS, is_limit},
    torque_estimate::SOURCES,
};
use crate::{
    Calibrated, Calibration, HIGHEST_VOLTAGE, Rig, RigError, Sign, SimulationOptions,
    VOLTAGE_RANGE,
    quanser::{QuanserOptions, QuanserRig},
    safety::{SafetyLimits, Supervised, Travel},
    serial::{self, SerialOptions, SerialRig},
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
            "Which rig: simulated, serial:PORT[@BAUD], quanser or quanser:CARD",
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
            rig.is_empty() || rig == "simulated",
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
    rig: RigName,
    simulation: SimulationOptions,
    model: ModelName,
    voltage_limit: f64,
    limits: SafetyLimits,
    velocity_given: bool,
    calibration: Calibration,
    pub(super) torque_source: TorqueSource,
    pub(super) torque_filter: f64,
    /// The rig in words.
    pub(super) name: String,
    /// Where the motor's temperature is kept; empty for the place where programs keep such things.
    pub(super) state_folder: String,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum RigName {
    Simulated,
    Serial { port: String, baud: u32 },
    Quanser { card: String },
}

impl RigName {
    fn read(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "rig must be simulated, serial:PORT as in serial:/dev/ttyACM0, quanser or quanser:CARD, but is `{text}`"
            )
        };
        match text.split_once(':') {
            None if text == "simulated" => Ok(Self::Simulated),
            None if text == "quanser" => Ok(Self::Quanser { card: "0".to_owned() }),
            Some(("quanser", card)) if !card.is_empty() => {
                Ok(Self::Quanser { card: card.to_owned() })
            }
            Some(("serial", port)) => {
                let (port, baud) = match port.rsplit_once('@') {
                    Some((port, baud)) => (
                        port,
                        baud.parse().map_err(|_| format!("`{baud}` in rig is no baud rate"))?,
                    ),
                    None => (port, SerialOptions::default().baud),
                };
                if port.is_empty() {
                    Err(wrong())
                } else {
                    Ok(Self::Serial { port: port.to_owned(), baud })
                }
            }
            _ => Err(wrong()),
        }
    }
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
        let rig = RigName::read(values.text("rig"))?;
        let voltage_limit = values.double("voltage_limit");
        let simulation = SimulationOptions {
            drive,
            // A real rig tells its range when it is opened.
            voltage_limit: if rig == RigName::Simulated {
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
        let default = SafetyLimits::default();
        let limits = SafetyLimits {
            slew: values.double("safety.slew"),
            velocity: if velocity > 0.0 { velocity } else { default.velocity },
            travel: values.boolean("safety.travel").then(|| Travel {
                min: values.double("safety.travel_min"),
                max: values.double("safety.travel_max"),
                margin: values.double("safety.travel_margin"),
            }),
            command_age: values.double("safety.command_age"),
            command_lost: values.double("safety.command_lost"),
            cycle_late: values.double("safety.cycle_late"),
            cycle_lost: values.double("safety.cycle_lost"),
            ..default
        };
        limits.check(simulation.period).map_err(|error| format!("safety: {error}"))?;
        if values.boolean("use_sim_time") {
            return Err("use_sim_time must be false: the rig runs by the system's clock, and stamps what it measures with it".into());
        }
        Ok(Self {
            rig,
            simulation,
            model: values
                .text("simulated.model")
                .parse()
                .map_err(|e: friction_model::ModelError| e.to_string())?,
            voltage_limit,
            limits,
            velocity_given: velocity > 0.0,
            calibration,
            torque_source: TorqueSource::named(values.text("torque_source")).unwrap_or_default(),
            torque_filter: values.double("torque_filter"),
            name: values.text("rig").to_owned(),
            state_folder: values.text("state_folder").to_owned(),
        })
    }

    /// Whether the rig is a simulated one.
    pub(super) fn is_simulated(&self) -> bool {
        self.rig == RigName::Simulated
    }

    /// Names of limits in which `other` differs.
    pub(super) fn differing(&self, other: &Self) -> Vec<&'static str> {
        let travel = |of: &Self| of.limits.travel;
        [
            ("rig", self.rig != other.rig),
            ("voltage_limit", self.voltage_limit != other.voltage_limit),
            ("safety.slew", self.limits.slew != other.limits.slew),
            (
                "safety.velocity",
                self.velocity_given != other.velocity_given
                    || self.limits.velocity != other.limits.velocity,
            ),
            ("safety.travel", travel(self) != travel(other)),
            ("safety.command_age", self.limits.command_age != other.limits.command_age),
            ("safety.command_lost", self.limits.command_lost != other.limits.command_lost),
            ("safety.cycle_late", self.limits.cycle_late != other.limits.cycle_late),
            ("safety.cycle_lost", self.limits.cycle_lost != other.limits.cycle_lost),
            ("calibration", self.calibration != other.calibration),
        ]
        .into_iter()
        .filter_map(|(name, differs)| differs.then_some(name))
        .collect()
    }

    /// The drive that the parameters describe.
    pub(super) const fn drive(&self) -> Motor {
        self.simulation.drive
    }

    /// Opens the rig with its motor at zero volts, under the safety layer, unconfigured.
    ///
    /// # Errors
    /// [`RigError`] says what is missing or refused.
    pub(super) fn open(&self) -> Result<Supervised<Box<dyn Rig + Send>>, RigError> {
        let (rig, fitting): (Box<dyn Rig + Send>, SafetyLimits) = match &self.rig {
            RigName::Simulated => {
                let rig = self.simulation.build(AnyModel::test_bed(self.model))?;
                // A simulated shaft stands still while its loop waits: a late cycle never asks for
                // a new activation.
                let limits = SafetyLimits::for_simulation(&self.simulation);
                (rig, SafetyLimits { cycle_lost: f64::MAX, ..limits })
            }
            RigName::Serial { port, baud } => {
                let options = SerialOptions { baud: *baud, ..SerialOptions::default() };
                let rig = SerialRig::open(std::path::Path::new(port), options)?;
                let limits = serial::limits(rig.hello());
                (Box::new(rig), limits)
            }
            RigName::Quanser { card } => {
                let options = QuanserOptions {
                    card: card.clone(),
                    voltage_limit: self.voltage_limit,
                    ..QuanserOptions::default()
                };
                let mut limits = SafetyLimits::default();
                if options.torque.is_none() {
                    limits.sensors.torque_range = None;
                }
                (Box::new(QuanserRig::open(options)?), limits)
            }
        };
        let simulated = self.rig == RigName::Simulated;
        let limits = SafetyLimits {
            voltage: SafetyLimits::voltage_within(Some(self.voltage_limit), rig.voltage_range())?,
            velocity: if self.velocity_given { self.limits.velocity } else { fitting.velocity },
            cycle_lost: if simulated { fitting.cycle_lost } else { self.limits.cycle_lost },
            motor: fitting.motor,
            sensors: fitting.sensors,
            standstill: fitting.standstill,
            ..self.limits
        };
        let rig: Box<dyn Rig + Send> = if self.calibration == Calibration::default() {
            rig
        } else {
            Box::new(Calibrated::new(rig, self.calibration)?)
        };
        Supervised::new(rig, limits)
    }
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
            .map_err(|(name, reason)| format!("{name}: {reason}"))?;
        RigSettings::read(store.values())
    }

    #[test]
    fn the_defaults_are_the_test_bed_under_its_limits() {
        let settings = read(&[]).unwrap();
        let default = SimulationOptions::default();
        assert_eq!((settings.simulation, settings.model), (default, ModelName::Proposed));
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

    /// The documentation shows the parameters of the code; `UPDATE_DOCS=1` writes them anew.
    #[test]
    fn the_documentation_shows_these_parameters() {
        let made = ros_node::parameters::markdown_table(&declarations("simulated"));
        let (begin, end) = ("<!-- rig_driver -->\n", "<!-- end of rig_driver -->\n");
        for page in ["../docs/reference/parameters.md"] {
            let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
            let mut text = std::fs::read_to_string(&path).expect("the page is part of the project");
            let from =
                text.find(begin).expect("the page marks where the table begins") + begin.len();
            let to = text.find(end).expect("the page marks where the table ends");
            if std::env::var_os("UPDATE_DOCS").is_some() {
                text.replace_range(from..to, &made);
                std::fs::write(&path, text).expect("the page can be written");
            } else {
                assert_eq!(&text[from..to], made, "{page}: run the test with UPDATE_DOCS=1");
            }
        }
    }
}
