//! Meet: signs, zeros, noise, and the voltages that just move the shaft.
//!
//! The steps are those of `frictionlab rig calibrate` ([`rig_setup::run_procedure`]): at rest, slow
//! ramps of voltage from zero until the encoder moves, then steady voltages above that.

use rig_driver::Calibration;
use rig_driver::safety::Travel;
use rig_setup::{Level, Procedure, RigDescription, Room, run_procedure};
use serde::{Deserialize, Serialize};

use crate::axis::{Axis, Known};
use crate::ends::{self, Sought};
use crate::noticed::{as_stated, noticed};
use crate::travel::TravelAsked;
use crate::{CommissionError, Stage};

/// Time in which a ramp would reach the voltage limit \[s\].
const RAMP: f64 = 12.0;
/// Highest voltage of the stage, as a share of the limit.
const SHARE: f64 = 0.95;
/// Highest steady voltage above the one that moves the shaft, as a share of the limit.
const ABOVE: f64 = 0.25;
/// Where a ramp begins that is not the first, as a share of what moved the shaft before.
const AGAIN: f64 = 0.6;
/// Share of the speed limit that the stage stays below.
const SPEED_SHARE: f64 = 0.6;
/// Steady voltages in each direction.
const LEVELS: u32 = 5;
/// Longest time of the stage that is usual \[s\].
const SECONDS: f64 = 90.0;
/// The slowest speed at the highest voltage from which a slope can be told [rad/s].
const SLOWEST: f64 = 1e-3;

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Met {
    /// What the device says of itself.
    pub description: Option<RigDescription>,
    /// What puts the readings right.
    pub calibration: Calibration,
    /// Whether the tachometer shows the motion; nothing depends on it.
    pub tachometer: bool,
    /// Whether the torque sensor shows the friction; nothing depends on it.
    pub torque: bool,
    /// Voltage that just moves the shaft, the larger of both directions \[V\].
    pub deadband: f64,
    /// Volts per speed above the deadband, roughly [V s/rad].
    pub slope: f64,
    /// Noise of the tachometer \[rad/s\].
    pub tachometer_noise: f64,
    /// What was not as expected and is put right.
    pub corrected: Vec<String>,
    /// What was noticed of sensors that contradict each other, or say nothing.
    #[serde(default)]
    pub noticed: Vec<String>,
    /// The fastest speed by the encoder, where a contradiction made it less [rad/s].
    #[serde(default)]
    pub fastest: Option<f64>,
    /// The ends of the travel, where they were looked for.
    #[serde(default)]
    pub sought: Option<Sought>,
}

impl Met {
    /// Voltage that breaks the shaft loose, the mean of both directions: a load falls out of it \[V\].
    #[must_use]
    pub fn breakaway(&self) -> f64 {
        0.5 * (self.calibration.deadband_forward + self.calibration.deadband_backward)
    }

    /// What is known of a rig, with the travel that was found for it and a speed that holds by all its
    /// sensors.
    #[must_use]
    pub fn known(&self, known: &Known) -> Known {
        let travel = known.travel.or(self.sought.and_then(|sought| sought.travel));
        let velocity = known.velocity.min(self.fastest.unwrap_or(f64::INFINITY));
        Known { travel, velocity, ..known.clone() }
    }
}

/// Does the stage; a travel that was to be found is told to `keep` before anything faster is driven.
/// `stated` is what the user's file says of the sensors: what contradicts it is refused.
///
/// # Errors
/// [`CommissionError`] if the rig refuses, does not move, or shows what no wiring explains.
pub fn meet(
    axis: &mut Axis<'_>,
    known: &Known,
    (asked, stated): (Option<TravelAsked>, Option<Calibration>),
    keep: impl FnOnce(Option<Travel>) -> Result<(), CommissionError>,
) -> Result<Met, CommissionError> {
    let sought = match asked {
        Some(TravelAsked::Find(angle)) => Some(ends::find(axis, known, angle)?),
        Some(TravelAsked::Around(..)) | None => None,
    };
    if let Some(sought) = &sought {
        axis.tell(&format!("travel: {sought}"));
        keep(sought.travel)?;
        axis.stay_within(sought.travel);
    }
    axis.reserve(Stage::Meet, SECONDS)?;
    let volts = SHARE * known.voltage;
    let procedure = Procedure {
        ramp: known.voltage / RAMP,
        again: AGAIN,
        above: Some(ABOVE * known.voltage),
        fastest: Some(SPEED_SHARE * known.velocity),
        levels: LEVELS,
        room: axis.reach().map(|reach| Room { low: reach.low, high: reach.high }),
        ..Procedure::default()
    };
    let found = axis.session(volts, |session, say| run_procedure(session, &procedure, say))?;
    let seen = noticed(&found, known);
    seen.said.iter().for_each(|said| axis.tell(said));
    as_stated(&found, stated, known)?;
    let deadband = found.deadband_forward.value.max(found.deadband_backward.value);
    let slope = slope(&found.levels).ok_or_else(|| CommissionError::Unusable {
        stage: Stage::Meet,
        why: match axis.reach() {
            None => format!(
                "the speed hardly changes up to {volts} V, so that nothing can be said of the drive; `frictionlab rig check --max-volts V` shows what more does"
            ),
            Some(reach) => format!(
                "in strokes within {:.2} rad the shaft did not turn at two speeds that differ clearly, so that nothing can be said of the drive: it breaks away too fast to be stopped within the travel; a longer travel helps, or `frictionlab identify-stiction` on a recording of the axis",
                reach.length()
            ),
        },
    })?;
    // A sensor that is not there is nothing to be put right.
    let there = |what: &str| match what {
        "tachometer gain" => found.tachometer_gain.is_some(),
        "torque sign" => found.torque_sign.is_some(),
        _ => true,
    };
    let corrected: Vec<String> = found
        .verdicts()
        .into_iter()
        .filter(|verdict| there(verdict.what))
        .filter_map(|verdict| Some(format!("{}: {}", verdict.what, verdict.wrong?)))
        .collect();
    corrected.iter().for_each(|said| axis.tell(&format!("put right: {said}")));
    Ok(Met {
        noticed: seen.said,
        fastest: seen.fastest,
        description: known.description.clone(),
        calibration: found.calibration(),
        tachometer: found.tachometer_gain.is_some(),
        torque: found.torque_sign.is_some(),
        deadband,
        slope,
        tachometer_noise: found.tachometer_residual,
        corrected,
        sought,
    })
}

/// Volts per speed between the lowest and the highest steady voltage.
fn slope(levels: &[Level]) -> Option<f64> {
    // Both directions of a level, so that a load that helps one way does not count.
    let mean = |pair: &[Level]| match pair {
        [a, b] => Some((0.5 * (a.volts - b.volts).abs(), 0.5 * (a.velocity - b.velocity).abs())),
        _ => None,
    };
    let points: Vec<(f64, f64)> = levels.chunks(2).filter_map(mean).collect();
    let (low, high) = (points.first()?, points.last()?);
    let speed = high.1 - low.1;
    let slope = (high.0 - low.0) / speed;
    (speed > SLOWEST && slope > 0.0 && slope.is_finite()).then_some(slope)
}
