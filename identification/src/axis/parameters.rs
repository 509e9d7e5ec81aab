//! `parameters.yaml`: what was found, as a ROS 2 parameter file for the friction observer.
//!
//! Coulomb and viscous friction are a Stribeck curve without a dip, `f_s = f_c`; the symmetric
//! model's are taken, because the observer's friction is odd in the velocity. The inertia stands in
//! a comment: it belongs to no node.

use friction_ident::robust_covariance::METHOD;
use friction_ident::{AxisTerm, TermEstimate};
use parameters::ParameterValue;
use parameters::file::Writer;
use report::numbers::{significant, value_and_error};

use super::{Identification, unit};
use crate::speeds;

/// Stribeck velocity of a curve without a dip: any positive number does.
const NO_DIP_V_S: f64 = 0.1;

/// The file as text; the model is `viscous` where no Coulomb friction was found.
pub fn render(found: &Identification, name: &str) -> String {
    let axis = found.settings.axis;
    let fit = &found.symmetric.fit;
    let coulomb = fit.value(AxisTerm::Coulomb);
    let viscous = fit.value(AxisTerm::Viscous).max(0.0);
    let mut file = Writer::default();
    let version = env!("CARGO_PKG_VERSION");
    file.comment(&format!("An axis fitted by frictionlab {version} to {name}."));
    if let Some(line) = speeds::line(found.symmetric.estimation.velocity.iter().copied(), axis) {
        file.comment(&line);
    }
    for estimate in &fit.terms {
        let (term, unit) = (estimate.term.describe(), unit(estimate.term, axis));
        let (value, error) = short(estimate);
        let doubt = estimate.doubt.map_or_else(String::new, |_| ", not to be trusted".to_owned());
        file.comment(&format!("{term}: {value} {unit}, standard error {error}{doubt}"));
    }
    file.comment(&format!("Standard errors: {METHOD}."));
    let origin = |term: AxisTerm| match fit.term(term) {
        Some(estimate) if estimate.value <= 0.0 => {
            "not identified: it came out below zero".to_owned()
        }
        Some(estimate) if estimate.is_identifiable() => {
            format!("identified, +- {}", short(&estimate).1)
        }
        Some(estimate) if estimate.doubt.is_some() => {
            format!("+- {}, which is not to be trusted", short(&estimate).1)
        }
        _ => "not identifiable from this recording".to_owned(),
    };
    let model = if coulomb > 0.0 { "stribeck" } else { "viscous" };
    file.node("/friction_observer");
    file.value("model", ParameterValue::String(model.to_owned()), "");
    let mut say = |name: &str, value, said: &str| {
        file.value(&format!("{model}.{name}"), ParameterValue::Double(value), said);
    };
    if coulomb > 0.0 {
        say("f_s", coulomb, "a copy of f_c: no Stribeck dip in this model, and v_s has no effect");
        say("f_c", coulomb, &origin(AxisTerm::Coulomb));
        say("v_s", NO_DIP_V_S, "not identified, without effect");
        say("delta", 2.0, "not identified, without effect");
    }
    say("f_v", viscous, &origin(AxisTerm::Viscous));
    file.text()
}

/// Value and error with as many digits as they deserve.
fn short(estimate: &TermEstimate) -> (String, String) {
    match value_and_error(estimate.value, estimate.standard_error) {
        (value, error) if error.is_empty() => (value, significant(estimate.standard_error, 2)),
        both => both,
    }
}
