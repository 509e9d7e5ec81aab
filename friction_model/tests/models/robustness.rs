//! Whatever a sensor says and however coarse the period: a model keeps its numbers, its symmetry
//! and its reproducibility.

use crate::arbitrary::{any_model, config, odd_model, period, velocities};
use friction_model::{AnyModel, ModelName, TimeStep};
use proptest::prelude::*;

proptest! {
    #![proptest_config(config())]

    #[test]
    fn forces_are_finite_for_every_model_and_motion(model in any_model(), dt in period(), path in velocities()) {
        let mut stepper = model.start(dt);
        for v in path {
            prop_assert!(stepper.step(v).is_finite(), "{v}");
            let inside = stepper.internals(v);
            prop_assert!(inside.deflection.is_finite() && inside.gamma.is_finite());
        }
    }

    #[test]
    fn forces_are_odd_in_the_motion(model in odd_model(), dt in period(), path in velocities()) {
        let (mut there, mut back) = (model.start(dt), model.start(dt));
        for v in path {
            prop_assert_eq!(there.step(v), -back.step(-v));
        }
    }

    /// An asymmetric contact seen from the other side is the one with its directions exchanged.
    #[test]
    fn exchanging_directions_mirrors_the_force(
        (forward, backward) in odd_model().prop_flat_map(|one| (Just(one), crate::arbitrary::model(one.name()))),
        dt in period(), path in velocities(),
    ) {
        let mut there = AnyModel::asymmetric(&forward, &backward).unwrap().start(dt);
        let mut back = AnyModel::asymmetric(&backward, &forward).unwrap().start(dt);
        for v in path {
            prop_assert_eq!(there.step(v), -back.step(-v));
        }
    }

    #[test]
    fn the_same_motion_gives_the_same_bits(model in any_model(), dt in period(), path in velocities()) {
        let run = || {
            let mut stepper = model.start(dt);
            path.iter().map(|&v| stepper.step(v).to_bits()).collect::<Vec<_>>()
        };
        prop_assert_eq!(run(), run());
    }

    #[test]
    fn parameters_survive_a_file(model in any_model()) {
        let text = serde_json::to_string(&model).unwrap();
        prop_assert_eq!(serde_json::from_str::<AnyModel>(&text).unwrap(), model);
    }
}

/// Velocities that are no velocities, and the way back from them.
#[test]
fn nothing_a_sensor_says_makes_a_model_forget_its_numbers() {
    let nonsense = [
        0.0,
        1e6,
        -1e6,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e300,
        -0.0,
        f64::MIN_POSITIVE,
        0.1,
    ];
    for name in ModelName::ALL {
        for dt in [1e-3, 1e-2] {
            let model = AnyModel::test_bed(name);
            let mut stepper = model.start(TimeStep::new(dt).unwrap());
            for v in nonsense {
                assert!(stepper.step(v).is_finite(), "{name} at {v}");
            }
            let expected = model.steady_state(0.1);
            if name == ModelName::Bristle {
                // Its sliding is random around the mean.
                let n = 200_000;
                let mean = (0..n).map(|_| stepper.step(0.1)).sum::<f64>() / f64::from(n);
                assert!(
                    (mean / expected - 1.0).abs() < 0.05,
                    "{name} at {dt} s: mean {mean} is not {expected}"
                );
                continue;
            }
            if name == ModelName::Armstrong {
                // Its Stribeck friction is that of the last dwell; the steady state is that of a
                // slip after a long rest.
                for _ in 0..5000 {
                    stepper.step(0.1);
                }
                let force = stepper.step(0.1);
                assert!(force < expected + 1e-12 && force >= 0.0925 + 0.0403 * 0.1, "{force}");
                stepper.reset();
            }
            for _ in 0..5000 {
                stepper.step(0.1);
            }
            let force = stepper.step(0.1);
            assert!((force - expected).abs() < 1e-9, "{name} at {dt} s: {force} is not {expected}");
        }
    }
}
