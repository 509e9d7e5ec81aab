//! What a recording says of inertia and friction where viscous friction may be no straight line.
//!
//! Grease shears thinner as it is sheared faster, a harmonic drive and the air resist more than in
//! proportion. A structure takes a straight line, and what the line leaves goes into the levels: that
//! of sliding, and a dip that reaches over half of all speeds. Beside a further force that goes with
//! a power of the speed they come out where they are without that (RESET; Ramsey 1969, Journal of the
//! Royal Statistical Society B 31, 350, adds powers for the same reason). Where the recording says
//! clearly that there is such a force, the intervals must reach there.

use nalgebra::DMatrix;

use super::fit::StructureFit;
use super::naming::{AxisUnits, unknowns};
use super::said::Said;
use super::search::{Best, Search};
use super::shape::ShapeTerm;
use crate::conditioning::Conditioned;
use crate::robust_covariance::{Course, robust_covariance};

/// Powers of the speed: friction that rises less and less, and more and more.
const POWERS: [f64; 3] = [0.5, 2.0, 3.0];
/// Values of a Stribeck velocity that are tried: a broad dip may have been the curve.
const TRIED: usize = 9;
/// Errors that the further force must be clear of zero by.
const CLEAR: f64 = 3.0;
/// Share of the sum of squares that it must take off: less hardly moves the others.
const NOTICED: f64 = 0.05;

/// What the fit says beside the power of the speed that suits the recording best; none where that is
/// not clearly there.
pub(super) fn said(fit: &StructureFit, recording: &Conditioned) -> Option<Said> {
    let trials = POWERS.into_iter().filter_map(|power| begun(fit, recording, power));
    let sum = |best: &Best| best.solution.residual.norm_squared();
    let (mut search, start) = trials.min_by(|(_, a), (_, b)| sum(a).total_cmp(&sum(b)))?;
    let best = search.from(start.shape, &[]).unwrap_or(start);
    let column = search.regressors.of_power()?;
    let straight = fit.residual_rms.powi(2) * fit.samples as f64;
    if sum(&best) > (1.0 - NOTICED) * straight || !is_there(&mut search, &best, column) {
        return None;
    }
    let terms = ShapeTerm::of(&fit.structure);
    let linear = best.solution.x.iter().copied().enumerate();
    let linear = linear.filter(|(k, _)| *k != column).map(|(_, value)| value);
    let values = linear.chain(terms.into_iter().map(|term| term.value(&best.shape)));
    let ids = unknowns(&fit.structure, &AxisUnits::LINEAR).into_iter().map(|unknown| unknown.id);
    Some(Said { structure: fit.structure, values: ids.zip(values).collect() })
}

/// A search beside a power of the speed, and where it begins.
fn begun<'a>(
    fit: &StructureFit,
    recording: &'a Conditioned,
    power: f64,
) -> Option<(Search<'a>, Best)> {
    let (structure, scale) = (fit.structure, fit.position_scale);
    let mut search = Search::with_power(recording, structure, scale, Some(power)).ok()?;
    search.follows(&fit.shape);
    let dip = ShapeTerm::StribeckVelocity;
    let shape = match structure.stribeck {
        true => {
            let mut values = search.limits.grid(dip, TRIED);
            values.push(fit.shape.v_s);
            search.best_of(dip, values, fit.shape).ok()?
        }
        false => fit.shape,
    };
    let solution = search.solve(&shape).ok()?;
    Some((search, Best { shape, solution }))
}

/// Whether the linear parameter of that column is clear of zero.
fn is_there(search: &mut Search, best: &Best, column: usize) -> bool {
    let terms = search.moving(&[]);
    let Ok(minimum) = search.linearise(best, &terms) else { return false };
    let free: Vec<usize> = (0..minimum.x.len()).filter(|&j| !minimum.held[j]).collect();
    let Some(place) = free.iter().position(|&j| j == column) else { return false };
    let slopes: DMatrix<f64> = minimum.jacobian.select_columns(&free);
    let motion = search.regressors.motion(&best.shape);
    let course = Course { points: 0, pieces: &search.regressors.rows.pieces(), motion: &motion };
    let Some(found) = robust_covariance(&slopes, minimum.residuals.as_slice(), &course) else {
        return false;
    };
    let error = &found.parameters[place];
    error.doubt.is_none() && best.solution.x[column].abs() > CLEAR * error.standard_error
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::super::tests::three_tones;
    use super::super::{AxisUnits, StructureFit, fit_structure};
    use crate::estimate::Estimate;

    /// An axis whose viscous friction is 2 |v|^power, behind Coulomb friction of 1.5, fitted by a
    /// structure and beside what else could be.
    fn found(structure: &str, power: f64, seed: u64) -> StructureFit {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let recording = three_tones(30_000, |_, v, a| {
            let friction = (1.5 + 2.0 * v.abs().powf(power)).copysign(v);
            0.3 * a + friction + 0.05 * rng.sample::<f64, _>(StandardNormal)
        });
        let structure = structure.parse().unwrap();
        let mut fit = fit_structure(&recording, structure, &AxisUnits::ROTARY).unwrap();
        fit.heed(&recording, &[]);
        fit
    }

    /// Grease that shears thinner, and gears that resist more than in proportion: the Coulomb friction
    /// came out 40 % too high, or far too low beside a dip as broad as all speeds, with narrow
    /// intervals.
    #[test]
    fn friction_that_is_no_straight_line_leaves_no_levels() {
        for (structure, power) in [
            ("symmetric", 0.6),
            ("asymmetric", 0.6),
            ("symmetric+stribeck", 0.6),
            ("symmetric", 3.0),
            ("symmetric+stribeck", 3.0),
        ] {
            let fit = found(structure, power, 1);
            assert!(!fit.curved.is_empty(), "{structure} {power}");
            let wrong = |estimate: &&Estimate| {
                let truth = match estimate.id.name {
                    "inertia" => 0.3,
                    "f_c" | "f_s" => 1.5,
                    _ => return false,
                };
                let off = !estimate.interval.is_some_and(|interval| interval.contains(truth));
                estimate.is_identified() && off && (estimate.value / truth - 1.0).abs() > 0.02
            };
            let wrong: Vec<&Estimate> = fit.estimates.parameters.iter().filter(wrong).collect();
            assert!(wrong.is_empty(), "{structure} {power}: {wrong:?}");
        }
    }

    #[test]
    fn a_straight_line_is_left_as_it_is() {
        for seed in 0..4 {
            for structure in ["symmetric", "symmetric+stribeck", "asymmetric+delay"] {
                let fit = found(structure, 1.0, seed);
                assert!(fit.curved.is_empty(), "{structure} {seed}: {:?}", fit.curved);
            }
        }
    }
}
