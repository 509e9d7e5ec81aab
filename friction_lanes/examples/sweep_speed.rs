//! Many parameter sets along one motion, in lanes and one after the other: the Rust side of `cargo
//! xtask bench-sweep`.
//!
//! `sweep_speed SETS SAMPLES THREADS [MODEL ...]` prints a line of JSON for each model, scheme and
//! way: nanoseconds a step, in processor time of the one thread for `lanes` and `scalar`, in wall time
//! of all threads for `threads`, and the sum of all forces. `sweep_speed --sets SETS` prints the
//! parameters of the sets, a line of JSON for each model.

use std::time::{Duration, Instant};
use std::{env, thread};

use friction_lanes::forces;
use friction_model::{AnyModel, FrictionModel, ModelName, ModelVisitor, Scheme, Stepper, TimeStep};
use rustix::time::{ClockId, clock_gettime};

const MODELS: [ModelName; 4] =
    [ModelName::LuGre, ModelName::Gms, ModelName::Xiong, ModelName::Proposed];

fn main() {
    let mut words = env::args().skip(1).peekable();
    if words.next_if_eq("--sets").is_some() {
        let sets = words.next().and_then(|word| word.parse().ok()).unwrap_or(0_usize);
        for name in MODELS {
            let sets = models(name, sets);
            println!("{}", serde_json::json!({ "model": name.as_str(), "sets": sets }));
        }
        return;
    }
    let mut number = || words.next().and_then(|word| word.parse().ok()).unwrap_or(0_usize);
    let [sets, samples, threads] = [number(), number(), number()];
    let named: Vec<ModelName> = words.filter_map(|word| word.parse().ok()).collect();
    let dt = TimeStep::new(1e-3).expect("a period");
    // Sliding, reversals and stops.
    let velocity: Vec<f64> = (0..samples)
        .map(|k| {
            let t = 1e-3 * k as f64;
            0.02 + 0.2 * (3.0 * t).sin() + 0.05 * (41.0 * t).sin()
        })
        .collect();
    for name in if named.is_empty() { MODELS.to_vec() } else { named } {
        let models = models(name, sets);
        for scheme in [Scheme::Held, Scheme::Mean] {
            let mut rows = vec![0.0; sets * samples];
            let mut tell = |way: &str, work: &mut dyn FnMut(&mut [f64]) -> Duration| {
                rows.fill(0.0);
                let time = work(&mut rows);
                let nanoseconds = 1e9 * time.as_secs_f64() / (sets * samples) as f64;
                let sum: f64 = rows.iter().sum();
                println!(
                    "{}",
                    serde_json::json!({ "model": name.as_str(), "scheme": scheme.to_string(), "way": way, "nanoseconds": nanoseconds, "sum": sum })
                );
            };
            let how = (dt, scheme);
            tell("scalar", &mut |rows| {
                timed(|| {
                    for (model, row) in models.iter().zip(rows.chunks_mut(samples)) {
                        model.visit(Alone { velocity: &velocity, how, row });
                    }
                })
            });
            tell("lanes", &mut |rows| timed(|| forces(&models, &velocity, how, rows, || false)));
            tell("threads", &mut |rows| {
                let each = sets.div_ceil(threads.max(1));
                let started = Instant::now();
                thread::scope(|scope| {
                    for (models, rows) in models.chunks(each).zip(rows.chunks_mut(each * samples)) {
                        let velocity = &velocity;
                        scope.spawn(move || forces(models, velocity, how, rows, || false));
                    }
                });
                started.elapsed()
            });
        }
    }
}

/// Sets of the test bed, every level and stiffness a little different.
fn models(name: ModelName, sets: usize) -> Vec<AnyModel> {
    let one = AnyModel::test_bed(name);
    (0..sets)
        .map(|k| {
            let share = k as f64 / sets as f64;
            let varied = one
                .scaled("v_s", 0.8 + 0.4 * share)
                .and_then(|m| m.scaled("f_s", 1.0 + 0.3 * share));
            varied.unwrap_or(one)
        })
        .collect()
}

struct Alone<'a> {
    velocity: &'a [f64],
    how: (TimeStep, Scheme),
    row: &'a mut [f64],
}

impl ModelVisitor for Alone<'_> {
    type Output = ();

    fn visit<M: FrictionModel>(self, model: M) {
        let mut contact = Stepper::by(self.how.1, model, self.how.0);
        for (force, velocity) in self.row.iter_mut().zip(self.velocity) {
            *force = contact.step(*velocity);
        }
    }
}

fn timed(work: impl FnOnce()) -> Duration {
    let clock = || Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).unwrap_or_default();
    let before = clock();
    work();
    clock() - before
}
