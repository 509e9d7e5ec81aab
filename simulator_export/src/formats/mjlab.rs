//! mjlab: an actuator's configuration in Python.
//!
//! From 1.5 on LuGre is a `BuiltinDcMotorActuatorCfg` whose motor gives nothing; before, and for
//! friction without pre-sliding, any actuator takes `frictionloss` and `viscous_damping`.

use super::{Drive, identifier, keyword, tuple};
use crate::contact::Contact;
use crate::head::Comments;

pub(super) fn render(drive: &Drive<'_>) -> String {
    let joint = drive.options.joint.as_str();
    let name = identifier(joint).to_uppercase();
    let armature = keyword("armature", drive.options.armature);
    let mut head = drive.head.clone();
    let body = match drive.contact {
        Contact::LuGre(p) => {
            head.push(format!(
                "Put {name}_FRICTION into `actuators` of EntityArticulationInfoCfg; set frictionloss and damping of the joint to 0."
            ));
            let lugre = tuple(&[p.sigma0, p.sigma1, p.f_c, p.f_s, p.v_s]);
            let cogging = drive.options.cogging.map_or_else(String::new, |c| {
                format!("    cogging={},\n", tuple(&[c.amplitude, c.periods, c.phase]))
            });
            format!(
                "from mjlab.actuator.builtin_actuator import (\n    BuiltinDcMotorActuatorCfg,\n    DcMotorInputMode,\n    DcMotorPhysicalParams,\n)\n\n{name}_FRICTION = BuiltinDcMotorActuatorCfg(\n    target_names_expr=(\"{joint}\",),\n    motor_params=DcMotorPhysicalParams(kt=1e-9, ke=1e-9, resistance=1.0),\n    mode=DcMotorInputMode.VOLTAGE,\n    # sigma0, sigma1, F_c, F_s, v_s\n    lugre={lugre},\n    frictionloss=0.0,\n{}{armature}{cogging})\n",
                keyword("viscous_damping", Some(p.f_v)),
            )
        }
        other => {
            let (f_c, f_v) = super::coulomb_viscous(other);
            head.push(format!(
                "Use: BuiltinPositionActuatorCfg(target_names_expr=(\"{joint}\",), ..., **{name}_FRICTION), or any other actuator's."
            ));
            format!(
                "{name}_FRICTION = dict(\n{}{}{armature})\n",
                keyword("frictionloss", Some(f_c)),
                keyword("viscous_damping", Some(f_v)),
            )
        }
    };
    format!("{}\n{body}", Comments::Hash.around(&head))
}
