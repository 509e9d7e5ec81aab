//! Control: linear gains, and what is fed forward beside them.
//!
//! Everything that is tried here depends on the reference alone. The loop, and with it sensitivity
//! peak and noise of the voltage, is the same in each arm: what differs is the error at equal
//! robustness. Techniques that feed a model's estimate back change the loop and are not tried here;
//! `frictionlab run compensation` compares them.

use controller::design::LinearDrive;
use rig_setup::REST;
use serde::{Deserialize, Serialize};

use crate::axis::{Axis, Bench, Known};
use crate::bed::{Arm, Bed, refined, seconds};
use crate::drive::Drive;
use crate::friction::Friction;
use crate::loop_design::{LoopDesign, QUICK, design, design_below};
use crate::model::Chosen;
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
    /// Error up to which the integral stands still while the reference does \[rad\].
    pub resting_angle: f64,
    /// Whether the shaft rests after a move.
    pub rests: bool,
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
    (known, drive): (&Known, &Drive),
    (friction, chosen): (&Friction, &Chosen),
    later: f64,
) -> Result<Control, CommissionError> {
    let refined = refined(known, drive, chosen);
    let design = design(&refined, QUICK, Stage::Control)?;
    let bed = Bed::of(known, drive, (friction, chosen), design)?;
    let arms = <Arm as strum::VariantArray>::VARIANTS;
    let mut errors: Vec<(Arm, Vec<f64>)> = arms.iter().map(|arm| (*arm, Vec::new())).collect();
    let bench = axis.bench()?;
    for _ in 0..TIMES {
        for (arm, errors) in &mut errors {
            axis.say(Stage::Control, &format!("{arm}"));
            errors.push(bed.try_out(axis, &bench, Stage::Control, *arm)?);
        }
    }
    let arm = choose(&errors);
    let (bed, rests) = at_rest(axis, &bench, bed, arm, later)?;
    let (design, resting_angle) = (*bed.design(), bed.resting_angle());
    let LinearDrive { gain, time_constant } = refined.drive;
    Ok(Control { design, drive: (gain, time_constant), errors, arm, resting_angle, rests })
}

/// The loop with which the shaft rests after a move either way, and whether it does. What a shaft
/// slips by is what its integral has to leave alone; what still hunts then, as in backlash, takes a
/// slower loop.
fn at_rest(
    axis: &mut Axis<'_>,
    bench: &Bench,
    mut bed: Bed,
    arm: Arm,
    later: f64,
) -> Result<(Bed, bool), CommissionError> {
    let (mut rested, mut forward) = (0, true);
    for attempt in 1..=HOLDS {
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
            let arms = <Arm as strum::VariantArray>::VARIANTS.iter().copied();
            choose(&arms.zip(errors.map(Vec::from)).collect::<Vec<_>>())
        };
        assert_eq!(of([[1.0, 1.1], [0.99, 1.0], [0.98, 1.0]]), Arm::Linear);
        assert_eq!(of([[1.0, 1.1], [0.5, 0.6], [0.58, 0.59]]), Arm::Reference);
        assert_eq!(of([[1.0, 1.1], [0.5, 0.6], [0.1, 0.2]]), Arm::Friction);
    }
}
