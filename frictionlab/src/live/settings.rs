//! The options of a live run as the parameters that its nodes are given, so that the nodes tell
//! what is true.

use std::collections::BTreeMap;

use controller::{ControlMode, ControllerOptions, ControllerParameters};
use friction_model::ModelName;
use friction_observer::EstimatorOptions;
use friction_observer::parameters::{ObserverParameters, Regulated};
use rig_driver::safety::Travel;
use rig_driver::{Sign, SimulationOptions};
use ros_node::parameter_file::NodeParameters;
use ros_node::{Arguments, ParameterValue};

use super::{LiveError, LiveOptions, Serving};
use rig_setup::{RigChoice, RigLimits};

type Given = BTreeMap<String, ParameterValue>;

/// The command line that gives the nodes these options; what the user's own says counts above it.
///
/// # Errors
/// [`LiveError::Parameters`] if no parameters say it; [`LiveError::Arguments`] if the user's
/// arguments are wrong.
pub(super) fn arguments(options: &LiveOptions, period: f64) -> Result<Arguments, LiveError> {
    let behind =
        std::iter::once("--ros-args".to_owned()).chain(options.ros_arguments.iter().cloned());
    let mut arguments =
        Arguments::parse(behind).map_err(|error| LiveError::Arguments(error.to_string()))?;
    arguments.namespace =
        std::env::var("ROS_NAMESPACE").ok().filter(|namespace| !namespace.is_empty());
    let (controller, estimator) = options.test_bed.settings(options.mode, options.means, period);
    let mut nodes = vec![
        ("rig_driver", rig(options)),
        ("friction_observer", observer(options, &estimator, period)?),
        ("controller", control(&controller)?),
    ];
    if let Some(Serving { runs, allow_rigs }) = &options.serve {
        let text = |text: String| ParameterValue::String(text);
        // On a real rig its experiments run too. A simulated one of their own needs no real time.
        let rig = if options.rig == RigChoice::Simulated { "simulated" } else { "nodes" };
        let allowed: Vec<String> = allow_rigs.iter().map(ToString::to_string).collect();
        let given = [
            ("runs", text(runs.display().to_string())),
            ("rig", text(rig.to_owned())),
            ("allow_rigs", text(allowed.join(","))),
        ];
        nodes.push((
            "experiment_runner",
            given.map(|(name, value)| (name.to_owned(), value)).into(),
        ));
    }
    let own = nodes
        .into_iter()
        .map(|(node, values)| NodeParameters { pattern: format!("/**/{node}"), values });
    arguments.parameters.put_before(own.collect());
    Ok(arguments)
}

fn rig(options: &LiveOptions) -> Given {
    let SimulationOptions { drive, voltage_limit, period, substeps, .. } =
        options.test_bed.simulation;
    let mut given = Given::new();
    let mut give = |name: &str, value| _ = given.insert(name.to_owned(), value);
    give("rig", ParameterValue::String(options.rig.to_string()));
    give("autostart", ParameterValue::Boolean(true));
    give("voltage_limit", ParameterValue::Double(voltage_limit));
    let RigLimits { velocity, travel, .. } = options.limits;
    if let Some(velocity) = velocity {
        give("safety.velocity", ParameterValue::Double(velocity));
    }
    if let Some(Travel { min, max, margin }) = travel {
        give("safety.travel", ParameterValue::Boolean(true));
        give("safety.travel_min", ParameterValue::Double(min));
        give("safety.travel_max", ParameterValue::Double(max));
        give("safety.travel_margin", ParameterValue::Double(margin));
    }
    if options.rig == RigChoice::Simulated {
        let model = options.test_bed.friction.name().to_string();
        give("simulated.model", ParameterValue::String(model));
        // The command refuses seeds that do not fit.
        let seed = i64::try_from(options.seed).unwrap_or(i64::MAX);
        give("simulated.seed", ParameterValue::Integer(seed));
        give("simulated.substeps", ParameterValue::Integer(i64::from(substeps)));
        give("period", ParameterValue::Double(period));
    }
    give("drive.motor_constant", ParameterValue::Double(drive.motor_constant));
    give("drive.gear_ratio", ParameterValue::Double(drive.gear_ratio));
    give("drive.armature_resistance", ParameterValue::Double(drive.armature_resistance));
    give("drive.inertia", ParameterValue::Double(drive.inertia));
    if let Some(calibration) = &options.calibration {
        let sign = |sign: Sign| ParameterValue::Integer(i64::from(i8::from(sign)));
        give("calibration.encoder_sign", sign(calibration.encoder_sign));
        give("calibration.tachometer_gain", ParameterValue::Double(calibration.tachometer_gain));
        give("calibration.tachometer_zero", ParameterValue::Double(calibration.tachometer_zero));
        give("calibration.torque_sign", sign(calibration.torque_sign));
        give("calibration.torque_zero", ParameterValue::Double(calibration.torque_zero));
        give("calibration.deadband_forward", ParameterValue::Double(calibration.deadband_forward));
        give(
            "calibration.deadband_backward",
            ParameterValue::Double(calibration.deadband_backward),
        );
    }
    given
}

/// All models with their parameters, so that the model can be changed while the loop runs.
fn observer(
    options: &LiveOptions,
    estimator: &EstimatorOptions,
    period: f64,
) -> Result<Given, LiveError> {
    let regulated = match options.mode {
        ControlMode::Velocity => Regulated::Velocity,
        ControlMode::Position => Regulated::Position,
    };
    let mut given = Given::new();
    // The one that runs comes last, so that it is the one named.
    let others = ModelName::ALL.map(|name| options.models.get(name));
    for model in others.iter().chain([&options.observer()]) {
        let said = ObserverParameters::saying(model, estimator, regulated);
        given.extend(said.map_err(|error| LiveError::Parameters(error.to_string()))?);
    }
    given.insert("period".to_owned(), ParameterValue::Double(period));
    Ok(given)
}

fn control(options: &ControllerOptions) -> Result<Given, LiveError> {
    let mut given = ControllerParameters::saying(options)
        .map_err(|error| LiveError::Parameters(error.to_string()))?;
    given.insert("period".to_owned(), ParameterValue::Double(options.period));
    Ok(given)
}
