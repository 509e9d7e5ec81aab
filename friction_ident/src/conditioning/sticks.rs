//! Where an encoder shows that the axis sticks, however short.
//!
//! Rest is told from noise by some tens of samples. An encoder tells more: its reading stays where it
//! is, and right before or after that the axis is far from there. A motion that only turns does not
//! look so: within half the time for which its reading stays, a parabola moves on by three steps
//! only, and a slow motion by half a step.

use std::collections::VecDeque;
use std::ops::Range;

use crate::statistics::sorted;

/// Samples that a reading must stay for.
const LEAST: usize = 4;
/// Steps that the axis is away by within half of that time, before or after.
const AWAY: f64 = 8.0;
/// Steps by which a reading that stays may differ: it may lie on an edge.
const STAYS: f64 = 1.5;
/// Differences that rounding can make, as a share of the largest position.
const ROUNDING: f64 = 1e-9;
/// Share of all steps that may be of a size that no encoder makes, as where turns are counted on from
/// an angle with few digits.
const FEW: f64 = 0.005;

/// The smallest step between two readings that more than a few of them have; zero where there is
/// none. Of an encoder it is its resolution, of a position that is no encoder's less than its noise.
pub(super) fn smallest_step(position: &[f64]) -> f64 {
    let largest = position.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
    let steps = position.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let steps = sorted(steps.filter(|step| *step > ROUNDING * largest));
    let few = (FEW * steps.len() as f64) as usize;
    let common = |pair: &(&f64, &f64)| *pair.1 <= STAYS * *pair.0;
    steps.iter().zip(steps.iter().skip(few)).find(common).map_or(0.0, |(step, _)| *step)
}

/// How near a sample lies to a stick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stick {
    /// So far that a low-pass brings nothing of it.
    Away,
    /// Where a low-pass rings after it.
    Rings,
    /// At it, or where a low-pass takes it for a part of the motion.
    At,
}

/// How near each sample lies to where the axis sticks, by readings that are `step` apart: a low-pass
/// spreads a stick over the first `reach` to each side, and rings over the second, longer one.
pub(super) fn sticking(position: &[f64], step: f64, reach: [usize; 2]) -> Vec<Stick> {
    let mut sticks = vec![false; position.len()];
    if step <= 0.0 {
        return vec![Stick::Away; position.len()];
    }
    let mut same = Same::default();
    for (k, &x) in position.iter().enumerate() {
        if !same.reaches(x, STAYS * step) {
            mark(&mut sticks, position, same.first..k, same.middle(), AWAY * step);
        }
        while !same.reaches(x, STAYS * step) {
            same.forget_first();
        }
        same.take(k, x);
    }
    mark(&mut sticks, position, same.first..position.len(), same.middle(), AWAY * step);
    let mut near = vec![Stick::Away; position.len()];
    let [spreads, rings] = reach;
    for (reach, how) in [(rings, Stick::Rings), (spreads, Stick::At)] {
        for (k, _) in sticks.iter().enumerate().filter(|(_, sticks)| **sticks) {
            let end = k.saturating_add(reach).saturating_add(1).min(near.len());
            near.get_mut(k.saturating_sub(reach)..end).unwrap_or_default().fill(how);
        }
    }
    near
}

/// Readings one after the other that stay where they are, with those of them that may be the lowest
/// or the highest when the first ones are forgotten.
#[derive(Default)]
struct Same {
    first: usize,
    lowest: VecDeque<(usize, f64)>,
    highest: VecDeque<(usize, f64)>,
}

impl Same {
    fn ends(&self) -> Option<(f64, f64)> {
        Some((self.lowest.front()?.1, self.highest.front()?.1))
    }

    fn middle(&self) -> f64 {
        self.ends().map_or(0.0, |(low, high)| 0.5 * (low + high))
    }

    /// Whether a further reading stays with them, `most` from the lowest to the highest.
    fn reaches(&self, x: f64, most: f64) -> bool {
        self.ends().is_none_or(|(low, high)| high.max(x) - low.min(x) <= most)
    }

    fn forget_first(&mut self) {
        self.first += 1;
        for queue in [&mut self.lowest, &mut self.highest] {
            while queue.front().is_some_and(|(k, _)| *k < self.first) {
                queue.pop_front();
            }
        }
    }

    fn take(&mut self, k: usize, x: f64) {
        while self.lowest.back().is_some_and(|(_, low)| *low >= x) {
            self.lowest.pop_back();
        }
        while self.highest.back().is_some_and(|(_, high)| *high <= x) {
            self.highest.pop_back();
        }
        self.lowest.push_back((k, x));
        self.highest.push_back((k, x));
    }
}

/// Marks a stretch in which the readings stay, if the axis is `away` from there soon before or after.
fn mark(sticks: &mut [bool], position: &[f64], stays: Range<usize>, middle: f64, away: f64) {
    if stays.len() < LEAST {
        return;
    }
    let half = stays.len() / 2;
    let before = stays.start.checked_sub(half).and_then(|k| position.get(k));
    let after = position.get(stays.end + half - 1);
    let is_away = |x: &f64| (x - middle).abs() > away;
    if before.is_some_and(is_away) || after.is_some_and(is_away) {
        sticks.get_mut(stays).unwrap_or_default().fill(true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 1e-3;

    fn read(position: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..4000).map(|k| (position(f64::from(k) * 1e-3) / STEP).floor() * STEP).collect()
    }

    fn share(position: &[f64]) -> f64 {
        let sticks = sticking(position, smallest_step(position), [0; 2]);
        sticks.iter().filter(|stick| **stick == Stick::At).count() as f64 / sticks.len() as f64
    }

    /// A period that is next to nothing makes any spread longer than all samples can be counted.
    #[test]
    fn a_stick_may_spread_without_end() {
        let mut stops = vec![0.0, 20.0, 40.0];
        stops.extend([60.0; 6]);
        stops.extend([80.0, 100.0, 120.0]);
        let sticks = |spreads, rings| {
            let found = sticking(&stops, 1.0, [spreads, rings]);
            [Stick::At, Stick::Rings].map(|how| found.iter().filter(|stick| **stick >= how).count())
        };
        assert_eq!((sticks(0, 0), sticks(1, 2)), ([6, 6], [8, 10]));
        assert_eq!((sticks(1, usize::MAX), sticks(usize::MAX, usize::MAX)), ([8, 12], [12, 12]));
    }

    /// Motion that turns, is slow, or stands for ever does not stick by this; what stops for 20 ms at
    /// each turn does.
    #[test]
    fn a_stop_is_told_from_a_turn() {
        assert_eq!(share(&read(|t| 0.3 * (3.0 * t).sin())), 0.0);
        assert_eq!(share(&read(|t| 0.02 * t)), 0.0);
        assert_eq!(share(&read(|t| 1e-3 * (0.5 * t).sin())), 0.0);
        assert_eq!(share(&vec![0.1; 4000]), 0.0);
        // Half a second up and down, with a stop of 20 ms in between.
        let stops = |t: f64| {
            let (turn, within) = ((t / 0.52).floor(), t % 0.52);
            let way = 0.25 * (1.0 - (std::f64::consts::TAU * within.min(0.5)).cos());
            if turn % 2.0 == 0.0 { way } else { 0.5 - way }
        };
        let found = share(&read(stops));
        // The encoder does not see the first and the last 20 ms of each way either.
        assert!((20.0 / 520.0..80.0 / 520.0).contains(&found), "{found}");
    }

    #[test]
    fn the_step_is_that_of_the_encoder() {
        let step = smallest_step(&read(|t| 0.3 * (3.0 * t).sin()));
        assert!((step - STEP).abs() < 1e-9, "{step}");
        assert_eq!(smallest_step(&[0.1; 9]), 0.0);
        assert_eq!(smallest_step(&[]), 0.0);
        // One reading in a thousand is off in its last digit.
        let mut printed = read(|t| 0.3 * (3.0 * t).sin());
        printed.iter_mut().step_by(1000).for_each(|x| *x += 1e-7);
        assert!((smallest_step(&printed) - STEP).abs() < 1e-6);
        assert_eq!(share(&printed), 0.0);
    }
}
