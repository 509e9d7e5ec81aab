//! The voltage at which an axis at rest begins to move.

use serde::Serialize;

use crate::conditioning::{Conditioned, Piece};

/// One start of motion out of rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Breakaway {
    /// When, since the recording's first sample \[s\].
    pub time: f64,
    /// Voltage at which it began \[V\].
    pub voltage: f64,
    /// Direction of the motion that followed, 1 or -1.
    pub direction: f64,
}

/// How long the axis must have rested \[s\].
const REST: f64 = 0.1;
/// Fastest change of the voltage that counts as slow \[V/s\]: a step would overshoot the deadband.
const SLOW: f64 = 3.0;

/// Longest time from rest to motion, and on to twice its speed \[s\].
const START: f64 = 1.0;

/// All starts of motion in a recording whose force is the voltage: at least 0.1 s below a hundredth
/// of the largest speed while the voltage changes by less than 3 V/s, then beyond 5 % and 10 % of
/// the largest speed, each within a second.
///
/// The voltage is carried back to zero speed along the line through these two moments. Slower
/// speeds do not count, because a contact creeps before it breaks away: where friction hardly falls
/// with speed this is the sliding level, and where it falls much the axis jumps and it is the
/// breakaway level itself. It contains the voltage that accelerates the axis, `T` times the rate of
/// the voltage.
pub fn breakaways(recording: &Conditioned) -> Vec<Breakaway> {
    let fastest = recording.velocity.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    recording.pieces.iter().flat_map(|piece| within(recording, piece, fastest)).collect()
}

/// Those within one stretch of it.
fn within(recording: &Conditioned, piece: &Piece, fastest: f64) -> Vec<Breakaway> {
    let Conditioned { velocity, force, time_step, first, .. } = recording;
    let velocity = velocity.get(piece.kept.clone()).unwrap_or_default();
    let force = force.get(piece.kept.clone()).unwrap_or_default();
    let (still, moving) = (0.01 * fastest, 0.05 * fastest);
    let samples = |seconds: f64| (seconds / time_step).ceil() as usize;
    let mut found = Vec::new();
    // First and last sample of the present rest.
    let mut rest: Option<(usize, usize)> = None;
    for (k, &v) in velocity.iter().enumerate() {
        if v.abs() < still {
            // A rest that was left and is entered again, without motion between, goes on.
            rest = Some(rest.map_or((k, k), |(start, _)| (start, k)));
        } else if v.abs() > moving
            && let Some((start, last)) = rest.take()
            && last - start >= samples(REST)
            && k - last < samples(START)
        {
            let direction = v.signum();
            let later = velocity.iter().skip(k).take(samples(START));
            let Some(ahead) = later.into_iter().position(|&v| v * direction > 2.0 * moving) else {
                continue;
            };
            let at = |column: &[f64], k: usize| column.get(k).copied().unwrap_or(0.0);
            let rate = (at(force, last) - at(force, last - samples(REST))) / REST;
            let (gain, rise) = (at(velocity, k + ahead) - v, at(force, k + ahead) - at(force, k));
            let voltage = at(force, k) - v * rise / gain;
            if rate.abs() < SLOW && voltage * direction > 0.0 {
                found.push(Breakaway {
                    time: piece.start + (first + last) as f64 * time_step,
                    voltage,
                    direction,
                });
            }
        }
    }
    found
}
