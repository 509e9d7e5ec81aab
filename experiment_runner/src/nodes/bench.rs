//! Nodes that the runs of an experiment take in turns.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use controller::{ControlMode, ControllerOptions, ControllerParameters};
use friction_model::AnyModel;
use friction_observer::EstimatorOptions;
use friction_observer::parameters::{ObserverParameters, Regulated};
use rig_driver::RigError;
use ros_node::RemoteParameters;
use ros_node::lifecycle::Phase;
use ros_node::parameters::ParameterError;
use ros_node::{Arguments, Discovery, ParameterValue, Participant, RosNodeError};

use super::link::{Event, FINDING, Led, Link, PATIENCE, STOPPING};
use super::nodes_loop::{NodesLoop, Task};
use rig_setup::RigSetupError;

/// Time over which the rig's period is measured.
const LISTEN: Duration = Duration::from_millis(500);
/// Largest relative difference between two periods that are the same.
const SAME: f64 = 1e-3;

/// The nodes of one axis, prepared for experiments. Dropped, the motor is at zero volts,
/// `/rig_driver` is inactive, and observer and controller have their own parameters again.
#[derive(Debug)]
pub struct NodesBench {
    link: Arc<Link>,
    stop: Arc<AtomicBool>,
    period: f64,
    voltage_limit: f64,
    torque_sensor: bool,
    own: Mutex<Own>,
    lost: Arc<AtomicU64>,
}

/// What the nodes had before, and have now.
#[derive(Debug, Default)]
struct Own {
    observer: Values,
    controller: Values,
    controller_was_active: bool,
    now: (Values, Values),
}

type Values = BTreeMap<String, ParameterValue>;

/// What the nodes are to do in one run.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// The controller.
    pub controller: &'a ControllerOptions,
    /// The observer's technique.
    pub estimator: &'a EstimatorOptions,
    /// The observer's model.
    pub model: &'a AnyModel,
}

impl NodesBench {
    /// Finds the nodes of an axis by its `namespace` (else `ROS_NAMESPACE`, else the root) on the
    /// network that the environment names, and brings the motor to zero volts. Once `stop` is set
    /// every run ends with [`RigError::Stopped`].
    ///
    /// # Errors
    /// [`RigSetupError`] names the node that is missing or does not fit, and how to mend it.
    pub fn open(namespace: Option<String>, stop: Arc<AtomicBool>) -> Result<Self, RigSetupError> {
        let (link, place) = found_link(namespace)?;
        led(&link.observer, "friction_observer", Phase::Active, &place)?;
        let controller_was_active = controller_at_rest(&link, &place)?;
        let period = measured_period(&link)?;
        let number = |of: &Led, name: &str| match of.parameters.get(&[name.to_owned()], FINDING) {
            Ok(values) => match values.get(name) {
                Some(ParameterValue::Double(value)) => Ok(*value),
                _ => Ok(f64::NAN),
            },
            Err(error) => Err(said(error)),
        };
        for (of, name) in [(&link.observer, "friction_observer"), (&link.controller, "controller")]
        {
            let its = number(of, "period")?;
            if (its / period - 1.0).abs() > SAME {
                return Err(RigSetupError::Nodes(format!(
                    "/{name} works at a period of {its} s, but the rig's is {period:.6} s; start it with -p period:={period:.6}"
                )));
            }
        }
        let voltage_limit = number(&link.rig, "voltage_limit")?;
        let source =
            link.rig.parameters.get(&["torque_source".to_owned()], FINDING).map_err(said)?;
        let sensor = ParameterValue::String("sensor".to_owned());
        Ok(Self {
            link: Arc::new(link),
            stop,
            period,
            voltage_limit: if voltage_limit > 0.0 { voltage_limit } else { f64::MAX },
            torque_sensor: source.values().all(|source| *source == sensor),
            own: Mutex::new(Own { controller_was_active, ..Own::default() }),
            lost: Arc::default(),
        })
    }

    /// Period of the cycle \[s\].
    #[must_use]
    pub const fn period(&self) -> f64 {
        self.period
    }

    /// What the rig's driver allows \[V\].
    #[must_use]
    pub const fn voltage_limit(&self) -> f64 {
        self.voltage_limit
    }

    /// Whether there is a torque sensor.
    #[must_use]
    pub const fn torque_sensor(&self) -> bool {
        self.torque_sensor
    }

    /// Cycles of which something was not heard so far.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }

    /// The parameters that say `wanted`, of observer and controller.
    ///
    /// # Errors
    /// [`ParameterError`] if no parameters say it.
    pub fn parameters(wanted: Wanted<'_>) -> Result<(Values, Values), ParameterError> {
        let regulated = match wanted.controller.mode {
            ControlMode::Velocity => Regulated::Velocity,
            ControlMode::Position => Regulated::Position,
        };
        Ok((
            ObserverParameters::saying(wanted.model, wanted.estimator, regulated)?,
            ControllerParameters::saying(wanted.controller)?,
        ))
    }

    /// The loop for one run: the nodes do what is `wanted`, the shaft has come to rest, the motor
    /// may move; its time and position are counted from here.
    ///
    /// # Errors
    /// [`RigError::Elsewhere`] says which node refused or does not answer.
    pub fn lend(&self, wanted: Wanted<'_>, task: Task) -> Result<NodesLoop, RigError> {
        let (observer, controller) =
            Self::parameters(wanted).map_err(|error| RigError::Elsewhere(error.to_string()))?;
        {
            let mut own = self.own.lock().unwrap_or_else(PoisonError::into_inner);
            if own.now != (observer.clone(), controller.clone()) {
                set(&self.link.observer.parameters, &observer, &mut own.observer)?;
                set(&self.link.controller.parameters, &controller, &mut own.controller)?;
                own.now = (observer, controller);
            }
        }
        let lost = Arc::clone(&self.lost);
        let voltage_limit = self.voltage_limit.min(wanted.controller.voltage_limit);
        let volts_per_newton_metre = wanted.controller.compensation.volts_per_newton_metre;
        let mut lent = NodesLoop::new(
            Arc::clone(&self.link),
            Arc::clone(&self.stop),
            self.period,
            task,
            (voltage_limit, volts_per_newton_metre),
            lost,
        );
        lent.begin(wanted.controller.mode)?;
        Ok(lent)
    }
}

impl Drop for NodesBench {
    fn drop(&mut self) {
        let own = self.own.get_mut().unwrap_or_else(PoisonError::into_inner);
        // A node that is gone cannot be left as it was.
        let _ = self.link.rig.lifecycle.lead_to(Phase::Inactive, STOPPING);
        for (of, values) in
            [(&self.link.observer, &own.observer), (&self.link.controller, &own.controller)]
        {
            if !values.is_empty() {
                let _ = of.parameters.set(values, STOPPING);
            }
        }
        if own.controller_was_active {
            let _ = self.link.controller.lifecycle.lead_to(Phase::Active, STOPPING);
        }
    }
}

/// Where the nodes of an axis are.
#[derive(Debug, Clone)]
pub(super) struct Place {
    /// Their namespace, as in `/axis_1`; empty for the root.
    pub(super) axis: String,
    domain: u16,
}

/// Joins the graph beside the nodes of an axis, by its `namespace` (else `ROS_NAMESPACE`, else the
/// root), and brings the motor to zero volts.
pub(super) fn found_link(namespace: Option<String>) -> Result<(Link, Place), RigSetupError> {
    let discovery = Discovery::from_environment().map_err(said)?;
    let given = || std::env::var("ROS_NAMESPACE").ok().filter(|namespace| !namespace.is_empty());
    let namespace = namespace.or_else(given);
    let axis = namespace.as_deref().unwrap_or("").trim_matches('/');
    let axis = if axis.is_empty() { String::new() } else { format!("/{axis}") };
    let arguments =
        Arguments { namespace, ..Arguments::default() }.or_enclave("/experiment_runner");
    let participant = Participant::join_with(&discovery, arguments).map_err(said)?;
    let link = Link::new(participant).map_err(said)?;
    let place = Place { axis, domain: discovery.domain };
    led(&link.rig, "rig_driver", Phase::Inactive, &place)?;
    Ok((link, place))
}

/// Leads a node of the axis to a phase; in which it was.
fn led(of: &Led, name: &str, goal: Phase, place: &Place) -> Result<Phase, RigSetupError> {
    let was = of.lifecycle.phase(FINDING).map_err(|error| {
        let Place { axis, domain } = place;
        RigSetupError::Nodes(format!(
            "the node {axis}/{name} was not found on domain {domain}: {error}; `frictionlab launch` or `frictionlab live` start it"
        ))
    })?;
    of.lifecycle.lead_to(goal, FINDING).map_err(said)?;
    Ok(was)
}

/// Lets the controller of the axis rest; whether it was active.
pub(super) fn controller_at_rest(link: &Link, place: &Place) -> Result<bool, RigSetupError> {
    Ok(led(&link.controller, "controller", Phase::Inactive, place)? == Phase::Active)
}

/// Sets `values`, and keeps in `own` what the node had before.
fn set(of: &RemoteParameters, values: &Values, own: &mut Values) -> Result<(), RigError> {
    let said = |error: RosNodeError| RigError::Elsewhere(error.to_string());
    let new: Vec<String> = values.keys().filter(|name| !own.contains_key(*name)).cloned().collect();
    if !new.is_empty() {
        own.extend(of.get(&new, FINDING).map_err(said)?);
    }
    of.set(values, FINDING).map_err(said)
}

/// The rig's period by its own clock \[s\].
pub(super) fn measured_period(link: &Link) -> Result<f64, RigSetupError> {
    link.begin(false);
    let until = Instant::now() + PATIENCE;
    let mut first: Option<(Instant, rig_driver::Measurement)> = None;
    while Instant::now() < until {
        let Some(Event::Measured { measurement, .. }) = link.next(Duration::from_millis(100))
        else {
            continue;
        };
        let (began, origin) = *first.get_or_insert_with(|| (Instant::now(), measurement));
        let cycles = measurement.cycle.saturating_sub(origin.cycle);
        if began.elapsed() > LISTEN && cycles > 0 {
            return Ok((measurement.time - origin.time) / cycles as f64);
        }
    }
    Err(RigSetupError::Nodes(
        "/rig_driver answers, but nothing is heard on /rig_measurement; is the topic remapped, or does a firewall stop multicast? See `frictionlab doctor`"
            .to_owned(),
    ))
}

pub(super) fn said(error: RosNodeError) -> RigSetupError {
    RigSetupError::Nodes(error.to_string())
}
