//! Gain and time constant of a motor from its voltage and its speed, and its inertia where the
//! motor's data sheet is at hand.
//!
//! `cargo run -p friction_ident --example drive_constants`

use friction_ident::axis_structure::AxisUnits;
use friction_ident::drive::{Calibration, DriveRecording, fit_drive};
use friction_ident::{Conditioning, IdentError, Uncertain, Verdict};

/// Sampling period \[s\].
const TIME_STEP: f64 = 1e-3;

/// Twenty seconds of a motor: voltage \[V\] and speed \[rad/s\]. A recording of your own takes its
/// place: steps of different height in both directions suit well.
fn recorded() -> (Vec<f64>, Vec<f64>) {
    let (gain, time_constant, friction_volts) = (1.86, 0.024, 0.45);
    let mut speed = 0.0f64;
    (0..20_000)
        .map(|sample| {
            let step = (sample / 400) % 7;
            let voltage = [3.0, -2.0, 5.0, -4.0, 1.5, -5.0, 2.5][step as usize];
            let now = speed;
            // The motor between two samples, in short steps: T w' + w = K (u - friction).
            for _ in 0..20 {
                let volts = voltage - friction_volts * speed.signum();
                speed += TIME_STEP / 20.0 * (gain * volts - speed) / time_constant;
            }
            (voltage, now)
        })
        .unzip()
}

/// Identifies the drive.
///
/// # Errors
/// [`IdentError`] says what the recording lacks.
pub fn main() -> Result<(), IdentError> {
    let (voltage, velocity) = recorded();
    let recording = DriveRecording {
        start: 0.0,
        time_step: TIME_STEP,
        voltage: &voltage,
        position: None,
        velocity: Some(&velocity),
        friction: None,
    };
    // From the data sheet, each to 2 %. Without it the inertia stays unknown, and the fit says so.
    let data_sheet = Calibration::Motor {
        torque_constant: Uncertain::relative(0.537, 0.02),
        resistance: Uncertain::relative(2.6, 0.02),
    };
    let how = Conditioning::for_time_step(TIME_STEP);
    let fit = fit_drive(&[recording], &how, Some(&data_sheet), &AxisUnits::ROTARY)?;
    for estimate in &fit.estimates.parameters {
        match (&estimate.verdict, estimate.standard_error) {
            (Verdict::NotIdentifiable { doubt, remedy }, _) => {
                println!("{:<24} is open: {doubt}; {remedy}", estimate.id);
            }
            (_, Some(error)) => println!(
                "{:<24} {:9.5} +- {error:.5} {}",
                estimate.id, estimate.value, estimate.unit
            ),
            (_, None) => println!("{:<24} {:9.5} {}", estimate.id, estimate.value, estimate.unit),
        }
    }
    for note in &fit.notes {
        println!("note: {note}");
    }
    let gain = fit.estimates.value("gain").unwrap_or(f64::NAN);
    assert!((gain / 1.86 - 1.0).abs() < 0.01, "{gain}");
    Ok(())
}
