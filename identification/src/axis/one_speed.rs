//! A motion that has one speed: what it does not tell, and what is said of that.

use friction_ident::one_speed::one_speed;
use friction_ident::{AxisFit, AxisTerm, Doubt, Estimate, Estimates, TermEstimate, Verdict};
use recording::AxisKind;
use report::numbers::significant;

use super::{ModelResult, ramps};

/// Parameters of friction that go with the position alone.
const OF_THE_PLACE: [&str; 3] = ["f_c_slope", "f_c_curvature", "period"];

/// A motion of one speed.
#[derive(Debug, Clone, PartialEq)]
pub struct OneSpeed {
    /// That speed \[m/s or rad/s\].
    pub speed: f64,
    /// The warning.
    pub said: String,
}

impl OneSpeed {
    /// Whether a motion is one, and then marks what each plain model does not tell from it.
    pub(super) fn of(
        velocity: &[f64],
        (symmetric, asymmetric): (&mut ModelResult, Option<&mut ModelResult>),
        axis: AxisKind,
    ) -> Option<Self> {
        let speed = one_speed(velocity)?;
        let inertia = distrust(symmetric, speed);
        asymmetric.map(|model| distrust(model, speed));
        let mut found = Self { speed, said: String::new() };
        found.tell(inertia, &symmetric.fit, axis);
        Some(found)
    }

    /// Says what such a motion does not tell, and what it does; `inertia` is whether its ramps tell
    /// that.
    pub(super) fn tell(&mut self, inertia: bool, symmetric: &AxisFit, axis: AxisKind) {
        self.said = said(self.speed, symmetric, axis, inertia);
    }
}

/// Says of a model's parameters that change with speed that the motion has one, and whether the ramps
/// tell its inertia.
fn distrust(model: &mut ModelResult, speed: f64) -> bool {
    let inertia = model.fit.term(AxisTerm::Inertia);
    let known = inertia.filter(|inertia| {
        inertia.doubt.is_none() && ramps::tell_inertia(&model.estimation, speed, inertia.value)
    });
    model.warned = true;
    model.fit.distrust_what_changes_with_speed();
    if let Some(TermEstimate { term, doubt, .. }) = known {
        let own = |estimate: &&mut TermEstimate| estimate.term == term;
        model.fit.terms.iter_mut().filter(own).for_each(|estimate| estimate.doubt = doubt);
    }
    known.is_some()
}

/// The same of a structure: not of what goes with the position, nor of the inertia where the ramps
/// tell it.
pub(super) fn distrust_structure(estimates: &mut Estimates, inertia: bool) {
    let told = |estimate: &Estimate| match estimate.id.name {
        "inertia" => inertia,
        name => OF_THE_PLACE.contains(&name),
    };
    let before = estimates.parameters.clone();
    estimates.distrust_what_changes_with_speed();
    for (estimate, before) in estimates.parameters.iter_mut().zip(before) {
        if told(estimate) {
            estimate.verdict = before.verdict;
        } else if let Verdict::NotIdentifiable { doubt: Doubt::NotToBeTrusted { why }, .. } =
            &mut estimate.verdict
            && inertia
            && before.verdict == Verdict::Identified
        {
            *why = "the motion has one speed and ramps up to it, where all that changes with speed acts at once"
                .to_owned();
        }
    }
}

/// What such a motion does not tell, and what it does; `inertia` is whether its ramps tell that.
fn said(speed: f64, symmetric: &AxisFit, axis: AxisKind, inertia: bool) -> String {
    let value = |term| symmetric.term(term).map(|estimate| estimate.value);
    let friction = value(AxisTerm::Coulomb).zip(value(AxisTerm::Viscous));
    let there = friction.map_or(String::new(), |(coulomb, viscous)| {
        format!(
            ", {} {} by the symmetric model",
            significant(coulomb + viscous * speed, 3),
            axis.force_unit()
        )
    });
    let speed = format!("{} {}", significant(speed, 3), axis.velocity_unit());
    if inertia {
        let together = correlation(symmetric).map_or(String::new(), |together| {
            format!(", their errors with a correlation of {together:.2}")
        });
        return format!(
            "The motion has one speed, {speed}, and ramps up to it: the ramps tell the inertia, but not how friction changes with speed. \
             Viscous and Coulomb friction are told apart on them alone{together}, where the rise of friction from rest and a lag of the \
             force act too: their numbers are not to be trusted one by one. What the recording tells is the inertia, the friction at \
             that speed{there}, and what goes with the position. Record other speeds as well."
        );
    }
    format!(
        "The motion has one speed, {speed}, and its turns: how friction changes with speed, and the inertia, hang on the turns \
         alone, where all acts at once, and their numbers are not to be trusted. What the recording tells is the friction at that \
         speed{there}, and what goes with the position. Record other speeds as well."
    )
}

/// Correlation of the errors of viscous and Coulomb friction.
fn correlation(symmetric: &AxisFit) -> Option<f64> {
    let place = |term| symmetric.terms.iter().position(|estimate| estimate.term == term);
    let row = symmetric.correlation.get(place(AxisTerm::Viscous)?)?;
    row.get(place(AxisTerm::Coulomb)?).copied().filter(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use friction_ident::{Interval, IntervalMethod};

    use super::*;

    #[test]
    fn of_a_structure_friction_is_not_told_and_the_inertia_is_where_the_ramps_tell_it() {
        let one = |name: &'static str| Estimate {
            id: name.into(),
            unit: "",
            value: 1.0,
            standard_error: Some(0.1),
            interval: Some(Interval { low: 0.8, high: 1.2, method: IntervalMethod::Robust }),
            verdict: Verdict::Identified,
        };
        let names = ["inertia", "f_v", "offset", "f_c", "f_c_slope", "delay"];
        let told = |inertia: bool| {
            let parameters = names.map(one).to_vec();
            let mut estimates = Estimates { parameters, ..Estimates::default() };
            distrust_structure(&mut estimates, inertia);
            let told = estimates.parameters.iter().filter(|estimate| estimate.is_identified());
            told.map(|estimate| estimate.id.name).collect::<Vec<_>>()
        };
        assert_eq!(told(true), ["inertia", "offset", "f_c_slope"]);
        assert_eq!(told(false), ["offset", "f_c_slope"]);
    }
}
