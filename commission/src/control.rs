//! Control: linear gains, and what is fed forward and back beside them.
//!
//! What is fed forward depends on the reference alone. The loop, and with it sensitivity peak and
//! noise of the voltage, is the same in each arm: what differs is the error at equal robustness.
//! What is fed back changes the loop. It is tried in simulation at equal robustness
//! ([`mod@pareto`]), and on the rig where it is clearly better there and the time is left.

use controller::design::LinearDrive;
use experiment_runner::cycle::CycleSample;
use friction_ident::statistics::root_mean_square;
use rig_setup::REST;
use serde::{Deserialize, Serialize};

use crate::axis::{Axis, Bench, Known};
use crate::bed::{Arm, Bed, Stuck, missed, refined, seconds};
use crate::drive::Drive;
use crate::feedback::FedBack;
use crate::friction::Friction;
use crate::level::level_now;
use crate::loop_design::{LoopDesign, QUICK, design, design_below};
use crate::meet::Met;
use crate::model::Chosen;
use crate::pareto::{self, Tried};
use crate::velocity_design::{VelocityDesign, velocity_design};
use crate::{CommissionError, Stage, hunting};

/// Times that each arm is tried.
const TIMES: usize = 2;
/// Move and hold: of its time, the part in which the shaft has to rest \[s\].
const HELD: (f64, f64) = (4.0, 16.0);
/// How often it is tried, and how often usually.
pub(crate) const HOLDS: u32 = 8;
const HOLDS_USUAL: f64 = 2.5;
/// How much larger than the farthest swing the angle of rest is made, and how much larger still in the
/// end: at another place, and another day, the shaft slips farther.
const LEFT: f64 = 1.5;
const MARGIN: f64 = 2.0;
/// The attempt from which on the loop is made slower too, and by which factor.
const SLOWER: u32 = 5;
const SLOWED: f64 = 0.7;
/// The attempt from which on it is made slower where it swings within the angle of rest.
const ALONE: u32 = 3;
/// Moves in a row after which the shaft has to rest.
const RESTED: u32 = 2;
/// A richer arm has to be better by this share.
const CLEARLY: f64 = 0.05;
/// Moves for which what is fed back has to come to rest.
const HOLDS_FED_BACK: u32 = 3;

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Control {
    /// The gains.
    pub design: LoopDesign,
    /// Drive that they are for: gain [rad/(V s)] and time constant \[s\].
    pub drive: (f64, f64),
    /// Root mean square errors of each arm \[rad\], the simplest arm first.
    pub errors: Vec<(Arm, Vec<f64>)>,
    /// The arm that was chosen.
    pub arm: Arm,
    /// What is fed back; it has its own loop, which is `design` too.
    #[serde(default)]
    pub fed_back: Option<FedBack>,
    /// A velocity loop; none where no such loop keeps the margins.
    #[serde(default)]
    pub velocity: Option<VelocityDesign>,
    /// What was tried in simulation.
    #[serde(default)]
    pub tried: Vec<Tried>,
    /// What was fed back on the rig, and its root mean square errors there \[rad\].
    #[serde(default)]
    pub fed_back_errors: Option<(FedBack, Vec<f64>)>,
    /// Error up to which the integral stands still while the reference does \[rad\].
    pub resting_angle: f64,
    /// Whether the shaft rests after a move.
    pub rests: bool,
    /// The static level that is fed forward with the friction, where what broke the shaft loose is more
    /// than what any block showed and that was clearly better on the rig.
    #[serde(default)]
    pub stuck: Option<Stuck>,
    /// Root mean square errors with it, where it was tried \[rad\].
    #[serde(default)]
    pub stuck_errors: Vec<f64>,
    /// How much of the friction is compensated, of what the curve says: it may have changed since.
    #[serde(default = "whole")]
    pub level: f64,
}

pub(crate) const fn whole() -> f64 {
    1.0
}

/// Rig time of the stage \[s\].
#[must_use]
pub fn seconds_needed() -> f64 {
    (TIMES * <Arm as strum::VariantArray>::VARIANTS.len()) as f64 * seconds()
        + HOLDS_USUAL * (REST + HELD.1)
}

/// Does the stage; `later` seconds are left for the one behind it.
///
/// # Errors
/// [`CommissionError`] if no loop can be designed, the rig refuses or the time is up.
pub fn control(
    axis: &mut Axis<'_>,
    (known, met, drive): (&Known, &Met, &Drive),
    (friction, chosen): (&Friction, &Chosen),
    later: f64,
) -> Result<Control, CommissionError> {
    let refined = refined(known, drive, chosen);
    let design = design(&refined, QUICK, Stage::Control)?;
    let bed = Bed::of(known, drive, (friction, chosen), design)?.breaking_loose(met.breakaway());
    let arms = bed.arms();
    let mut errors: Vec<(Arm, Vec<f64>)> = arms.iter().map(|arm| (*arm, Vec::new())).collect();
    let mut heard: Vec<Vec<Vec<CycleSample>>> = vec![Vec::new(); arms.len()];
    axis.say(Stage::Control, "what feedback is worth, in simulation");
    let tried = pareto::tried(&bed)?;
    let stuck = bed
        .stuck(friction.speeds.0)
        .filter(|_| axis.left() > later + seconds_needed() + TIMES as f64 * seconds());
    let mut stuck_errors = Vec::new();
    let mut fed_back_errors = pareto::promising(&tried, CLEARLY)
        .filter(|_| axis.left() > later + with_feedback())
        .map(|fed| (fed, Vec::new()));
    let bench = axis.bench()?;
    for _ in 0..TIMES {
        for ((arm, errors), heard) in errors.iter_mut().zip(&mut heard) {
            axis.say(Stage::Control, &format!("{arm}"));
            let seen = bed.heard(axis, &bench, Stage::Control, *arm)?;
            errors.push(root_mean_square(&missed(&seen)));
            heard.push(seen);
        }
        if stuck.is_some() {
            axis.say(Stage::Control, "friction, with what breaks the shaft loose");
            let bed = bed.sticking(stuck)?;
            stuck_errors.push(bed.try_out(axis, &bench, Stage::Control, Arm::Friction)?);
        }
        if let Some((fed, errors)) = &mut fed_back_errors {
            axis.say(Stage::Control, &format!("{} fed back", fed.kind));
            let bed = bed.feeding_back(Some(*fed));
            errors.push(bed.try_out(axis, &bench, Stage::Control, Arm::Friction)?);
        }
    }
    let chosen_arm = choose(&errors);
    // Beside a load it is what it is beside the friction alone.
    let beside = if chosen_arm == Arm::Load { Arm::Friction } else { chosen_arm };
    let stuck = stuck.filter(|_| is_better(&stuck_errors, beside, &errors));
    let arm = if stuck.is_some() { chosen_arm.max(Arm::Friction) } else { chosen_arm };
    let of_arm = errors.iter().position(|(one, _)| *one == arm);
    let level = of_arm.map_or(1.0, |place| level_now(1.0, &heard[place]));
    let bed = bed.leveled(level).sticking(stuck)?;
    // A load behind a play lets the integral go back and forth in it for ever, now and then only.
    let bed = if drive.seems_early() {
        bed.resting(bed.resting_angle().max(hunting::smallest(bed.encoder_step())))
    } else {
        bed
    };
    let fed = fed_back_errors.as_ref().filter(|(_, fed)| is_better(fed, arm, &errors));
    let fed_bed = fed.map(|(fed, _)| bed.feeding_back(Some(*fed)));
    let looks = |most| Looks { later, sure: RESTED, most };
    let rested = match fed_bed {
        Some(bed) => {
            let what = (Stage::Control, Arm::Friction);
            Some(at_rest(axis, &bench, what, bed, looks(HOLDS_FED_BACK))?)
        }
        None => None,
    };
    // What is fed back and hunts is not handed over.
    let (Rested { bed, rests }, arm) = match rested.filter(|rested| rested.rests) {
        Some(rested) => (rested, Arm::Friction),
        None => (at_rest(axis, &bench, (Stage::Control, arm), bed, looks(HOLDS))?, arm),
    };
    let (design, resting_angle) = (*bed.design(), bed.resting_angle());
    let LinearDrive { gain, time_constant } = refined.drive;
    let fed_back = bed.fed_back().copied();
    let tachometer = met.tachometer.then_some(met.tachometer_noise);
    let velocity = velocity_design(&refined, tachometer);
    Ok(Control {
        design,
        drive: (gain, time_constant),
        errors,
        arm,
        fed_back,
        velocity,
        tried,
        fed_back_errors,
        resting_angle,
        rests,
        stuck,
        stuck_errors,
        level,
    })
}

/// A loop that was looked at for whether the shaft rests after moves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rested {
    /// The loop, with the error up to which its integral stands still.
    pub bed: Bed,
    /// Whether the shaft rested after moves either way.
    pub rests: bool,
}

/// How long a shaft may be looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Looks {
    /// Rig time that is left for what comes later \[s\].
    pub later: f64,
    /// Moves that are made whatever time is left.
    pub sure: u32,
    /// Moves in all.
    pub most: u32,
}

/// The loop with which the shaft rests after a move either way, and whether it does.
///
/// Integral action and stiction make a limit cycle (hunting; Armstrong-Helouvry, Dupont and Canudas de
/// Wit 1994, section 4.2.3); a dead zone of the integral that is wider than what the shaft slips by
/// ([`Bed::slip`], and as it was seen) ends it. What still hunts then, as in backlash, takes a slower loop. Where nothing of that was seen to
/// help, the integral stands still whenever the reference does, and the loop is as fast as it was.
pub(crate) fn at_rest(
    axis: &mut Axis<'_>,
    bench: &Bench,
    (stage, arm): (Stage, Arm),
    first: Bed,
    Looks { later, sure, most }: Looks,
) -> Result<Rested, CommissionError> {
    let mut bed = first;
    let (mut rested, mut forward) = (0, true);
    for attempt in 1..=most {
        if attempt > sure && axis.left() < later + REST + HELD.1 {
            break;
        }
        axis.say(stage, &format!("move and hold, {attempt}"));
        let held = bed.move_and_hold(axis, bench, stage, (arm, forward), HELD)?;
        forward = !forward;
        if hunting::rests(&held, bed.encoder_step()) {
            rested += 1;
            if rested == RESTED {
                let helped = bed.resting_angle() > first.resting_angle();
                let margin = if helped { MARGIN } else { 1.0 };
                return Ok(Rested { bed: bed.resting(margin * bed.resting_angle()), rests: true });
            }
            continue;
        }
        rested = 0;
        let farthest = held.iter().map(|error| error.abs()).fold(0.0, f64::max);
        let before = bed.resting_angle();
        bed = bed.resting((LEFT * farthest).max(2.0 * bed.resting_angle()).max(bed.slip()));
        // What swings while its integral stands still is the loop itself.
        let alone = attempt >= ALONE && farthest <= before;
        if attempt >= SLOWER || alone {
            let fastest = SLOWED * bed.design().natural_frequency;
            bed = bed.with(design_below(bed.plant(), QUICK, fastest, stage)?);
        }
    }
    Ok(Rested { bed: first.resting(first.amplitude()), rests: false })
}

/// Rig time that a try of feedback takes at most, with what comes behind it in the stage \[s\].
fn with_feedback() -> f64 {
    let holds = f64::from(HOLDS_FED_BACK) + HOLDS_USUAL;
    seconds_needed() + TIMES as f64 * seconds() + holds * (REST + HELD.1)
}

/// Whether what is fed back is clearly better in its worst try than the best of the arm.
fn is_better(fed_back: &[f64], arm: Arm, errors: &[(Arm, Vec<f64>)]) -> bool {
    let worst = fed_back.iter().copied().fold(0.0, f64::max);
    errors
        .iter()
        .filter(|(one, _)| *one == arm)
        .flat_map(|(_, errors)| errors)
        .all(|error| worst < (1.0 - CLEARLY) * error)
}

/// The simplest arm, unless a richer one is clearly better in its worst try.
fn choose(errors: &[(Arm, Vec<f64>)]) -> Arm {
    let worst = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
    let best = |errors: &[f64]| errors.iter().copied().fold(f64::INFINITY, f64::min);
    let mut chosen = (Arm::Linear, f64::INFINITY);
    for (arm, errors) in errors {
        if worst(errors) < (1.0 - CLEARLY) * chosen.1 {
            chosen = (*arm, best(errors));
        }
    }
    chosen.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_arms_that_are_alike_the_simplest_is_chosen() {
        let of = |errors: [[f64; 2]; 3]| {
            // The last is there where a load was found.
            let arms = <Arm as strum::VariantArray>::VARIANTS.iter().copied();
            choose(&arms.zip(errors.map(Vec::from)).collect::<Vec<_>>())
        };
        assert_eq!(of([[1.0, 1.1], [0.99, 1.0], [0.98, 1.0]]), Arm::Linear);
        assert_eq!(of([[1.0, 1.1], [0.5, 0.6], [0.58, 0.59]]), Arm::Reference);
        assert_eq!(of([[1.0, 1.1], [0.5, 0.6], [0.1, 0.2]]), Arm::Friction);
    }
}
