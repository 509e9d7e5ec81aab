//! Isaac Lab: fields of an actuator's configuration in Python.

use super::{Drive, identifier, keyword, static_dynamic_viscous};
use crate::head::Comments;

pub(super) fn render(drive: &Drive<'_>) -> String {
    let joint = drive.options.joint.as_str();
    let name = identifier(joint).to_uppercase();
    let (f_s, f_d, f_v) = static_dynamic_viscous(drive.contact);
    let mut head = drive.head.clone();
    head.push(format!(
        "Use: ImplicitActuatorCfg(joint_names_expr=[\"{joint}\"], ..., **{name}_FRICTION), or any other actuator's."
    ));
    format!(
        "{}\n{name}_FRICTION = dict(\n{}{}{}{})\n",
        Comments::Hash.around(&head),
        keyword("friction", Some(f_s)),
        keyword("dynamic_friction", Some(f_d)),
        keyword("viscous_friction", Some(f_v)),
        keyword("armature", drive.options.armature),
    )
}
