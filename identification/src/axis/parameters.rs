//! `parameters.yaml`: what was found, as a ROS 2 parameter file for the friction observer.
//!
//! Coulomb and viscous friction are a Stribeck curve without a dip, `f_s = f_c`; the symmetric
//! model's are taken, because the observer's friction is odd in the velocity. The inertia stands in
//! a comment: it belongs to no node.

use std::fmt::Write;

use files::commented_yaml::number;
use friction_ident::AxisTerm;

use super::{Identification, unit};

/// Stribeck velocity of a curve without a dip: any positive number does.
const NO_DIP_V_S: f64 = 0.1;

/// The file as text; the model is `viscous` where no Coulomb friction was found.
pub fn render(found: &Identification, name: &str) -> String {
    let axis = found.settings.axis;
    let fit = &found.symmetric.fit;
    let coulomb = fit.value(AxisTerm::Coulomb);
    let viscous = fit.value(AxisTerm::Viscous).max(0.0);
    let mut text = format!(
        "# An axis fitted by frictionlab {} to {}.\n",
        env!("CARGO_PKG_VERSION"),
        one_line(name)
    );
    for estimate in &fit.terms {
        let (term, unit) = (estimate.term.describe(), unit(estimate.term, axis));
        let (value, error) = (number(estimate.value), number(estimate.standard_error));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "# {term}: {value} {unit}, standard error {error}");
    }
    let origin = |term: AxisTerm| match fit.term(term) {
        Some(estimate) if estimate.value <= 0.0 => {
            "not identified: it came out below zero".to_owned()
        }
        Some(estimate) if estimate.is_identifiable() => {
            format!("identified, +- {}", number(estimate.standard_error))
        }
        _ => "not identifiable from this recording".to_owned(),
    };
    text.push_str("/friction_observer:\n  ros__parameters:\n");
    if coulomb > 0.0 {
        let (f_c, f_v, v_s) = (number(coulomb), number(viscous), number(NO_DIP_V_S));
        let _ = write!(
            text,
            "    model: stribeck\n    stribeck:\n      f_s: {f_c}  # no Stribeck dip in this model, so f_s is f_c and v_s \
             has no effect\n      f_c: {f_c}  # {}\n      v_s: {v_s}  # not identified, without effect\n      delta: 2.0  # not identified, without effect\n      f_v: {f_v}  # {}\n",
            origin(AxisTerm::Coulomb),
            origin(AxisTerm::Viscous)
        );
    } else {
        let _ = write!(
            text,
            "    model: viscous\n    viscous:\n      f_v: {}  # {}\n",
            number(viscous),
            origin(AxisTerm::Viscous)
        );
    }
    text
}

/// A path must not end the comment it stands in.
fn one_line(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
