//! Strokes: steady voltages to and fro where the travel has ends.
//!
//! A stroke ends in time: what the shaft coasted after the strokes before says how far it will. Each
//! is a little stronger than the one before, until the travel is too short for a stronger one.

use rig_driver::Measurement;

use super::{RigSetupError, Session};

/// Where a stroke may go, by the rig's own count \[rad\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Room {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Time in which a shaft of which nothing is known may coast \[s\].
const COASTS: f64 = 0.5;
/// How much longer than it was seen to.
const MORE: f64 = 1.6;
/// Shortest time that is believed \[s\].
const SHORTEST: f64 = 0.02;
/// Time over which the speed is told while it goes \[s\].
const SPEED: f64 = 0.01;
/// Longest stroke \[s\], and the shortest that says something.
const LONGEST: f64 = 1.2;
const TOO_SHORT: f64 = 0.12;
/// What the first is above the voltage that moves the shaft, as a share of it, and how much more
/// each further one is.
const FIRST: f64 = 0.05;
const GROWS: f64 = 1.6;
/// Pairs of strokes at most, and strokes that lead the shaft back into its room.
const PAIRS: u32 = 8;

/// Strokes of voltages above `start` \[V\], at most `most` and in pairs: each voltage, and the second
/// half of what was seen under it. `forward` is the way that the encoder counts at a positive voltage.
pub(super) fn strokes(
    session: &mut Session<'_>,
    room: Room,
    (start, most): (f64, f64),
    forward: f64,
    settle: f64,
) -> Result<Vec<(f64, Vec<Measurement>)>, RigSetupError> {
    let mut coasts = COASTS;
    let mut found = Vec::new();
    let mut above = FIRST * start;
    for _ in 0..PAIRS {
        let volts = (start + above).min(most);
        // Towards the farther end first.
        let place = session.step(|_| 0.0)?.encoder_position;
        let first = if (room.high - place) > (place - room.low) { forward } else { -forward };
        let mut pair = Vec::new();
        for direction in [first, -first] {
            let (seen, coasted) = stroke(session, room, direction * volts, coasts, settle)?;
            if let Some(coasted) = coasted {
                coasts =
                    if pair.is_empty() && found.is_empty() { coasted } else { coasts.max(coasted) };
            }
            pair.push((direction * volts, seen));
            session.cool()?;
        }
        let shortest = pair.iter().map(|(_, seen)| seen.len()).min().unwrap_or_default();
        let seconds = shortest as f64 * session.period();
        if seconds < TOO_SHORT && !found.is_empty() {
            break;
        }
        // Forwards before backwards, as whoever reads them expects.
        pair.sort_by(|a, b| b.0.total_cmp(&a.0));
        found
            .extend(pair.into_iter().map(|(volts, seen)| (volts, seen[seen.len() / 2..].to_vec())));
        if volts >= most || seconds < TOO_SHORT {
            break;
        }
        above *= GROWS;
    }
    Ok(found)
}

/// One stroke, and the time in which the shaft coasted to rest behind it \[s\], where that was seen.
fn stroke(
    session: &mut Session<'_>,
    room: Room,
    volts: f64,
    coasts: f64,
    settle: f64,
) -> Result<(Vec<Measurement>, Option<f64>), RigSetupError> {
    let cycles = (LONGEST / session.period()) as usize;
    let span = ((SPEED / session.period()) as usize).max(1);
    let mut seen: Vec<Measurement> = Vec::with_capacity(cycles);
    let mut speed = 0.0;
    for _ in 0..cycles {
        let now = session.step(|_| volts)?;
        seen.push(now);
        if let Some(before) = seen.len().checked_sub(span + 1).and_then(|at| seen.get(at)) {
            speed = (now.encoder_position - before.encoder_position) / (now.time - before.time);
        }
        let stops = now.encoder_position + speed * coasts;
        let leaves = (speed > 0.0 && stops > room.high) || (speed < 0.0 && stops < room.low);
        if leaves || !speed.is_finite() {
            break;
        }
    }
    let rest = session.hold(0.0, settle.max(2.0 * coasts))?;
    let end = seen.last().map_or(0.0, |seen| seen.encoder_position);
    let way = rest.last().map_or(0.0, |rest| (rest.encoder_position - end).abs());
    let coasted = (MORE * way / speed.abs()).max(SHORTEST);
    Ok((seen, coasted.is_finite().then_some(coasted.min(COASTS))))
}
