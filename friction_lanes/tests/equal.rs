//! Forces in lanes are those of the scalar step, to rounding.

use friction_lanes::{WIDTH, forces};
use friction_model::{AnyModel, ModelName, Scheme, TimeStep};
use proptest::prelude::*;

/// The models with lanes.
const IN_LANES: [ModelName; 4] =
    [ModelName::LuGre, ModelName::Gms, ModelName::Xiong, ModelName::Proposed];

/// Valid parameters, each up to a factor of ten from one of the presets; the shape exponent and the
/// falling micro-damping of LuGre are now and then not the usual ones. Shares keep their sum.
fn model(name: ModelName) -> impl Strategy<Value = AnyModel> {
    let factors = prop::collection::vec(-1.0..1.0f64, 10);
    let odd = (prop::option::of(0.3..4.0f64), prop::option::of(0.01..1.0f64));
    (any::<bool>(), factors, 0.4..=1.0f64, odd).prop_map(
        move |(test_bed, exponents, ratio, (delta, v_d))| {
            let preset =
                if test_bed { AnyModel::test_bed(name) } else { AnyModel::chapter_3(name) };
            let mut parameters = preset.parameters();
            for (row, exponent) in preset.parameters().table().iter().zip(exponents) {
                if !matches!(row.name, "alpha" | "lambda" | "f_c" | "delta") {
                    parameters.scale(row.name, 10f64.powf(exponent));
                }
            }
            let f_s = parameters.values("f_s")[0];
            parameters.set("f_c", f_s * ratio);
            if let Some(delta) = delta {
                parameters.set("delta", delta);
            }
            if let (Some(v_d), ModelName::LuGre) = (v_d, name) {
                parameters.set("v_d", v_d);
            }
            AnyModel::try_from(parameters).unwrap_or(preset)
        },
    )
}

/// Motions of stretches: rest, a held velocity, a swing through zero, jumps over many decades.
fn motion() -> impl Strategy<Value = Vec<f64>> {
    let stretch = (0..4u8, -6.0..2.0f64, any::<bool>(), 1..40usize, 0.01..1.0f64);
    prop::collection::vec(stretch, 1..12).prop_map(|stretches| {
        let mut velocities = Vec::new();
        for (kind, exponent, back, samples, rate) in stretches {
            let v = 10f64.powf(exponent) * if back { -1.0 } else { 1.0 };
            velocities.extend((0..samples).map(|k| match kind {
                0 => 0.0,
                1 => v,
                2 => v * (rate * k as f64).cos(),
                _ => v * 10f64.powf(4.0 * (7.3 * rate * k as f64).sin()) * (-1f64).powi(k as i32),
            }));
        }
        velocities
    })
}

/// The largest number that the forces of a model are put together from \[N or N m\].
fn scale(model: &AnyModel, velocity: &[f64]) -> f64 {
    let parameters = model.parameters();
    let sum = |name: &str| parameters.values(name).iter().sum::<f64>();
    let fastest = velocity.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let fastest_of_all = fastest.max(sum("c"));
    sum("f_s") + (sum("sigma1") + sum("sigma") + sum("f_v")) * fastest_of_all
}

fn alone(model: &AnyModel, velocity: &[f64], (dt, scheme): (TimeStep, Scheme)) -> Vec<f64> {
    let mut contact = model.start_by(scheme, dt);
    velocity.iter().map(|v| contact.step(*v)).collect()
}

fn in_lanes(models: &[AnyModel], velocity: &[f64], how: (TimeStep, Scheme)) -> Vec<f64> {
    let mut rows = vec![f64::NAN; models.len() * velocity.len()];
    forces(models, velocity, how, &mut rows, || false);
    rows
}

fn agree(models: &[AnyModel], velocity: &[f64], how: (TimeStep, Scheme)) {
    let rows = in_lanes(models, velocity, how);
    for (model, row) in models.iter().zip(rows.chunks(velocity.len())) {
        let (most, alone) = (1e-12 * scale(model, velocity), alone(model, velocity, how));
        let off = |k: usize| (row[k] - alone[k]).abs();
        let Some(k) = (0..row.len()).find(|k| off(*k) > most) else { continue };
        assert!(
            rounding_decides(model, &velocity[..=k], how, most.max(0.1 * off(k))),
            "{:?}, sample {k} at {}: {} in lanes, {} alone: {model:?}",
            how.1,
            velocity[k],
            row[k],
            alone[k]
        );
    }
}

/// Whether a change of the parameters, or of the deflection, in the last digits moves the scalar
/// step's force by more than `much`: a switch stands where rounding throws it. That is an element of
/// GMS that begins to slip, and the deflection of the proposed model that turns back by less than a
/// digit, as it may after a long slip at one velocity.
fn rounding_decides(
    model: &AnyModel,
    velocity: &[f64],
    how: (TimeStep, Scheme),
    much: f64,
) -> bool {
    let before = alone(model, velocity, how);
    let moved = |after: Vec<f64>| before.iter().zip(after).any(|(a, b)| (a - b).abs() > much);
    (1..=64_u32).any(|draw| {
        let off = |place: usize| {
            let digits = f64::from(draw.wrapping_mul(37 + 11 * place as u32) % 9) - 4.0;
            2e-16 * digits
        };
        let mut parameters = model.parameters();
        for (place, row) in model.parameters().table().iter().enumerate() {
            // Shares must sum to one, and levels keep their order.
            if !matches!(row.name, "alpha" | "lambda" | "delta") {
                parameters.scale(row.name, 1.0 + off(place));
            }
        }
        let mut contact = model.start_by(how.1, how.0);
        let nudged = |(k, v): (usize, &f64)| {
            let z = contact.internals(*v).deflection;
            contact.step_injected(*v, off(k) * z / how.0.seconds())
        };
        moved(velocity.iter().enumerate().map(nudged).collect())
            || AnyModel::try_from(parameters).is_ok_and(|model| moved(alone(&model, velocity, how)))
    })
}

/// A tenth of the cases that are asked for: each is up to twenty sets along up to 400 samples.
fn config() -> ProptestConfig {
    let usual = ProptestConfig::default();
    let cases = usual.cases.min(256).max(usual.cases / 10);
    ProptestConfig { cases, failure_persistence: None, ..usual }
}

fn sets() -> impl Strategy<Value = Vec<AnyModel>> {
    prop::sample::select(&IN_LANES[..])
        .prop_flat_map(|name| prop::collection::vec(model(name), 1..WIDTH + 4))
}

fn period() -> impl Strategy<Value = TimeStep> {
    (-5.0..=-2.0f64).prop_map(|e| TimeStep::new(10f64.powf(e).min(0.01)).unwrap())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn lanes_give_what_the_scalar_step_gives(
        models in sets(), velocity in motion(), dt in period(), held in any::<bool>(),
    ) {
        agree(&models, &velocity, (dt, if held { Scheme::Held } else { Scheme::Mean }));
    }

    #[test]
    fn a_set_does_not_depend_on_its_neighbours(
        models in sets(), velocity in motion(), dt in period(), held in any::<bool>(),
    ) {
        let how = (dt, if held { Scheme::Held } else { Scheme::Mean });
        let together = in_lanes(&models, &velocity, how);
        for (model, row) in models.iter().zip(together.chunks(velocity.len())) {
            prop_assert_eq!(row, in_lanes(std::slice::from_ref(model), &velocity, how));
        }
    }
}

/// Long motions with many reversals and inner loops: nothing builds up.
#[test]
fn nothing_builds_up_over_a_long_motion() {
    let velocity: Vec<f64> = (0..30_000)
        .map(|k| {
            let t = 1e-3 * f64::from(k);
            let swing = 0.05 * (2.1 * t).sin() + 0.2 * (0.3 * t).sin() + 0.03 * (31.0 * t).sin();
            if (k / 2500) % 4 == 3 { 0.0 } else { swing }
        })
        .collect();
    let dt = TimeStep::new(1e-3).unwrap();
    for name in IN_LANES {
        for preset in [AnyModel::test_bed(name), AnyModel::chapter_3(name)] {
            let models: Vec<_> =
                (0..20).map(|k| preset.scaled("v_s", 1.0 + 0.05 * f64::from(k)).unwrap()).collect();
            agree(&models, &velocity, (dt, Scheme::Held));
            agree(&models, &velocity, (dt, Scheme::Mean));
        }
    }
}

/// A slip at one velocity until the deflection stands still: whether its last move was back or forth
/// is a matter of its last digit, and with it the slope from which the next one starts.
#[test]
fn a_long_slip_that_ends_agrees_or_rounding_decides() {
    let mut model = AnyModel::test_bed(ModelName::Proposed).parameters();
    for (name, value) in [
        ("f_s", 0.05086202077121477),
        ("f_c", 0.047745904173639955),
        ("v_s", 0.0871127010637665),
        ("delta", 0.8412960909317256),
        ("sigma", 0.08349709887063919),
        ("tau", 0.0009715680585666313),
        ("z_b", 0.0018710718285269484),
        ("f_v", 0.0403),
    ] {
        model.set(name, value);
    }
    let model = AnyModel::try_from(model).unwrap();
    for samples in 1..200 {
        let mut velocity = vec![0.07904188592096745; samples];
        velocity.push(0.0);
        let how = (TimeStep::new(0.009430712560706133).unwrap(), Scheme::Mean);
        agree(&[model], &velocity, how);
    }
}

/// Every other model is stepped alone, and kinds may be mixed.
#[test]
fn any_models_can_be_given() {
    let velocity: Vec<f64> = (0..300).map(|k| 0.3 * (0.05 * f64::from(k)).sin()).collect();
    let how = (TimeStep::new(1e-3).unwrap(), Scheme::Mean);
    let mut models: Vec<_> = ModelName::ALL.into_iter().map(AnyModel::test_bed).collect();
    models.push(AnyModel::chapter_3(ModelName::Gms));
    models.push(AnyModel::asymmetric(&models[8], &AnyModel::chapter_3(models[8].name())).unwrap());
    agree(&models, &velocity, how);
}

#[test]
fn what_a_broken_sensor_gives_counts_as_for_one_contact() {
    let velocity = [0.1, f64::NAN, f64::INFINITY, -1e300, 0.0, -0.0, 1e-310, 0.2];
    let dt = TimeStep::new(1e-3).unwrap();
    for name in IN_LANES {
        for scheme in [Scheme::Held, Scheme::Mean] {
            let model = AnyModel::test_bed(name);
            let rows = in_lanes(&[model], &velocity, (dt, scheme));
            let most = 1e-12 * scale(&model, &[1e6]);
            for (lane, scalar) in rows.iter().zip(alone(&model, &velocity, (dt, scheme))) {
                assert!((lane - scalar).abs() <= most, "{name}: {lane} {scalar}");
            }
        }
    }
}

#[test]
fn it_ends_when_told_and_leaves_out_what_has_no_room() {
    let models = [AnyModel::test_bed(ModelName::LuGre); 3];
    let how = (TimeStep::new(1e-3).unwrap(), Scheme::Held);
    let mut rows = [7.0; 9];
    forces(&models, &[0.1; 3], how, &mut rows, || true);
    assert_eq!(rows, [7.0; 9]);
    let mut short = [7.0; 4];
    forces(&models, &[0.1; 3], how, &mut short, || false);
    assert!(short.iter().all(|force| *force < 1.0), "{short:?}");
    forces(&models, &[], how, &mut short, || false);
    forces(&[], &[0.1], how, &mut short, || false);
}
