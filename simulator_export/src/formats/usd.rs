//! USD: a layer over a joint, with the attributes of PhysX or of Newton.
//!
//! USD measures angles in degrees: viscous coefficients of a joint that turns are told for a degree
//! a second, and both engines turn them back.

use super::{Drive, coulomb_viscous, number, static_dynamic_viscous};
use crate::Axis;
use crate::head::Comments;

/// A layer for PhysX.
pub(super) fn physx(drive: &Drive<'_>) -> String {
    let (f_s, f_d, f_v) = static_dynamic_viscous(drive.contact);
    let instance = match drive.given.axis {
        Axis::Rotary => "angular",
        Axis::Linear => "linear",
    };
    let name = |attribute: &str| format!("physxJointAxis:{instance}:{attribute}");
    let values = [
        (name("staticFrictionEffort"), Some(f_s)),
        (name("dynamicFrictionEffort"), Some(f_d)),
        (name("viscousFrictionCoefficient"), Some(a_degree(drive, f_v))),
        (name("armature"), drive.options.armature),
    ];
    layer(drive, &format!("PhysxJointAxisAPI:{instance}"), &values)
}

/// A layer for Newton.
pub(super) fn newton(drive: &Drive<'_>) -> String {
    let (f_c, f_v) = coulomb_viscous(drive.contact);
    let values = [
        ("newton:friction".to_owned(), Some(f_c)),
        ("newton:damping".to_owned(), Some(a_degree(drive, f_v))),
        ("newton:armature".to_owned(), drive.options.armature),
    ];
    layer(drive, "NewtonJointAPI", &values)
}

/// A viscous coefficient as USD has it.
fn a_degree(drive: &Drive<'_>, f_v: f64) -> f64 {
    match drive.given.axis {
        Axis::Rotary => f_v.to_radians(),
        Axis::Linear => f_v,
    }
}

fn layer(drive: &Drive<'_>, schema: &str, values: &[(String, Option<f64>)]) -> String {
    let joint = super::identifier(&drive.options.joint);
    let mut head = drive.head.clone();
    head.push(format!("Put what stands in `{joint}` over the joint `{}`.", drive.options.joint));
    if drive.given.axis == Axis::Rotary {
        head.push("The viscous coefficient is in N m s/degree, as USD has it.".to_owned());
    }
    let lines: String = values
        .iter()
        .filter_map(|(name, value)| Some(format!("    float {name} = {}\n", number((*value)?))))
        .collect();
    format!(
        "#usda 1.0\n{}\nover \"{joint}\" (\n    prepend apiSchemas = [\"{schema}\"]\n)\n{{\n{lines}}}\n",
        Comments::Hash.around(&head)
    )
}
