//! Forces along the axis that look alike over a short travel.
//!
//! Over less than about a radian `sin q`, `cos q`, a spring and a constant force differ from one another
//! by little. Fitted together they may each be many times what acts, and cancel. Their errors count
//! noise, which many samples average out. What the structure lacks they do not average out.

use nalgebra::{DMatrix, DVector};

use super::AxisStructure;
use super::shape::PositionScale;
use crate::conditioning::Conditioned;
use crate::estimate::Estimates;

/// Positions that are looked at, at most.
const MOST: usize = 2000;
/// The forces, in the order of their columns.
const FORCES: [&str; 4] = ["gravity_sin", "gravity_cos", "spring", "offset"];

/// Distrusts each of those forces of which less is its own, told apart from the others, than the fit
/// leaves of the force: `left`, a root mean square \[N or N m\].
pub(super) fn judge(
    recording: &Conditioned,
    structure: &AxisStructure,
    scale: PositionScale,
    left: f64,
    estimates: &mut Estimates,
) {
    if !(structure.position && structure.gravity) {
        return;
    }
    let own = own_parts(recording.position.as_deref().unwrap_or_default(), scale);
    let alike = |(name, own): &(&'static str, f64)| {
        estimates.value(*name).is_some_and(|value| value.abs() * own < left)
    };
    let names: Vec<&str> =
        FORCES.into_iter().zip(own).filter(alike).map(|(name, _)| name).collect();
    let why = "over this travel a weight, a spring and a constant force look alike";
    let remedy = "more of the travel: a weight is told from a spring over a good part of a turn";
    estimates.distrust_but(|id| !names.contains(&id.name), why, remedy);
}

/// Root mean square of what each column has that the others have not.
fn own_parts(position: &[f64], scale: PositionScale) -> [f64; 4] {
    let stride = position.len().div_ceil(MOST).max(1);
    let some: Vec<f64> = position.iter().copied().step_by(stride).collect();
    let all = DMatrix::from_fn(some.len(), FORCES.len(), |row, column| match column {
        0 => some[row].sin(),
        1 => some[row].cos(),
        2 => scale.normalised(some[row]),
        _ => 1.0,
    });
    std::array::from_fn(|column| {
        let others = all.clone().remove_column(column);
        let own: DVector<f64> = all.column(column).into_owned();
        let Some(share) = others.clone().svd(true, true).solve(&own, 1e-12).ok() else {
            return 0.0;
        };
        (own - others * share).norm() / (some.len().max(1) as f64).sqrt()
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::damped_bristle;
    use super::*;
    use crate::estimate::{Estimate, Verdict};

    /// A stranger's axis over 0.77 rad: a ripple of 0.07 N m was made of a weight of 1 N m that a spring
    /// and a constant force took away again, all identified.
    #[test]
    fn over_a_short_travel_a_weight_and_a_spring_are_not_told_apart() {
        let structure = "symmetric+position+gravity".parse().unwrap();
        let known = |travel: f64, structure: &AxisStructure| {
            let place = |k: i32| 0.8 + 0.5 * travel * (0.1 * f64::from(k)).sin();
            let position = (0..999).map(place).collect();
            let recording = Conditioned { position: Some(position), ..damped_bristle() };
            let one = |name: &'static str| Estimate {
                verdict: Verdict::Identified,
                ..Estimate::given(name, "", 0.66, "")
            };
            let parameters = [&FORCES[..], &["f_c"]].concat().into_iter().map(one).collect();
            let mut estimates = Estimates { parameters, ..Estimates::default() };
            let scale = PositionScale::of(&recording);
            judge(&recording, structure, scale, 0.01, &mut estimates);
            assert!(estimates.get("f_c").unwrap().is_identified());
            FORCES.map(|name| estimates.get(name).unwrap().is_identified())
        };
        // Of the constant force the cosine leaves a hundredth.
        assert_eq!(known(0.77, &structure), [false, false, false, true]);
        assert_eq!(known(0.4, &structure), [false; 4]);
        assert_eq!(known(6.0, &structure), [true; 4]);
        assert_eq!(known(0.77, &"symmetric+gravity".parse().unwrap()), [true; 4]);
    }
}
