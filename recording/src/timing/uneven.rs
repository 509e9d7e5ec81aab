//! Uneven samples brought to an even grid of a rate that was asked for.
//!
//! Every channel goes the same way, so that what holds between channels goes on to hold: read along
//! straight lines between neighbouring samples, on a grid at least twice as dense as the samples
//! are in the mean, then through the zero-phase anti-alias low-pass of
//! [`decimate`], which ends at 0.4 of the new rate. Where
//! the new rate itself is that dense, there is nothing to be filtered.

use super::between::between;
use friction_ident::zero_phase::decimate;

/// A stretch of uneven samples, and where it is read.
#[derive(Debug, Clone, PartialEq)]
pub struct Uneven {
    /// Recorded samples and their times from the first one \[s\].
    nodes: Vec<(usize, f64)>,
    /// Period of the dense grid \[s\].
    dense: f64,
    /// Points of the dense grid.
    points: usize,
    /// One in so many of them is kept.
    factor: usize,
}

impl Uneven {
    /// The stretch of `nodes` at `rate`; none where it is too short for the low-pass.
    pub fn new(nodes: Vec<(usize, f64)>, rate: f64) -> Option<Self> {
        let (&(_, start), &(_, end)) = (nodes.first()?, nodes.last()?);
        let nodes: Vec<(usize, f64)> = nodes.iter().map(|&(k, t)| (k, t - start)).collect();
        let mean_rate = (nodes.len() - 1) as f64 / (end - start);
        let factor = (2.0 * mean_rate / rate).ceil().max(1.0) as usize;
        let dense = 1.0 / (rate * factor as f64);
        let points = ((end - start) / dense * (1.0 + 1e-12)).floor() as usize + 1;
        let found = Self { nodes, dense, points, factor };
        decimate(&vec![0.0; points], factor).is_ok().then_some(found)
    }

    /// Samples on the new grid.
    pub fn len(&self) -> usize {
        self.points.div_ceil(self.factor)
    }

    /// A channel on the new grid. Where nothing is filtered, one that comes from a quantiser keeps
    /// to its steps.
    pub fn channel(&self, recorded: &[f64], step: Option<f64>) -> Vec<f64> {
        let value = |index: usize| recorded.get(index).copied().unwrap_or_default();
        self.read(|node| value(self.nodes[node].0), step.filter(|_| self.factor == 1))
    }

    /// The readings that are nearest to the new samples, each as it was recorded: what stays the same
    /// goes on to stay the same. A reading that is computed between two others differs from them by
    /// the rounding of the file.
    pub fn nearest(&self, recorded: &[f64]) -> Vec<f64> {
        let reading = |(node, part): (usize, f64)| {
            let (index, _) = self.nodes[if part < 0.5 { node } else { node + 1 }];
            recorded.get(index).copied().unwrap_or_default()
        };
        self.places().step_by(self.factor).map(reading).collect()
    }

    fn read(&self, value: impl Fn(usize) -> f64, step: Option<f64>) -> Vec<f64> {
        // It was tried when this was made.
        decimate(&self.dense(value, step), self.factor).unwrap_or_default()
    }

    /// The dense grid, along straight lines.
    fn dense(&self, value: impl Fn(usize) -> f64, step: Option<f64>) -> Vec<f64> {
        let read = |(node, part)| between([value(node), value(node + 1)], part, step);
        self.places().map(read).collect()
    }

    /// Where the points of the dense grid lie: behind which node, and how far to the next one.
    fn places(&self) -> impl Iterator<Item = (usize, f64)> {
        let (mut node, last) = (0, self.nodes.len() - 1);
        (0..self.points).map(move |point| {
            let now = point as f64 * self.dense;
            while node + 1 < last && self.nodes[node + 1].1 <= now {
                node += 1;
            }
            let (from, to) = (self.nodes[node].1, self.nodes[node + 1].1);
            (node, ((now - from) / (to - from)).clamp(0.0, 1.0))
        })
    }

    /// What becomes of white noise on the samples, by trying it.
    pub fn noise(&self) -> f64 {
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        let white: Vec<f64> = (0..self.nodes.len())
            .map(|_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
            })
            .collect();
        let deviation = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len().max(1) as f64)
                .sqrt()
        };
        deviation(&self.read(|node| white[node], None)) / deviation(&white)
    }

    /// Where the low-pass ends \[Hz\].
    pub fn low_pass(&self, rate: f64) -> Option<f64> {
        (self.factor > 1).then_some(0.4 * rate)
    }
}
