//! Waves that come again with the turn: of gear teeth, and of the motor's slots.
//!
//! Each block is looked at by itself first, at every number of waves that its parts resolve: a
//! periodogram with the block's own phase. The peak of the sum is then fitted over all blocks at once,
//! by one phase for all.

use super::fit::{Column, Fitted};
use crate::friction::{PARTS, Trail};

/// Waves a radian from which on they are no load that hangs.
const FEWEST: f64 = 1.4;
/// Largest phase in a part: what is faster is smoothed away.
const FASTEST: f64 = 0.8;
/// Waves that a block has to show at least.
const SHOWN: f64 = 1.5;
/// Counts of the encoder in a wave, at least.
const COUNTS: f64 = 12.0;
/// Steps in which the number of waves changes, as a share of what a block can tell apart.
const STEP: f64 = 0.2;
/// Blocks that have to show a wave.
const BLOCKS: usize = 5;
/// Fine steps to either side of the peak.
const FINE: i32 = 40;

/// Whether a trail resolves so many waves a radian.
fn shows(trail: &Trail, waves: f64) -> bool {
    let phase = waves * trail.length;
    phase <= FASTEST && phase * PARTS as f64 >= SHOWN * std::f64::consts::TAU
}

/// Those that do.
pub(super) fn showing<'a>(trails: &[&'a Trail], waves: f64) -> Vec<&'a Trail> {
    trails.iter().copied().filter(|trail| shows(trail, waves)).collect()
}

/// Numbers of waves a radian that the trails and an encoder of that `step` \[rad\] resolve; none where
/// they resolve nothing.
pub(super) fn range(trails: &[&Trail], step: f64) -> Option<(f64, f64)> {
    let mut lengths: Vec<f64> = trails.iter().map(|trail| trail.length).collect();
    lengths.sort_by(f64::total_cmp);
    // So many blocks are needed.
    let shortest = *lengths.get(BLOCKS - 1)?;
    let most = (FASTEST / shortest).min(std::f64::consts::TAU / (COUNTS * step));
    (most > 1.5 * FEWEST).then_some((FEWEST, most))
}

/// The number of waves a radian that stands out most; none where too few blocks show any.
pub(super) fn strongest(trails: &[&Trail], range: (f64, f64)) -> Option<f64> {
    let mut waves = range.0;
    let mut best = None;
    while waves < range.1 {
        let showing = showing(trails, waves);
        if showing.len() >= BLOCKS {
            // Of a block's own scatter, so that each counts alike.
            let share = showing.iter().map(|trail| power(trail, waves)).sum::<f64>();
            let mean = share / showing.len() as f64;
            if best.is_none_or(|(most, _)| mean > most) {
                best = Some((mean, waves));
            }
        }
        // A block of FASTEST a part tells so much apart.
        waves *= 1.0 + STEP * std::f64::consts::TAU / (FASTEST * PARTS as f64);
    }
    let (_, about) = best?;
    finest(trails, about)
}

/// The number of waves near `about` that one phase for all blocks fits best.
fn finest(trails: &[&Trail], about: f64) -> Option<f64> {
    let showing = showing(trails, about);
    let width = 1.5 * STEP * std::f64::consts::TAU / (FASTEST * PARTS as f64);
    let mut best = None;
    for fine in -FINE..=FINE {
        let waves = about * (1.0 + width * f64::from(fine) / f64::from(FINE));
        let columns = [Column::Sine(waves), Column::Cosine(waves)];
        let Some(fitted) = Fitted::of(&showing, &columns, true) else { continue };
        let left: f64 = fitted.scatter().iter().map(|scatter| scatter.max(1e-12).ln()).sum();
        if best.is_none_or(|(least, _)| left < least) {
            best = Some((left, waves));
        }
    }
    best.map(|(_, waves)| waves)
}

/// The share of a block's scatter that a wave with a phase of its own explains.
fn power(trail: &Trail, waves: f64) -> f64 {
    let one = |parts: &[(f64, f64)]| {
        let n = parts.len() as f64;
        let mean = parts.iter().map(|(_, volts)| volts).sum::<f64>() / n;
        let (mut a, mut b, mut all) = (0.0, 0.0, 0.0);
        let (mut ss, mut sc, mut cc) = (0.0, 0.0, 0.0);
        for (place, volts) in parts {
            let (sin, cos) = (waves * place).sin_cos();
            let volts = volts - mean;
            a += volts * sin;
            b += volts * cos;
            ss += sin * sin;
            sc += sin * cos;
            cc += cos * cos;
            all += volts * volts;
        }
        let det = ss * cc - sc * sc;
        if all > 0.0 && det > 1e-9 * n * n {
            (cc * a * a - 2.0 * sc * a * b + ss * b * b) / (det * all)
        } else {
            0.0
        }
    };
    0.5 * (one(&trail.forward) + one(&trail.backward))
}
