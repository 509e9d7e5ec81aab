//! URDF: the element `dynamics` of a joint.

use super::{Drive, attribute, coulomb_viscous};
use crate::head::Comments;

pub(super) fn render(drive: &Drive<'_>) -> String {
    let (f_c, f_v) = coulomb_viscous(drive.contact);
    let mut head = drive.head.clone();
    head.push(format!("Put this element into <joint name=\"{}\">.", drive.options.joint));
    format!(
        "{}<dynamics{}{}/>\n",
        Comments::Xml.around(&head),
        attribute("damping", Some(f_v)),
        attribute("friction", Some(f_c)),
    )
}
