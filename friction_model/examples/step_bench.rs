//! Nanoseconds a step of the fixed-step forms: the Rust side of `cargo xtask bench`.
//!
//! `step_bench STEPS` prints, for each model, its name, nanoseconds a step and the sum of all forces. The C
//! side, `xtask/bench/peer.c`, does the same with the same velocities and parameters.

use std::f64::consts::PI;
use std::hint::black_box;
use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

use friction_model::{FrictionModel, LuGre, Proposed, Stepper, Stribeck, TimeStep};

const SAMPLES: usize = 4096;

fn main() -> ExitCode {
    let steps =
        std::env::args().nth(1).and_then(|text| text.parse().ok()).filter(|&steps: &usize| steps >= 10);
    let (Some(steps), Ok(dt)) = (steps, TimeStep::new(1e-3)) else {
        // Nothing is lost if nobody reads it.
        let _ = writeln!(std::io::stderr(), "usage: step_bench STEPS (at least 10)");
        return ExitCode::from(2);
    };
    let velocity: [f64; SAMPLES] = std::array::from_fn(|i| {
        let phase = 2.0 * PI * i as f64 / SAMPLES as f64;
        0.02 + 0.2 * (3.0 * phase).sin() + 0.01 * (41.0 * phase).sin()
    });
    measure("stribeck", Stribeck::test_bed(), dt, &velocity, steps);
    measure("lugre", LuGre::test_bed(), dt, &velocity, steps);
    measure("proposed", Proposed::test_bed(), dt, &velocity, steps);
    ExitCode::SUCCESS
}

/// A first pass of a tenth of the steps, from which the state goes on, warms caches and clock.
fn measure<M: FrictionModel>(name: &str, model: M, dt: TimeStep, velocity: &[f64; SAMPLES], steps: usize) {
    // Numbers that the compiler cannot know.
    let mut stepper = Stepper::new(black_box(model), black_box(dt));
    let warm = run(&mut stepper, velocity, steps / 10);
    let start = Instant::now();
    let sum = run(&mut stepper, velocity, steps);
    let nanoseconds = start.elapsed().as_secs_f64() / steps as f64 * 1e9;
    // A closed pipe shows in the reader.
    let _ = writeln!(std::io::stdout(), "{name} {nanoseconds:.4} {:.17e}", warm + sum);
}

#[inline(never)]
fn run<M: FrictionModel>(stepper: &mut Stepper<M>, velocity: &[f64; SAMPLES], steps: usize) -> f64 {
    let mut sum = 0.0;
    for k in 0..steps {
        sum += stepper.step(velocity[k % SAMPLES]);
    }
    sum
}
