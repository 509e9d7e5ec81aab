//! The options of a live run as the parameters that its nodes are given, so that the nodes tell
//! what is true.

use std::collections::BTreeMap;

use controller::{ControlMode, ControllerOptions, ControllerParameters};
use experiment_runner::server::parameters::RunnerParameters;
use friction_model::ModelName;
use friction_observer::EstimatorOptions;
use friction_observer::parameters::{ObserverParameters, Regulated};
use rig_driver::parameters::RigParameters;
use rig_driver::{RigSetup, SimulationOptions};
use ros_node::parameter_file::NodeParameters;
use ros_node::parameters::Declared;
use ros_node::{Arguments, ParameterValue};

use super::{LiveError, LiveOptions, Serving};
use rig_setup::RigChoice;

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
        ("controller", control(&controller, &options.of_files.controller)?),
    ];
    if let Some(serving) = &options.serve {
        nodes.push(("experiment_runner", runner(options, serving)));
    }
    let own = nodes
        .into_iter()
        .map(|(node, values)| NodeParameters { pattern: format!("/**/{node}"), values });
    arguments.parameters.put_before(own.collect());
    Ok(arguments)
}

fn rig(options: &LiveOptions) -> Given {
    let setup = RigSetup {
        calibration: options.calibration,
        limits: options.limits,
        simulation: SimulationOptions { seed: options.seed, ..options.test_bed.simulation },
        friction: options.test_bed.friction,
        wiring: None,
    };
    // A real rig activates itself here too: who runs this is at the rig.
    RigParameters { autostart: true, ..RigParameters::of(&options.rig, &setup) }.values().into()
}

fn runner(options: &LiveOptions, serving: &Serving) -> Given {
    // On a real rig its experiments run too. A simulated one of their own needs no real time.
    let rig = if options.rig == RigChoice::Simulated { "simulated" } else { "nodes" };
    let allowed: Vec<String> = serving.allow_rigs.iter().map(ToString::to_string).collect();
    RunnerParameters {
        runs: serving.runs.display().to_string(),
        rig: rig.to_owned(),
        allow_rigs: allowed.join(","),
        ..RunnerParameters::default()
    }
    .values()
    .into()
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
    given.extend(options.of_files.observer.clone());
    Ok(given)
}

fn control(options: &ControllerOptions, of_files: &Given) -> Result<Given, LiveError> {
    let mut given = ControllerParameters::saying(options)
        .map_err(|error| LiveError::Parameters(error.to_string()))?;
    given.insert("period".to_owned(), ParameterValue::Double(options.period));
    given.extend(of_files.clone());
    Ok(given)
}
