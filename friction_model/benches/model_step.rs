//! Time of one control step of every model: `cargo bench -p friction_model`.
//!
//! Each iteration steps once around a table of velocities with reversals and sliding, at 1 kHz:
//! with a model known at compile time, and with one chosen while the program runs.

use std::f64::consts::PI;
use std::hint::black_box;

use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use friction_model::{AnyModel, FrictionModel, ModelName, ModelVisitor, Stepper, TimeStep};

const SAMPLES: usize = 4096;

fn velocities() -> Vec<f64> {
    (0..SAMPLES)
        .map(|i| {
            let phase = 2.0 * PI * i as f64 / SAMPLES as f64;
            0.02 + 0.2 * (3.0 * phase).sin() + 0.01 * (41.0 * phase).sin()
        })
        .collect()
}

fn bench(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, mut step: impl FnMut(f64) -> f64) {
    let velocity = velocities();
    group.bench_function(name, |b| {
        b.iter(|| velocity.iter().fold(0.0, |sum, &v| sum + step(black_box(v))))
    });
}

/// Benches a model whose type is known at compile time.
struct Known<'a, 'b> {
    group: &'a mut BenchmarkGroup<'b, WallTime>,
    dt: TimeStep,
}

impl ModelVisitor for Known<'_, '_> {
    type Output = ();

    fn visit<M: FrictionModel>(self, model: M) {
        let mut stepper = Stepper::new(model, self.dt);
        bench(self.group, M::NAME, |v| stepper.step(v));
    }
}

fn known(c: &mut Criterion) {
    let mut group = c.benchmark_group("known");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    let dt = TimeStep::new(1e-3).expect("1 ms is a valid period");
    for name in ModelName::ALL {
        AnyModel::test_bed(name).visit(Known { group: &mut group, dt });
    }
    group.finish();
}

fn chosen(c: &mut Criterion) {
    let mut group = c.benchmark_group("chosen");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    let dt = TimeStep::new(1e-3).expect("1 ms is a valid period");
    for name in ModelName::ALL {
        let mut stepper = AnyModel::test_bed(name).start(dt);
        bench(&mut group, name.as_str(), |v| stepper.step(v));
    }
    group.finish();
}

criterion_group!(benches, known, chosen);
criterion_main!(benches);
