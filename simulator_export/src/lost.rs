//! What of the identified friction a target cannot hold, in words.

use friction_model::{AnyModel, ModelName};

use crate::Given;
use crate::contact::Contact;

/// What the contact lacks that the model has.
pub(crate) fn lost(given: &Given, contact: &Contact) -> Vec<String> {
    if matches!(contact, Contact::Own(_)) {
        return Vec::new();
    }
    let model = &given.model;
    let mut lost: Vec<String> = Vec::new();
    if given.is_asymmetric() {
        lost.push(
            "a friction of its own in each direction: the mean of both is written".to_owned(),
        );
    }
    let bends = bends(model);
    if bends && !matches!(contact, Contact::LuGre(_)) {
        lost.push(
            "pre-sliding: the contact bends before it slides, and so lags at each reversal"
                .to_owned(),
        );
    }
    if falls(model) {
        match contact {
            Contact::CoulombViscous { .. } => lost.push(
                "the fall of the friction from rest to sliding (Stribeck): one level stands for both".to_owned(),
            ),
            Contact::StaticDynamicViscous { .. } => lost.push(
                "how the friction falls from rest to sliding (Stribeck): it drops at once".to_owned(),
            ),
            _ => {}
        }
    }
    if matches!(contact, Contact::LuGre(_)) {
        lost.extend(of_lugre(model));
    }
    lost
}

/// What LuGre with exponent 2 and constant micro-damping lacks.
fn of_lugre(model: &AnyModel) -> Option<String> {
    let exponent = model.parameter("delta").filter(|delta| *delta != 2.0);
    match model.name() {
        ModelName::LuGre if model.parameter("v_d").is_some() => {
            Some("micro-damping that falls with the speed (v_d)".to_owned())
        }
        ModelName::LuGre => exponent.map(|delta| {
            format!("the exponent {delta} of the Stribeck curve: it is fitted with 2")
        }),
        ModelName::Dahl => exponent
            .filter(|delta| *delta != 1.0)
            .map(|delta| format!("the shape {delta} of the curve in pre-sliding")),
        name => Some(format!(
            "what {} has beyond LuGre: the shape of its pre-sliding, and the memory of its reversals",
            name.title()
        )),
    }
}

/// Whether the model has pre-sliding.
fn bends(model: &AnyModel) -> bool {
    let parameters = model.parameters();
    parameters.table().iter().any(|row| row.unit == friction_model::Unit::Stiffness)
        || model.parameter("sigma0").is_some()
}

/// Whether its friction falls with the speed.
fn falls(model: &AnyModel) -> bool {
    match (model.parameter("f_s"), model.parameter("f_c")) {
        (Some(f_s), Some(f_c)) => f_s > f_c,
        _ => model.parameter("v_s").is_some(),
    }
}
