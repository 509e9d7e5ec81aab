//! Names, units and remedies of the parameters.

use super::AxisStructure;
use super::shape::ShapeTerm;
use crate::estimate::Unknown;
use crate::parameter_id::{ParameterId, Side};

/// Units of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AxisUnits {
    /// Of a force or torque.
    pub force: &'static str,
    /// Of an inertia.
    pub inertia: &'static str,
    /// Of a velocity.
    pub velocity: &'static str,
    /// Of viscous friction.
    pub viscous: &'static str,
    /// Of a displacement.
    pub displacement: &'static str,
}

impl AxisUnits {
    /// Metres, newtons, kilograms.
    pub const LINEAR: Self =
        Self { force: "N", inertia: "kg", velocity: "m/s", viscous: "N s/m", displacement: "m" };
    /// Radians, newton metres, kilogram square metres.
    pub const ROTARY: Self = Self {
        force: "N m",
        inertia: "kg m^2",
        velocity: "rad/s",
        viscous: "N m s/rad",
        displacement: "rad",
    };
}

const FASTER: &str = "a motion with more and stronger acceleration";
/// What tells the parts of friction at steady speeds.
pub(super) const SPEEDS: &str = "a motion at several constant speeds in both directions";
/// What shows a dip.
pub(super) const SLOW: &str =
    "slow motion: steady speeds below and around the dip, down to where the axis sticks";
const REVERSALS: &str = "small oscillations about a point, with a position sensor that resolves the first part of each reversal";
const STEPS: &str = "reversals and steps of the force, sampled faster";
const TURNS: &str = "motion over more of a turn at several speeds";
const TRAVEL: &str = "motion over the whole axis at several speeds";

/// The parameters of a structure: linear ones in the order of the columns, then the nonlinear ones.
pub(super) fn unknowns(structure: &AxisStructure, units: &AxisUnits) -> Vec<Unknown> {
    let mut all = Vec::new();
    let mut add = |id: ParameterId, unit, remedy| all.push(Unknown { id, unit, remedy });
    let sides = Side::of(structure.asymmetric);
    let each = |name| sides.iter().map(move |&side| ParameterId::new(name).side(side));
    add("inertia".into(), units.inertia, FASTER);
    each("f_v").for_each(|id| add(id, units.viscous, SPEEDS));
    if !structure.asymmetric {
        add("offset".into(), units.force, "equal motion in both directions");
    }
    if structure.position {
        add("spring".into(), units.force, TRAVEL);
    }
    if structure.gravity {
        add("gravity_sin".into(), units.force, TURNS);
        add("gravity_cos".into(), units.force, TURNS);
    }
    each("f_c").for_each(|id| add(id, units.force, SPEEDS));
    if structure.stribeck {
        each("f_s").for_each(|id| add(id, units.force, SLOW));
    }
    if structure.position {
        add("f_c_slope".into(), units.force, TRAVEL);
        add("f_c_curvature".into(), units.force, TRAVEL);
    }
    if structure.damping {
        add("sigma1".into(), units.viscous, REVERSALS);
    }
    if structure.harmonic {
        add("harmonic_cos".into(), units.force, TRAVEL);
        add("harmonic_sin".into(), units.force, TRAVEL);
    }
    for term in ShapeTerm::of(structure) {
        match term {
            ShapeTerm::Delay => add("delay".into(), "s", STEPS),
            ShapeTerm::StribeckVelocity => add("v_s".into(), units.velocity, SLOW),
            ShapeTerm::Displacement => add("presliding".into(), units.displacement, REVERSALS),
            ShapeTerm::Period => add("period".into(), units.displacement, TRAVEL),
            ShapeTerm::Ratio => {}
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_structure_names_as_many_parameters_as_it_counts() {
        for structure in AxisStructure::all() {
            assert_eq!(
                unknowns(&structure, &AxisUnits::LINEAR).len(),
                structure.parameters(),
                "{structure}"
            );
        }
    }
}
