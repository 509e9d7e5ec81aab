//! How sure a friction curve is: intervals, the band in which it lies, and what to measure where
//! the data leave a parameter open.
//!
//! `cargo run -p friction_ident --example static_curve_with_uncertainty`

use friction_ident::{
    IdentError, SteadyPoint, StribeckOptions, StribeckParameter, Verdict, fit_stribeck,
};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

/// Forty constant velocities, both ways, with a noise of `deviation` \[N m\] on each mean torque.
fn measured(deviation: f64) -> Vec<SteadyPoint> {
    let mut random = Pcg64Mcg::seed_from_u64(2017);
    (1..=20)
        .map(|i| 0.02 * f64::from(i * i)) // more of them at low speed, where the curve bends
        .flat_map(|speed| [speed, -speed])
        .map(|velocity: f64| {
            let dip = 0.0069 * (-(velocity / 0.14).powi(2)).exp();
            let torque = velocity.signum() * (0.0925 + dip) + 0.0403 * velocity;
            let noise: f64 = random.sample(StandardNormal);
            SteadyPoint::new(velocity, torque + deviation * noise)
        })
        .collect()
}

/// Fits the curve to precise and to noisy measurements.
///
/// # Errors
/// [`IdentError`] says what the measurements lack.
pub fn main() -> Result<(), IdentError> {
    for deviation in [2e-4, 6e-3] {
        println!("noise of {deviation} N m on each point");
        let fit = fit_stribeck(&measured(deviation), &StribeckOptions::default())?;
        // The same numbers as a table of estimates: value, interval, verdict.
        for estimate in &fit.to_estimates().parameters {
            match (&estimate.verdict, estimate.interval) {
                (Verdict::NotIdentifiable { doubt, remedy }, _) => {
                    println!("  {:<4} is open: {doubt}; {remedy}", estimate.id);
                }
                (_, Some(interval)) => println!(
                    "  {:<4} {:.5}, with 95 % between {:.5} and {:.5} {}",
                    estimate.id, estimate.value, interval.low, interval.high, estimate.unit
                ),
                (_, None) => {
                    println!("  {:<4} {:.5} {}", estimate.id, estimate.value, estimate.unit)
                }
            }
        }
        // Where the curve itself lies, whatever its parameters.
        let (low, high) = fit.band(0.1);
        println!("  friction at 0.1 rad/s: {low:.4} to {high:.4} N m\n");

        // The dip is 0.0069 N m: one noise leaves it in sight, the other hides it.
        let open = fit.estimate(StribeckParameter::StribeckVelocity).unidentifiable.is_some();
        assert_eq!(open, deviation > 1e-3);
    }
    Ok(())
}
