//! What another fit says of the parameters of a structure.

use super::cross_validation::ENOUGH;
use super::naming::{AxisUnits, unknowns};
use super::search::{Best, Search};
use super::shape::{PositionScale, ShapeTerm};
use super::{AxisStructure, CrossValidation};
use crate::conditioning::Conditioned;
use crate::parameter_id::{ParameterId, Side};

/// The parameters of another fit.
pub(super) struct Said {
    pub structure: AxisStructure,
    pub values: Vec<(ParameterId, f64)>,
}

impl Said {
    /// Those of a structure that was cross-validated on a recording: its search ended there, as near
    /// as it has to be, and goes on only where this is another one.
    pub fn of(
        recording: &Conditioned,
        rival: &CrossValidation,
        scale: PositionScale,
    ) -> Option<Self> {
        let structure = rival.structure;
        let mut search = Search::resumed(recording, structure, scale, &rival.shape).ok()?;
        let Best { solution, shape } = search.closer(rival.shape, &[], ENOUGH).ok()?;
        let nonlinear = ShapeTerm::of(&structure).into_iter().map(|term| term.value(&shape));
        let values = solution.x.iter().copied().chain(nonlinear);
        let ids = unknowns(&structure, &AxisUnits::LINEAR).into_iter().map(|unknown| unknown.id);
        Some(Self { structure, values: ids.zip(values).collect() })
    }

    fn get(&self, id: ParameterId) -> Option<f64> {
        self.values.iter().find(|(own, _)| *own == id).map(|(_, value)| *value)
    }

    /// What it says of a parameter of a structure `of`; none where it has nothing of that meaning.
    pub fn value(&self, id: ParameterId, of: AxisStructure) -> Option<f64> {
        let name = id.name;
        // At the middle of the travel, or on average; and parts of a wave only together.
        let level = ["f_c", "f_s", "offset"].contains(&name);
        if level && self.structure.position != of.position {
            return None;
        }
        if ["harmonic_cos", "harmonic_sin", "period"].contains(&name) {
            return None;
        }
        if self.structure.asymmetric == of.asymmetric {
            return self.get(id);
        }
        let side = |name: &'static str, side: Side| self.get(ParameterId::new(name).side(side));
        let both = |name: &'static str| side(name, Side::Forward).zip(side(name, Side::Backward));
        match (name, id.side) {
            // A constant force pushes with friction one way and against it the other.
            ("offset", _) => both("f_c").map(|(forward, backward)| 0.5 * (forward - backward)),
            (_, Side::Both) => {
                self.get(id).or_else(|| both(name).map(|(forward, back)| 0.5 * (forward + back)))
            }
            ("f_c" | "f_s", Side::Forward) => {
                Some(self.get(name.into())? + self.get("offset".into())?)
            }
            ("f_c" | "f_s", Side::Backward) => {
                Some(self.get(name.into())? - self.get("offset".into())?)
            }
            _ => self.get(name.into()),
        }
    }
}
