//! The low-pass and the derivatives of one stretch.

use super::conditioned::{Conditioned, Piece};
use super::settings::Conditioning;
use super::sticks::{Stick, smallest_step, sticking};
use crate::IdentError;
use crate::zero_phase::LowPass;

/// What was recorded, all channels at the same instants.
#[derive(Debug, Clone, Copy)]
pub struct Signals<'a> {
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Position \[m or rad\].
    pub position: Option<&'a [f64]>,
    /// Position as its sensor gave it, where `position` went through a low-pass before: it shows
    /// where the axis sticks.
    pub readings: Option<&'a [f64]>,
    /// Velocity \[m/s or rad/s\]; the position is not used where this is given.
    pub velocity: Option<&'a [f64]>,
    /// Driving force \[N\] or torque \[N m\].
    pub force: &'a [f64],
}

/// Periods of a low-pass by which it spreads a step to each side.
const REACH: f64 = 0.25;
/// And within which it still rings by more than 2 % of the step.
const RINGS: f64 = 0.75;
/// Share of the fastest velocity above which a direction is clear.
const CLEAR: f64 = 0.01;

/// Filters, differentiates and trims a recording.
///
/// # Errors
/// [`IdentError`] for a sampling period, a cutoff or an order out of range, channels of different
/// length, values that are not finite, a missing motion, and too few samples for the filter or the
/// trimming.
pub fn condition(signals: &Signals, how: &Conditioning) -> Result<Conditioned, IdentError> {
    let dt = signals.time_step;
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(IdentError::TimeStep(dt));
    }
    let filter = LowPass::butterworth(how.order, how.cutoff, 1.0 / dt)?;
    if !(1..=1000).contains(&how.decimate) {
        return Err(IdentError::Decimation(how.decimate));
    }
    let n = signals.force.len();
    let channels = [
        ("the position", signals.position),
        ("the position as it was read", signals.readings),
        ("the velocity", signals.velocity),
        ("the force", Some(signals.force)),
    ];
    for (channel, values) in
        channels.iter().filter_map(|(name, values)| values.map(|values| (*name, values)))
    {
        if values.len() != n {
            return Err(IdentError::UnequalLengths { channel, found: values.len(), expected: n });
        }
        if let Some(index) = values.iter().position(|value| !crate::finite::usable(*value)) {
            return Err(IdentError::NotFinite { channel, index, value: values[index] });
        }
    }
    let needed = how.trim.saturating_mul(2).saturating_add(3).max(filter.padding() + 1);
    if n < needed {
        return Err(IdentError::TooFewSamples {
            what: "conditioning (low-pass and trimming)",
            needed,
            found: n,
            lower: Some("the trim or the filter order"),
        });
    }
    let position = signals.position.map(|position| filter.filter(position)).transpose()?;
    let (velocity, velocity_floor) = match (signals.velocity, signals.position, &position) {
        (Some(velocity), ..) => (filter.filter(velocity)?, rounding(velocity)),
        (None, Some(raw), Some(smooth)) => (how.differences.of(smooth, dt), rounding(raw) / dt),
        _ => return Err(IdentError::NoMotion),
    };
    let acceleration = if how.acceleration_cutoff < how.cutoff {
        let filter = LowPass::butterworth(how.order, how.acceleration_cutoff, 1.0 / dt)?;
        how.differences.of(&filter.filter(&velocity)?, dt)
    } else {
        how.differences.of(&velocity, dt)
    };
    let force = if how.low_pass_force { &filter.filter(signals.force)? } else { signals.force };
    let kept = how.trim..n - how.trim;
    let all = 0..kept.len();
    let way = first_way(&velocity, velocity_floor);
    let origin = kept.clone();
    let readings = signals.readings.or(signals.position).unwrap_or_default();
    let step = smallest_step(readings);
    let spread = REACH / how.cutoff.min(how.acceleration_cutoff);
    let reach = [REACH, RINGS].map(|periods| (spread * periods / REACH / dt).round() as usize);
    let mut sticks = sticking(readings, step, reach);
    sticks.resize(n, Stick::Away);
    let pieces = vec![Piece { stretch: 0, kept: all, origin, begin: 0, way, start: 0.0 }];
    Ok(Conditioned {
        pieces,
        time_step: dt,
        first: how.trim,
        position: position.map(|position| position[kept.clone()].to_vec()),
        velocity: velocity[kept.clone()].to_vec(),
        acceleration: acceleration[kept.clone()].to_vec(),
        force: force[kept.clone()].to_vec(),
        sampled: dt,
        spread,
        sticking: false,
        stops_to_turn: false,
        step,
        sticks: sticks[kept].to_vec(),
        acceleration_floor: velocity_floor / dt,
        velocity_floor,
        decimate: how.decimate,
        lived: velocity,
        stride: ((0.5 / (dt * how.cutoff)).round() as usize).max(1),
    })
}

/// The size of what filtering in double precision can leave of a signal that should be smooth.
fn rounding(signal: &[f64]) -> f64 {
    1e-12 * signal.iter().fold(0.0f64, |largest, value| largest.max(value.abs()))
}

/// The direction of the first motion that is no noise.
fn first_way(velocity: &[f64], floor: f64) -> f64 {
    let fastest = velocity.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    let clear = floor.max(CLEAR * fastest);
    velocity.iter().find(|v| v.abs() > clear).map_or(0.0, |v| v.signum())
}
