//! Experiment 3, stage 2: nested loops below breakaway.
//!
//! Where the path comes to a level at which it turned before, and has not left the range of the
//! loop in between, hysteresis with non-local memory is back where it was: the loop closes.

use friction_ident::FrictionTorque;
use serde::{Deserialize, Serialize};

use super::Channels;
use super::channels::block_means;
use crate::profile::REST;
use crate::protocol::{Displacement, PreSlidingProtocol};

/// Half width of the window that is averaged at a turn \[s\].
const WINDOW: f64 = 0.025;

/// One closed loop of the path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Closure {
    /// Turn at which the loop begins, from 0.
    pub begin: usize,
    /// Turn at which it ends, at the same level.
    pub end: usize,
    /// Torque level of both [N m].
    pub level: f64,
    /// Displacement at the end minus at the beginning \[rad\]: zero for a loop that closes.
    pub gap: f64,
    /// Work that the loop takes, closed integral of F dx \[J\].
    pub work: f64,
    /// Its standard deviation by the drive's constants \[J\].
    pub work_systematic: f64,
}

/// The path of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NestedPath {
    /// Its closed loops, in the order in which they close.
    pub closures: Vec<Closure>,
    /// Displacement, means of blocks \[rad\].
    pub displacement: Vec<f64>,
    /// Friction torque, means of blocks [N m].
    pub torque: Vec<f64>,
}

/// Pairs of turns that begin and end a closed loop: the latest earlier turn of the same level, if
/// no turn in between lies outside the range of the turns of the loop that holds it.
#[must_use]
pub fn closed_pairs(turns: &[f64]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for (end, &level) in turns.iter().enumerate() {
        let same = |&turn: &f64| (turn - level).abs() <= 1e-9 * level.abs();
        let Some(begin) = turns[..end].iter().rposition(same) else { continue };
        // The first turn lies on the virgin curve, whose other end is its mirror image.
        let other = if begin == 0 { -level } else { turns[begin - 1] };
        let (least, most) = (level.min(other), level.max(other));
        if turns[begin..end].iter().all(|&turn| turn >= least - 1e-12 && turn <= most + 1e-12) {
            pairs.push((begin, end));
        }
    }
    pairs
}

/// Takes the path's recording apart.
#[must_use]
pub fn nested_path(
    channels: &Channels,
    friction: &FrictionTorque,
    protocol: &PreSlidingProtocol,
) -> NestedPath {
    let position = match protocol.displacement {
        Displacement::Encoder => &channels.encoder,
        Displacement::Potentiometer => &channels.potentiometer,
    };
    let rest = ((REST / channels.period) as usize).clamp(1, position.len().max(1));
    let zero = position.iter().take(rest).sum::<f64>() / rest as f64;
    let last = position.len().saturating_sub(1);
    // The first segment is the rest.
    let turns: Vec<usize> = protocol
        .path()
        .ends()
        .iter()
        .skip(1)
        .map(|end| ((end / channels.period).round() as usize).min(last))
        .collect();
    let half = (WINDOW / channels.period) as usize;
    let mean_at = |index: usize| {
        let values = &position[index.saturating_sub(half)..=(index + half).min(last)];
        values.iter().sum::<f64>() / values.len() as f64
    };
    let size = (protocol.duration / channels.period / f64::from(protocol.samples)).round().max(1.0)
        as usize;
    let blocks = |values: &[f64]| block_means(values.get(rest..).unwrap_or_default(), size);
    let displacement: Vec<f64> = blocks(position).iter().map(|x| x - zero).collect();
    let block_of = |turn: usize| {
        (turns[turn].saturating_sub(rest) / size).min(displacement.len().saturating_sub(1))
    };
    let closures = closed_pairs(&protocol.turns)
        .into_iter()
        .filter(|&(_, end)| end < turns.len())
        .map(|(begin, end)| {
            let (from, to) = (block_of(begin), block_of(end));
            let work = |torque: &[f64]| loop_work(&blocks(torque), &displacement, from, to);
            Closure {
                begin,
                end,
                level: protocol.turns[end],
                gap: mean_at(turns[end]) - mean_at(turns[begin]),
                work: work(&friction.torque),
                work_systematic: friction.propagate(work),
            }
        });
    NestedPath { closures: closures.collect(), torque: blocks(&friction.torque), displacement }
}

/// Closed integral of F dx by trapezia over the samples `from` to `to`, closed by a straight line.
fn loop_work(torque: &[f64], displacement: &[f64], from: usize, to: usize) -> f64 {
    let (Some(torque), Some(x)) = (torque.get(from..=to), displacement.get(from..=to)) else {
        return 0.0;
    };
    let pairs = torque.windows(2).zip(x.windows(2));
    let open: f64 = pairs.map(|(f, x)| 0.5 * (f[0] + f[1]) * (x[1] - x[0])).sum();
    let n = torque.len() - 1;
    open + 0.5 * (torque[n] + torque[0]) * (x[0] - x[n])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_close_where_the_path_stayed_inside() {
        assert_eq!(closed_pairs(&[1.0, -1.0, 0.5, -0.5, 0.5, -1.0, 1.0]), [(2, 4), (1, 5), (0, 6)]);
        // -0.8 leaves the loop of 0.5 and -0.5.
        assert_eq!(closed_pairs(&[1.0, -0.5, 0.5, -0.8, 0.5]), []);
        // The mirror image of the virgin curve's end was passed.
        assert_eq!(closed_pairs(&[0.5, -0.8, 0.5]), []);
    }

    #[test]
    fn the_work_of_a_rectangle_is_its_area() {
        let torque = [1.0, 1.0, -1.0, -1.0, 1.0];
        let x = [0.0, 2.0, 2.0, 0.0, 0.0];
        assert_eq!(loop_work(&torque, &x, 0, 4), 4.0);
        // An open one is closed by a straight line.
        assert_eq!(loop_work(&torque, &x, 0, 3), 4.0);
    }
}
