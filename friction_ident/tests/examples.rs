//! The examples for readers run, and find what they say they find.

use friction_ident::IdentError;

#[path = "../examples/choose_model.rs"]
mod choose_model;
#[path = "../examples/drive_constants.rs"]
mod drive_constants;
#[path = "../examples/identify_from_arrays.rs"]
mod identify_from_arrays;
#[path = "../examples/static_curve_with_uncertainty.rs"]
mod static_curve_with_uncertainty;
#[path = "../examples/stribeck_fit.rs"]
mod stribeck_fit;

#[test]
fn a_stribeck_curve_is_fitted() -> Result<(), IdentError> {
    stribeck_fit::main()
}

#[test]
fn the_curve_says_how_sure_it_is() -> Result<(), IdentError> {
    static_curve_with_uncertainty::main()
}

#[test]
fn an_axis_is_identified_from_arrays() -> Result<(), IdentError> {
    identify_from_arrays::main()
}

#[test]
fn a_drive_is_identified_from_voltage_and_speed() -> Result<(), IdentError> {
    drive_constants::main()
}

#[test]
fn a_model_is_chosen_on_what_it_has_not_seen() -> Result<(), IdentError> {
    choose_model::main()
}
