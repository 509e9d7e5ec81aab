//! How far a bristle may bend where its damping is not fitted.
//!
//! A structure without damping is chosen where a damping does not help to predict. That is no sign
//! that there is none: what happens around a reversal may be a stiff bristle that is damped or a
//! softer one that is not, and the displacement is only known as far as the damping is.

use super::AxisStructure;
use super::fit::{StructureFit, errors};
use super::naming::AxisUnits;
use super::search::Search;
use super::shape::ShapeTerm;
use crate::conditioning::Conditioned;
use crate::estimate::{Interval, IntervalMethod};

impl StructureFit {
    /// The interval of the displacement beside a damping; none where the structure has no bristle, or
    /// one whose damping it fits, or where the recording does not say how it is damped at all.
    pub(super) fn displacement_beside_damping(&self, recording: &Conditioned) -> Option<Interval> {
        if !self.structure.presliding || self.structure.damping {
            return None;
        }
        let structure = AxisStructure { damping: true, ..self.structure };
        let mut search = Search::new(recording, structure, self.position_scale).ok()?;
        // The period of a wave and the breadth of a dip hardly hang on what happens within a reversal.
        let kept = [ShapeTerm::Period, ShapeTerm::StribeckVelocity];
        let best = search.from(self.shape, &kept).ok()?;
        let beside = errors(&mut search, &best, &AxisUnits::LINEAR).ok()?;
        // Its logarithm is what is searched, and what the sum of squares is nearly straight in.
        let beside = beside.estimates.get("presliding")?;
        let share = (beside.interval?.high - beside.value) / beside.value;
        let [low, high] = [-share, share].map(|by| beside.value * by.exp());
        Some(Interval { low, high, method: IntervalMethod::Rivals })
    }
}

#[cfg(test)]
mod tests {
    use super::super::fit_structure;
    use super::super::tests::{DAMPED, damped_bristle};
    use super::*;

    /// The displacement of a bristle that is damped was told with a narrow interval beside the true
    /// one where the structure has no damping.
    #[test]
    fn a_displacement_is_as_unsure_as_the_damping_that_is_left_out() {
        let recording = damped_bristle();
        let structure = "symmetric+presliding".parse().unwrap();
        let mut fit = fit_structure(&recording, structure, &AxisUnits::LINEAR).unwrap();
        let holds = |fit: &StructureFit| {
            fit.estimates.get("presliding").unwrap().interval.unwrap().contains(DAMPED[0])
        };
        assert!(!holds(&fit));
        fit.heed(&recording, &[]);
        assert!(holds(&fit), "{:?}", fit.estimates.get("presliding"));
        let damped = "symmetric+damping".parse().unwrap();
        let damped = fit_structure(&recording, damped, &AxisUnits::LINEAR).unwrap();
        assert_eq!(damped.displacement_beside_damping(&recording), None);
    }
}
