//! Time of the joint fit.
use std::ops::ControlFlow;
use std::time::Instant;

use friction_ident::output_error::{Measured, OutputErrorOptions, fit_output_error, predict};
use friction_ident::{FreeParameters, Stretch};
use friction_model::{AnyModel, ModelName};
use rand::{RngExt, SeedableRng};

fn main() {
    let mut parameters = AnyModel::test_bed(ModelName::Proposed).parameters();
    parameters.set("tau", 0.0111);
    let truth: AnyModel = parameters.try_into().unwrap();
    let velocity: Vec<f64> = (0..6000)
        .map(|k| f64::from(k) * 1e-3)
        .map(|t| 0.4 * (1.3 * t).sin() * (0.37 * t).cos() + 0.03 * (11.0 * t).sin())
        .collect();
    let mut stretch = Stretch::new(1e-3, velocity, None, vec![0.0; 6000]).unwrap();
    stretch.friction = predict(&truth, &stretch);
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(1);
    stretch.friction.iter_mut().for_each(|f| *f += 0.0029 * rng.sample::<f64, _>(rand_distr::StandardNormal));
    let free = FreeParameters::usual(&truth);
    let start: Vec<f64> =
        free.start().iter().zip([1.2, 0.85, 1.1, 0.9, 1.05, 0.95, 1.1]).map(|(a, b)| a * b).collect();
    let away = FreeParameters::usual(&free.model(&start).unwrap());
    let one = Instant::now();
    for _ in 0..20 {
        std::hint::black_box(predict(&truth, &stretch));
    }
    println!("one simulation {:.3} ms", one.elapsed().as_secs_f64() * 50.0);
    for (restarts, broyden) in [(0, false), (0, true), (4, false), (4, true)] {
        let mut options = OutputErrorOptions { restarts, ..Default::default() };
        options.patience.broyden = broyden;
        options.patience.sum = 1e-8;
        options.patience.step = 1e-8;
        let begin = Instant::now();
        let data = Measured { points: &[], stretches: std::slice::from_ref(&stretch) };
        let fit = fit_output_error(&away, &data, &[], &options, &mut |_| ControlFlow::Continue(())).unwrap();
        println!(
            "restarts {restarts} broyden {broyden}: {:.2} ms, {} evaluations, rms {:.8}",
            begin.elapsed().as_secs_f64() * 1e3,
            fit.evaluations,
            fit.rms
        );
        for e in &fit.estimates.parameters {
            print!("{}={:.5}±{:.5} ", e.name, e.value, e.standard_error.unwrap_or(0.0));
        }
        println!();
    }
}
