//! Nothing on the step path allocates: a real-time loop must not wait for the allocator.

use std::hint::black_box;

use allocation_counter::measure;
use friction_model::{
    AnyModel, Body, Drive, FrictionModel, LoadDependent, ModelName, ModelVisitor, Proposed,
    Stepper, TimeStep, rk4,
};

const STEPS: u32 = 20_000;

/// Sliding, reversals, and now and then a train of ever smaller ones, more than a hysteresis can
/// remember.
fn velocity(k: u32) -> f64 {
    let t = 1e-3 * f64::from(k);
    let phase = k % 5000;
    if phase < 1000 {
        let sign = if phase.is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * 2.0 * 0.99f64.powf(f64::from(phase))
    } else {
        0.3 * (3.1 * t).sin() + 0.1 * (17.0 * t).sin()
    }
}

/// The same with what a broken sensor may deliver.
fn measured(k: u32) -> f64 {
    match k % 977 {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2 => -1e300,
        3 => 0.0,
        _ => velocity(k),
    }
}

fn period() -> TimeStep {
    TimeStep::new(1e-3).unwrap()
}

/// Allocations while `step` is called many times.
fn allocations(mut step: impl FnMut(u32)) -> u64 {
    measure(|| (0..STEPS).for_each(&mut step)).count_total
}

/// Allocations of every way to step a model.
struct EveryWay;

impl ModelVisitor for EveryWay {
    type Output = [(&'static str, u64); 4];

    fn visit<M: FrictionModel>(self, model: M) -> Self::Output {
        let mut stepper = Stepper::new(model.clone(), period());
        let fixed = allocations(|k| {
            black_box(stepper.step(measured(k)));
            black_box(stepper.internals(measured(k)));
        });

        let mut state = model.rest();
        let integrated = allocations(|k| {
            let v = [2 * k, 2 * k + 1, 2 * k + 2].map(velocity);
            black_box(rk4::step(&model, &mut state, v, 1e-4));
        });

        let mut contact = LoadDependent::new(model.clone(), 0.5, period()).unwrap();
        let loaded = allocations(|k| {
            black_box(contact.step(measured(k), velocity(k)));
        });

        // A force beyond the levels of either preset, so that models with stiction hold, slip and
        // hold again; and a state of the driver.
        let mut body = Body::<M, 1>::new(model, 1.0);
        let moved = allocations(|_| {
            body.advance(1e-4, |at| Drive {
                force: 5.0 * (200.0 * at.time).sin() + at.driver[0],
                rates: [0.1],
            });
            black_box(body.friction(0.0));
        });
        assert!(body.moment().velocity.is_finite(), "the body went somewhere");
        [("Stepper", fixed), ("rk4", integrated), ("LoadDependent", loaded), ("Body", moved)]
    }
}

/// Without this, a counter that counts nothing would pass the other test.
#[test]
fn the_counter_counts() {
    let mut list = Vec::new();
    assert_eq!(measure(|| list.push(black_box(1.0))).count_total, 1);
    assert_eq!(allocations(|k| drop(black_box(vec![k]))), u64::from(STEPS));
    assert_eq!(allocations(|k| _ = black_box(k)), 0);
}

#[test]
fn no_model_allocates_while_it_steps() {
    for name in ModelName::ALL {
        let (forward, backward) = (AnyModel::test_bed(name), AnyModel::chapter_3(name));
        let both = AnyModel::asymmetric(&forward, &backward).unwrap();
        for (kind, model) in [("test bed", forward), ("chapter 3", backward), ("asymmetric", both)]
        {
            for (way, count) in model.visit(EveryWay) {
                assert_eq!(count, 0, "{name}, {kind}: {way} allocates");
            }
            let mut stepper = model.start(period());
            let chosen = allocations(|k| {
                black_box(stepper.step(measured(k)));
                black_box(stepper.internals(measured(k)));
            });
            assert_eq!(chosen, 0, "{name}, {kind}: AnyStepper allocates");
        }
    }
}

/// The motions above reach the slow paths too: a memory that overflows.
#[test]
fn the_motion_fills_the_memory_of_the_hysteresis() {
    let mut stepper = Stepper::new(Proposed::test_bed(), period());
    let deepest = (0..STEPS).map(|k| {
        stepper.step(measured(k));
        stepper.state().memory.depth()
    });
    assert!(deepest.max().unwrap() >= 119);
}
