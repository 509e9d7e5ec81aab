//! Names, units and remedies of the parameters.

use super::AxisStructure;
use super::shape::ShapeTerm;
use crate::estimate::Unknown;

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
const SPEEDS: &str = "a motion at several constant speeds in both directions";
const SLOW: &str =
    "slow motion: steady speeds below and around the dip, down to where the axis sticks";
const REVERSALS: &str = "small oscillations about a point, with a position sensor that resolves the first part of each reversal";
const STEPS: &str = "reversals and steps of the force, sampled faster";
const TRAVEL: &str = "motion over the whole axis at several speeds";

/// The parameters of a structure: linear ones in the order of the columns, then the nonlinear ones.
pub(super) fn unknowns(structure: &AxisStructure, units: &AxisUnits) -> Vec<Unknown> {
    let mut all = Vec::new();
    let mut add =
        |name: &str, unit, remedy| all.push(Unknown { name: name.to_owned(), unit, remedy });
    let sides: &[&str] = if structure.asymmetric { &[".forward", ".backward"] } else { &[""] };
    add("inertia", units.inertia, FASTER);
    sides.iter().for_each(|side| add(&format!("f_v{side}"), units.viscous, SPEEDS));
    if !structure.asymmetric {
        add("offset", units.force, "equal motion in both directions");
    }
    if structure.position {
        add("spring", units.force, TRAVEL);
    }
    sides.iter().for_each(|side| add(&format!("f_c{side}"), units.force, SPEEDS));
    if structure.stribeck {
        sides.iter().for_each(|side| add(&format!("f_s{side}"), units.force, SLOW));
    }
    if structure.position {
        add("f_c_slope", units.force, TRAVEL);
        add("f_c_curvature", units.force, TRAVEL);
    }
    if structure.harmonic {
        add("harmonic_cos", units.force, TRAVEL);
        add("harmonic_sin", units.force, TRAVEL);
    }
    for term in ShapeTerm::of(structure) {
        match term {
            ShapeTerm::Delay => add("delay", "s", STEPS),
            ShapeTerm::StribeckVelocity => add("v_s", units.velocity, SLOW),
            ShapeTerm::Displacement => add("presliding", units.displacement, REVERSALS),
            ShapeTerm::Period => add("period", units.displacement, TRAVEL),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_structure_names_as_many_parameters_as_it_counts() {
        for structure in AxisStructure::candidates() {
            assert_eq!(
                unknowns(&structure, &AxisUnits::LINEAR).len(),
                structure.parameters(),
                "{structure}"
            );
        }
    }
}
