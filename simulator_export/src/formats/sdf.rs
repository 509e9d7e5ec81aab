//! SDFormat: the element `dynamics` of a joint's axis.

use super::{Drive, coulomb_viscous, number};
use crate::head::Comments;

pub(super) fn render(drive: &Drive<'_>) -> String {
    let (f_c, f_v) = coulomb_viscous(drive.contact);
    let mut head = drive.head.clone();
    let joint = &drive.options.joint;
    head.push(format!("Put this element into <joint name=\"{joint}\"> <axis>."));
    format!(
        "{}<dynamics>\n  <damping>{}</damping>\n  <friction>{}</friction>\n</dynamics>\n",
        Comments::Xml.around(&head),
        number(f_v),
        number(f_c),
    )
}
