//! The same tones in strokes to and fro, where the travel has ends.
//!
//! The voltage turns round where the shaft would else not stop within its reach. Each stroke is a
//! stretch of its own, so that none is long; there are more of them.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use super::{ABOVE, Drive, LESS, LOWEST, SECONDS, TONE, encoder_step, evaluate, fits, tones};
use crate::axis::Axis;
use crate::meet::Met;
use crate::reach::Reach;
use crate::{CommissionError, Stage};

/// Time that a stroke is to take \[s\], its first part in which the shaft starts, and the shortest
/// stretch behind it that tells something.
const STROKE: f64 = 0.9;
const START: f64 = 0.12;
const SHORTEST: f64 = 0.25;
/// Stretches that are enough, and at most so many strokes are looked at.
const ENOUGH: usize = 4;
/// Attempts, each with less voltage above friction.
const ATTEMPTS: u32 = 6;
/// Time in which a shaft turns round \[s\], before anything is known and at least.
const TURNS: f64 = 0.15;
/// Time over which the speed is told \[s\].
const SPEED: f64 = 0.01;

/// Does the stage within `reach`, at most `highest` volts.
pub(super) fn drive(
    axis: &mut Axis<'_>,
    met: &Met,
    reach: Reach,
    highest: f64,
) -> Result<Drive, CommissionError> {
    let bench = axis.bench()?;
    let speed = reach.length() / STROKE;
    let wanted = met.deadband + speed * met.slope / (1.0 - TONE);
    let mut peak = wanted.min(highest).max((1.0 + ABOVE) * met.deadband);
    let mut low = met.deadband.min(LOWEST * peak);
    let mut last = None;
    for _ in 0..ATTEMPTS {
        let (seen, pieces) = excite(axis, &bench, reach, (low, peak))?;
        if pieces.len() >= ENOUGH {
            let told = fits(&seen, pieces, bench.period());
            let found = evaluate(told, encoder_step(&seen), peak);
            if found.is_ok() {
                return found;
            }
            last = found.err();
        }
        peak = low + LESS * (peak - low);
        low *= 0.9;
    }
    Err(last.unwrap_or_else(|| CommissionError::Unusable {
        stage: Stage::Drive,
        why: format!(
            "within {:.2} rad the shaft meets an end before it turns steadily; a longer travel helps, by the speed at the lowest voltage that keeps it turning one of about {:.1} rad",
            reach.length(),
            2.0 * reach.length()
        ),
    }))
}

/// One excitation: what was seen, and the stretches of its strokes.
fn excite(
    axis: &mut Axis<'_>,
    bench: &crate::axis::Bench,
    reach: Reach,
    (low, peak): (f64, f64),
) -> Result<(Vec<rig_driver::Measurement>, Vec<Range<usize>>), CommissionError> {
    let period = bench.period();
    let span = ((SPEED / period) as usize).max(1);
    let (sign, cycle) = (Cell::new(1.0), Cell::new(0_usize));
    let before = RefCell::new(std::collections::VecDeque::with_capacity(span + 2));
    let turned = RefCell::new(vec![0_usize]);
    let seen = axis.answer(bench, Stage::Drive, SECONDS, |seen| {
        let place = seen.encoder_position;
        let mut before = before.borrow_mut();
        if seen.cycle == 0 {
            sign.set(if place > reach.middle() { -1.0 } else { 1.0 });
            cycle.set(0);
            before.clear();
            turned.replace(vec![0]);
        }
        before.push_back(place);
        let speed = if before.len() > span {
            let old = before.pop_front().unwrap_or(place);
            (place - old) / (span as f64 * period)
        } else {
            0.0
        };
        if speed * sign.get() > 0.0 && reach.is_left(place, speed, TURNS) {
            sign.set(-sign.get());
            turned.borrow_mut().push(cycle.get());
        }
        cycle.set(cycle.get() + 1);
        sign.get() * (low + (peak - low) * (1.0 - TONE + TONE * tones(seen.time)))
    })?;
    let mut turned = turned.into_inner();
    turned.push(seen.len().saturating_sub(2));
    let at = |seconds: f64| (seconds / period).round() as usize;
    let pieces = turned
        .windows(2)
        .map(|pair| pair[0] + at(START)..pair[1])
        .flat_map(|piece| cut(piece, at(STROKE)))
        .filter(|piece| piece.len() >= at(SHORTEST))
        .collect();
    Ok((seen, pieces))
}

/// A long stretch in several.
fn cut(piece: Range<usize>, longest: usize) -> impl Iterator<Item = Range<usize>> {
    let parts = piece.len().div_ceil(2 * longest.max(1)).max(1);
    let size = piece.len() / parts;
    (0..parts).map(move |part| piece.start + part * size..piece.start + (part + 1) * size)
}
