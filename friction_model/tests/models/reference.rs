//! Pointwise comparison with an independent implementation (see `reference/README.md`).

use friction_model::{
    ElastoPlastic, FrictionModel, Gms, Hysteresis, LuGre, Proposed, Stepper, TimeStep, Xiong, rk4,
};

/// A column of a reference file by name.
fn column(text: &str, name: &str) -> Vec<f64> {
    let mut lines = text.lines();
    let index = lines.next().unwrap().split(',').position(|head| head == name).unwrap();
    lines.map(|line| line.split(',').nth(index).unwrap().parse().unwrap()).collect()
}

/// Largest difference between the model's force and the reference, stepping by RK4 between the
/// reference's samples.
fn largest_difference<M: FrictionModel>(
    model: &M,
    velocity: impl Fn(f64) -> f64,
    reference: &[f64],
    steps_per_sample: u32,
) -> f64 {
    let dt = 0.01 / f64::from(steps_per_sample);
    let mut state = model.rest();
    let mut worst: f64 = (model.evaluate(&state.continuous, &state.memory, velocity(0.0)).force
        - reference[0])
        .abs();
    let mut k = 0u32;
    for expected in &reference[1..] {
        let mut force = 0.0;
        for _ in 0..steps_per_sample {
            let t = f64::from(k) * dt;
            force = rk4::step(
                model,
                &mut state,
                [velocity(t), velocity(t + 0.5 * dt), velocity(t + dt)],
                dt,
            );
            k += 1;
        }
        worst = worst.max((force - expected).abs());
    }
    worst
}

fn chapter_3_velocity(t: f64) -> f64 {
    0.02 * (2.0 * t).sin() + 0.005 * (11.0 * t).sin()
}

fn test_bed_velocity(t: f64) -> f64 {
    0.3 * (1.5 * t).sin() + 0.05 * (9.0 * t).sin()
}

#[test]
fn lugre_follows_the_reference() {
    let reference = column(include_str!("../reference/ref_ch3.csv"), "LuGre");
    assert!(largest_difference(&LuGre::chapter_3(), chapter_3_velocity, &reference, 1000) < 1e-6);
    let reference = column(include_str!("../reference/ref_testbed.csv"), "LuGre");
    assert!(largest_difference(&LuGre::test_bed(), test_bed_velocity, &reference, 1000) < 1e-6);
}

#[test]
fn proposed_follows_the_reference() {
    let reference = column(include_str!("../reference/ref_ch3.csv"), "Proposed");
    assert!(
        largest_difference(&Proposed::chapter_3(), chapter_3_velocity, &reference, 1000) < 1e-6
    );
    let reference = column(include_str!("../reference/ref_testbed.csv"), "Proposed");
    assert!(largest_difference(&Proposed::test_bed(), test_bed_velocity, &reference, 1000) < 1e-6);
}

#[test]
fn elasto_plastic_follows_the_reference() {
    let reference = column(include_str!("../reference/ref_ch3.csv"), "EP");
    assert!(
        largest_difference(&ElastoPlastic::chapter_3(), chapter_3_velocity, &reference, 1000)
            < 1e-6
    );
}

/// Elements change regime at the end of a step: both implementations are of first order in it
/// there.
#[test]
fn gms_follows_the_reference() {
    let reference = column(include_str!("../reference/ref_ch3.csv"), "GMS10");
    let difference = largest_difference(&Gms::chapter_3(), chapter_3_velocity, &reference, 2000);
    assert!(difference < 1e-4, "{difference} N");
    let reference = column(include_str!("../reference/ref_testbed.csv"), "GMS");
    let difference = largest_difference(&Gms::test_bed(), test_bed_velocity, &reference, 1000);
    assert!(difference < 1e-4, "{difference} N m");
}

#[test]
fn xiong_follows_the_reference() {
    let reference = column(include_str!("../reference/ref_ch3.csv"), "Xiong10");
    let difference = largest_difference(&Xiong::chapter_3(), chapter_3_velocity, &reference, 1000);
    assert!(difference < 1e-6, "{difference} N");
    let reference = column(include_str!("../reference/ref_testbed.csv"), "Xiong");
    let difference = largest_difference(&Xiong::test_bed(), test_bed_velocity, &reference, 1000);
    assert!(difference < 1e-6, "{difference} N m");
}

#[test]
fn the_hysteresis_follows_the_reference() {
    let text = include_str!("../reference/ref_hyst.csv");
    let (z, expected) = (column(text, "z_over_Zb"), column(text, "F_over_Fs"));
    let model = Proposed::test_bed();
    let p = model.parameters();
    let mut memory = Hysteresis::default();
    assert_eq!(z.len(), 400);
    for (z, expected) in z.iter().zip(&expected) {
        let force = model.hysteresis_force(&mut memory, z * p.z_b) / p.f_s;
        assert!((force - expected).abs() < 1e-12, "z/Zb {z}: {force} is not {expected}");
    }
}

/// What the 1 kHz observer gives away against the exact trajectory, and that it is of first order
/// in the period.
fn fixed_step_error<M: FrictionModel>(model: M, column_name: &str, dt: f64) -> f64 {
    let reference = column(include_str!("../reference/ref_testbed.csv"), column_name);
    let steps = (0.01 / dt).round() as usize;
    let mut stepper = Stepper::new(model, TimeStep::new(dt).unwrap());
    let mut worst = 0.0f64;
    for (k, expected) in reference.iter().enumerate() {
        for j in 0..steps {
            let t = (k * steps + j) as f64 * dt;
            let force = stepper.step(test_bed_velocity(t));
            if j == 0 {
                worst = worst.max((force - expected).abs());
            }
        }
    }
    worst
}

#[test]
fn the_fixed_step_form_converges_to_the_reference() {
    fn both<M: FrictionModel>(model: &M, column: &str) -> (f64, f64) {
        (
            fixed_step_error(model.clone(), column, 1e-3),
            fixed_step_error(model.clone(), column, 1e-4),
        )
    }
    for (at_1_ms, at_a_tenth) in [
        both(&LuGre::test_bed(), "LuGre"),
        both(&Proposed::test_bed(), "Proposed"),
        both(&Gms::test_bed(), "GMS"),
        both(&Xiong::test_bed(), "Xiong"),
    ] {
        assert!(at_1_ms < 0.02 * 0.0994, "at 1 ms: {at_1_ms} N m");
        assert!(at_a_tenth < 0.15 * at_1_ms, "{at_a_tenth} is not a tenth of {at_1_ms}");
    }
}
