//! Time of one control step of every model: `cargo bench -p friction_model`.
//!
//! Each iteration steps once around a table of velocities with reversals and sliding, at 1 kHz.

use std::f64::consts::PI;
use std::hint::black_box;

use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use friction_model::{Coulomb, FrictionModel, LuGre, Proposed, Stepper, Stribeck, TimeStep, Viscous};

const SAMPLES: usize = 4096;

fn velocities() -> Vec<f64> {
    (0..SAMPLES)
        .map(|i| {
            let phase = 2.0 * PI * i as f64 / SAMPLES as f64;
            0.02 + 0.2 * (3.0 * phase).sin() + 0.01 * (41.0 * phase).sin()
        })
        .collect()
}

fn bench<M: FrictionModel>(group: &mut BenchmarkGroup<'_, WallTime>, model: M) {
    let velocity = velocities();
    let dt = TimeStep::new(1e-3).expect("1 ms is a valid period");
    let mut stepper = Stepper::new(model, dt);
    group.bench_function(M::NAME.as_str(), |b| {
        b.iter(|| velocity.iter().fold(0.0, |sum, &v| sum + stepper.step(black_box(v))))
    });
}

fn model_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("model_step");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    bench(&mut group, Coulomb::test_bed());
    bench(&mut group, Viscous::test_bed());
    bench(&mut group, Stribeck::test_bed());
    bench(&mut group, LuGre::test_bed());
    bench(&mut group, Proposed::test_bed());
    group.finish();
}

criterion_group!(benches, model_step);
criterion_main!(benches);
