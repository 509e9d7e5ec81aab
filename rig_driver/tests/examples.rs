//! The examples for readers run, and find what they say they find.

use std::error::Error;

#[path = "../examples/calibrated_channels.rs"]
mod calibrated_channels;
#[path = "../examples/open_by_address.rs"]
mod open_by_address;
#[path = "../examples/own_back_end.rs"]
mod own_back_end;

#[test]
fn a_rig_is_opened_by_its_address() -> Result<(), Box<dyn Error>> {
    open_by_address::main()
}

#[test]
fn the_safety_layer_stands_around_any_back_end() -> Result<(), Box<dyn Error>> {
    own_back_end::main()
}

#[test]
fn a_calibration_puts_readings_right() -> Result<(), Box<dyn Error>> {
    calibrated_channels::main()
}
