//! Position behind an encoder: what lies between the counts.
//!
//! An encoder that rounds down tells the position to within a count `[k, k + 1)`. In pre-sliding
//! that matters: with 4096 counts a turn the breakaway displacement of the thesis's test bed is 3.9
//! counts, and a fit to the raw counts finds it several percent too large, because a staircase
//! reaches less far than the motion does. What is exact are the instants at which the count
//! changes: there the position is the edge between both counts. [`between_counts`] runs a path
//! through these edges, and beyond the last edge before a turn as far as the motion says: straight
//! to a corner, or on legs that are half a cosine each. The first edges say how far inside its
//! count the path starts.
//!
//! A motion that changes counts often enough is asked for: a leg within one count leaves no trace.
//! [`step_of`] tells the resolution from the readings. Beside a measured velocity the counts are
//! asked for less: [`path_beside_velocity`].

use crate::IdentError;

mod cosine_legs;
mod taut_string;

use cosine_legs::Turns;
pub use taut_string::{path_beside_velocity, path_within_scatter};

/// The step of an encoder that can be seen in `position` \[m or rad\]: the greatest length of which
/// all differences are multiples, where the position stands still for a fifth of the samples at
/// least. None for a position without such steps.
///
/// ```
/// let slow: Vec<f64> = (0..1000).map(|k| (0.03 * k as f64).floor() * 0.5).collect();
/// assert_eq!(friction_ident::quantiser::step_of(&slow), Some(0.5));
/// assert_eq!(friction_ident::quantiser::step_of(&[0.0, 0.1, 0.25]), None);
/// ```
pub fn step_of(position: &[f64]) -> Option<f64> {
    let (count, still) = count_and_rest(position)?;
    (5 * still >= position.len().saturating_sub(1)).then_some(count)
}

/// The greatest length of which all differences of `position` are multiples \[m or rad\], whether
/// it ever stands still or not. None where there is no such length.
pub fn count_of(position: &[f64]) -> Option<f64> {
    count_and_rest(position).map(|(count, _)| count)
}

/// The length of a count, and how often the next reading is the same.
fn count_and_rest(position: &[f64]) -> Option<(f64, usize)> {
    let differences = position.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let largest = position.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    let rounding = 1e-9 * largest;
    let (mut still, mut step) = (0usize, f64::INFINITY);
    for difference in differences.clone() {
        if difference <= rounding {
            still += 1;
        } else {
            step = step.min(difference);
        }
    }
    // Positions printed with few digits are multiples to that rounding only.
    let is_multiple = |d: f64| (d / step - (d / step).round()).abs() < 0.05;
    let counted = step.is_finite() && differences.filter(|&d| d > rounding).all(is_multiple);
    counted.then_some((step, still))
}

/// Edges for each sample, on average, beyond which readings are not those of an encoder but of a
/// wrong resolution.
const MOST_EDGES: f64 = 1e4;

/// How the motion turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Turn {
    /// At constant speed to a corner: ramps and triangles.
    #[default]
    Sharp,
    /// From halt to halt, each leg half a cosine: sines. The first leg begins with the recording.
    Round,
}

/// An edge passed: at the instant `time`, in samples, the position is `edge` counts, and the motion
/// goes in direction `side`.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    time: f64,
    edge: f64,
    side: f64,
}

/// The displacement from the first sample on \[unit of `resolution`], between the counts of an
/// encoder that rounds down.
///
/// `position` are the readings, whole multiples of `resolution` apart; `resolution` is one count.
///
/// # Errors
/// [`IdentError::Resolution`] unless the resolution is positive and the motion passes fewer than
/// ten thousand edges a sample, [`IdentError::NotFinite`], [`IdentError::TooFewSamples`] for a
/// motion that passes fewer than two edges.
///
/// ```
/// use friction_ident::quantiser::{Turn, between_counts};
///
/// // A ramp that starts 0.3 counts above an edge.
/// let truth = |i: usize| 0.01 * i as f64;
/// let read: Vec<f64> = (0..1000).map(|i| (0.3 + truth(i)).floor()).collect();
/// let path = between_counts(&read, 1.0, Turn::Sharp)?;
/// assert!(path.iter().enumerate().all(|(i, x)| (x - truth(i)).abs() < 0.011));
/// # Ok::<(), friction_ident::IdentError>(())
/// ```
pub fn between_counts(
    position: &[f64],
    resolution: f64,
    turn: Turn,
) -> Result<Vec<f64>, IdentError> {
    if !(resolution > 0.0 && resolution.is_finite()) {
        return Err(IdentError::Resolution(resolution));
    }
    if let Some((index, &value)) =
        position.iter().enumerate().find(|(_, value)| !crate::finite::usable(**value))
    {
        return Err(IdentError::NotFinite { channel: "the position", index, value });
    }
    let first = position.first().copied().unwrap_or(0.0);
    let counts: Vec<f64> = position.iter().map(|x| ((x - first) / resolution).round()).collect();
    let edges: f64 = counts.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
    if edges > MOST_EDGES * counts.len() as f64 {
        return Err(IdentError::Resolution(resolution));
    }
    let crossings = crossings(&counts);
    let path = path(&crossings, counts.len(), turn).ok_or(IdentError::TooFewSamples {
        what: "the path between the counts of an encoder (edges passed)",
        needed: 2,
        found: crossings.len(),
        lower: Some("the resolution"),
    })?;
    let start = path.first().copied().unwrap_or(0.0);
    Ok(path.iter().map(|x| resolution * (x - start)).collect())
}

/// Positions in counts at whole samples.
fn path(crossings: &[Crossing], samples: usize, turn: Turn) -> Option<Vec<f64>> {
    let knots = knots(crossings, samples)?;
    if turn == Turn::Sharp {
        return Some(along(&knots, samples));
    }
    let ends = [knots.first()?.1, knots.last()?.1];
    let turns = Turns::through(crossings, ends, samples.saturating_sub(1) as f64)?;
    Some(turns.path(crossings, samples))
}

/// Every edge passed, in time; several between two samples share the time evenly.
fn crossings(counts: &[f64]) -> Vec<Crossing> {
    let mut all = Vec::new();
    for (i, pair) in counts.windows(2).enumerate() {
        let [from, to] = pair else { continue };
        let side = (to - from).signum();
        let many = (to - from).abs() as usize;
        for j in 0..many {
            // Upwards the count k ends at the edge k + 1, downwards at k.
            let edge = if side > 0.0 { from + 1.0 + j as f64 } else { from - j as f64 };
            all.push(Crossing { time: i as f64 + (j as f64 + 0.5) / many as f64, edge, side });
        }
    }
    all
}

/// Points (time, position) through which the path runs in straight lines.
fn knots(crossings: &[Crossing], samples: usize) -> Option<Vec<(f64, f64)>> {
    let last_time = samples.saturating_sub(1) as f64;
    // Speed between two neighbouring edges of one leg, in counts a sample.
    let speed = |i: usize| {
        let (a, b) = (crossings.get(i)?, crossings.get(i + 1)?);
        (a.side == b.side && b.time > a.time).then(|| 1.0 / (b.time - a.time))
    };
    let known: Vec<(usize, f64)> =
        (0..crossings.len()).filter_map(|i| Some((i, speed(i)?))).collect();
    // The speed nearest to a crossing, before it or after it: legs that pass one edge only borrow
    // it from their neighbours.
    let before = |i: usize| {
        let near = known.iter().rev().find(|(j, _)| *j < i).or(known.first());
        near.map(|(_, speed)| *speed)
    };
    let after =
        |i: usize| known.iter().find(|(j, _)| *j >= i).or(known.last()).map(|(_, speed)| *speed);
    let (first, last) = (crossings.first()?, crossings.last()?);
    let mut knots = Vec::with_capacity(2 * crossings.len() + 2);
    knots.push((0.0, first.edge - first.side * (after(0)? * first.time).min(1.0)));
    for (i, crossing) in crossings.iter().enumerate() {
        knots.push((crossing.time, crossing.edge));
        let Some(next) = crossings.get(i + 1) else { break };
        if next.side == crossing.side {
            continue;
        }
        // Both pass the same edge, with the turn between them.
        let (up, down, room) = (before(i)?, after(i + 1)?, next.time - crossing.time);
        let height = (up * down * room / (up + down)).min(1.0);
        let share = down / (up + down);
        knots.push((crossing.time + share * room, crossing.edge + crossing.side * height));
    }
    let tail = (before(crossings.len().saturating_sub(1))? * (last_time - last.time)).min(1.0);
    knots.push((last_time.max(last.time + 0.5), last.edge + last.side * tail));
    Some(knots)
}

/// The straight lines through the knots at whole samples.
fn along(knots: &[(f64, f64)], samples: usize) -> Vec<f64> {
    let mut segment = 0;
    (0..samples)
        .map(|i| {
            let time = i as f64;
            while knots.get(segment + 1).is_some_and(|knot| knot.0 < time) {
                segment += 1;
            }
            match (knots.get(segment), knots.get(segment + 1)) {
                (Some(a), Some(b)) if b.0 > a.0 => {
                    a.1 + (b.1 - a.1) * ((time - a.0) / (b.0 - a.0)).clamp(0.0, 1.0)
                }
                (Some(a), _) => a.1,
                _ => 0.0,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests;
