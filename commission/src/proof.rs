//! Proof: the linear gains alone against what is handed over, in alternating blocks.
//!
//! Two tasks: a slow sine with its reversals, and moves: a step, a small move back, and hold behind
//! each. While it holds, the shaft must not hunt.

use experiment_runner::waveform::Waveform;
use friction_ident::statistics::root_mean_square;
use rig_setup::REST;
use serde::{Deserialize, Serialize};

use crate::axis::{Axis, Bench};
use crate::bed::{Arm, Bed, missed, seconds};
use crate::control::{HOLDS, Looks, Rested, at_rest, whole};
use crate::identified::Looped;
use crate::level::level_now;
use crate::loop_design::LoopDesign;
use crate::margin::{DriftMargin, drift_margin};
use crate::{CommissionError, Ranged, Stage, hunting};

/// Pairs of sines.
const PAIRS: usize = 4;
/// Pairs that do where a warm motor took the time for more.
const FEWEST: usize = 3;
/// Long holds at most, and their part that counts \[s\].
const LONGER: usize = 4;
const LONG: (f64, f64) = (4.0, 16.0);
/// Pairs of moves.
const MOVES: usize = 3;
/// Pairs of the end by which the friction is told as it is now.
const LAST: usize = 2;
/// Time that a pause may take \[s\].
const SPARE: f64 = 5.0;
/// A step: when it is, and when the shaft is held \[s\].
const STEP: (f64, f64) = (0.2, 4.0);
/// A small move: when it begins, how long it takes, and how long it is held \[s\].
const SMALL: (f64, f64, f64) = (0.2, 0.6, 4.0);
/// The time of either in which the shaft has to rest \[s\].
const HELD: f64 = 2.0;
/// A step is that share of the task's amplitude.
const STEPS: f64 = 0.25;
/// How much larger than the farthest that was missed, and than before, the angle of rest is made
/// where the shaft hunted.
const LEFT: f64 = 1.5;
const LARGER: f64 = 2.0;
/// Highest speed of a step over that of the task, and how often it is halved for that.
const BRISK: f64 = 2.0;
const HALVED: u32 = 6;
/// A small move is that share, and so many counts of the encoder at least.
const SMALLER: f64 = 0.05;
const COUNTS: f64 = 8.0;

/// What moves came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Moves {
    /// The step and the small move \[rad\].
    pub sizes: (f64, f64),
    /// Root mean square errors of each pair's step, before and after \[rad\].
    pub steps: Vec<(f64, f64)>,
    /// Of its small move.
    pub small: Vec<(f64, f64)>,
    /// After over before of the steps, with its paired 95 % interval.
    pub step_ratio: Option<Ranged>,
    /// Of the small moves.
    pub small_ratio: Option<Ranged>,
    /// What is still missed while the shaft is held, before and after \[rad\].
    pub missed: (f64, f64),
    /// How often it hunted while it was held, before and after, and how often it was held.
    pub hunted: (usize, usize, usize),
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Proof {
    /// What was held against the linear gains.
    pub arm: Arm,
    /// Root mean square errors of each pair, before and after \[rad\].
    pub pairs: Vec<(f64, f64)>,
    /// After over before with its paired 95 % interval; none where nothing was added.
    pub ratio: Option<Ranged>,
    /// What moves came to; none where no time was left for them.
    #[serde(default)]
    pub moves: Option<Moves>,
    /// How far what was identified may drift before it hunts, in simulation.
    #[serde(default)]
    pub drift: Option<DriftMargin>,
    /// How much of the friction is compensated in the end, of what the curve says.
    #[serde(default = "whole")]
    pub level: f64,
    /// What was made calmer because the shaft hunted while it was held.
    #[serde(default)]
    pub calmed: Option<Calmed>,
}

/// A loop that was made calmer, and looked at once more.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Calmed {
    /// The loop.
    pub design: LoopDesign,
    /// Error up to which its integral stands still while the reference does \[rad\].
    pub resting_angle: f64,
    /// Whether the shaft rested after moves either way then.
    pub rests: bool,
}

impl Proof {
    /// What is handed over, of what was to be proven.
    #[must_use]
    pub fn handed_over(&self, bed: &Bed) -> Bed {
        let bed = bed.leveled(self.level);
        self.calmed.map_or(bed, |calmed| bed.with(calmed.design).resting(calmed.resting_angle))
    }
}

/// Rig time of the stage \[s\].
#[must_use]
pub fn seconds_needed() -> f64 {
    (2 * PAIRS) as f64 * seconds() + MOVES as f64 * moves_seconds()
}

/// Rig time of a pair of moves \[s\].
fn moves_seconds() -> f64 {
    2.0 * (2.0 * REST + STEP.1 + SMALL.2)
}

/// Does the stage. Where the linear gains won there is nothing to hold against them: they alone make
/// the moves.
///
/// # Errors
/// [`CommissionError`] if the rig refuses or the time is up.
pub fn proof(axis: &mut Axis<'_>, bed: &Bed, arm: Arm) -> Result<Proof, CommissionError> {
    let drift = Some(drift_margin(bed, arm)?);
    let bench = axis.bench()?;
    let mut pairs = Vec::new();
    let mut heard = Vec::new();
    for pair in 0..if arm == Arm::Linear { 0 } else { PAIRS } {
        if pair >= FEWEST && axis.left() < 2.0 * seconds() + moves_seconds() + SPARE {
            break;
        }
        axis.say(Stage::Proof, &format!("before and after, pair {} of {PAIRS}", pair + 1));
        let mut run = |arm| bed.heard(axis, &bench, Stage::Proof, arm);
        // What drifts meets both: the order changes from pair to pair.
        let (before, after) = in_turn(pair, arm, &mut run)?;
        pairs.push((root_mean_square(&missed(&before)), root_mean_square(&missed(&after))));
        heard.push(after);
    }
    let (moves, farthest) = moves(axis, &bench, bed, arm)?;
    let hunted = moves.as_ref().is_some_and(|moves| moves.hunted.1 > 0);
    let swung = if hunted { Some(farthest) } else { held_longer(axis, &bench, bed, arm)? };
    let calmed = if let Some(farthest) = swung {
        let angle = (LEFT * farthest).max(LARGER * bed.resting_angle());
        let looks = Looks { later: 0.0, sure: 0, most: HOLDS };
        let what = (Stage::Proof, arm);
        let Rested { bed, rests } = at_rest(axis, &bench, what, bed.resting(angle), looks)?;
        Some(Calmed { design: *bed.design(), resting_angle: bed.resting_angle(), rests })
    } else {
        None
    };
    let ratio = ratio(&pairs);
    let last = heard.split_off(heard.len().saturating_sub(LAST));
    let level = match bed.fed_back() {
        None => level_now(bed.level(), &last),
        Some(_) => bed.level(),
    };
    Ok(Proof { arm, pairs, ratio, moves, drift, level, calmed })
}

/// Holds for longer in the time that is left: a shaft may rest after some moves and hunt after
/// others. The most that was missed where it hunted.
fn held_longer(
    axis: &mut Axis<'_>,
    bench: &Bench,
    bed: &Bed,
    arm: Arm,
) -> Result<Option<f64>, CommissionError> {
    for hold in 0..LONGER {
        // What helps has to be looked at too.
        if axis.left() < 3.0 * (REST + LONG.1) + SPARE {
            break;
        }
        axis.say(Stage::Proof, &format!("move and hold, {} of {LONGER}", hold + 1));
        let forward = hold.is_multiple_of(2);
        let held = bed.move_and_hold(axis, bench, Stage::Proof, (arm, forward), LONG)?;
        if hunting::hunts(&held, bed.encoder_step()) {
            return Ok(Some(held.iter().map(|error| error.abs()).fold(0.0, f64::max)));
        }
    }
    Ok(None)
}

/// What is done by the linear gains alone, and what by `arm`; which comes first changes with `pair`.
fn in_turn<T>(
    pair: usize,
    arm: Arm,
    run: &mut impl FnMut(Arm) -> Result<T, CommissionError>,
) -> Result<(T, T), CommissionError> {
    if pair.is_multiple_of(2) {
        let before = run(Arm::Linear)?;
        Ok((before, run(arm)?))
    } else {
        let after = run(arm)?;
        Ok((run(Arm::Linear)?, after))
    }
}

/// A step, a small move, and hold.
#[derive(Debug, Clone, Copy)]
struct Held {
    step: f64,
    small: f64,
    /// What is missed while it is held.
    missed: f64,
    /// The most that is missed then.
    farthest: f64,
    hunted: usize,
}

fn moves(
    axis: &mut Axis<'_>,
    bench: &Bench,
    bed: &Bed,
    arm: Arm,
) -> Result<(Option<Moves>, f64), CommissionError> {
    let step = step(bed, arm)?;
    let small = (SMALLER * bed.amplitude()).max(COUNTS * bed.encoder_step());
    let sizes = (step, small.min(STEPS * bed.amplitude()));
    let mut pairs: Vec<(Held, Held)> = Vec::new();
    for pair in 0..MOVES {
        if axis.left() < moves_seconds() + SPARE {
            break;
        }
        axis.say(Stage::Proof, &format!("steps and small moves, pair {} of {MOVES}", pair + 1));
        // Forwards and back in turn.
        let sign = if pair.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut run = |arm| held(axis, bench, bed, arm, (sign * sizes.0, sign * sizes.1));
        pairs.push(in_turn(pair, arm, &mut run)?);
    }
    if pairs.is_empty() {
        return Ok((None, 0.0));
    }
    let both = |of: fn(&Held) -> f64| -> Vec<(f64, f64)> {
        pairs.iter().map(|(before, after)| (of(before), of(after))).collect()
    };
    let (steps, small, left) = (both(|h| h.step), both(|h| h.small), both(|h| h.missed));
    let hunted = |of: fn(&(Held, Held)) -> usize| pairs.iter().map(of).sum::<usize>();
    let mean =
        |of: fn(&(f64, f64)) -> f64| root_mean_square(&left.iter().map(of).collect::<Vec<f64>>());
    let is_compared = arm != Arm::Linear;
    let farthest = pairs.iter().map(|(_, after)| after.farthest).fold(0.0, f64::max);
    let moves = Moves {
        sizes,
        step_ratio: ratio(&steps).filter(|_| is_compared),
        small_ratio: ratio(&small).filter(|_| is_compared),
        missed: (mean(|pair| pair.0), mean(|pair| pair.1)),
        hunted: (hunted(|pair| pair.0.hunted), hunted(|pair| pair.1.hunted), 2 * pairs.len()),
        steps,
        small,
    };
    Ok((Some(moves), farthest))
}

/// A step that is no faster than twice the task, in simulation \[rad\].
fn step(bed: &Bed, arm: Arm) -> Result<f64, CommissionError> {
    let mut size = STEPS * bed.amplitude();
    for _ in 0..HALVED {
        let wave = Waveform::StepPosition { position: size, at: 0.0 };
        let fastest =
            |arm| Looped::fastest(&bed.identified(), &bed.simulated(arm), wave, STEP.1 - STEP.0);
        if fastest(Arm::Linear)?.max(fastest(arm)?) <= BRISK * bed.speed() {
            break;
        }
        size *= 0.5;
    }
    Ok(size)
}

/// Both moves, by one arm.
fn held(
    axis: &mut Axis<'_>,
    bench: &Bench,
    bed: &Bed,
    arm: Arm,
    (step, small): (f64, f64),
) -> Result<Held, CommissionError> {
    let period = bench.period();
    let mut does = |task, part: (f64, f64)| {
        let errors = bed.does(axis, bench, Stage::Proof, (arm, task), part)?;
        let rests = errors.len().saturating_sub((HELD / period).round() as usize);
        let end = errors.get(rests..).unwrap_or_default();
        let hunts = hunting::hunts(end, bed.encoder_step());
        let farthest = end.iter().map(|error| error.abs()).fold(0.0, f64::max);
        Ok::<_, CommissionError>((
            root_mean_square(&errors),
            root_mean_square(end),
            hunts,
            farthest,
        ))
    };
    let step = does(Waveform::StepPosition { position: step, at: STEP.0 }, STEP)?;
    let wave = Waveform::MovePosition { position: -small, at: SMALL.0, duration: SMALL.1 };
    let small = does(wave, (SMALL.0, SMALL.2))?;
    Ok(Held {
        step: step.0,
        small: small.0,
        missed: (0.5 * (step.1 * step.1 + small.1 * small.1)).sqrt(),
        farthest: step.3.max(small.3),
        hunted: usize::from(step.2) + usize::from(small.2),
    })
}

/// The ratio of the errors by the mean of its logarithm over the pairs.
fn ratio(pairs: &[(f64, f64)]) -> Option<Ranged> {
    let logs: Vec<f64> = pairs
        .iter()
        .map(|(before, after)| (after / before).ln())
        .filter(|log| log.is_finite())
        .collect();
    let mean = Ranged::mean_of(&logs)?;
    let end = |end: Option<f64>| end.map_or(f64::NAN, f64::exp);
    Some(Ranged::new(mean.value.exp(), end(mean.low), end(mean.high)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ratio_is_paired_so_that_what_drifts_in_both_falls_out() {
        let drifting: Vec<(f64, f64)> = (1..=5)
            .map(|i| (f64::from(i), 0.5 * f64::from(i) * (1.0 + 0.01 * f64::from(i % 2))))
            .collect();
        let ratio = ratio(&drifting).unwrap();
        assert!(
            (ratio.value - 0.503).abs() < 1e-3 && ratio.relative().unwrap() < 0.02,
            "{ratio:?}"
        );
    }

    #[test]
    fn which_comes_first_changes_and_each_is_told_as_what_it_is() {
        for pair in 0..2 {
            let mut order = Vec::new();
            let told = in_turn(pair, Arm::Friction, &mut |arm| {
                order.push(arm);
                Ok(arm)
            });
            assert_eq!(told.unwrap(), (Arm::Linear, Arm::Friction));
            assert_eq!(order[pair], Arm::Linear);
        }
    }
}
