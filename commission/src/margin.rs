//! How far what was identified may drift before what was handed over hunts: in simulation, with the
//! identified friction as the plant.

use serde::{Deserialize, Serialize};

use crate::bed::{Arm, Bed};
use crate::identified::{Identified, Looped};
use crate::{CommissionError, hunting};

/// Factors of friction and of gain that are tried, from one away.
const LESS: [f64; 8] = [0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2];
const MORE: [f64; 7] = [1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0];
/// The part of a move and hold in which the shaft has to rest \[s\].
const HELD: (f64, f64) = (4.0, 12.0);

/// Factors up to which the shaft rests after a move; 1 where it does not rest at all, the last one
/// tried where none makes it hunt.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DriftMargin {
    /// Friction may fall to this share of what is compensated: less is over-compensation.
    pub friction_falls: f64,
    /// Friction may rise to this.
    pub friction_rises: f64,
    /// The gain of the drive may rise to this.
    pub gain_rises: f64,
}

/// That of the hand-over.
///
/// # Errors
/// [`CommissionError`] for settings that cannot be.
pub fn drift_margin(bed: &Bed, arm: Arm) -> Result<DriftMargin, CommissionError> {
    let identified = bed.identified();
    let last = |factors: &[f64], plant: &dyn Fn(f64) -> Identified| {
        let mut reached = 1.0;
        for &factor in factors {
            if !rests(bed, arm, &plant(factor))? {
                break;
            }
            reached = factor;
        }
        Ok::<f64, CommissionError>(reached)
    };
    Ok(DriftMargin {
        friction_falls: last(&LESS, &|factor| identified.scaled(factor, 1.0))?,
        friction_rises: last(&MORE, &|factor| identified.scaled(factor, 1.0))?,
        gain_rises: last(&MORE, &|factor| identified.scaled(1.0, factor))?,
    })
}

fn rests(bed: &Bed, arm: Arm, plant: &Identified) -> Result<bool, CommissionError> {
    let cycles = Looped::on(plant, &bed.simulated(arm), bed.smooth_move(true), HELD)?;
    let errors: Vec<f64> = cycles.iter().map(|cycle| cycle.error).collect();
    Ok(hunting::rests(&errors, bed.encoder_step()))
}
