//! What is said of a motion that has one speed.

use friction_ident::{AxisFit, AxisTerm};
use recording::AxisKind;
use report::numbers::significant;

pub(super) use friction_ident::one_speed::one_speed;

/// What such a motion does not tell, and what it does.
pub(super) fn said(speed: f64, symmetric: &AxisFit, axis: AxisKind) -> String {
    let value = |term| symmetric.term(term).map(|estimate| estimate.value);
    let friction = value(AxisTerm::Coulomb).zip(value(AxisTerm::Viscous));
    let there = friction.map_or(String::new(), |(coulomb, viscous)| {
        format!(
            ", {} {} by the symmetric model",
            significant(coulomb + viscous * speed, 3),
            axis.force_unit()
        )
    });
    format!(
        "The motion has one speed, {} {}, and its turns: how friction changes with speed, and the inertia, hang on the turns \
         alone, where all acts at once, and their numbers are not to be trusted. What the recording tells is the friction at that \
         speed{there}, and what goes with the position. Record other speeds as well.",
        significant(speed, 3),
        axis.velocity_unit()
    )
}
