//! MuJoCo: a file for `<include file="..."/>`, which acts on the joint of that name.
//!
//! From 3.7 on LuGre is an actuator `dcmotor` without a motor: a motor constant that gives nothing
//! and a resistance above zero. Before 3.12 it has an input that must stay at zero; from 3.12 on it
//! has none; before 4.0 the motor constant must be above zero. Viscous friction is the actuator's
//! `damping`. Before 3.7, and for friction without pre-sliding, a default class has the joint's
//! `frictionloss` and `damping`.

use super::{Drive, attribute, number};
use crate::Version;
use crate::contact::Contact;
use crate::given::Cogging;
use crate::head::Comments;

/// The first version whose `dcmotor` can do without an input.
const WITHOUT_INPUT: Version = Version::new(3, 12);
/// The first version whose `dcmotor` can do without a motor constant.
const WITHOUT_CONSTANT: Version = Version::new(4, 0);

pub(super) fn render(drive: &Drive<'_>) -> String {
    let joint = drive.options.joint.as_str();
    let mut head = drive.head.clone();
    let body = match drive.contact {
        Contact::LuGre(p) => {
            head.push(format!(
                "Use: <include file=\"THIS FILE\"/> in a model with a joint `{joint}` that has no frictionloss and no damping of its own."
            ));
            head.push(
                "Use small steps (1e-4 to 1e-3 s) and the integrator implicitfast.".to_owned(),
            );
            let input = if drive.version >= WITHOUT_INPUT { " input=\"none\"" } else { "" };
            let constant = if drive.version >= WITHOUT_CONSTANT { "0" } else { "1e-9" };
            let lugre = [p.sigma0, p.sigma1, p.f_c, p.f_s, p.v_s].map(number).join(" ");
            let cogging = drive.options.cogging.map_or_else(String::new, cogging);
            format!(
                "  <actuator>\n    <dcmotor name=\"{joint}_friction\" joint=\"{joint}\"{input} motorconst=\"{constant}\" resistance=\"1\"\n             lugre=\"{lugre}\"{}{}{cogging}/>\n  </actuator>\n",
                attribute("damping", Some(p.f_v)),
                attribute("armature", drive.options.armature),
            )
        }
        Contact::CoulombViscous { f_c, f_v } => {
            head.push(format!(
                "Use: <include file=\"THIS FILE\"/> and class=\"{joint}_friction\" in the joint `{joint}`."
            ));
            let cogging = drive.options.cogging;
            if cogging.is_some() {
                head.push("Cogging is left out: a joint has no place for it.".to_owned());
            }
            format!(
                "  <default>\n    <default class=\"{joint}_friction\">\n      <joint{}{}{}/>\n    </default>\n  </default>\n",
                attribute("frictionloss", Some(f_c)),
                attribute("damping", Some(f_v)),
                attribute("armature", drive.options.armature),
            )
        }
        // No release of it holds any other.
        _ => String::new(),
    };
    format!("{}<mujocoinclude>\n{body}</mujocoinclude>\n", Comments::Xml.around(&head))
}

fn cogging(cogging: Cogging) -> String {
    let Cogging { amplitude, periods, phase } = cogging;
    format!(" cogging=\"{}\"", [amplitude, periods, phase].map(number).join(" "))
}
