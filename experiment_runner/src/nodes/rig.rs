//! The rig of the running nodes, for whoever drives a rig cycle by cycle.
//!
//! A reading is what `/rig_measurement` says of a cycle, and a voltage is published on
//! `/motor_voltage` in answer to it. `/rig_driver` has its own safety layer; another one stands here,
//! so that what drives is stopped for the same reasons as on a rig of its own. The controller rests.

use std::sync::Arc;
use std::time::{Duration, Instant};

use parameters::{Declared, Values};
use rig_driver::registry::{Opened, Pace, RigSetup, SensorsPresent};
use rig_driver::safety::{RigLimits, SafetyLimits, Travel};
use rig_driver::{Calibrated, Calibration, Measurement, Rig, RigError};
use rig_setup::RigSetupError;
use ros_node::ParameterValue;
use ros_node::lifecycle::Phase;

use super::bench::{controller_at_rest, found_link, measured_period, said};
use super::link::{Event, FINDING, Link, PATIENCE, STOPPING};

/// Time without a measurement after which the driver counts as gone.
const SILENCE: Duration = Duration::from_millis(500);
/// How long it may take to hear why the driver stopped the motor.
const TELLING: Duration = Duration::from_millis(1500);

/// The nodes of one axis, found, with what `/rig_driver` is set to. Clones are one.
#[derive(Debug, Clone)]
pub struct NodesAxis {
    link: Arc<Found>,
    period: f64,
    /// What the driver allows.
    limits: RigLimits,
    /// What it puts right already.
    calibration: Calibration,
    axis: String,
}

/// The link. Dropped, it leaves the controller as it was.
#[derive(Debug)]
struct Found {
    link: Arc<Link>,
    controller_was_active: bool,
}

impl Drop for Found {
    fn drop(&mut self) {
        let _ = self.link.rig.lifecycle.lead_to(Phase::Inactive, STOPPING);
        if self.controller_was_active {
            let _ = self.link.controller.lifecycle.lead_to(Phase::Active, STOPPING);
        }
    }
}

impl NodesAxis {
    /// Finds the nodes of an axis by its `namespace` (else `ROS_NAMESPACE`, else the root), and
    /// brings the motor to zero volts.
    ///
    /// # Errors
    /// [`RigSetupError::Nodes`] names the node that is missing, and how to start it.
    pub fn find(namespace: Option<String>) -> Result<Self, RigSetupError> {
        let (link, place) = found_link(namespace)?;
        let controller_was_active = controller_at_rest(&link, &place)?;
        let link = Arc::new(Found { link: Arc::new(link), controller_was_active });
        let period = measured_period(&link.link)?;
        let asked = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
            link.link.rig.parameters.get(&names, FINDING).map_err(said)
        };
        let set = asked(&[
            "voltage_limit",
            "safety.velocity",
            "safety.travel",
            "safety.travel_min",
            "safety.travel_max",
            "safety.travel_margin",
        ])?;
        let number = |name: &str| match set.get(name) {
            Some(ParameterValue::Double(value)) => Some(*value),
            _ => None,
        };
        let limited = set.get("safety.travel") == Some(&ParameterValue::Boolean(true));
        let travel = limited.then(|| {
            Some(Travel {
                min: number("safety.travel_min")?,
                max: number("safety.travel_max")?,
                margin: number("safety.travel_margin")?,
            })
        });
        let limits = RigLimits {
            voltage: number("voltage_limit"),
            velocity: number("safety.velocity").filter(|velocity| *velocity > 0.0),
            travel: travel.flatten(),
            ..RigLimits::default()
        };
        let names: Vec<String> = Calibration::default()
            .declarations()
            .iter()
            .map(|one| format!("calibration.{}", one.name()))
            .collect();
        let its = link.link.rig.parameters.get(&names, FINDING).map_err(said)?;
        let given = its
            .into_iter()
            .filter_map(|(name, value)| {
                Some((name.strip_prefix("calibration.")?.to_owned(), value))
            })
            .collect();
        let values = Values::given(&Calibration::default().declarations(), &given)
            .map_err(|error| RigSetupError::Nodes(error.to_string()))?;
        let calibration = Calibration::default().with(&values);
        Ok(Self { link, period, limits, calibration, axis: place.axis })
    }

    /// What the driver puts right already, before anybody sees it.
    #[must_use]
    pub const fn calibration(&self) -> &Calibration {
        &self.calibration
    }

    /// The rig, with the motor at zero volts. The limits of `setup` count where they are narrower
    /// than the driver's.
    ///
    /// # Errors
    /// [`RigSetupError`] where a limit cannot be.
    pub fn open(&self, setup: &RigSetup) -> Result<Opened, RigSetupError> {
        let range = self.limits.voltage.unwrap_or(SafetyLimits::default().voltage);
        let narrower = |asked: Option<f64>, its: Option<f64>| match (asked, its) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        let limits = RigLimits {
            voltage: narrower(setup.limits.voltage, self.limits.voltage),
            velocity: narrower(setup.limits.velocity, self.limits.velocity),
            travel: setup.limits.travel.or(self.limits.travel),
            ..setup.limits
        };
        // The driver watches the sensors that it has; what is not there is not known here.
        let mut usual = SafetyLimits::default().before_calibration();
        usual.sensors.torque_range = None;
        usual.sensors.frozen_cycles = None;
        let limits = limits.on(usual, range, false)?;
        let rig = NodesRig {
            link: Arc::clone(&self.link),
            period: self.period,
            range,
            newest: None,
            waited: false,
            active: false,
            first: None,
        };
        let rig: Box<dyn Rig + Send> = match setup.calibration {
            Some(calibration) => Box::new(Calibrated::new(rig, calibration)?),
            None => Box::new(rig),
        };
        let sensors = SensorsPresent { torque: false, current: false };
        let about = Some(format!(
            "the nodes of {}: a cycle every {:.3} ms, at most {range:.2} V",
            if self.axis.is_empty() { "the root namespace" } else { &self.axis },
            1e3 * self.period
        ));
        Ok(Opened { rig, limits, pace: Pace::Device, sensors, about, description: None })
    }
}

/// The rig of the nodes. Dropped, it leaves the motor at zero volts and the driver inactive.
struct NodesRig {
    link: Arc<Found>,
    period: f64,
    range: f64,
    newest: Option<(u64, Measurement)>,
    waited: bool,
    active: bool,
    /// The first cycle and time: those of the driver began with it.
    first: Option<(u64, f64)>,
}

impl NodesRig {
    fn gone(&self, what: &str) -> RigError {
        RigError::Elsewhere(format!("{what}; the motor is at zero volts"))
    }
}

impl Rig for NodesRig {
    fn period(&self) -> f64 {
        self.period
    }

    fn voltage_range(&self) -> f64 {
        self.range
    }

    fn keeps_time(&self) -> bool {
        true
    }

    fn wait(&mut self) -> Result<(), RigError> {
        let link = &self.link.link;
        let end = Instant::now() + SILENCE;
        let mut fresh = None;
        // What lies there already: the newest counts. If nothing does, the next is waited for.
        while let Some(event) = link.next(Duration::ZERO) {
            if let Event::Measured { stamp_ns, measurement } = event {
                fresh = Some((stamp_ns, measurement));
            }
        }
        while fresh.is_none() {
            let left = end.saturating_duration_since(Instant::now());
            match link.next(left) {
                Some(Event::Measured { stamp_ns, measurement }) => {
                    fresh = Some((stamp_ns, measurement));
                }
                Some(Event::Whole(_)) => {}
                None => {
                    return Err(self.gone(
                        "/rig_driver was not heard for half a second: it ended, hangs, or this machine is too busy",
                    ));
                }
            }
        }
        if self.active && link.was_deactivated() {
            self.active = false;
            return Err(match link.fault(TELLING) {
                Some(fault) => self.gone(&format!("/rig_driver stopped the motor: {fault}")),
                None => self.gone("somebody deactivated /rig_driver"),
            });
        }
        self.newest = fresh;
        self.waited = true;
        Ok(())
    }

    fn measure(&mut self) -> Measurement {
        let failed = !self.waited && self.wait().is_err();
        self.waited = false;
        let Some((_, seen)) = self.newest else {
            return Measurement { fault: true, ..Measurement::default() };
        };
        let (cycle, time) = *self.first.get_or_insert((seen.cycle, seen.time));
        Measurement {
            cycle: seen.cycle.saturating_sub(cycle),
            time: seen.time - time,
            fault: seen.fault || failed,
            ..seen
        }
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        if !volts.is_finite() {
            return Err(RigError::VoltageNotFinite(volts));
        }
        match self.newest {
            Some((stamp_ns, _)) if self.active => self
                .link
                .link
                .drive(stamp_ns, volts)
                .map_err(|error| RigError::Elsewhere(error.to_string())),
            // A motor that may not move has zero volts already.
            _ if volts == 0.0 => Ok(()),
            _ => Err(self.gone("/rig_driver is not active")),
        }
    }

    fn activate(&mut self) -> Result<(), RigError> {
        let link = &self.link.link;
        link.rig
            .lifecycle
            .lead_to(Phase::Active, PATIENCE)
            .map_err(|error| RigError::Elsewhere(error.to_string()))?;
        link.begin(false);
        self.active = true;
        Ok(())
    }

    fn halt(&mut self) -> Result<(), RigError> {
        self.apply(0.0)
    }

    fn deactivate(&mut self) -> Result<(), RigError> {
        if !std::mem::take(&mut self.active) {
            return Ok(());
        }
        if let Some((stamp_ns, _)) = self.newest {
            // At once; the transition takes a moment.
            let _ = self.link.link.drive(stamp_ns, 0.0);
        }
        let led = self.link.link.rig.lifecycle.lead_to(Phase::Inactive, STOPPING);
        led.map(drop).map_err(|error| RigError::Elsewhere(error.to_string()))
    }

    fn emergency_stop(&mut self) -> Result<(), RigError> {
        self.deactivate()
    }
}

impl Drop for NodesRig {
    fn drop(&mut self) {
        // Where the driver is gone its own watch has stopped the motor.
        let _ = self.deactivate();
    }
}
