//! Whether the ramps of a motion of one speed tell its inertia.
//!
//! A move from place to place speeds up and slows down over ramps. At one speed in one direction
//! friction is the same on both, whatever its curve: what the force differs by is the inertia. A
//! model whose inertia is right leaves nothing of that difference. The turns of a triangle are too
//! short for that: there the force's own lag and the rise of friction from rest fill them.

use std::ops::Range;

use friction_ident::Prediction;

/// Speeds of a ramp, as shares of the one speed: neither reversal nor cruise.
const RAMP: Range<f64> = 0.15..0.85;
/// Speeds that are told apart on a ramp, in each direction.
const BINS: usize = 6;
/// Share of the motion that ramps must be.
const LEAST_SHARE: f64 = 0.08;
/// Rows on ramps below which nothing is said.
const FEWEST: usize = 40;
/// Parts of the rows that are left out in turn for the error.
const PARTS: usize = 8;
/// Share of the inertia that the ramps may add to it and that their error may be.
const EXACT: f64 = 0.03;
/// Share of the acceleration that must be left where each speed's own mean is taken off: the axis
/// speeds up and slows down at the same speeds.
const BOTH_WAYS: f64 = 0.25;

/// A row on a ramp.
#[derive(Clone, Copy)]
struct Row {
    bin: usize,
    acceleration: f64,
    residual: f64,
}

/// Whether the ramps of a motion at `speed` agree with the `inertia` of the model that predicts it.
pub(super) fn tell_inertia(prediction: &Prediction, speed: f64, inertia: f64) -> bool {
    let Some(rows) = rows(prediction, speed) else { return false };
    let Some(more) = more(&rows) else { return false };
    let part = |part: usize| {
        let out = part * rows.len() / PARTS..(part + 1) * rows.len() / PARTS;
        let kept: Vec<Row> = rows
            .iter()
            .enumerate()
            .filter(|(place, _)| !out.contains(place))
            .map(|(_, row)| *row)
            .collect();
        self::more(&kept)
    };
    let Some(without) = (0..PARTS).map(part).collect::<Option<Vec<f64>>>() else { return false };
    let mean = without.iter().sum::<f64>() / PARTS as f64;
    let squares: f64 = without.iter().map(|value| (value - mean).powi(2)).sum();
    let error = ((PARTS - 1) as f64 / PARTS as f64 * squares).sqrt();
    more.abs().max(error) < EXACT * inertia
}

/// The rows on ramps; none where the motion has too few.
fn rows(prediction: &Prediction, speed: f64) -> Option<Vec<Row>> {
    let Prediction { time, velocity, .. } = prediction;
    let residual = prediction.residual();
    let step = time.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let row = |k: usize| {
        let (v, width) = (velocity[k], time[k + 1] - time[k - 1]);
        let share = (v.abs() / speed - RAMP.start) / (RAMP.end - RAMP.start);
        let inside = (0.0..1.0).contains(&share) && width < 2.5 * step;
        inside.then(|| Row {
            bin: (share * BINS as f64) as usize + if v < 0.0 { BINS } else { 0 },
            acceleration: (velocity[k + 1] - velocity[k - 1]) / width,
            residual: residual[k],
        })
    };
    let last = velocity.len().checked_sub(1)?;
    let rows: Vec<Row> = (1..last).filter_map(row).collect();
    let moving = velocity.iter().filter(|v| v.abs() > RAMP.start * speed).count();
    let enough = rows.len() >= FEWEST && rows.len() as f64 >= LEAST_SHARE * moving as f64;
    enough.then_some(rows)
}

/// What the rows add to the inertia: how the residual goes with the acceleration among rows of the
/// same speed. None where the axis does not speed up and slow down at the same speeds.
fn more(rows: &[Row]) -> Option<f64> {
    let mut means = [(0.0, 0.0, 0.0); 2 * BINS];
    for row in rows {
        let (count, acceleration, residual) = &mut means[row.bin];
        *count += 1.0;
        *acceleration += row.acceleration;
        *residual += row.residual;
    }
    let (mut both, mut own, mut all) = (0.0, 0.0, 0.0);
    for row in rows {
        let (count, acceleration, residual) = means[row.bin];
        let off = row.acceleration - acceleration / count;
        both += off * (row.residual - residual / count);
        own += off * off;
        all += row.acceleration * row.acceleration;
    }
    (own > BOTH_WAYS * all && own > 0.0).then(|| both / own)
}

#[cfg(test)]
mod tests {
    use friction_ident::{AxisModel, AxisTerm, Conditioning, Signals, condition, fit_axis};

    use super::*;

    const INERTIA: f64 = 0.1;

    /// A motion whose speed goes through zero over `turn` seconds, with friction that builds up over a
    /// short way from rest, which the model does not have.
    fn told(turn: f64, wrong: f64) -> bool {
        let (dt, cruise) = (2e-3, 0.7);
        let (mut place, mut force) = (Vec::new(), Vec::new());
        let (mut x, mut z) = (0.0, 0.0);
        for k in 0..20_000 {
            let phase = (f64::from(k) * dt).rem_euclid(2.0) - 0.5;
            let near = if phase < 0.5 { phase } else { 1.0 - phase };
            let v = cruise * (2.0 * near / turn).clamp(-1.0, 1.0);
            let ramp = (2.0 * near / turn).abs() < 1.0;
            let way = if phase < 0.5 { 1.0 } else { -1.0 };
            let a = if ramp { way * 2.0 * cruise / turn } else { 0.0 };
            x += dt * v;
            z = f64::signum(v) + (z - f64::signum(v)) * (-dt * v.abs() / 3e-4).exp();
            place.push(x);
            force.push(INERTIA * a + 0.05 * v + 0.1 * z);
        }
        let signals = Signals {
            time_step: dt,
            position: Some(&place),
            readings: None,
            velocity: None,
            force: &force,
        };
        let recording = condition(&signals, &Conditioning::for_time_step(dt)).unwrap();
        let fit = fit_axis(&recording, AxisModel::SYMMETRIC).unwrap();
        let mut prediction = fit.predict(&recording).unwrap();
        let inertia = fit.value(AxisTerm::Inertia);
        // As if the inertia had come out wrong.
        let Prediction { time, velocity, predicted, .. } = &mut prediction;
        for k in 1..time.len() - 1 {
            let a = (velocity[k + 1] - velocity[k - 1]) / (time[k + 1] - time[k - 1]);
            predicted[k] += wrong * inertia * a;
        }
        tell_inertia(&prediction, cruise, (1.0 + wrong) * inertia)
    }

    /// The inertia of every move from place to place was called untrusted, right to a thousandth.
    #[test]
    fn the_ramps_of_a_trapezoid_tell_its_inertia_and_the_turns_of_a_triangle_do_not() {
        assert!(told(0.4, 0.0));
        assert!(!told(0.4, 0.2), "what the ramps say is not what the fit says");
        assert!(!told(0.04, 0.0));
    }
}
