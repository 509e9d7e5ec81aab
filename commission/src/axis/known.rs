//! A rig that is looked at before it moves.

use std::sync::Arc;

use rig_driver::safety::{MotorThermal, Travel};
use rig_driver::{Calibration, Rig};
use rig_setup::{BenchRig, Heat, RigDescription};

use super::{Axis, Bench};
use crate::travel::{Kept, TravelAsked, switched_on};
use crate::{CommissionError, reach};

/// What is known of a rig before it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// What it says of itself, in a line.
    pub about: Option<String>,
    /// What it says of itself, number by number.
    pub description: Option<RigDescription>,
    /// Largest voltage \[V\].
    pub voltage: f64,
    /// Largest speed [rad/s].
    pub velocity: f64,
    /// Whether a torque sensor is there; it is not used.
    pub torque: bool,
    /// Period \[s\].
    pub period: f64,
    /// The winding, where the safety layer watches it.
    pub winding: Option<MotorThermal>,
    /// Where the shaft may be, by the rig's own count before it is calibrated.
    pub travel: Option<Travel>,
    /// When the device was switched on by its own clock, where it tells that \[s since the Unix epoch\].
    pub switched_on: Option<f64>,
    /// What the nodes that drive the rig put right before anybody sees it.
    pub corrected_by: Option<Calibration>,
}

impl Known {
    /// Voltage that the motor bears at rest for ever \[V\].
    #[must_use]
    pub fn continuous(&self) -> f64 {
        self.winding.map_or(f64::INFINITY, |motor| Heat(motor).continuous())
    }
}

impl Axis<'_> {
    /// Clears what is latched in the device. Nothing moves.
    ///
    /// # Errors
    /// [`CommissionError::Rig`] where its cause is still there.
    pub fn clear(&self) -> Result<(), CommissionError> {
        Ok(self.open()?.rig.clear()?)
    }

    /// Opens the rig, looks at it, and closes it. Nothing moves. The travel that is `asked` for is
    /// counted from where the shaft stands, one that was `kept` is by the rig's own count; where it is
    /// to be found there is none yet.
    ///
    /// # Errors
    /// [`CommissionError::Rig`] for a rig that is not there, or limits that contradict each other.
    pub fn look(
        &self,
        asked: Option<TravelAsked>,
        kept: Option<Kept>,
    ) -> Result<Known, CommissionError> {
        let mut opened = self.open()?;
        opened.limits.check(opened.rig.period())?;
        let known = Known {
            about: opened.about.clone(),
            description: opened.description.clone(),
            voltage: opened.limits.voltage,
            velocity: opened.limits.velocity,
            torque: opened.sensors.torque,
            period: opened.rig.period(),
            winding: opened.limits.motor,
            travel: opened.limits.travel,
            switched_on: None,
            corrected_by: self.opening.corrected_by(),
        };
        if let (Some(travel), Some(TravelAsked::Find(_))) = (known.travel, asked) {
            return Err(CommissionError::Asked(format!(
                "--travel find is for a rig whose travel is not known, and the limits of this one say that it is from {} to {} rad: leave out one of them",
                travel.min, travel.max
            )));
        }
        // Its first reading tells; a rig in lock-step has none to wait for.
        opened.rig.wait()?;
        let powered_for = opened.rig.powered_for();
        let known = Known { switched_on: powered_for.map(switched_on), ..known };
        let known = match kept {
            None => known,
            Some(kept) => {
                kept.check(self.opening.rig.is_simulated(), powered_for)?;
                Known { travel: Some(kept.travel), ..known }
            }
        };
        let around = match asked {
            Some(TravelAsked::Around(low, high)) => Some((low, high)),
            Some(TravelAsked::Find(_)) | None => None,
        };
        if known.travel.is_none() && around.is_none() {
            return Ok(known);
        }
        // Where it stands is no matter for the safety layer while nothing moves.
        opened.limits.travel = None;
        let bench = Bench(BenchRig::new(opened, Arc::clone(&self.stop))?);
        let place = bench.place()?;
        let asked = around.map(|around| reach::around(place, around));
        if let (Some(asked), Some(own)) = (&asked, &known.travel) {
            reach::check_inside(asked, own)?;
        }
        let travel = asked.or(known.travel);
        travel.as_ref().map_or(Ok(()), |travel| reach::check(travel, place))?;
        Ok(Known { travel, ..known })
    }
}
