//! How long the frictional-lag stage takes on 9425 noisy samples, the reference recording.
//!
//! ```text
//! cargo run --release -p friction_ident --example lag_speed
//! ```

use std::time::Instant;

use friction_ident::frictional_lag::{LagOptions, LagRecording, fit_lag};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

/// Table 4.8: f_s, f_c, v_s, f_v, tau.
const TRUTH: [f64; 5] = [0.0986, 0.0925, 0.1526, 0.0403, 0.0111];

fn velocity(t: f64) -> f64 {
    1.0 - 0.95 * (10.0 * t * t / (2.0 * 9.425)).cos()
}

/// Torque with Gaussian noise of .0029 N m.
fn recording(seed: u64) -> (Vec<f64>, Vec<f64>) {
    let [f_s, f_c, v_s, f_v, tau] = TRUTH;
    let g = |t: f64| f_c + (f_s - f_c) * (-(velocity(t) / v_s).powi(2)).exp();
    let (fine, h) = (100, 1e-5);
    let decay = (-h / tau).exp();
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut gamma = g(0.0);
    let noise = Normal::new(0.0, 0.0029);
    (0..9425)
        .map(|k| {
            let t = 1e-3 * f64::from(k);
            let sample = noise.map_or(0.0, |noise| noise.sample(&mut rng));
            let row = (velocity(t), gamma + f_v * velocity(t) + sample);
            for i in 0..fine {
                let middle = g(t + h * (f64::from(i) + 0.5));
                gamma = middle + (gamma - middle) * decay;
            }
            row
        })
        .unzip()
}

fn main() {
    let data: Vec<_> = (0..20).map(recording).collect();
    let mut times = Vec::new();
    let mut last = None;
    for _ in 0..10 {
        for (velocity, torque) in &data {
            let started = Instant::now();
            last = fit_lag(&[LagRecording { velocity, torque, dt: 1e-3 }], &LagOptions::default()).ok();
            times.push(started.elapsed().as_secs_f64() * 1e3);
        }
    }
    times.sort_by(f64::total_cmp);
    println!("proposed: median {:.3} ms, fastest {:.3} ms", times[times.len() / 2], times[0]);
    if let Some(fit) = last {
        println!("{} passes, mse {:.4e}, {:?}", fit.passes, fit.mse, fit.values);
    }
}
