//! A motion from halt to halt, each leg half a cosine, through the edges that it passed.
//!
//! A leg from the turn `(t_i, x_i)` to the next one is
//! `x_i + (x_j - x_i) (1 - cos(pi (t - t_i) / (t_j - t_i))) / 2`. The turns are those for which all
//! legs pass the edges at their instants (least squares); where a leg passes too few edges to say,
//! its turns stay near the first guess.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use super::Crossing;
use crate::bounded::{Bound, Patience, Residuals, minimise};

/// Weight of a turn's first guess: counts a count, and counts a share of the room between the
/// edges.
const TETHER: f64 = 0.02;

/// Instants \[samples\] and positions \[counts\] of the turns, both ends included.
#[derive(Debug, Clone)]
pub(super) struct Turns(Vec<[f64; 2]>);

impl Turns {
    /// Position, by the leg in which the time lies.
    fn at(&self, time: f64, leg: usize) -> f64 {
        let (Some(&[t0, x0]), Some(&[t1, x1])) = (self.0.get(leg), self.0.get(leg + 1)) else {
            return 0.0;
        };
        let share = if t1 > t0 { ((time - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { 1.0 };
        x0 + 0.5 * (x1 - x0) * (1.0 - (PI * share).cos())
    }

    /// The legs through the crossings; `ends` are guesses of the first and the last position, the
    /// first at time 0, the last at `last`.
    pub fn through(crossings: &[Crossing], ends: [f64; 2], last: f64) -> Option<Self> {
        let (first_edge, last_edge) = (crossings.first()?, crossings.last()?);
        let beyond = |edge: &Crossing, side: f64| {
            let far = edge.edge + side * edge.side;
            (edge.edge.min(far), edge.edge.max(far))
        };
        // The guess, and the ranges of instant and position.
        let mut guess = vec![[0.0, ends[0]]];
        let mut ranges = vec![[(0.0, 0.0), beyond(first_edge, -1.0)]];
        let mut legs = Vec::with_capacity(crossings.len());
        for (i, crossing) in crossings.iter().enumerate() {
            legs.push(guess.len() - 1);
            let Some(next) = crossings.get(i + 1) else { break };
            if next.side == crossing.side {
                continue;
            }
            let middle = 0.5 * (crossing.time + next.time);
            guess.push([middle, crossing.edge + 0.4 * crossing.side]);
            ranges.push([(crossing.time, next.time), beyond(crossing, 1.0)]);
        }
        guess.push([last, ends[1]]);
        ranges.push([(last_edge.time, last.max(last_edge.time + 0.5)), beyond(last_edge, 1.0)]);
        let mut problem = Problem { crossings, legs: &legs, guess: &guess, ranges: &ranges };
        let start: Vec<f64> = guess.iter().flatten().copied().collect();
        let bounds: Vec<Bound> = ranges
            .iter()
            .flatten()
            .map(|&(low, high)| Bound::within(low, high, (high - low).max(1.0)))
            .collect();
        let patience = Patience { sum: 1e-6, step: 1e-6, iterations: 40, broyden: false };
        let found =
            minimise(&mut problem, &start, &bounds, &patience, &mut |_| ControlFlow::Continue(()))?;
        Some(turns_of(&found.x))
    }

    /// Positions at whole samples, moved so that every edge is passed at its instant: by the
    /// straight line between the gaps of neighbouring crossings.
    pub fn path(&self, crossings: &[Crossing], samples: usize) -> Vec<f64> {
        let leg_at = |time: f64, from: usize| {
            (from..self.0.len().saturating_sub(2))
                .find(|&leg| self.0.get(leg + 1).is_some_and(|turn| time <= turn[0]))
                .unwrap_or(self.0.len().saturating_sub(2))
        };
        let mut leg = 0;
        let mut gaps = Vec::with_capacity(crossings.len());
        for crossing in crossings {
            leg = leg_at(crossing.time, leg);
            gaps.push((crossing.time, crossing.edge - self.at(crossing.time, leg)));
        }
        let (mut leg, mut next) = (0, 0);
        (0..samples)
            .map(|k| {
                let time = k as f64;
                leg = leg_at(time, leg);
                while gaps.get(next).is_some_and(|gap| gap.0 < time) {
                    next += 1;
                }
                let gap = match (next.checked_sub(1).and_then(|i| gaps.get(i)), gaps.get(next)) {
                    (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (time - a.0) / (b.0 - a.0),
                    (Some(only), None) | (None, Some(only)) => only.1,
                    (None, None) => 0.0,
                };
                self.at(time, leg) + gap
            })
            .collect()
    }
}

fn turns_of(x: &[f64]) -> Turns {
    Turns(x.chunks_exact(2).filter_map(|pair| pair.first_chunk().copied()).collect())
}

struct Problem<'a> {
    crossings: &'a [Crossing],
    /// Leg of each crossing.
    legs: &'a [usize],
    guess: &'a [[f64; 2]],
    ranges: &'a [[(f64, f64); 2]],
}

impl Residuals for Problem<'_> {
    fn len(&self) -> usize {
        self.crossings.len() + 2 * self.guess.len()
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        let turns = turns_of(x);
        let at_edges =
            self.crossings.iter().zip(self.legs).map(|(c, &leg)| turns.at(c.time, leg) - c.edge);
        let tethers =
            turns.0.iter().zip(self.guess).zip(self.ranges).flat_map(|((turn, guess), ranges)| {
                let room = (ranges[0].1 - ranges[0].0).max(1.0);
                [TETHER * (turn[0] - guess[0]) / room, TETHER * (turn[1] - guess[1])]
            });
        out.iter_mut().zip(at_edges.chain(tethers)).for_each(|(out, value)| *out = value);
        true
    }
}
