//! Friction and inertia of an axis from three arrays: time step, position, driving torque.
//!
//! This is the first thing to try with a recording: no model has to be chosen, and a few seconds of
//! motion to and fro are enough. `cargo run -p friction_ident --example identify_from_arrays`

use friction_ident::{AxisModel, AxisTerm, Conditioning, IdentError, Signals, condition, fit_axis};

/// Sampling period \[s\].
const TIME_STEP: f64 = 1e-3;

/// Ten seconds of an axis: position \[rad\] and the torque that drove it \[N m\]. A recording of your
/// own takes its place.
fn recorded() -> (Vec<f64>, Vec<f64>) {
    let (inertia, viscous, coulomb) = (0.0026, 0.04, 0.09);
    (0..10_000)
        .map(|sample| {
            let t = f64::from(sample) * TIME_STEP;
            // Two sines: the axis speeds up, slows down, and turns.
            let position = 1.2 * (2.0 * t).sin() + 0.5 * (5.0 * t).sin();
            let velocity = 2.4 * (2.0 * t).cos() + 2.5 * (5.0 * t).cos();
            let acceleration = -4.8 * (2.0 * t).sin() - 12.5 * (5.0 * t).sin();
            let torque = inertia * acceleration + viscous * velocity + coulomb * velocity.signum();
            // An encoder of 100 000 counts a turn.
            let count = std::f64::consts::TAU / 1e5;
            ((position / count).round() * count, torque)
        })
        .unzip()
}

/// Identifies the axis.
///
/// # Errors
/// [`IdentError`] says what the recording lacks.
pub fn main() -> Result<(), IdentError> {
    let (position, torque) = recorded();
    // Velocity and acceleration come from the position, through filters without phase shift.
    let signals = Signals {
        time_step: TIME_STEP,
        position: Some(&position),
        readings: None,
        velocity: None,
        force: &torque,
    };
    let conditioned = condition(&signals, &Conditioning::for_time_step(TIME_STEP))?;
    let fit = fit_axis(&conditioned, AxisModel::SYMMETRIC)?;
    for term in &fit.terms {
        let note = if term.is_identifiable() { "" } else { "  (cannot be told from zero)" };
        let name = term.term.to_string();
        println!("{name:<10} {:9.5} +- {:.5}{note}", term.value, term.standard_error);
    }
    println!("unexplained: {:.1} % of the torque", fit.relative_error);

    // What the recording was made with comes back.
    let inertia = fit.terms.iter().find(|term| term.term == AxisTerm::Inertia);
    assert!(inertia.is_some_and(|term| (term.value / 0.0026 - 1.0).abs() < 0.05), "{fit:?}");
    Ok(())
}
