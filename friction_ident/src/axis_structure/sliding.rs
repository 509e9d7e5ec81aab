//! What the sliding alone says of inertia, friction and load.
//!
//! Around a reversal an axis sticks, its contact bends, and a position loop winds up: whatever the
//! structure has for that, what it lacks goes into all other parameters. Far from reversals and rest
//! friction is a level and a slope, and plain least squares finds them, at the full rate, so that no
//! low-pass carries the reversals there. Where that says something else than the structure, the
//! interval must reach to it.

use nalgebra::{DMatrix, DVector};

use super::AxisStructure;
use super::naming::{AxisUnits, unknowns};
use super::regressors::Regressors;
use super::rows::rows_of;
use super::said::Said;
use super::search::Projection;
use super::shape::{LONGEST_DELAY, PositionScale, Shape};
use super::stability::variances;
use crate::conditioning::{Conditioned, Piece};
use crate::parameter_id::ParameterId;
use crate::statistics::{quantile, sorted};

/// Share of the usual largest speed below which an axis does not count as sliding, and as moving.
const SLIDES: f64 = 0.2;
const MOVES: f64 = 0.02;
/// Stribeck velocities at which a dip has faded, and the share of the largest speed that may take.
const FADED: f64 = 2.0;
const MOST_FADED: f64 = 0.5;
/// Half periods of the motion's low-pass that are left out on both sides of what does not slide.
const AROUND: usize = 2;
/// Share of what a recording tells of a parameter that must lie in the sliding.
const TOLD: f64 = 0.1;
/// Samples of a recording that are taken at its full rate: of a longer one every so many stretches
/// of so many samples.
const MOST_SAMPLES: usize = 500_000;
const EXCERPT: usize = 10_000;
/// Rows for each parameter that a fit needs.
const ROWS_EACH: usize = 10;

/// What the sliding says of the parameters of which it tells enough, in a structure of that shape;
/// none where the axis hardly slides.
pub(super) fn said(
    recording: &Conditioned,
    of: AxisStructure,
    shape: &Shape,
    scale: PositionScale,
) -> Option<Said> {
    let pieces = excerpts(&recording.pieces, recording.velocity.len(), MOST_SAMPLES);
    let fine = Conditioned { decimate: 1, pieces, ..recording.clone() };
    let structure =
        AxisStructure { stribeck: false, presliding: false, damping: false, lag: false, ..of };
    let mut regressors = Regressors::new(&fine, structure, scale).ok()?;
    let speeds = sorted(fine.velocity.iter().map(|v| v.abs()));
    let fastest = quantile(&speeds, 0.95)?;
    let dip = if of.stribeck { FADED * shape.v_s } else { 0.0 };
    let sliding = (SLIDES * fastest).max(dip.min(MOST_FADED * fastest));
    let slides = rows(&fine, sliding, AROUND * fine.stride);
    let moves = rows(&fine, MOVES * fastest, 0);
    let unknowns = unknowns(&structure, &AxisUnits::LINEAR);
    // A delay that stands for what happens at the reversals is not there where the axis slides.
    let prompt = Shape { delay: 0.0, ..*shape };
    let shapes = if structure.delay { vec![*shape, prompt] } else { vec![prompt] };
    let mut best: Option<(f64, DVector<f64>, DMatrix<f64>)> = None;
    for shape in &shapes {
        let matrix = regressors.matrix(shape).ok()?;
        let own = matrix.select_rows(&slides);
        if own.nrows() < ROWS_EACH * own.ncols() {
            return None;
        }
        let (x, rest) = Projection::new(own)?.rest(&regressors.force.select_rows(&slides));
        let rest = rest.norm_squared();
        if best.as_ref().is_none_or(|(least, ..)| rest < *least) {
            best = Some((rest, x, matrix));
        }
    }
    let (_, x, matrix) = best?;
    let told = told(&matrix.select_rows(&slides), &matrix.select_rows(&moves))?;
    let ids = unknowns.into_iter().map(|unknown| unknown.id);
    let values = ids.zip(x.iter().copied()).zip(told);
    let values: Vec<(ParameterId, f64)> =
        values.filter_map(|(value, told)| told.then_some(value)).collect();
    Some(Said { structure, values })
}

/// The stretches of a recording of `samples`, or every so many parts of them, so that no more than
/// about `most` samples are left.
fn excerpts(pieces: &[Piece], samples: usize, most: usize) -> Vec<Piece> {
    let every = samples.div_ceil(most);
    if every <= 1 {
        return pieces.to_vec();
    }
    let parts = pieces.iter().flat_map(|piece| {
        let starts = piece.kept.clone().step_by(EXCERPT);
        starts.map(|start| Piece {
            kept: start..piece.kept.end.min(start + EXCERPT),
            ..piece.clone()
        })
    });
    parts.step_by(every).collect()
}

/// Rows at which the axis is faster than `speed`, and so many samples before and after.
fn rows(recording: &Conditioned, speed: f64, around: usize) -> Vec<usize> {
    let mut rows = Vec::new();
    let mut first = 0;
    for piece in &recording.pieces {
        let velocity = recording.velocity.get(piece.kept.clone()).unwrap_or_default();
        let own = rows_of(piece, 1);
        // The row from which none has been too slow. What was before the first is not known, nor what
        // a late force answers to.
        let mut since = around.max(LONGEST_DELAY);
        for (k, v) in velocity.iter().enumerate() {
            if v.abs() < speed {
                since = k + around + 1;
            } else if let Some(row) =
                k.checked_sub(around).filter(|row| *row >= since && *row < own)
            {
                rows.push(first + row);
            }
        }
        first += own;
    }
    rows
}

/// Of which parameters some rows tell enough, beside all.
fn told(some: &DMatrix<f64>, all: &DMatrix<f64>) -> Option<Vec<bool>> {
    let (some, all) = (variances(some)?, variances(all)?);
    Some(some.iter().zip(all).map(|(some, all)| all > TOLD * some).collect())
}

#[cfg(test)]
mod tests {
    use super::super::fit_structure;
    use super::*;
    use crate::conditioning::{Conditioning, Signals, condition};

    const INERTIA: f64 = 1.0;
    const F_C: f64 = 2.0;
    const F_V: f64 = 0.3;

    /// A joint that a position loop moves from place to place, at 125 Hz. It sticks before it moves
    /// and after it has.
    fn moves() -> Conditioned {
        let (dt, every) = (2e-4, 40);
        let (mut q, mut v, mut wound) = (0.0f64, 0.0f64, 0.0f64);
        let (mut place, mut force) = (Vec::new(), Vec::new());
        for k in 0..300_000 {
            let t = dt * f64::from(k);
            let (number, since) = ((t / 1.6).floor(), t % 1.6);
            let goal = |number: f64| if number < 1.0 { 0.0 } else { 0.8 * (2.4 * number).sin() };
            let (from, to) = (goal(number), goal(number + 1.0));
            let part = (since / 1.1).min(1.0);
            let way = part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
            let rate = 30.0 * part.powi(2) * (1.0 - part).powi(2) / 1.1;
            let (wanted, wanted_v) = (from + (to - from) * way, (to - from) * rate);
            wound += 300.0 * (wanted - q) * dt;
            let torque = 400.0 * (wanted - q) + 30.0 * (wanted_v - v) + wound;
            if k % every == 0 {
                place.push((q / 2e-4).round() * 2e-4);
                force.push(torque);
            }
            // Friction stops it before it turns it round.
            let driven = v + (torque - F_V * v) * dt / INERTIA;
            v = driven.signum() * (driven.abs() - F_C * dt / INERTIA).max(0.0);
            q += v * dt;
        }
        let signals =
            Signals { time_step: 8e-3, position: Some(&place), velocity: None, force: &force };
        let found = condition(&signals, &Conditioning::for_motion(8e-3, &[signals])).unwrap();
        found.moving().unwrap().0
    }

    #[test]
    fn of_a_long_recording_parts_are_enough() {
        let recording = moves();
        let samples: usize = recording.pieces.iter().map(|piece| piece.kept.len()).sum();
        let parts = excerpts(&recording.pieces, samples, samples / 4);
        let left: usize = parts.iter().map(|piece| piece.kept.len()).sum();
        assert!(left > samples / 8 && left < samples / 3, "{left} of {samples}");
        let structure = AxisStructure::SYMMETRIC;
        let scale = PositionScale::of(&recording);
        let shape = Shape { delay: 0.0, v_s: 1.0, displacement: 1.0, period: 1.0, ratio: 1.0 };
        let part = Conditioned { pieces: parts, ..recording.clone() };
        for recording in [recording, part] {
            let said = said(&recording, structure, &shape, scale).unwrap();
            let f_v = said.value("f_v".into(), structure).unwrap();
            assert!((f_v / F_V - 1.0).abs() < 0.02, "{f_v}");
        }
        let long = Piece { kept: 5..2_500_005, ..part_of(0..1) };
        let parts = excerpts(&[long], 2_500_000, MOST_SAMPLES);
        assert!(parts.len() == 50 && parts[1].kept == (50_005..60_005), "{}", parts.len());
    }

    fn part_of(kept: std::ops::Range<usize>) -> Piece {
        Piece { stretch: 0, kept, origin: 0..1, begin: 0, way: 0.0, start: 0.0 }
    }

    /// The structure took what happens around the rests for viscous friction.
    #[test]
    fn an_interval_reaches_to_what_the_sliding_says() {
        let recording = moves();
        let structure = "symmetric+presliding+damping+delay".parse().unwrap();
        let mut fit = fit_structure(&recording, structure, &AxisUnits::ROTARY).unwrap();
        let own = fit.estimates.clone();
        fit.heed(&recording, &[]);
        for (name, truth) in [("inertia", INERTIA), ("f_v", F_V), ("f_c", F_C)] {
            let estimate = fit.estimates.get(name).unwrap();
            assert!(estimate.interval.unwrap().contains(truth), "{estimate:?}");
            let before = own.get(name).unwrap().interval.unwrap();
            assert!(name != "f_v" || !before.contains(truth), "{before:?}");
        }
        let said = fit.sliding.iter().find(|(said, _)| *said == "f_v".into()).unwrap().1;
        assert!((said / F_V - 1.0).abs() < 0.02, "{said}");
    }
}
