//! The axis, opened for a run.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use friction_ident::TorqueSource;

use super::Axis;
#[cfg(feature = "ros")]
use crate::nodes::NodesBench;
use crate::run::experiment::Experiment;
use crate::run::{RunError, RunOptions};
use rig_setup::{
    BenchRig, Opened, Reopen, RigChoice, RigSetup, RigSetupError, SensorsPresent, require_device,
};
use work::progress::Progress;

/// Opens the real rig, or finds the nodes, if that was chosen. The options that come back have its
/// period and voltage limit.
///
/// # Errors
/// [`RunError::Setup`] if it does not open; [`RunError::NoSensor`] if it lacks what the experiments
/// read.
pub(in crate::run) fn open(
    options: &RunOptions,
    progress: &Progress,
    cancel: &Arc<AtomicBool>,
) -> Result<(Axis, RunOptions), RunError> {
    let mut options = options.clone();
    if options.rig == RigChoice::Simulated {
        return Ok((Axis::Simulated, options));
    }
    if let RigChoice::Nodes { namespace } = options.rig.clone() {
        return open_nodes(options, namespace, progress, cancel);
    }
    let opened = opened(&options)?;
    require_sensors(&options, opened.sensors)?;
    let again = options.clone();
    opened.about.iter().for_each(|about| progress.line(about));
    let rig = if again.rig.comes_back() {
        let reopen: Reopen = Box::new(move || self::opened(&again));
        BenchRig::reopening(opened, Arc::clone(cancel), reopen)?
    } else {
        // A card whose watchdog expired is not driven again by itself.
        BenchRig::new(opened, Arc::clone(cancel))?
    };
    let simulation = &mut options.test_bed.simulation;
    simulation.period = rig.period();
    simulation.voltage_range = rig.voltage_range();
    simulation.voltage_limit = simulation.voltage_limit.min(rig.voltage_limit());
    Ok((Axis::Real(Box::new(rig)), options))
}

/// The real rig, open and the one that its profile is of.
fn opened(options: &RunOptions) -> Result<Opened, RigSetupError> {
    let setup = RigSetup {
        calibration: options.calibration,
        limits: options.limits,
        friction: options.test_bed.friction,
        ..RigSetup::default()
    };
    let opened = options.rig.open(&setup)?;
    let profile = options.rig_profile.as_ref().and_then(|profile| profile.description.as_ref());
    if let Some(expected) = profile {
        require_device(expected, &options.rig, opened.description.as_ref())?;
    }
    Ok(opened)
}

#[cfg(feature = "ros")]
fn open_nodes(
    mut options: RunOptions,
    namespace: Option<String>,
    progress: &Progress,
    cancel: &Arc<AtomicBool>,
) -> Result<(Axis, RunOptions), RunError> {
    progress.stage("looking for the nodes");
    let nodes = NodesBench::open(namespace, Arc::clone(cancel))?;
    require_sensors(&options, SensorsPresent { torque: nodes.torque_sensor(), current: false })?;
    progress.line(&format!(
        "the nodes are there: a cycle every {:.3} ms, at most {:.2} V",
        nodes.period() * 1e3,
        nodes.voltage_limit()
    ));
    let simulation = &mut options.test_bed.simulation;
    simulation.period = nodes.period();
    simulation.voltage_limit = simulation.voltage_limit.min(nodes.voltage_limit());
    Ok((Axis::Nodes(nodes), options))
}

#[cfg(not(feature = "ros"))]
fn open_nodes(
    _options: RunOptions,
    _namespace: Option<String>,
    _progress: &Progress,
    _cancel: &Arc<AtomicBool>,
) -> Result<(Axis, RunOptions), RunError> {
    Err(RigSetupError::Nodes(
        "this program was built without ROS 2: build it with the feature `ros`".to_owned(),
    )
    .into())
}

fn require_sensors(options: &RunOptions, sensors: SensorsPresent) -> Result<(), RunError> {
    if !options.experiment.parts().any(Experiment::reads_torque) {
        return Ok(());
    }
    match options.torque.source {
        TorqueSource::Sensor if !sensors.torque => Err(RunError::NoSensor {
            sensor: "torque sensor",
            instead: if sensors.current { "current (or voltage)" } else { "voltage" },
        }),
        TorqueSource::Current if !sensors.current => Err(RunError::NoSensor {
            sensor: "measurement of the motor current",
            instead: "voltage",
        }),
        _ => Ok(()),
    }
}
