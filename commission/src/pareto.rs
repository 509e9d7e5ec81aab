//! What each technique is worth at equal robustness: error against peak of the sensitivity and
//! noise, in simulation on the identified plant.
//!
//! The measure is the linear loop as it was designed. A technique that feeds back makes the loop
//! stiffer; so the linear gains under it are lowered until the peak of the sensitivity and the noise
//! of the voltage, of the loop as it runs, are no more than before. What it earns then is earned, and
//! not taken from the margins. Arms that feed forward leave the loop alone.
//!
//! Friction is not told by its curve for ever. The error is that over three plants: friction as it
//! was identified, a tenth less and a tenth more.

use friction_ident::statistics::root_mean_square;
use serde::{Deserialize, Serialize};
use strum::VariantArray;

use crate::bed::{Arm, Bed};
use crate::feedback::{FedBack, Kind};
use crate::identified::{Identified, Looped, Robustness, robustness};
use crate::loop_design::{QUICK, design_below};
use crate::{CommissionError, Stage, hunting};

/// What friction may change by.
const DRIFTS: [f64; 3] = [0.9, 1.0, 1.1];
/// Slack of what counts as equal.
const EQUAL: (f64, f64) = (1.01, 1.05);
/// Ratio of two loops that are looked at, and how many.
const RATIO: f64 = 0.85;
const LOOPS: i32 = 14;
/// Loops beside the equal one, for the picture, over its frequency.
const BESIDE: [f64; 2] = [0.7, 0.5];
/// Move and hold: the part in which the shaft has to rest \[s\].
const HELD: (f64, f64) = (4.0, 10.0);
/// How often the angle of rest is made larger, and by how much.
const RESTS: usize = 5;
const LEFT: f64 = 1.5;
/// Factors by which the gain of the plant may grow.
const GAINS: [f64; 6] = [1.25, 1.6, 2.0, 2.5, 3.2, 4.0];
/// By how much the error may grow with it.
const WORSE: f64 = 3.0;

/// One that was tried in simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Tried {
    /// What is fed forward, where nothing is fed back.
    pub arm: Arm,
    /// What is fed back.
    pub fed_back: Option<FedBack>,
    /// Whether it is as robust as the linear loop; others are for the picture.
    pub equal: bool,
    /// Peak of the sensitivity function.
    pub peak: f64,
    /// Root mean square of the voltage that the encoder's steps make \[V\].
    pub noise: f64,
    /// Chattering: root mean square of the voltage's change from cycle to cycle, on the sine \[V\].
    pub chatter: f64,
    /// Root mean square error on the sine, over the plants \[rad\].
    pub error: f64,
    /// Whether the shaft hunts after a move, with the angle of rest that helps most; none where it
    /// was not asked.
    pub hunts: Option<bool>,
    /// Factor by which the plant's gain may grow before it hunts or the error is three times as
    /// large; 1 where a quarter is too much already, none where it was not asked.
    pub gain_margin: Option<f64>,
}

impl Tried {
    /// Its name in tables.
    #[must_use]
    pub fn name(&self) -> String {
        self.fed_back.map_or_else(|| self.arm.to_string(), |fed| fed.kind.to_string())
    }
}

/// Everything that was tried: the arms first, the simplest of them first.
///
/// # Errors
/// [`CommissionError`] for settings that cannot be.
pub fn tried(bed: &Bed) -> Result<Vec<Tried>, CommissionError> {
    let mut all = Vec::new();
    let mut measure = None;
    // In the simulation nothing hangs.
    for arm in Arm::VARIANTS.iter().filter(|arm| **arm != Arm::Load) {
        let robust = robust(bed, *arm)?;
        // The arms have one loop: the first one's is that of all.
        measure.get_or_insert(robust);
        all.push(judged(bed, *arm, robust, true)?);
        for slower in BESIDE {
            all.extend(beside(bed, *arm, None, slower)?);
        }
    }
    let Some(measure) = measure.filter(|measure| measure.peak.is_finite()) else {
        return Ok(all.into_iter().filter(|tried| tried.peak.is_finite()).collect());
    };
    for kind in Kind::VARIANTS {
        for strength in kind.strengths() {
            let Some((fed, robust)) = equal(bed, (*kind, strength), &measure)? else { continue };
            let fed_bed = bed.feeding_back(Some(fed));
            all.push(judged(&fed_bed, Arm::Friction, robust, true)?);
            for slower in BESIDE {
                all.extend(beside(&fed_bed, Arm::Friction, Some(fed), slower)?);
            }
        }
    }
    Ok(all.into_iter().filter(|tried| tried.peak.is_finite() && tried.error.is_finite()).collect())
}

/// The feedback that is worth rig time: the best of those that rest, if it is better than every arm
/// by the share `clearly`.
#[must_use]
pub fn promising(tried: &[Tried], clearly: f64) -> Option<FedBack> {
    let equal = || tried.iter().filter(|tried| tried.equal && tried.hunts == Some(false));
    let forward = equal()
        .filter(|tried| tried.fed_back.is_none())
        .map(|tried| tried.error)
        .fold(f64::INFINITY, f64::min);
    equal()
        .filter(|tried| tried.fed_back.is_some() && tried.error < (1.0 - clearly) * forward)
        .min_by(|a, b| a.error.total_cmp(&b.error))
        .and_then(|tried| tried.fed_back)
}

/// The technique over the fastest loop with which it is as robust and as quiet as `measure`.
fn equal(
    bed: &Bed,
    (kind, strength): (Kind, f64),
    measure: &Robustness,
) -> Result<Option<(FedBack, Robustness)>, CommissionError> {
    let mut slowest = f64::INFINITY;
    for step in 0..LOOPS {
        let fastest = bed.design().natural_frequency * RATIO.powi(step);
        let Ok(design) = design_below(bed.plant(), QUICK, fastest, Stage::Control) else {
            return Ok(None);
        };
        if design.natural_frequency >= slowest {
            continue;
        }
        slowest = design.natural_frequency;
        let fed = FedBack { kind, strength, design };
        let found = robust(&bed.feeding_back(Some(fed)), Arm::Friction)?;
        if found.peak <= EQUAL.0 * measure.peak && found.noise <= EQUAL.1 * measure.noise {
            return Ok(Some((fed, found)));
        }
    }
    Ok(None)
}

/// The same over a slower loop; none where no loop is as slow.
fn beside(
    bed: &Bed,
    arm: Arm,
    fed: Option<FedBack>,
    slower: f64,
) -> Result<Option<Tried>, CommissionError> {
    let fastest = slower * bed.design().natural_frequency;
    let Ok(design) = design_below(bed.plant(), QUICK, fastest, Stage::Control) else {
        return Ok(None);
    };
    let bed = bed.feeding_back(fed.map(|fed| FedBack { design, ..fed })).with(design);
    Ok(Some(judged(&bed, arm, robust(&bed, arm)?, false)?))
}

fn robust(bed: &Bed, arm: Arm) -> Result<Robustness, CommissionError> {
    let about = (bed.speed(), bed.design().natural_frequency);
    robustness(&bed.identified(), &bed.simulated(arm), about)
}

fn judged(
    bed: &Bed,
    arm: Arm,
    Robustness { peak, noise }: Robustness,
    equal: bool,
) -> Result<Tried, CommissionError> {
    let identified = bed.identified();
    let (mut squares, mut chatter) = (0.0, 0.0);
    for drift in DRIFTS {
        let (error, jumps) = sine(bed, arm, &identified.scaled(drift, 1.0))?;
        squares += error * error / DRIFTS.len() as f64;
        chatter = f64::max(chatter, jumps);
    }
    let error = squares.sqrt();
    let (mut hunts, mut gain_margin) = (None, None);
    // What is only for the picture is not asked whether it rests.
    if equal {
        let rested = rested(bed, arm, &identified)?;
        hunts = Some(rested.is_none());
        gain_margin = rested.map(|rested| grows(&rested, arm, error)).transpose()?;
    }
    let fed_back = bed.fed_back().copied();
    Ok(Tried { arm, fed_back, equal, peak, noise, chatter, error, hunts, gain_margin })
}

/// Error on the sine, and the voltage's change from cycle to cycle, both root mean square.
fn sine(bed: &Bed, arm: Arm, plant: &Identified) -> Result<(f64, f64), CommissionError> {
    let cycles = Looped::on(plant, &bed.simulated(arm), bed.sine(), Bed::counted())?;
    let errors: Vec<f64> = cycles.iter().map(|cycle| cycle.error).collect();
    let jumps: Vec<f64> = cycles.windows(2).map(|pair| pair[1].volts - pair[0].volts).collect();
    Ok((root_mean_square(&errors), root_mean_square(&jumps)))
}

/// Whether the shaft rests after a move on that plant, and the farthest swing \[rad\].
fn holds(bed: &Bed, arm: Arm, plant: &Identified) -> Result<(bool, f64), CommissionError> {
    let cycles = Looped::on(plant, &bed.simulated(arm), bed.smooth_move(true), HELD)?;
    let errors: Vec<f64> = cycles.iter().map(|cycle| cycle.error).collect();
    let farthest = errors.iter().map(|error| error.abs()).fold(0.0, f64::max);
    Ok((hunting::rests(&errors, bed.encoder_step()), farthest))
}

/// The bed with the angle of rest with which the shaft rests; none where it hunts all the same.
fn rested(bed: &Bed, arm: Arm, plant: &Identified) -> Result<Option<Bed>, CommissionError> {
    let mut bed = *bed;
    for _ in 0..RESTS {
        let (rests, farthest) = holds(&bed, arm, plant)?;
        if rests {
            return Ok(Some(bed));
        }
        bed = bed.resting((LEFT * farthest).max(2.0 * bed.resting_angle()));
    }
    Ok(None)
}

/// The factor by which the gain of the plant may grow.
fn grows(bed: &Bed, arm: Arm, error: f64) -> Result<f64, CommissionError> {
    let mut margin = 1.0;
    for gain in GAINS {
        let plant = bed.identified().scaled(1.0, gain);
        // Feedforward of a wrong gain is no matter of robustness; what oscillates is.
        if !holds(bed, arm, &plant)?.0
            || sine(bed, arm, &plant)?.0 > WORSE * error.max(bed.encoder_step())
        {
            break;
        }
        margin = gain;
    }
    Ok(margin)
}

#[cfg(test)]
mod tests {
    use controller::design::LinearDrive;

    use super::*;
    use crate::loop_design::{Plant, design};

    fn bed() -> Bed {
        let plant = Plant {
            drive: LinearDrive::THESIS,
            delay: 0.001,
            period: 1e-3,
            encoder_step: std::f64::consts::TAU / 4096.0,
            voltage_limit: 6.0,
        };
        let design = design(&plant, QUICK, Stage::Control).unwrap();
        Bed::new(plant, design, (0.5, 0.4), (0.1, 2.0), 0.2).unwrap()
    }

    #[test]
    fn what_feeds_back_is_as_robust_and_as_quiet_as_the_linear_loop() {
        let all = tried(&bed()).unwrap();
        let measure = &all[0];
        assert!(measure.arm == Arm::Linear && measure.equal);
        let mut kinds = std::collections::BTreeSet::new();
        for one in all.iter().filter(|one| one.equal) {
            assert!(one.peak <= 1.02 * measure.peak, "{one:?}");
            assert!(one.noise <= 1.06 * measure.noise, "{one:?}");
            kinds.extend(one.fed_back.map(|fed| fed.kind));
        }
        assert!(kinds.len() >= 3, "{kinds:?}");
    }

    #[test]
    fn feedback_is_tried_where_it_is_clearly_better_and_rests() {
        let design = *bed().design();
        let fed = FedBack { kind: Kind::Fuzzy, strength: 0.5, design };
        let forward = Tried {
            arm: Arm::Friction,
            fed_back: None,
            equal: true,
            peak: 1.4,
            noise: 0.1,
            chatter: 0.1,
            error: 1.0,
            hunts: Some(false),
            gain_margin: Some(2.0),
        };
        let back = Tried { fed_back: Some(fed), error: 0.8, ..forward };
        assert_eq!(promising(&[forward, back], 0.05), Some(fed));
        assert_eq!(promising(&[forward, Tried { error: 0.97, ..back }], 0.05), None);
        assert_eq!(promising(&[forward, Tried { hunts: Some(true), ..back }], 0.05), None);
        assert_eq!(promising(&[forward, Tried { equal: false, ..back }], 0.05), None);
    }
}
