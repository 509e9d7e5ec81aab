//! What the sliding alone says of inertia, friction and load.
//!
//! Around a reversal an axis sticks, its contact bends, and a position loop winds up: whatever the
//! structure has for that, what it lacks goes into all other parameters. Far from reversals and rest
//! friction is a level and a slope, and plain least squares finds them, at the full rate, so that no
//! low-pass carries the reversals there. Where that says something else than the structure, the
//! interval must reach to it.

use std::cell::LazyCell;

use nalgebra::{DMatrix, DVector};

use super::AxisStructure;
use super::late::LATE;
use super::naming::{AxisUnits, unknowns};
use super::projection::Projection;
use super::regressors::Regressors;
use super::rows::rows_of;
use super::said::Said;
use super::shape::{LONGEST_DELAY, Late, PositionScale, Shape};
use super::stability::variances;
use crate::conditioning::{Conditioned, Piece};
use crate::estimate::{Estimate, Estimates};
use crate::parameter_id::ParameterId;
use crate::robust_covariance::{Course, RobustError, robust_covariance};
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
/// Of what it tells less, what it says must be off the estimate by so many of its own errors at least.
const CERTAIN: f64 = 3.0;
/// What a prompt force leaves over, as a share of what a late one does, below which there is no delay.
const PROMPT: f64 = 0.9;
/// Rows for each parameter that a fit needs.
const ROWS_EACH: usize = 10;

/// What the sliding says of the parameters, in a structure of that shape: of those of which it tells
/// enough, and of those of which it says for certain that they lie outside the interval of their
/// estimate. Most of what a recording tells of the inertia may lie where an axis breaks away, and be
/// wrong there. None where the axis hardly slides.
pub(super) fn said(
    recording: &Conditioned,
    of: AxisStructure,
    shape: &Shape,
    scale: PositionScale,
    estimates: &Estimates,
) -> Option<Said> {
    let pieces = excerpts(&recording.pieces, recording.velocity.len(), MOST_SAMPLES);
    let fine = Conditioned { decimate: 1, pieces, ..recording.clone() };
    let structure = AxisStructure {
        stribeck: false,
        presliding: false,
        damping: false,
        lag: false,
        delay: true,
        ..of
    };
    let mut regressors = Regressors::new(&fine, structure, scale).ok()?;
    let speeds = sorted(fine.velocity.iter().map(|v| v.abs()));
    let fastest = quantile(&speeds, 0.95)?;
    let dip = if of.stribeck { FADED * shape.v_s } else { 0.0 };
    let sliding = (SLIDES * fastest).max(dip.min(MOST_FADED * fastest));
    let slides = rows(&fine, sliding, AROUND * fine.stride);
    let moves = rows(&fine, MOVES * fastest, 0);
    let unknowns = unknowns(&structure, &AxisUnits::LINEAR).into_iter();
    let mut fit = |shape: Shape| {
        let matrix = regressors.matrix(&shape).ok()?;
        let own = matrix.select_rows(&slides);
        if own.nrows() < ROWS_EACH * own.ncols() {
            return None;
        }
        let (x, rest) = Projection::new(own)?.rest(&regressors.force.select_rows(&slides));
        Some(Slide { shape, matrix, x, rest })
    };
    // A delay that stands for what happens at the reversals is not there where the axis slides.
    let prompt = fit(Shape { delay: 0.0, ..*shape })?;
    let late = if of.delay { fit(*shape) } else { None };
    let no_delay = late.as_ref().is_some_and(|own| prompt.rest.norm() < PROMPT * own.rest.norm());
    let own = late.filter(|own| own.rest.norm() <= prompt.rest.norm()).unwrap_or(prompt);
    let own_delay = own.shape.delay;
    let slide =
        recorded_late(own, fine.time_step, |slide| slide.within_band(&slides, fine.stride), fit);
    let Slide { shape, matrix, x, rest } = slide;
    let delay = if shape.delay < own_delay { Some(shape.delay) } else { no_delay.then_some(0.0) };
    let own = matrix.select_rows(&slides);
    let told = told(&own, &matrix.select_rows(&moves))?;
    // Errors cost more than the fit; most often nothing hangs on them.
    let errors = LazyCell::new(|| errors(&own, &rest, &slides, &regressors.motion(&shape)));
    let counts = |&(k, (id, value)): &(usize, (ParameterId, f64))| {
        let off = estimates.get(id).and_then(|estimate| off(estimate, value));
        told[k] || off.is_some_and(|off| off > CERTAIN * errors[k])
    };
    let found = unknowns.map(|unknown| unknown.id).zip(x.iter().copied());
    let mut values: Vec<(ParameterId, f64)> =
        found.enumerate().filter(counts).map(|(_, value)| value).collect();
    values.extend(delay.map(|delay| ("delay".into(), delay)));
    Some(Said { structure, values })
}

/// Least squares over the rows in which the axis slides.
struct Slide {
    shape: Shape,
    /// Of all rows.
    matrix: DMatrix<f64>,
    x: DVector<f64>,
    rest: DVector<f64>,
}

impl Slide {
    /// Sum of squares of what is left at `rows` within the band of the motion: of means over `each`
    /// rows in a row. What the sensor of a force adds above is the same whatever is fitted.
    fn within_band(&self, rows: &[usize], each: usize) -> f64 {
        let mut rest = self.rest.as_slice();
        let mut sum = 0.0;
        for run in rows.chunk_by(|a, b| a + 1 == *b) {
            let (own, others) = rest.split_at_checked(run.len()).unwrap_or_default();
            let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
            sum += own.chunks_exact(each).map(|part| mean(part).powi(2)).sum::<f64>();
            rest = others;
        }
        sum
    }
}

/// The slide with a force that was recorded later than in `own`, by whole samples of `time_step`,
/// where that leaves clearly less of `left`; else `own`. Inertia and viscous friction hang on it: a
/// force that is late by T takes `f_v T` off the inertia.
fn recorded_late(
    own: Slide,
    time_step: f64,
    left: impl Fn(&Slide) -> f64,
    mut fit: impl FnMut(Shape) -> Option<Slide>,
) -> Slide {
    let asked = (1.0 - LATE) * left(&own);
    let (mut least, mut best) = (left(&own), None);
    for samples in 1..=LONGEST_DELAY {
        let delay = own.shape.delay.min(0.0) - samples as f64 * time_step;
        let Some(later) = fit(Shape { delay, late: Late::Delayed, ..own.shape }) else { break };
        let squares = left(&later);
        if squares >= least {
            break;
        }
        (least, best) = (squares, Some(later));
    }
    best.filter(|_| least < asked).unwrap_or(own)
}

/// How far a value is from an estimate whose interval does not hold it.
fn off(estimate: &Estimate, value: f64) -> Option<f64> {
    let outside = !estimate.interval?.contains(value);
    outside.then(|| (value - estimate.value).abs())
}

/// The standard error of each parameter of a fit to some rows, with what the fit lacks; infinite
/// where that is a guess. `motion` has a value a row.
fn errors(
    matrix: &DMatrix<f64>,
    rest: &DVector<f64>,
    rows: &[usize],
    motion: &[Vec<f64>],
) -> Vec<f64> {
    let runs: Vec<usize> = rows.chunk_by(|a, b| a + 1 == *b).map(<[usize]>::len).collect();
    let of = |all: &Vec<f64>| rows.iter().filter_map(|&row| all.get(row).copied()).collect();
    let motion: Vec<Vec<f64>> = motion.iter().map(of).collect();
    let course = Course { points: 0, pieces: &runs, motion: &motion };
    let Some(found) = robust_covariance(matrix, rest.as_slice(), &course) else {
        return vec![f64::INFINITY; matrix.ncols()];
    };
    let error = |own: &RobustError| own.doubt.map_or(own.standard_error, |_| f64::INFINITY);
    found.parameters.iter().map(error).collect()
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
    use super::super::tests::three_tones;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;
    use crate::conditioning::{Conditioning, Signals, Stick, condition};
    use crate::estimate::{Interval, IntervalMethod, Verdict};

    const INERTIA: f64 = 1.0;
    const LIGHT: f64 = 0.175;
    const F_C: f64 = 2.0;
    const F_V: f64 = 0.3;

    /// A joint that a position loop moves from place to place, at 125 Hz. It sticks before it moves
    /// and after it has.
    fn moves() -> Conditioned {
        let goal = |number: f64| if number < 1.0 { 0.0 } else { 0.8 * (2.4 * number).sin() };
        let wanted = |t: f64| {
            let (number, since) = ((t / 1.6).floor(), t % 1.6);
            let (from, to) = (goal(number), goal(number + 1.0));
            let part = (since / 1.1).min(1.0);
            let way = part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
            let rate = 30.0 * part.powi(2) * (1.0 - part).powi(2) / 1.1;
            (from + (to - from) * way, (to - from) * rate)
        };
        let (seconds, gains) = (60.0, [400.0, 30.0, 300.0]);
        Loop { inertia: INERTIA, level: |_| F_C, gains, step: 2e-4, every: 40, resolution: 2e-4 }
            .recorded(seconds, wanted)
    }

    /// A slide that breaks away at one and a half times its kinetic friction, under a position loop
    /// that winds up until it does: it sticks at every reversal.
    fn breaks_away() -> Conditioned {
        let wanted = |t: f64| {
            let begun = (t / 0.5).min(1.0).powi(2);
            let wave = |k: i32| {
                let rate = 0.1 * 20f64.powf(f64::from(k) / 5.0);
                let (size, w) = (0.05 / 6.0 * (0.1 / rate).powf(0.7), std::f64::consts::TAU * rate);
                let (sin, cos) = (w * t + 1.7 * f64::from(k * k)).sin_cos();
                (size * sin, size * w * cos)
            };
            let add = |(q, v): (f64, f64), (more, faster): (f64, f64)| (q + more, v + faster);
            let (q, v) = (0..6).map(wave).fold((0.0, 0.0), add);
            (begun * q, begun * v)
        };
        let level = |v: f64| F_C * (1.0 + 0.5 * (-(v / 0.01).powi(2)).exp());
        let (inertia, w) = (LIGHT, 63.0);
        let gains = [inertia * w * w, 2.0 * inertia * w, 0.3 * inertia * w * w * w];
        Loop { inertia, level, gains, step: 5e-5, every: 20, resolution: 2e-7 }
            .recorded(40.0, wanted)
    }

    /// An axis with rigid friction of a level under a position loop, and how it is recorded.
    struct Loop {
        inertia: f64,
        level: fn(f64) -> f64,
        gains: [f64; 3],
        step: f64,
        every: usize,
        resolution: f64,
    }

    impl Loop {
        fn recorded(&self, seconds: f64, wanted: impl Fn(f64) -> (f64, f64)) -> Conditioned {
            let &Self { inertia, level, gains: [k_p, k_d, k_i], step: dt, every, resolution } =
                self;
            let (mut q, mut v, mut wound) = (0.0f64, 0.0f64, 0.0f64);
            let (mut place, mut force) = (Vec::new(), Vec::new());
            for k in 0..(seconds / dt) as usize {
                let (wanted, wanted_v) = wanted(dt * k as f64);
                wound += k_i * (wanted - q) * dt;
                let torque = k_p * (wanted - q) + k_d * (wanted_v - v) + wound;
                if k % every == 0 {
                    place.push((q / resolution).round() * resolution);
                    force.push(torque);
                }
                // Friction stops it before it turns it round.
                let driven = v + (torque - F_V * v) * dt / inertia;
                v = driven.signum() * (driven.abs() - level(v) * dt / inertia).max(0.0);
                q += v * dt;
            }
            let time_step = dt * every as f64;
            let signals = Signals {
                time_step,
                position: Some(&place),
                readings: None,
                velocity: None,
                force: &force,
            };
            let how = Conditioning::for_motion(time_step, &[signals]);
            let mut found = condition(&signals, &how).unwrap();
            // Its short sticks stay in it, as where the position is not that of an encoder.
            found.sticks.fill(Stick::Away);
            found.moving().unwrap().0
        }
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
        let shape = Shape::UNUSED;
        let part = Conditioned { pieces: parts, ..recording.clone() };
        for recording in [recording, part] {
            let none = &Estimates::default();
            let said = said(&recording, structure, &shape, scale, none).unwrap();
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

    /// The structure made a delay, and a larger inertia, of what happens where the axis breaks away.
    #[test]
    fn a_delay_that_is_not_there_where_the_axis_slides_is_none() {
        let recording = breaks_away();
        let structure = "symmetric+stribeck+presliding+damping+delay".parse().unwrap();
        let mut fit = fit_structure(&recording, structure, &AxisUnits::ROTARY).unwrap();
        let own = fit.estimates.clone();
        fit.heed(&recording, &[]);
        for (name, truth) in [("inertia", LIGHT), ("f_v", F_V), ("f_c", F_C), ("delay", 0.0)] {
            let estimate = fit.estimates.get(name).unwrap();
            assert!(estimate.interval.unwrap().contains(truth), "{estimate:?}");
            let before = own.get(name).unwrap().interval.unwrap();
            assert!(name != "delay" || !before.contains(truth), "{before:?}");
        }
        assert!(fit.sliding.contains(&("delay".into(), 0.0)), "{:?}", fit.sliding);
    }

    /// A force that is recorded 8 ms late takes 0.0112 off an inertia of 0.05 beside a viscous friction
    /// of 1.4, and the sliding tells that it is late. One that is recorded at once is not late.
    #[test]
    fn a_force_that_is_recorded_late_where_the_axis_slides_is_seen() {
        let of = AxisStructure::SYMMETRIC;
        for late in [0usize, 8] {
            let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
            let mut before = std::collections::VecDeque::from(vec![0.0; late]);
            let recording = three_tones(20_000, |_, v, a| {
                before.push_back(0.05 * a + 1.4 * v + 0.7 * v.signum());
                let noise = 0.01 * rng.sample::<f64, _>(StandardNormal);
                before.pop_front().unwrap_or_default() + noise
            });
            let scale = PositionScale::of(&recording);
            let none = &Estimates::default();
            let said = said(&recording, of, &Shape::UNUSED, scale, none).unwrap();
            let value = |name: &'static str| said.value(name.into(), of);
            let inertia = value("inertia").unwrap();
            assert!((inertia / 0.05 - 1.0).abs() < 0.02, "{late}: {inertia}");
            assert_eq!(value("delay"), (late > 0).then_some(-8e-3), "{late}");
        }
    }

    #[test]
    fn only_what_lies_outside_the_interval_is_off() {
        let estimate = Estimate {
            id: "inertia".into(),
            unit: "kg m^2",
            value: 1.25,
            standard_error: None,
            interval: Some(Interval { low: 1.0, high: 2.0, method: IntervalMethod::Robust }),
            verdict: Verdict::Identified,
        };
        assert_eq!(off(&estimate, 0.75), Some(0.5));
        assert_eq!(off(&estimate, 2.25), Some(1.0));
        assert_eq!(off(&estimate, 1.5), None);
        assert_eq!(off(&Estimate { interval: None, ..estimate }, 0.9), None);
    }

    /// A level and a slope in runs of rows, with white noise of one size: the errors of theory. And
    /// none where a single run holds all that is told.
    #[test]
    fn errors_are_those_of_the_rows() {
        let rows: Vec<usize> = (0..4000).map(|k| k + k / 50).collect();
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        let mut noise = || rng.sample::<f64, _>(StandardNormal);
        let matrix =
            DMatrix::from_fn(rows.len(), 2, |k, j| if j == 0 { 1.0 } else { (k as f64).sin() });
        let force = DVector::from_iterator(rows.len(), rows.iter().map(|_| noise()));
        let (_, rest) = Projection::new(matrix.clone()).unwrap().rest(&force);
        let found = errors(&matrix, &rest, &rows, &[]);
        for (error, square) in found.iter().zip([4000.0, 2000.0]) {
            let ratio = error * f64::sqrt(square);
            assert!((0.6..1.5).contains(&ratio), "{ratio}");
        }
        let once = DMatrix::from_fn(rows.len(), 2, |k, j| if j == 0 || k < 20 { 1.0 } else { 0.0 });
        let (_, rest) = Projection::new(once.clone()).unwrap().rest(&force);
        assert_eq!(errors(&once, &rest, &rows, &[])[1], f64::INFINITY);
    }
}
