//! How long the frictional-lag stage takes on 9425 noisy samples, the reference recording.
//!
//! ```text
//! cargo run --release -p friction_ident --example lag_speed
//! ```

use std::time::Instant;

use friction_ident::frictional_lag::{LagOptions, LagRecording, Relaxation, fit_lag, fit_relaxation};
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
    let options = LagOptions::default();
    let (alpha, sigma0, sigma1) = ([0.25; 4], [15.0; 4], [0.0; 4]);
    let gms = Relaxation::Gms { alpha: &alpha, sigma0: &sigma0, sigma1: &sigma1 };
    time("proposed", &data, |recordings| fit_lag(recordings, &options).map(|fit| fit.mse));
    time("LuGre", &data, |recordings| {
        fit_relaxation(recordings, &options, Relaxation::LuGre).map(|fit| fit.mse)
    });
    time("GMS, 4 elements", &data, |recordings| fit_relaxation(recordings, &options, gms).map(|fit| fit.mse));
}

/// Runs `fit` over all recordings, ten times each, and prints what it took.
fn time(
    model: &str,
    data: &[(Vec<f64>, Vec<f64>)],
    fit: impl Fn(&[LagRecording]) -> Result<f64, friction_ident::IdentError>,
) {
    let mut times = Vec::new();
    let mut mse = Vec::new();
    for _ in 0..10 {
        for (velocity, torque) in data {
            let recordings = [LagRecording { velocity, torque, dt: 1e-3 }];
            let started = Instant::now();
            mse.extend(fit(&recordings));
            times.push(started.elapsed().as_secs_f64() * 1e3);
        }
    }
    times.sort_by(f64::total_cmp);
    let mean = mse.iter().sum::<f64>() / mse.len() as f64;
    println!("{model}: median {:.3} ms, fastest {:.3} ms, mse {mean:.4e}", times[times.len() / 2], times[0]);
}
