//! Whatever parameters a model accepts, however far apart: at any period and any velocity its
//! numbers stay finite, and what it would lose them with is refused when it is built.

use crate::arbitrary::config;
use friction_model::{AnyModel, AnyParameters, FrictionModel, ModelName, ModelVisitor};
use friction_model::{Scheme, Stepper, TimeStep};
use proptest::prelude::*;

/// A magnitude: of the whole range of numbers, of what machines have, or at its very ends.
fn magnitude() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-12.0..12.0f64).prop_map(|e| 10f64.powf(e)),
        2 => (-60.0..60.0f64).prop_map(|e| 10f64.powf(e)),
        1 => (-307.0..308.0f64).prop_map(|e| 10f64.powf(e)),
        1 => prop::sample::select(vec![0.0, 5e-324, f64::MIN_POSITIVE, f64::MAX, 1.0]),
    ]
}

/// Parameters with every number anywhere; lists keep shares that sum to one, and levels their
/// order most of the time, so that not all are refused.
fn anywhere() -> impl Strategy<Value = AnyParameters> {
    let names = prop::sample::select(&ModelName::ALL[..]);
    let usual = (-4.0..4.0f64).prop_map(|e| 10f64.powf(e));
    let numbers =
        prop_oneof![prop::collection::vec(usual, 64), prop::collection::vec(magnitude(), 64),];
    (names, numbers, 0.1..=1.0f64, 0..8u8).prop_map(|(name, numbers, ratio, choice)| {
        let mut parameters = AnyParameters::test_bed(name);
        let mut numbers = numbers.into_iter().cycle();
        for row in parameters.table() {
            if matches!(row.name, "alpha" | "lambda" | "bonds" | "seed") {
                continue;
            }
            for index in 0..parameters.values(row.name).len() {
                let number = numbers.next().unwrap_or(1.0);
                let number = match row.range {
                    friction_model::Range::Within(low, high)
                    | friction_model::Range::FromTo(low, high) => {
                        low + (high - low) * number.clamp(1e-9, 1.0)
                    }
                    _ => number,
                };
                parameters.set_at(row.name, index, number);
            }
        }
        let value = |parameters: &AnyParameters, name| parameters.values(name).first().copied();
        for (low, high) in [("f_c", "f_s"), ("f_s", "f_h"), ("f_2", "f_1")] {
            if let (7.., _) | (_, None) = (choice, value(&parameters, high)) {
                continue;
            }
            if let Some(high) = value(&parameters, high) {
                parameters.set(low, high * ratio);
            }
        }
        parameters
    })
}

fn any_period() -> impl Strategy<Value = TimeStep> {
    prop_oneof![
        3 => (-6.0..=-2.0f64).prop_map(|e| 10f64.powf(e).min(0.01)),
        1 => (-300.0..=-2.0f64).prop_map(|e| 10f64.powf(e).min(0.01)),
        1 => Just(0.01),
    ]
    .prop_map(|seconds| TimeStep::new(seconds).unwrap())
}

/// Any velocity that is accepted, and some that are cut to one.
fn any_velocities() -> impl Strategy<Value = Vec<f64>> {
    let one = prop_oneof![
        6 => (-9.0..=6.0f64, any::<bool>()).prop_map(|(e, back)| {
            10f64.powf(e).min(1e6) * if back { -1.0 } else { 1.0 }
        }),
        1 => (-300.0..=6.0f64).prop_map(|e| 10f64.powf(e)),
        1 => prop::sample::select(vec![0.0, -0.0, 1e6, -1e6, 5e-324, f64::NAN, f64::INFINITY, -1e300]),
    ];
    prop::collection::vec(one, 1..40)
}

/// The first output that is not finite, in words.
struct Run<'a> {
    scheme: Scheme,
    dt: TimeStep,
    path: &'a [f64],
}

impl ModelVisitor for Run<'_> {
    type Output = Option<String>;

    fn visit<M: FrictionModel>(self, model: M) -> Option<String> {
        let mut stepper = Stepper::by(self.scheme, model.clone(), self.dt);
        for &v in self.path {
            let seen = friction_model::arithmetic::bounded(v);
            let inner = stepper.internals(seen);
            let energy = model.stored_energy(stepper.state()).unwrap_or(0.0);
            for (what, value) in [
                ("force", stepper.step(v)),
                ("injected force", stepper.step_injected(v, -seen)),
                ("steady state", model.steady_state(seen)),
                ("viscous", model.viscous(seen)),
                ("deflection", inner.deflection),
                ("gamma", inner.gamma),
                ("energy", energy),
            ] {
                if !value.is_finite() {
                    return Some(format!("{what} {value} at {v}"));
                }
            }
        }
        None
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn what_is_accepted_stays_finite(
        parameters in anywhere(), dt in any_period(), path in any_velocities(),
    ) {
        if let Ok(model) = AnyModel::try_from(parameters) {
            for scheme in [Scheme::Held, Scheme::Mean] {
                let lost = model.visit(Run { scheme, dt, path: &path });
                prop_assert!(lost.is_none(), "{scheme}: {}", lost.unwrap_or_default());
            }
        }
    }
}

/// Enough of the random sets are models: the property says something.
#[test]
fn many_of_the_sets_are_accepted() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;

    let mut runner = TestRunner::deterministic();
    let mut accepted = [0; ModelName::ALL.len()];
    for _ in 0..4000 {
        let parameters = anywhere().new_tree(&mut runner).unwrap().current();
        if let Ok(model) = AnyModel::try_from(parameters) {
            accepted[model.name() as usize] += 1;
        }
    }
    for (name, count) in ModelName::ALL.iter().zip(accepted) {
        assert!(count > 5, "{name}: {count}");
    }
}

/// Each of these is positive and finite, as its row asks; together they leave the numbers.
#[test]
fn parameters_that_lead_out_of_the_numbers_are_refused_with_what_happens() {
    let set = |name: ModelName, values: &[(&str, f64)]| {
        let mut parameters = AnyParameters::test_bed(name);
        for (parameter, value) in values {
            assert!(parameters.set(parameter, *value));
        }
        AnyModel::try_from(parameters).unwrap_err().to_string()
    };
    let said = set(ModelName::LuGre, &[("f_s", 1e-200), ("f_c", 1e-200)]);
    assert!(said.contains("lugre.f_s must be zero or of a magnitude from 1e-50 to 1e50"), "{said}");
    let said = set(ModelName::Leuven, &[("f_h", 1e30), ("f_c", 1e-30), ("n", 20.0)]);
    assert!(said.contains("leuven: with these parameters the force is"), "{said}");
    assert!(said.contains("another unit"), "{said}");
}
