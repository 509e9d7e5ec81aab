//! Proof: the linear gains alone against what is handed over, in alternating blocks.

use serde::{Deserialize, Serialize};

use crate::axis::Axis;
use crate::bed::{Arm, Bed, seconds};
use crate::margin::{DriftMargin, drift_margin};
use crate::{CommissionError, Ranged, Stage};

/// Pairs of blocks.
const PAIRS: usize = 5;
/// Pairs that do where a warm motor took the time for more.
const FEWEST: usize = 3;
/// Time that a pause may take \[s\].
const SPARE: f64 = 5.0;

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Proof {
    /// What was held against the linear gains.
    pub arm: Arm,
    /// Root mean square errors of each pair, before and after \[rad\].
    pub pairs: Vec<(f64, f64)>,
    /// After over before with its paired 95 % interval; none where nothing was added.
    pub ratio: Option<Ranged>,
    /// How far what was identified may drift before it hunts, in simulation.
    #[serde(default)]
    pub drift: Option<DriftMargin>,
}

/// Rig time of the stage \[s\].
#[must_use]
pub fn seconds_needed() -> f64 {
    (2 * PAIRS) as f64 * seconds()
}

/// Does the stage. Where the linear gains won there is nothing to hold against them.
///
/// # Errors
/// [`CommissionError`] if the rig refuses or the time is up.
pub fn proof(axis: &mut Axis<'_>, bed: &Bed, arm: Arm) -> Result<Proof, CommissionError> {
    let drift = Some(drift_margin(bed, arm)?);
    if arm == Arm::Linear {
        return Ok(Proof { arm, pairs: Vec::new(), ratio: None, drift });
    }
    let bench = axis.bench()?;
    let mut pairs = Vec::new();
    for pair in 0..PAIRS {
        if pair >= FEWEST && axis.left() < 2.0 * seconds() + SPARE {
            break;
        }
        axis.say(Stage::Proof, &format!("before and after, pair {} of {PAIRS}", pair + 1));
        let mut run = |arm| bed.try_out(axis, &bench, Stage::Proof, arm);
        // What drifts meets both: the order changes from pair to pair.
        pairs.push(if pair % 2 == 0 {
            let before = run(Arm::Linear)?;
            (before, run(arm)?)
        } else {
            let after = run(arm)?;
            (run(Arm::Linear)?, after)
        });
    }
    let ratio = ratio(&pairs);
    Ok(Proof { arm, pairs, ratio, drift })
}

/// The ratio of the errors by the mean of its logarithm over the pairs.
fn ratio(pairs: &[(f64, f64)]) -> Option<Ranged> {
    let logs: Vec<f64> = pairs.iter().map(|(before, after)| (after / before).ln()).collect();
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
}
