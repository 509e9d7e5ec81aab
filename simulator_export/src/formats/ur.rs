//! Universal Robots: the scales of the arm's own friction model in direct torque control, as
//! `ur_msgs/FrictionModelParameters` has them.
//!
//! A scale of 1 is the friction of the arm's model, which [`Reference`](crate::Reference) tells; what
//! is beyond it cannot be set.

use super::{Drive, coulomb_viscous, number};
use crate::head::Comments;
use crate::{Refusal, Target};

pub(super) fn render(drive: &Drive<'_>) -> Result<String, Refusal> {
    let Some(reference) = drive.options.reference else {
        let what = "the friction that the arm's own model has at scale 1: give --reference COULOMB:VISCOUS [N m, N m s/rad]";
        return Err(Refusal::Needs { target: Target::Ur, what });
    };
    let (f_c, f_v) = coulomb_viscous(drive.contact);
    for (what, value) in
        [("the Coulomb scale", f_c / reference.f_c), ("the viscous scale", f_v / reference.f_v)]
    {
        if !(0.0..=1.0).contains(&value) {
            return Err(Refusal::Value {
                what,
                expected: "from 0 to 1: the arm's own model has at most as much friction as --reference says",
                value,
            });
        }
    }
    let mut head = drive.head.clone();
    head.push(format!(
        "Scales of the joint {}, of a reference with a Coulomb level of {} N m and {} N m s/rad.",
        drive.options.joint,
        number(reference.f_c),
        number(reference.f_v)
    ));
    head.push(
        "ur_msgs/FrictionModelParameters has one place for each of the six joints.".to_owned(),
    );
    Ok(format!(
        "{}viscous_scale: {}\ncoulomb_scale: {}\n",
        Comments::Hash.around(&head),
        number(f_v / reference.f_v),
        number(f_c / reference.f_c),
    ))
}
