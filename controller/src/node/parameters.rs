//! Parameters of the node `controller`.

use friction_model::Motor;
use ros_node::parameters::{Declaration, ValueRange, Values};

use crate::{
    Compensation, ControlMode, Controller, ControllerOptions, DerivativeOn, Dither, DitherShape,
    GuardOptions, LagGains, PiGains, PidGains, PlantInverse, VelocityLaw, design::LinearDrive,
};

const POSITIVE: ValueRange = ValueRange::Double(f64::MIN_POSITIVE, f64::MAX);
const NON_NEGATIVE: ValueRange = ValueRange::Double(0.0, f64::MAX);

/// Highest voltage limit of any rig [V]: the end of extra-low direct voltage, as the driver has it.
const HIGHEST_VOLTAGE: f64 = 60.0;

/// Every parameter of the node. Of the velocity laws, the one that the command line gives gains to
/// is the default.
#[must_use]
pub fn declarations(given: &[String]) -> Vec<Declaration> {
    let options = ControllerOptions::default();
    let (lag, pid, drive) = (LagGains::THESIS, PidGains::THESIS, LinearDrive::of(&Motor::SRV02));
    let gives = |prefix: &str| given.iter().any(|name| name.starts_with(prefix));
    let law = if gives("pi.") && !gives("lag.") { "pi" } else { "lag" };
    let double = |name: &str, default, range, description: &str| {
        Declaration::double(name, default, description).range(range)
    };
    vec![
        Declaration::text("mode", "velocity", "What is regulated")
            .choices(["velocity", "position"]),
        Declaration::text("velocity_law", law, "Linear law of velocity").choices(["lag", "pi"]),
        double("lag.k_p", lag.k_p, POSITIVE, "Gain K_p of the lag compensator [V s/rad]"),
        double("lag.t_i", lag.t_i, POSITIVE, "Time constant T_i of the lag compensator [s]"),
        double(
            "lag.gamma",
            lag.gamma,
            ValueRange::Double(0.0, 1.0),
            "Ratio gamma of the lag compensator",
        ),
        double("pi.k_p", lag.k_p, POSITIVE, "Proportional gain K_p of the PI [V s/rad]"),
        double("pi.k_i", lag.k_p / lag.t_i, NON_NEGATIVE, "Integral gain K_i of the PI [V/rad]"),
        double(
            "pid.k_p",
            pid.k_p,
            NON_NEGATIVE,
            "Proportional gain K_p of the PID of position [V/rad]",
        ),
        double("pid.k_i", pid.k_i, NON_NEGATIVE, "Integral gain K_i of the PID [V/(rad s)]"),
        double("pid.k_d", pid.k_d, ValueRange::Any, "Derivative gain K_d of the PID [V s/rad]"),
        Declaration::text("derivative_on", "measurement", "What the PID differentiates")
            .choices(["error", "measurement"]),
        double(
            "derivative_filter",
            options.derivative_filter,
            NON_NEGATIVE,
            "Time constant of the PID's derivative filter [s]",
        ),
        Declaration::text("inverse", "off", "How much of the drive's inverse is fed forward")
            .choices(["off", "gain", "whole"]),
        double(
            "drive.gain",
            drive.gain,
            POSITIVE,
            "Velocity gain K of the drive, for its inverse [rad/s per V]",
        ),
        double(
            "drive.time_constant",
            drive.time_constant,
            POSITIVE,
            "Time constant T of the drive, for its inverse [s]",
        ),
        Declaration::boolean(
            "compensation",
            options.compensation.enabled,
            "Whether the friction estimate is compensated",
        ),
        double(
            "compensation_scale",
            options.compensation.scale,
            ValueRange::Double(0.0, 2.0),
            "Fraction of the estimate that is compensated",
        ),
        double(
            "volts_per_newton_metre",
            options.compensation.volts_per_newton_metre,
            POSITIVE,
            "Voltage that overcomes 1 N m of friction [V/(N m)]",
        ),
        Declaration::boolean("guard", true, "Whether compensation that hunts is scaled back"),
        Declaration::text("dither.shape", "sine", "Shape of the dither")
            .choices(["sine", "square"]),
        double("dither.amplitude", 0.0, NON_NEGATIVE, "Amplitude of the dither [V]; 0 for none"),
        double("dither.frequency", 50.0, POSITIVE, "Frequency of the dither [Hz]"),
        double(
            "fade",
            options.fade,
            NON_NEGATIVE,
            "Time in which a change of the compensation is faded in [s]",
        ),
        double(
            "voltage_limit",
            options.voltage_limit,
            ValueRange::Double(0.1, HIGHEST_VOLTAGE),
            "Largest magnitude of the command [V]; the rig's driver cuts it at its own limit",
        ),
        Declaration::integer(
            "tolerated_cycles",
            i64::from(options.tolerated_cycles),
            "Joint states in a row that are no numbers before it is a fault",
        )
        .range(ValueRange::Integer(0, 10_000)),
        double(
            "reference_timeout",
            0.5,
            ValueRange::Double(0.01, 60.0),
            "Age at which a reference is stale and ramps to zero velocity [s]",
        ),
        double(
            "reference_deceleration",
            10.0,
            POSITIVE,
            "How fast a stale reference goes to zero velocity [rad/s^2]",
        ),
        double(
            "estimate_timeout",
            0.02,
            ValueRange::Double(1e-3, 1.0),
            "Age at which a friction estimate is no longer compensated [s]",
        ),
        double(
            "estimate_wait",
            0.0006,
            ValueRange::Double(0.0, 0.01),
            "Longest wait for the estimate that belongs to a joint state [s]",
        ),
        double(
            "period",
            options.period,
            ValueRange::Double(1e-4, 0.01),
            "Period of the joint states [s]",
        )
        .read_only(),
        Declaration::boolean("autostart", true, "Configure and activate when the program starts")
            .read_only(),
    ]
}

/// What the parameters say, read and checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ControlSettings {
    pub(super) options: ControllerOptions,
    pub(super) reference_timeout: f64,
    pub(super) reference_deceleration: f64,
    /// Velocity that the drive reaches at the voltage limit [rad/s].
    pub(super) fastest: f64,
    pub(super) estimate_timeout: f64,
    pub(super) estimate_wait: f64,
}

impl ControlSettings {
    /// Reads and checks the parameters as a whole.
    ///
    /// # Errors
    /// The reason, for people.
    pub(super) fn read(values: &Values) -> Result<Self, String> {
        Self::read_upon(values, &ControllerOptions::default())
    }

    /// The same with `base` for the options that are no parameters.
    ///
    /// # Errors
    /// The reason, for people.
    pub(super) fn read_upon(values: &Values, base: &ControllerOptions) -> Result<Self, String> {
        let drive = LinearDrive {
            gain: values.double("drive.gain"),
            time_constant: values.double("drive.time_constant"),
        };
        let amplitude = values.double("dither.amplitude");
        let options = ControllerOptions {
            mode: match values.text("mode") {
                "position" => ControlMode::Position,
                _ => ControlMode::Velocity,
            },
            period: values.double("period"),
            velocity: match values.text("velocity_law") {
                "pi" => VelocityLaw::Pi(PiGains {
                    k_p: values.double("pi.k_p"),
                    k_i: values.double("pi.k_i"),
                }),
                _ => VelocityLaw::Lag(LagGains {
                    k_p: values.double("lag.k_p"),
                    t_i: values.double("lag.t_i"),
                    gamma: values.double("lag.gamma"),
                }),
            },
            pid: PidGains {
                k_p: values.double("pid.k_p"),
                k_i: values.double("pid.k_i"),
                k_d: values.double("pid.k_d"),
            },
            derivative_on: match values.text("derivative_on") {
                "error" => DerivativeOn::Error,
                _ => DerivativeOn::Measurement,
            },
            derivative_filter: values.double("derivative_filter"),
            inverse: match values.text("inverse") {
                "gain" => PlantInverse::Gain(drive),
                "whole" => PlantInverse::Whole(drive),
                _ => PlantInverse::Off,
            },
            compensation: Compensation {
                enabled: values.boolean("compensation"),
                volts_per_newton_metre: values.double("volts_per_newton_metre"),
                scale: values.double("compensation_scale"),
            },
            dither: (amplitude > 0.0).then(|| Dither {
                shape: match values.text("dither.shape") {
                    "square" => DitherShape::Square,
                    _ => DitherShape::Sine,
                },
                amplitude,
                frequency: values.double("dither.frequency"),
            }),
            guard: values.boolean("guard").then(GuardOptions::default),
            tolerated_cycles: u32::try_from(values.integer("tolerated_cycles")).unwrap_or(0),
            fade: values.double("fade"),
            voltage_limit: values.double("voltage_limit"),
            ..*base
        };
        // What cannot be built is refused here, and not in the middle of the loop.
        Controller::new(options).map_err(|error| error.to_string())?;
        Ok(Self {
            options,
            reference_timeout: values.double("reference_timeout"),
            reference_deceleration: values.double("reference_deceleration"),
            fastest: drive.gain * options.voltage_limit,
            estimate_timeout: values.double("estimate_timeout"),
            estimate_wait: values.double("estimate_wait"),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use ros_node::parameters::ParameterStore;

    use super::*;

    #[test]
    fn the_defaults_are_those_of_the_controller() {
        let store =
            ParameterStore::new(declarations(&[]), &BTreeMap::new(), Box::new(|_, _| Ok(())))
                .unwrap();
        assert_eq!(
            ControlSettings::read(store.values()).unwrap().options,
            ControllerOptions::default()
        );
        let given = ["pi.k_p".to_owned()];
        let store =
            ParameterStore::new(declarations(&given), &BTreeMap::new(), Box::new(|_, _| Ok(())))
                .unwrap();
        let options = ControlSettings::read(store.values()).unwrap().options;
        assert!(
            matches!(options.velocity, VelocityLaw::Pi(_)),
            "gains of a PI in the file mean a PI"
        );
    }

    /// The documentation shows the parameters of the code; `UPDATE_DOCS=1` writes them anew.
    #[test]
    fn the_documentation_shows_these_parameters() {
        let made = ros_node::parameters::markdown_table(&declarations(&[]));
        let (begin, end) = ("<!-- controller -->\n", "<!-- end of controller -->\n");
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
