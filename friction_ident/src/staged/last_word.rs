//! What is said of each number in the end.

use friction_model::AnyModel;

use super::StageResult;
use super::decided::{Exponent, has_exponent};
use crate::axis_term::AxisTerm;
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};
use crate::free_parameters::{FreeParameters, remedy};
use crate::parameter_id::{ParameterId, Side};
use crate::position_load::{self, PositionLoad};
use crate::static_curve::{StribeckFit, StribeckParameter};
use crate::statistics::student_95;

/// The scan over all Stribeck velocities knows better than a local fit whether there is a dip, and
/// its profile where the intervals end.
pub(super) fn take_over(estimates: &mut Estimates, side: Side, curve: &StribeckFit) {
    let has_dip = estimates.get(ParameterId::new("v_s").side(side)).is_some();
    for (parameter, why) in StribeckParameter::ALL.into_iter().zip(curve.unidentifiable) {
        let profile = curve.estimate(parameter).interval;
        let id = ParameterId::new(parameter.name()).side(side);
        let Some(estimate) = estimates.get_mut(id) else { continue };
        // A later fit may have gone where the scan did not look: its own interval is kept then.
        let holds = |&(low, high): &(f64, f64)| (low..=high).contains(&estimate.value);
        if let (Some((low, high)), true) = (profile.filter(holds), has_dip) {
            estimate.interval = Some(Interval { low, high, method: IntervalMethod::Profile });
            // What other exponents of the dip leave open belongs to the error too.
            let half = 0.5 * (high - low) / student_95(curve.degrees_of_freedom);
            if let Some(error) = estimate.standard_error.as_mut().filter(|_| half.is_finite()) {
                *error = error.max(half);
            }
            // The interval that is shown decides whether there is anything.
            let relative_error = estimate.standard_error.unwrap_or(0.0) / estimate.value.abs();
            let remedy = remedy(id.name);
            match &estimate.verdict {
                verdict if low > 0.0 && verdict.is_for_reaching_zero() => {
                    estimate.verdict = Verdict::Identified;
                }
                Verdict::Identified if low <= 0.0 || relative_error > 0.5 => {
                    let doubt = Doubt::LargeError { relative_error };
                    estimate.verdict = Verdict::NotIdentifiable { doubt, remedy };
                }
                _ => {}
            }
        }
        if let Some(why) = why {
            let remedy = remedy(id.name);
            estimate.verdict = Verdict::NotIdentifiable { doubt: why.into(), remedy };
        }
    }
}

/// Every number of the model with what the last stage that estimated it says.
pub(super) fn last_word(
    model: &AnyModel,
    stages: &[StageResult],
    terms: &[AxisTerm],
    load: PositionLoad,
    exponent: Exponent,
    rotary: bool,
) -> Estimates {
    let all = FreeParameters::new(model, |_| true);
    let beside = position_load::unknowns(terms, rotary);
    let parameters = all
        .unknowns(rotary)
        .into_iter()
        .zip(all.values())
        .chain(beside.zip(terms.iter().map(|&term| load.value(term))))
        .map(|(unknown, value)| {
            let found = stages.iter().rev().find_map(|stage| stage.estimates.get(unknown.id));
            match found {
                Some(found) => Estimate { value, ..found.clone() },
                None => Estimate::given(
                    unknown.id,
                    unknown.unit,
                    value,
                    if terms.iter().any(|term| unknown.id == ParameterId::new(term.name())) {
                        "from a linear fit of all that slides, before the model's own"
                    } else if unknown.id.name == "delta" && has_exponent(model.name()) {
                        exponent.source()
                    } else {
                        "no recording shows it: the value it started with"
                    },
                ),
            }
        })
        .collect();
    // Correlations are those of the last fit, where it covers everything it estimated.
    let last = stages.last().map(|stage| stage.estimates.clone()).unwrap_or_default();
    Estimates { parameters, ..last }
}
