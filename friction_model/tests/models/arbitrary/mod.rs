//! Random parameter sets, motions and periods for the property tests.

use friction_model::{AnyModel, AnyParameters, ModelName, TimeStep};
use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;

/// Two thousand cases, unless `PROPTEST_CASES` says otherwise; what once failed is kept in a file
/// beside the test and tried again first.
pub fn config() -> ProptestConfig {
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() {
        ProptestConfig::default().cases
    } else {
        2000
    };
    ProptestConfig {
        cases,
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..ProptestConfig::default()
    }
}

/// Valid parameters of one model, each up to a factor of 30 from one of the presets. A factor that
/// would make the set invalid is left out; the levels and the shares of elements keep their order
/// and their sum.
pub fn model(name: ModelName) -> impl Strategy<Value = AnyModel> {
    let factors = prop::collection::vec(-1.5..1.5f64, AnyParameters::test_bed(name).table().len());
    (any::<bool>(), factors, 0.4..=1.0f64).prop_map(move |(test_bed, exponents, ratio)| {
        let preset = if test_bed { AnyModel::test_bed(name) } else { AnyModel::chapter_3(name) };
        let mut model = preset;
        for (row, exponent) in preset.parameters().table().iter().zip(exponents) {
            if matches!(row.name, "alpha" | "lambda" | "f_c") {
                continue;
            }
            model = model.scaled(row.name, 10f64.powf(exponent)).unwrap_or(model);
        }
        // Some levels closer together, or equal.
        let mut parameters = model.parameters();
        if let Some(f_s) = model.parameter("f_s")
            && model.parameter("f_c").is_some()
        {
            parameters.set("f_c", f_s * ratio);
            model = parameters.try_into().unwrap_or(model);
        }
        model
    })
}

/// Any of `names`, with random parameters.
pub fn model_of(names: &'static [ModelName]) -> impl Strategy<Value = AnyModel> {
    prop::sample::select(names).prop_flat_map(model)
}

/// Any model at all, with random parameters; now and then with other parameters backward.
pub fn any_model() -> impl Strategy<Value = AnyModel> {
    let one = prop::sample::select(&ModelName::ALL[..])
        .prop_flat_map(|name| (model(name), model(name), 0..4u8));
    one.prop_map(|(forward, backward, choice)| match choice {
        0 => AnyModel::asymmetric(&forward, &backward).unwrap_or(forward),
        _ => forward,
    })
}

/// Any symmetric model but the bristles, whose bonds are drawn at random: they are odd on average
/// only.
pub fn odd_model() -> impl Strategy<Value = AnyModel> {
    let names: Vec<_> =
        ModelName::ALL.into_iter().filter(|&name| name != ModelName::Bristle).collect();
    prop::sample::select(names).prop_flat_map(model)
}

/// Velocities over many decades, both signs, as a sampled motion may throw at an observer.
pub fn velocities() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec((-6.0..6.0f64, any::<bool>()), 1..300).prop_map(|v| {
        v.into_iter().map(|(e, back)| if back { -10f64.powf(e) } else { 10f64.powf(e) }).collect()
    })
}

/// Any valid period.
pub fn period() -> impl Strategy<Value = TimeStep> {
    (-5.0..=-2.0f64).prop_map(|e| TimeStep::new(10f64.powf(e).min(0.01)).unwrap())
}
