//! Newton: a configuration in Python.
//!
//! From 1.8 on `newton.solvers.mujoco` has a DC motor with LuGre, whose control must stay at zero;
//! before, and for friction without pre-sliding, a `JointDofConfig` has `friction` and `damping`.

use super::{Drive, identifier, keyword, tuple};
use crate::contact::Contact;
use crate::head::Comments;

pub(super) fn render(drive: &Drive<'_>) -> String {
    let joint = drive.options.joint.as_str();
    let name = identifier(joint);
    let upper = name.to_uppercase();
    let armature = keyword("armature", drive.options.armature);
    let mut head = drive.head.clone();
    let body = match drive.contact {
        Contact::LuGre(p) => {
            head.push(format!(
                "Call add_{name}_friction(builder, joint) once the joint `{joint}` is there; give the joint no friction of its own."
            ));
            if !armature.is_empty() {
                head.push(format!(
                    "Give the joint {upper}_DOF: JointDofConfig(..., **{upper}_DOF)."
                ));
            }
            let lugre = tuple(&[p.sigma0, p.sigma1, p.f_c, p.f_s, p.v_s]);
            let cogging = drive.options.cogging.map_or_else(String::new, |c| {
                format!("        cogging={},\n", tuple(&[c.amplitude, c.periods, c.phase]))
            });
            let dof = if armature.is_empty() {
                String::new()
            } else {
                format!("\n\n{upper}_DOF = dict(\n{armature})\n")
            };
            format!(
                "from newton.solvers import mujoco\n\n\ndef add_{name}_friction(builder, joint):\n    return mujoco.add_actuator_dcmotor(\n        builder,\n        mujoco.ActuatorTarget.joint(joint),\n        motorconst=(1e-9,),\n        resistance=1.0,\n        # sigma0, sigma1, F_c, F_s, v_s\n        lugre={lugre},\n        damping={},\n{cogging}        input=\"voltage\",\n        ctrl=0.0,\n    )\n{dof}",
                tuple(&[p.f_v]).replace(')', ",)"),
            )
        }
        other => {
            let (f_c, f_v) = super::coulomb_viscous(other);
            head.push(format!("Use: newton.ModelBuilder.JointDofConfig(..., **{upper}_DOF)."));
            format!(
                "{upper}_DOF = dict(\n{}{}{armature})\n",
                keyword("friction", Some(f_c)),
                keyword("damping", Some(f_v)),
            )
        }
    };
    format!("{}\n{body}", Comments::Hash.around(&head))
}
