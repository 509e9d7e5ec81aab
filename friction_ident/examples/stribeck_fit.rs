//! A Stribeck curve through measured friction, in as few lines as it takes.
//!
//! `cargo run -p friction_ident --example stribeck_fit`

use friction_ident::{IdentError, SteadyPoint, StribeckOptions, fit_stribeck};

/// Velocity \[rad/s\] and mean friction torque \[N m\] while it was held.
const MEASURED: [(f64, f64); 32] = [
    (0.03, 0.10031),
    (-0.03, -0.10043),
    (0.05, 0.10050),
    (-0.05, -0.10070),
    (0.07, 0.10068),
    (-0.07, -0.10068),
    (0.09, 0.10090),
    (-0.09, -0.10073),
    (0.12, 0.10067),
    (-0.12, -0.10074),
    (0.16, 0.10095),
    (-0.16, -0.10084),
    (0.20, 0.10153),
    (-0.20, -0.10138),
    (0.25, 0.10283),
    (-0.25, -0.10282),
    (0.30, 0.10453),
    (-0.30, -0.10451),
    (0.40, 0.10846),
    (-0.40, -0.10860),
    (0.60, 0.11666),
    (-0.60, -0.11665),
    (0.90, 0.12878),
    (-0.90, -0.12864),
    (1.30, 0.14488),
    (-1.30, -0.14491),
    (1.80, 0.16512),
    (-1.80, -0.16496),
    (2.50, 0.19321),
    (-2.50, -0.19305),
    (3.50, 0.23350),
    (-3.50, -0.23333),
];

/// Fits the curve.
///
/// # Errors
/// [`IdentError`] says what the measurements lack.
pub fn main() -> Result<(), IdentError> {
    let points = MEASURED.map(|(velocity, torque)| SteadyPoint::new(velocity, torque));
    let fit = fit_stribeck(&points, &StribeckOptions::default())?;
    let curve = fit.parameters;
    println!("static friction    {:.4} N m", curve.f_s);
    println!("Coulomb friction   {:.4} N m", curve.f_c);
    println!("Stribeck velocity  {:.3} rad/s", curve.v_s);
    println!("viscous friction   {:.4} N m s/rad", curve.f_v);
    println!("friction at 0.5 rad/s: {:.4} N m", fit.torque(0.5));
    assert!((curve.f_c - 0.0925).abs() < 1e-3, "{curve:?}");
    Ok(())
}
