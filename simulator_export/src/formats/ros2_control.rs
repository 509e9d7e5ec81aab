//! `ros2_control`: parameters of a joint in the robot's description.

use super::{Drive, number};
use crate::contact::Contact;
use crate::head::Comments;

pub(super) fn render(drive: &Drive<'_>) -> String {
    let joint = &drive.options.joint;
    let mut head = drive.head.clone();
    head.push("Put the element `joint` into <ros2_control>, beside its interfaces.".to_owned());
    let values = match drive.contact {
        Contact::Stribeck(p) => vec![
            ("friction_static", p.f_s),
            ("friction_coulomb", p.f_c),
            ("friction_stribeck_velocity", p.v_s),
            ("friction_stribeck_exponent", p.delta),
            ("friction_viscous", p.f_v),
        ],
        other => {
            let (f_c, f_v) = super::coulomb_viscous(other);
            vec![("friction_coulomb", f_c), ("friction_viscous", f_v)]
        }
    };
    let lines: String = values
        .iter()
        .map(|(name, value)| format!("  <param name=\"{name}\">{}</param>\n", number(*value)))
        .collect();
    format!("{}<joint name=\"{joint}\">\n{lines}</joint>\n", Comments::Xml.around(&head))
}
