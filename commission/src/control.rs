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
use crate::bed::{Arm, Bed, missed, refined, seconds};
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
const HOLDS: u32 = 8;
const HOLDS_USUAL: f64 = 2.5;
/// How much larger than the farthest swing the angle of rest is made, and how much larger still in the
/// end: at another place, and another day, the shaft slips farther.
const LEFT: f64 = 1.5;
const MARGIN: f64 = 2.0;
/// The attempt from which on the loop is made slower too, and by which factor.
const SLOWER: u32 = 5;
const SLOWED: f64 = 0.7;
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
    let bed = Bed::of(known, drive, (friction, chosen), design)?;
    let arms = bed.arms();
    let mut errors: Vec<(Arm, Vec<f64>)> = arms.iter().map(|arm| (*arm, Vec::new())).collect();
    let mut heard: Vec<Vec<Vec<CycleSample>>> = vec![Vec::new(); arms.len()];
    axis.say(Stage::Control, "what feedback is worth, in simulation");
    let tried = pareto::tried(&bed)?;
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
        if let Some((fed, errors)) = &mut fed_back_errors {
            axis.say(Stage::Control, &format!("{} fed back", fed.kind));
            let bed = bed.feeding_back(Some(*fed));
            errors.push(bed.try_out(axis, &bench, Stage::Control, Arm::Friction)?);
        }
    }
    let arm = choose(&errors);
    let of_arm = errors.iter().position(|(one, _)| *one == arm);
    let level = of_arm.map_or(1.0, |place| level_now(1.0, &heard[place]));
    let bed = bed.leveled(level);
    let fed = fed_back_errors.as_ref().filter(|(_, fed)| is_better(fed, arm, &errors));
    let fed_bed = fed.map(|(fed, _)| bed.feeding_back(Some(*fed)));
    let rested = match fed_bed {
        Some(bed) => Some(at_rest(axis, &bench, bed, Arm::Friction, (later, HOLDS_FED_BACK))?),
        None => None,
    };
    // What is fed back and hunts is not handed over.
    let ((bed, rests), arm) = match rested.filter(|(_, rests)| *rests) {
        Some(rested) => (rested, Arm::Friction),
        None => (at_rest(axis, &bench, bed, arm, (later, HOLDS))?, arm),
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
        level,
    })
}

/// The loop with which the shaft rests after a move either way, and whether it does. What a shaft
/// slips by is what its integral has to leave alone; what still hunts then, as in backlash, takes a
/// slower loop.
fn at_rest(
    axis: &mut Axis<'_>,
    bench: &Bench,
    mut bed: Bed,
    arm: Arm,
    (later, most): (f64, u32),
) -> Result<(Bed, bool), CommissionError> {
    let (mut rested, mut forward) = (0, true);
    for attempt in 1..=most {
        if attempt > RESTED && axis.left() < later + REST + HELD.1 {
            break;
        }
        axis.say(Stage::Control, &format!("move and hold, {attempt}"));
        let held = bed.move_and_hold(axis, bench, Stage::Control, (arm, forward), HELD)?;
        forward = !forward;
        if hunting::rests(&held, bed.encoder_step()) {
            rested += 1;
            if rested == RESTED {
                return Ok((bed.resting(MARGIN * bed.resting_angle()), true));
            }
            continue;
        }
        rested = 0;
        let farthest = held.iter().map(|error| error.abs()).fold(0.0, f64::max);
        bed = bed.resting((LEFT * farthest).max(2.0 * bed.resting_angle()));
        if attempt >= SLOWER {
            let fastest = SLOWED * bed.design().natural_frequency;
            bed = bed.with(design_below(bed.plant(), QUICK, fastest, Stage::Control)?);
        }
    }
    Ok((bed, false))
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
