//! The whole estimator: every technique, changes while it runs, and what broken sensors may
//! deliver.

use friction_model::{AnyModel, ModelName, TimeStep};
use friction_observer::adaptive::{LevelOptions, ParameterOptions, StiffnessOptions};
use friction_observer::{
    DisturbanceObserverOptions, EstimatorOptions, FrictionEstimator, FuzzyOptions, RbfOptions,
    Seen, SuperTwistingOptions, Technique, VelocitySource,
};
use proptest::prelude::*;

const TECHNIQUES: [Technique; 10] = [
    Technique::Feedback,
    Technique::Feedforward,
    Technique::Both { share: 0.5 },
    Technique::Adaptive(LevelOptions { share: 0.3, ..LevelOptions::SRV02 }),
    Technique::AdaptiveParameters(ParameterOptions { share: 0.3, ..ParameterOptions::SRV02 }),
    Technique::AdaptiveStiffness(StiffnessOptions::SRV02),
    Technique::DisturbanceObserver(DisturbanceObserverOptions::SRV02),
    Technique::Rbf(RbfOptions::SRV02),
    Technique::SuperTwisting(SuperTwistingOptions::SRV02_POSITION),
    Technique::Fuzzy(FuzzyOptions::SRV02_POSITION),
];

const SOURCES: [VelocitySource; 5] = [
    VelocitySource::Tachometer,
    VelocitySource::TachometerLowPass { time_constant: 0.005 },
    VelocitySource::TRACKING_LOOP,
    VelocitySource::ENCODER_KALMAN,
    VelocitySource::FUSED,
];

fn period() -> TimeStep {
    TimeStep::new(1e-3).unwrap()
}

fn estimator(model: &AnyModel, technique: Technique) -> FrictionEstimator {
    FrictionEstimator::new(model, EstimatorOptions { technique, ..Default::default() }, period())
        .unwrap()
}

/// Motion to and fro under a voltage that fits it roughly.
fn seen(k: u32) -> Seen {
    let t = 1e-3 * f64::from(k);
    let velocity = 0.3 * (1.5 * t).sin();
    let voltage =
        velocity / 1.8625 + 4.84 * (0.09 * velocity / (velocity.abs() + 0.01) + 0.04 * velocity);
    Seen {
        velocity,
        position: 0.2 * (1.0 - (1.5 * t).cos()),
        reference_velocity: velocity + 0.01,
        error: -0.01,
        voltage,
        torque: None,
    }
}

/// `k` shows as `-sigma k e` in the torque at once, and in the states later.
#[test]
fn injection_is_gain_on_the_error_at_once() {
    let model = AnyModel::test_bed(ModelName::Proposed);
    let options = EstimatorOptions { injection: 0.5, ..Default::default() };
    let mut injected = FrictionEstimator::new(&model, options, period()).unwrap();
    let mut plain = estimator(&model, Technique::Feedback);
    let at_rest = Seen { error: 0.02, ..Seen::default() };
    let (with, without) = (injected.estimate(&at_rest).torque, plain.estimate(&at_rest).torque);
    assert!((with - without + 0.3213 * 0.5 * 0.02).abs() < 1e-12, "{with} {without}");
    let later = (0..50).map(|_| injected.estimate(&at_rest).torque).last().unwrap();
    assert!(later < with - 1e-3, "the states follow: {later} after {with}");
    let broken = Seen { error: f64::NAN, ..Seen::default() };
    assert!(injected.estimate(&broken).torque.is_finite());
}

/// Forward the friction of the forward side, backward that of the backward side, for every model.
#[test]
fn observers_know_the_direction() {
    for name in ModelName::ALL {
        let forward = AnyModel::test_bed(name);
        let mut heavier = forward.parameters();
        for row in forward.parameters().table() {
            if row.unit == friction_model::Unit::Force || row.name == "f_v" {
                heavier.scale(row.name, 1.3);
            }
        }
        let backward = AnyModel::try_from(heavier).unwrap();
        let both = AnyModel::asymmetric(&forward, &backward).unwrap();
        let mut observer = estimator(&both, Technique::Feedback);
        for velocity in [0.5, -0.5] {
            let at = Seen { velocity, ..Seen::default() };
            let mean =
                (0..4000).map(|_| observer.estimate(&at).torque).skip(2000).sum::<f64>() / 2000.0;
            let expected = both.steady_state(velocity);
            // The bristles' torque fluctuates about its mean.
            let within = if name == ModelName::Bristle { 0.05 } else { 0.02 };
            assert!(
                (mean / expected - 1.0).abs() < within,
                "{name} at {velocity}: {mean}, not {expected}"
            );
        }
        assert!(both.steady_state(-0.5).abs() > 1.05 * both.steady_state(0.5), "{name}");
    }
}

/// At no cycle after a change does the torque move more than the two estimators themselves move and
/// the fade allows.
#[test]
fn a_change_while_running_does_not_jump() {
    let model = AnyModel::test_bed(ModelName::Proposed);
    let other = AnyModel::test_bed(ModelName::Gms);
    // What moves itself by less than 0.006, the slips of a model that begins at rest among it, and a
    // hundredth of the largest difference of two estimates, 0.2: the fade takes a hundred cycles.
    let most = 0.008;
    for from in TECHNIQUES {
        for to in TECHNIQUES {
            let mut running = estimator(&model, from);
            let mut before = (0..1400).map(|k| running.estimate(&seen(k)).torque).last().unwrap();
            running
                .change(&other, EstimatorOptions { technique: to, ..Default::default() })
                .unwrap();
            for k in 1400..1700 {
                if k == 1430 {
                    // In the middle of the first one.
                    running
                        .change(&model, EstimatorOptions { technique: from, ..Default::default() })
                        .unwrap();
                }
                let torque = running.estimate(&seen(k)).torque;
                assert!(
                    (torque - before).abs() < most,
                    "{from:?} to {to:?}: from {before} to {torque} at {k}"
                );
                before = torque;
            }
        }
    }
}

#[test]
fn after_the_fade_the_new_estimator_is_alone() {
    let (old, new) = (AnyModel::test_bed(ModelName::Coulomb), AnyModel::test_bed(ModelName::LuGre));
    let mut changed = estimator(&old, Technique::Feedback);
    (0..500).for_each(|k| _ = changed.estimate(&seen(k)));
    changed.change(&new, EstimatorOptions::default()).unwrap();
    let mut fresh = estimator(&new, Technique::Feedback);
    for k in 500..700 {
        let (a, b) = (changed.estimate(&seen(k)), fresh.estimate(&seen(k)));
        assert!(k < 601 || a == b, "at {k}");
        assert!(k != 500 || a != b, "the old one counts at first");
    }
    assert_eq!(changed.model(), ModelName::LuGre);
    let wrong =
        EstimatorOptions { technique: Technique::Both { share: 2.0 }, ..Default::default() };
    assert!(changed.change(&old, wrong).is_err());
    assert_eq!(changed.model(), ModelName::LuGre, "a refused change changes nothing");
}

fn reading() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -3.0..3.0f64,
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 0.0, 1e-300]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: if std::env::var_os("PROPTEST_CASES").is_some() { ProptestConfig::default().cases } else { 24 }, failure_persistence: None, ..ProptestConfig::default() })]

    /// A thousand cycles of whatever may come: the torque stays a number, and after good readings
    /// the estimator estimates again.
    #[test]
    fn no_reading_makes_a_torque_that_is_not_a_number(
        name in prop::sample::select(&ModelName::ALL[..]),
        technique in prop::sample::select(&TECHNIQUES[..]),
        velocity in prop::sample::select(&SOURCES[..]),
        injection in prop::sample::select(vec![0.0, 0.035, -2.0]),
        readings in prop::collection::vec(prop::array::uniform6(reading()), 1000),
    ) {
        let options = EstimatorOptions { technique, velocity, injection, ..Default::default() };
        let mut estimator = FrictionEstimator::new(&AnyModel::test_bed(name), options, period()).unwrap();
        for [velocity, position, reference_velocity, error, voltage, torque] in readings {
            let seen = Seen { velocity, position, reference_velocity, error, voltage, torque: Some(torque) };
            let estimate = estimator.estimate(&seen);
            prop_assert!(estimate.torque.is_finite(), "{name} {technique:?}: {estimate:?} from {seen:?}");
        }
        for k in 0..100 {
            prop_assert!(estimator.estimate(&seen(k)).torque.is_finite());
        }
    }
}
