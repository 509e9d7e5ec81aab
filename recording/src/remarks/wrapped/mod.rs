//! A position that starts again after each turn, as that of an encoder with one turn does.
//!
//! It jumps from one rim of its range to the other between two samples, and moves on there as
//! before. Where that is certain the turns are counted, so that the position goes on.

use std::f64::consts::PI;

use friction_ident::quantiser::step_of;
use friction_ident::statistics::{quantile, sorted, upper_median};
use serde::Serialize;

use crate::AxisKind;
use crate::sheet::Found;

/// Samples below which nothing is said.
const FEWEST: usize = 20;
/// A step of more than this part of the range may be a jump.
const JUMP: f64 = 0.5;
/// How near a rim the position stands before and after a jump, as a part of the turn.
const RIM: f64 = 0.15;
/// How far the size of a jump may be from the others, or from one turn of the unit, as a part.
const ALIKE: f64 = 0.01;
/// Jumps of one size that are needed where that is no turn of the unit.
const SEVERAL: usize = 3;
/// Samples before and after a jump that tell how the axis moves there.
const AROUND: usize = 6;

/// A position that wrapped.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Wrapped {
    /// Jumps that were taken out.
    pub jumps: usize,
    /// Size of a turn \[rad, or the unit of the position\].
    pub turn: f64,
    /// It is one turn of the axis.
    pub one_turn: bool,
}

impl Wrapped {
    pub(super) fn and(self, other: Self) -> Self {
        Self { jumps: self.jumps + other.jumps, ..self }
    }

    /// In words.
    pub(super) fn describe(self) -> String {
        let Self { jumps, turn, one_turn } = self;
        let times = if jumps == 1 { "once" } else { &format!("{jumps} times") };
        let size = if one_turn { "one turn".to_owned() } else { format!("{turn:.6}") };
        let unit = if one_turn { " (6.28319 rad)" } else { " in its own unit" };
        format!(
            "The position wraps {times} by {size}{unit}: the turns are counted, and the position goes on"
        )
    }
}

/// What is known of a position, beside its values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Angle {
    /// Kind of axis that the names tell.
    pub axis: Option<AxisKind>,
    /// What its values were multiplied with.
    pub scale: f64,
    /// Its name says a unit, and that is what its values were multiplied with.
    pub in_rad: bool,
}

impl Angle {
    /// An angle in rad.
    pub(crate) const RADIANS: Self =
        Self { axis: Some(AxisKind::Rotary), scale: 1.0, in_rad: true };

    /// The position in a column, on an axis of that kind.
    pub(crate) fn of(found: &Found, axis: Option<AxisKind>) -> Self {
        let axis = found.axis.or(axis);
        let in_rad = found.written.is_some() && axis == Some(AxisKind::Rotary);
        Self { axis, scale: found.source.scale, in_rad }
    }

    /// One turn of the units that it may have.
    fn turns(self) -> Vec<f64> {
        let turn = 2.0 * PI;
        if self.in_rad {
            return vec![turn];
        }
        let counts = (8..=32).map(|bits| f64::from(bits).exp2());
        let written = [turn, 360.0].into_iter().chain(counts).map(|turn| turn * self.scale.abs());
        std::iter::once(turn).chain(written).collect()
    }
}

/// Counts the turns of a position that wraps, and tells what was done. One that does not clearly
/// wrap stays as it is.
pub(crate) fn unwrap(time: &[f64], position: &mut [f64], angle: Angle) -> Option<Wrapped> {
    if position.len() < FEWEST || angle.axis == Some(AxisKind::Linear) {
        return None;
    }
    let wrap = Wrap::of(time, position)?;
    let turn = wrap.turn(position, angle)?;
    let mut turns = 0.0;
    let mut before = position[0];
    for value in position.iter_mut() {
        let step = *value - before;
        before = *value;
        if step.abs() > 0.5 * turn {
            turns -= step.signum();
        }
        *value += turns * turn;
    }
    let one_turn = (turn / (2.0 * PI) - 1.0).abs() < 1e-9;
    Some(Wrapped { jumps: wrap.jumps.len(), turn, one_turn })
}

/// The jumps of a position.
struct Wrap {
    low: f64,
    high: f64,
    /// The step of its quantiser, or none.
    count: f64,
    /// Steps from sample to sample.
    steps: Vec<f64>,
    /// Which of them are jumps.
    jumps: Vec<usize>,
    /// Which of them go over a gap in time.
    gaps: Vec<bool>,
}

impl Wrap {
    fn of(time: &[f64], position: &[f64]) -> Option<Self> {
        let low = position.iter().copied().fold(f64::INFINITY, f64::min);
        let high = position.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let steps: Vec<f64> = position.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let is_jump = |step: f64| step.abs() > JUMP * (high - low);
        let jumps: Vec<usize> = (0..steps.len()).filter(|&k| is_jump(steps[k])).collect();
        if jumps.is_empty() || 4 * jumps.len() > steps.len() {
            return None;
        }
        let times: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let usual = upper_median(&mut times.clone()).unwrap_or(0.0);
        let gaps = times.iter().map(|step| *step > 3.0 * usual).collect();
        Some(Self { low, high, count: step_of(position).unwrap_or(0.0), steps, jumps, gaps })
    }

    /// The step that the axis goes on with around step `k`.
    fn going(&self, k: usize) -> f64 {
        let from = k.saturating_sub(AROUND);
        let around = self.steps.iter().enumerate().skip(from).take(2 * AROUND + 1);
        let small = around.map(|(_, step)| *step).filter(|step| self.is_small(*step));
        let (n, sum) = small.fold((0usize, 0.0), |(n, sum), step| (n + 1, sum + step));
        if n == 0 { 0.0 } else { sum / n as f64 }
    }

    fn is_small(&self, step: f64) -> bool {
        step.abs() <= JUMP * (self.high - self.low)
    }

    /// The size of a turn, where the position wraps.
    fn turn(&self, position: &[f64], angle: Angle) -> Option<f64> {
        let mut sizes: Vec<f64> =
            self.jumps.iter().map(|&k| (self.steps[k] - self.going(k)).abs()).collect();
        let size = upper_median(&mut sizes)?;
        let known = angle.turns().into_iter().find(|turn| (size / turn - 1.0).abs() < ALIKE);
        let turn = known.unwrap_or_else(|| self.in_counts(size));
        let fits = self.high - self.low <= turn * (1.0 + 1e-6) + self.count;
        // Beside the noise at the rim, the axis goes on as it came.
        let noise = self.noise();
        let goes_on = |&k: &usize| {
            let rest = self.steps[k] - self.steps[k].signum() * turn - self.going(k);
            rest.abs() < (ALIKE * turn).max(10.0 * noise + 2.0 * self.count).min(0.1 * turn)
        };
        let from_rim_to_rim = |&k: &usize| {
            let (from, to) = (position[k], position[k + 1]);
            let (upper, lower) = if from > to { (from, to) } else { (to, from) };
            self.high - upper < RIM * turn && lower - self.low < RIM * turn
        };
        let clear = |k: &&usize| goes_on(k) && from_rim_to_rim(k);
        let timely: Vec<&usize> = self.jumps.iter().filter(|&&k| !self.gap(k)).collect();
        let clean = timely.iter().filter(|k| clear(k)).count();
        if !fits || timely.is_empty() || 10 * clean < 9 * timely.len() {
            return None;
        }
        match known {
            Some(_) => self.moves(turn).then_some(turn),
            None => (self.passes(position) && self.fills(position)).then_some(turn),
        }
    }

    fn gap(&self, k: usize) -> bool {
        self.gaps.get(k).copied().unwrap_or(false)
    }

    /// A size in whole counts, where the position has counts.
    fn in_counts(&self, size: f64) -> f64 {
        if self.count > 0.0 { (size / self.count).round() * self.count } else { size }
    }

    /// How much a step differs from the one before, as a rule.
    fn noise(&self) -> f64 {
        let small = |pair: &&[f64]| self.is_small(pair[0]) && self.is_small(pair[1]);
        let changes = self.steps.windows(2).filter(small).map(|pair| (pair[1] - pair[0]).abs());
        quantile(&sorted(changes), 0.9).unwrap_or(0.0)
    }

    /// Whether the position is more than two levels, which is a signal that is switched.
    fn moves(&self, turn: f64) -> bool {
        let moving = self.steps.iter().filter(|step| **step != 0.0 && self.is_small(**step));
        moving.count() > 2 * self.jumps.len()
            && self.steps.iter().all(|step| step.abs() <= 1.01 * turn)
    }

    /// Whether the axis passes the rim several times, coming and going at about one velocity: it
    /// neither rests there nor begins anew.
    fn passes(&self, position: &[f64]) -> bool {
        let mut groups: Vec<(usize, usize, i32)> = Vec::new();
        for &k in &self.jumps {
            let way = if self.steps[k] > 0.0 { -1 } else { 1 };
            match groups.last_mut() {
                Some((_, last, sum)) if k - *last <= AROUND => (*last, *sum) = (k, *sum + way),
                _ => groups.push((k, k, way)),
            }
        }
        let slope = |from: usize, to: usize| {
            let (from, to) = (position.get(from)?, position.get(to)?);
            Some(to - from).filter(|step| self.is_small(*step))
        };
        let ways = (0..position.len()).filter_map(|k| slope(k, k + AROUND)).map(f64::abs);
        let slow = 0.1 * quantile(&sorted(ways), 0.9).unwrap_or(0.0);
        let (mut passed, mut not) = (0, 0);
        for (first, last, sum) in groups.into_iter().filter(|(_, _, sum)| *sum != 0) {
            let came = first.checked_sub(AROUND).and_then(|from| slope(from, first));
            let went = slope(last + 1, last + 1 + AROUND);
            let (Some(came), Some(went)) = (came, went) else { continue };
            if came.abs().max(went.abs()) < slow {
                continue;
            }
            let same = came * f64::from(sum) > 0.0 && went * f64::from(sum) > 0.0;
            let alike = (0.33..3.0).contains(&(went / came).abs());
            if same && alike { passed += 1 } else { not += 1 }
        }
        passed >= SEVERAL && 2 * not <= passed
    }

    /// Whether the position has been everywhere between its rims.
    fn fills(&self, position: &[f64]) -> bool {
        const PARTS: usize = 16;
        let mut seen = [false; PARTS];
        for value in position {
            let part = (value - self.low) / (self.high - self.low) * PARTS as f64;
            seen[(part as usize).min(PARTS - 1)] = true;
        }
        seen.iter().all(|seen| *seen)
    }
}

#[cfg(test)]
mod tests;
