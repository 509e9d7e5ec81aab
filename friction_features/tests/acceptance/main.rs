//! The features against the figures of an independent implementation (`expected_results.md`,
//! sections 5 and 11), against closed forms, and against what the models cannot show.

mod breakaway;
mod drift;
mod frictional_lag;
mod memory;
mod sensitivity;
mod snapshot;
mod steady_state;
mod stick_slip;
mod whole;
mod zero_crossing;

use friction_features::Contact;
use friction_model::{AnyModel, AnyParameters, ModelName};

/// The contact of that name with the parameters of the thesis's chapter 3.
fn chapter_3(name: ModelName) -> Contact {
    Contact::new(&AnyModel::chapter_3(name))
}

/// The same with some parameters set to other values.
fn chapter_3_with(name: ModelName, values: &[(&str, f64)]) -> Contact {
    let mut parameters = AnyParameters::chapter_3(name);
    for (parameter, value) in values {
        assert!(parameters.set(parameter, *value), "{name} has no {parameter}");
    }
    Contact::new(&parameters.try_into().unwrap())
}

/// A model from a parameter file.
fn from_file(text: &str) -> Contact {
    Contact::new(&serde_json::from_str(text).unwrap())
}

#[track_caller]
fn assert_relative(what: &str, value: f64, expected: f64, tolerance: f64) {
    let error = (value / expected - 1.0).abs();
    assert!(
        error <= tolerance,
        "{what}: {value} is not {expected} within {tolerance}, off by {error:e}"
    );
}

#[track_caller]
fn assert_close(what: &str, value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{what}: {value} is not {expected} within {tolerance}"
    );
}
