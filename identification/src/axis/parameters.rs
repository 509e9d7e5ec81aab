//! `parameters.yaml`: what was found, as a ROS 2 parameter file for the friction observer.
//!
//! Coulomb and viscous friction are a Stribeck curve without a dip, `f_s = f_c`; the symmetric
//! model's are taken, because the observer's friction is odd in the velocity. The inertia stands in
//! a comment: it belongs to no node.

use friction_ident::robust_covariance::METHOD;
use friction_ident::statistics::{quantile, sorted};
use friction_ident::{AxisTerm, TermEstimate};
use parameters::ParameterValue;
use parameters::file::Writer;
use report::numbers::{significant, value_and_error};

use super::{Identification, unit};
use crate::speeds;

/// Stribeck velocity of a curve without a dip: any positive number does.
const NO_DIP_V_S: f64 = 0.1;

/// The speed at which the axis mostly moves \[m/s or rad/s\].
pub(super) fn usual_speed(velocity: &[f64]) -> f64 {
    let speeds = sorted(velocity.iter().map(|v| v.abs()));
    quantile(&speeds, 0.5).unwrap_or(0.0)
}

/// The level that is written where a viscous friction below zero is written as 0: friction at the
/// usual speed stays what it is.
pub(super) fn level_beside(level: f64, viscous: f64, speed: f64) -> f64 {
    let carried = level + viscous.min(0.0) * speed;
    if carried > 0.0 { carried } else { level }
}

/// The file as text; the model is `viscous` where no Coulomb friction was found.
pub fn render(found: &Identification, name: &str) -> String {
    let axis = found.settings.axis;
    let fit = &found.symmetric.fit;
    let viscous = fit.value(AxisTerm::Viscous);
    let coulomb = level_beside(
        fit.value(AxisTerm::Coulomb),
        viscous,
        usual_speed(&found.symmetric.estimation.velocity),
    );
    let viscous = viscous.max(0.0);
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
        let less = if fit.value(AxisTerm::Viscous) < 0.0 {
            "; less what viscous friction below zero takes off at the usual speed"
        } else {
            ""
        };
        say("f_c", coulomb, &format!("{}{less}", origin(AxisTerm::Coulomb)));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// At a constant 12 rad/s a friction of 8 came out as a level of 11.08 less 0.257 a rad/s, and the
    /// level alone was written: 38 % off at the only speed that was recorded.
    #[test]
    fn a_viscous_friction_that_is_left_out_leaves_friction_at_the_usual_speed() {
        let level = level_beside(11.08, -0.257, usual_speed(&[12.0, -12.0, 12.1, 11.9, 12.0]));
        assert!((level - 8.0).abs() < 0.01, "{level}");
        assert_eq!(level_beside(2.0, 0.3, 12.0), 2.0);
        // No level is below zero.
        assert_eq!(level_beside(2.0, -0.3, 12.0), 2.0);
    }
}
