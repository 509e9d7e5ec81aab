//! Forces along the axis that look alike over a short travel.
//!
//! Over less than about a radian `sin q`, `cos q`, a spring and a constant force differ from one another
//! by little. Fitted together they may each be many times what acts, and cancel. Their errors count
//! noise, which many samples average out. What the structure lacks they do not average out.

use nalgebra::{DMatrix, DVector};

use super::AxisStructure;
use super::naming::AxisUnits;
use super::shape::PositionScale;
use crate::conditioning::Conditioned;
use crate::estimate::Estimates;

/// Positions that are looked at, at most.
const MOST: usize = 2000;
/// The forces, in the order of their columns.
const FORCES: [&str; 4] = ["gravity_sin", "gravity_cos", "spring", "offset"];

/// Distrusts each of those forces of which less is its own, told apart from the others, than the fit
/// leaves of the force: `left`, a root mean square \[N or N m\]. Of a structure with a weight or a spring
/// alone it is asked whether the other one would do: both and the constant force are distrusted
/// where what it could not take up is less than that.
pub(super) fn judge(
    recording: &Conditioned,
    structure: &AxisStructure,
    units: &AxisUnits,
    scale: PositionScale,
    left: f64,
    estimates: &mut Estimates,
) {
    let place = Place::of(recording.position.as_deref().unwrap_or_default(), scale);
    let value = |name: &'static str| estimates.value(name).unwrap_or(0.0);
    let names: Vec<&str> = match (structure.position, structure.gravity) {
        (true, true) => {
            let alike = |(name, own): &(&'static str, f64)| (value(name) * own).abs() < left;
            let own = [0, 1, 2, 3].map(|column| place.own_part(column));
            FORCES.into_iter().zip(own).filter(alike).map(|(name, _)| name).collect()
        }
        (false, true) => {
            let weight =
                |row: &[f64; 4]| value("gravity_sin") * row[0] + value("gravity_cos") * row[1];
            let taken_up = place.left_of(weight, &[2, 3]) < left;
            FORCES.into_iter().filter(|_| taken_up).collect()
        }
        (true, false) if *units == AxisUnits::ROTARY => {
            let taken_up = place.left_of(|row| value("spring") * row[2], &[0, 1, 3]) < left;
            FORCES.into_iter().filter(|_| taken_up).collect()
        }
        _ => return,
    };
    let why = "over this travel a weight, a spring and a constant force look alike";
    let remedy = "more of the travel: a weight is told from a spring over a good part of a turn";
    estimates.distrust_but(|id| !names.contains(&id.name), why, remedy);
}

/// The forces along the positions of a recording, each of size 1.
struct Place {
    rows: Vec<[f64; 4]>,
}

impl Place {
    fn of(position: &[f64], scale: PositionScale) -> Self {
        let stride = position.len().div_ceil(MOST).max(1);
        let row = |&x: &f64| [x.sin(), x.cos(), scale.normalised(x), 1.0];
        Self { rows: position.iter().step_by(stride).map(row).collect() }
    }

    /// Root mean square of what a column has that the others have not.
    fn own_part(&self, column: usize) -> f64 {
        let others: Vec<usize> = (0..FORCES.len()).filter(|other| *other != column).collect();
        self.left_of(|row| row[column], &others)
    }

    /// Root mean square of what some columns leave of a force.
    fn left_of(&self, force: impl Fn(&[f64; 4]) -> f64, columns: &[usize]) -> f64 {
        let count = self.rows.len();
        let force = DVector::from_iterator(count, self.rows.iter().map(force));
        let columns =
            DMatrix::from_fn(count, columns.len(), |row, column| self.rows[row][columns[column]]);
        let Ok(share) = columns.clone().svd(true, true).solve(&force, 1e-12) else { return 0.0 };
        (force - columns * share).norm() / (count.max(1) as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::damped_bristle;
    use super::*;
    use crate::estimate::{Estimate, Verdict};

    /// A stranger's axis over 0.77 rad: a ripple of 0.07 N m was made of a weight of 1 N m that a spring
    /// and a constant force took away again, all identified. Two others had a spring that came out as a
    /// weight and a weight that came out as a spring.
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
            judge(&recording, structure, &AxisUnits::ROTARY, scale, 0.01, &mut estimates);
            assert!(estimates.get("f_c").unwrap().is_identified());
            FORCES.map(|name| estimates.get(name).unwrap().is_identified())
        };
        // Of the constant force the cosine leaves a hundredth.
        assert_eq!(known(0.77, &structure), [false, false, false, true]);
        assert_eq!(known(0.4, &structure), [false; 4]);
        assert_eq!(known(6.0, &structure), [true; 4]);
        // A weight that a spring would do for, and the other way round.
        for alone in ["symmetric+gravity", "symmetric+position"] {
            let alone = alone.parse().unwrap();
            assert_eq!(known(0.4, &alone), [false; 4]);
            assert_eq!(known(6.0, &alone), [true; 4]);
        }
        assert_eq!(known(0.77, &"symmetric".parse().unwrap()), [true; 4]);
    }
}
