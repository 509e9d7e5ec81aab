//! Section 5.1.

use std::f64::consts::PI;

use friction_features::{Motion, StickSlip, StickSlipSettings, stick_slip};
use friction_model::ModelName;

use crate::{assert_close, assert_relative, chapter_3, chapter_3_with};

fn at_step(name: ModelName, step: f64) -> StickSlip {
    stick_slip(
        &chapter_3(name),
        &StickSlipSettings { step: Some(step), ..StickSlipSettings::default() },
    )
}

/// Mass on a spring between two levels: while it slips, `m x'' = K (v0 t - x) - F_c`, so in the
/// frame of the spring's end it swings harmonically about the stretch `F_c / K`. It starts at rest
/// with `a = (F_s - F_c) / K` more than that, and comes to rest again when it has swung through all
/// of the circle but twice the angle `atan(a w / v0)`. Then the spring must be stretched by `2 a`
/// at the speed v0 until it breaks away again.
#[test]
fn two_levels_give_the_cycle_of_the_closed_form() {
    let result = at_step(ModelName::Stiction, 1e-5);
    let (m, k, v0, f_s, f_c) = (1.0f64, 2.0f64, 0.1f64, 1.5f64, 1.0f64);
    let (w, a) = ((k / m).sqrt(), (f_s - f_c) / k);
    let slip = (2.0 * PI - 2.0 * (a * w / v0).atan()) / w;
    let stick = 2.0 * (f_s - f_c) / (k * v0);
    assert_close("the closed form itself", slip + stick, 7.611259, 1e-6);
    assert_relative("period", result.period.unwrap(), slip + stick, 1e-5);
    let radius = a.hypot(v0 / w);
    assert_relative("largest spring force", result.spring_max, f_c + k * radius, 1e-5);
    assert_relative("smallest spring force", result.spring_min, f_c - k * radius, 1e-5);
    assert_relative("peak velocity", result.velocity_max, v0 + w * radius, 1e-5);
    assert_relative("largest friction", result.friction_max, f_s, 1e-5);
    // At rest, and slower than v0/10 just after breakaway and just before rest: the angle from -v0
    // to -.9 v0 on the circle, twice.
    let angle = (v0 / (w * radius)).asin() - (0.9 * v0 / (w * radius)).asin();
    let rest = (stick + 2.0 * angle / w) / (slip + stick);
    assert_relative("share of rest", result.share_of_rest.unwrap(), rest, 2e-4);
    assert_eq!(result.motion, Motion::StickSlip);
}

/// The same cycle from Karnopp's model, with a Stribeck velocity far below every velocity of the
/// cycle.
#[test]
fn karnopps_model_gives_the_cycle_of_two_levels() {
    let contact = chapter_3_with(ModelName::Karnopp, &[("v_s", 1e-9)]);
    let result = stick_slip(
        &contact,
        &StickSlipSettings { step: Some(1e-4), ..StickSlipSettings::default() },
    );
    let printed = [7.6117, 1.51963, 0.48031, 0.46746, 1.5000];
    let found = [
        result.period.unwrap(),
        result.spring_max,
        result.spring_min,
        result.velocity_max,
        result.friction_max,
    ];
    for (value, printed) in found.into_iter().zip(printed) {
        assert_relative("Karnopp, two levels", value, printed, 5e-4);
    }
}

/// Without a static level above the kinetic one nothing makes it stick: from rest the mass swings
/// about v0 for ever and touches zero once a period.
#[test]
fn coulomb_friction_alone_does_not_stick() {
    let result = at_step(ModelName::Coulomb, 1e-4);
    assert_eq!(result.motion, Motion::Vibration);
    assert_relative("period", result.period.unwrap(), 2.0 * PI / 2.0f64.sqrt(), 1e-6);
    assert_relative("share of rest", result.share_of_rest.unwrap(), 0.9f64.acos() / PI, 1e-3);
}

#[test]
fn viscous_friction_ends_in_smooth_sliding() {
    let contact = chapter_3_with(ModelName::Viscous, &[("f_v", 1.0)]);
    let result = stick_slip(&contact, &StickSlipSettings::default());
    assert_eq!((result.motion, result.period), (Motion::Smooth, None));
    assert_relative("spring", result.spring_max, 0.1, 1e-3);
}

/// Model, step [s]; period [s], largest and smallest spring force [N], peak velocity [m/s], largest
/// friction [N]; tolerance.
const TABLE: [(ModelName, f64, [f64; 5], f64); 7] = [
    (ModelName::Karnopp, 1e-4, [7.9236, 1.5517, 0.4483, 0.4902, 1.5], 5e-4),
    (ModelName::Stribeck, 1e-4, [7.9236, 1.5517, 0.4483, 0.4902, 1.5], 5e-4),
    (ModelName::LuGre, 1e-5, [7.8867, 1.547867, 0.452133, 0.487401, 1.4975], 5e-4),
    (ModelName::ElastoPlastic, 1e-5, [7.8876, 1.547987, 0.452013, 0.487485, 1.4976], 5e-4),
    (ModelName::Proposed, 1e-4, [7.92748, 1.551939, 0.448061, 0.490280, 1.49996], 5e-4),
    (ModelName::Gms, 1e-4, [8.3487, 1.58088, 0.34238, 0.56200, 2.0792], 2e-3),
    (ModelName::Xiong, 1e-4, [7.9146, 1.550754, 0.449246, 0.489442, 1.49972], 5e-4),
];

#[test]
fn every_model_stick_slips_as_the_independent_implementation() {
    for (name, step, [period, spring_max, spring_min, velocity_max, friction_max], tolerance) in
        TABLE
    {
        let result = at_step(name, step);
        assert_eq!(result.motion, Motion::StickSlip, "{name}");
        for (what, value, expected) in [
            ("period", result.period.unwrap(), period),
            ("largest spring force", result.spring_max, spring_max),
            ("smallest spring force", result.spring_min, spring_min),
            ("peak velocity", result.velocity_max, velocity_max),
            ("largest friction", result.friction_max, friction_max),
        ] {
            assert_relative(&format!("{name}, {what}"), value, expected, tolerance);
        }
    }
}

/// At 0.1 ms LuGre does not blow up, it gives another cycle. The step that is found by halving must
/// not be deceived.
#[test]
fn the_step_found_by_halving_is_small_enough_where_a_larger_one_is_silently_wrong() {
    let wrong = at_step(ModelName::LuGre, 1e-4);
    assert_relative("wrong period", wrong.period.unwrap(), 7.08, 1e-3);
    assert_relative("wrong peak velocity", wrong.velocity_max, 0.304, 0.02);
    let found = stick_slip(&chapter_3(ModelName::LuGre), &StickSlipSettings::default());
    assert!(found.evidence.step < 5e-5 && found.evidence.holds_to(1e-6), "{:?}", found.evidence);
    assert_relative("period", found.period.unwrap(), 7.886745, 1e-6);
}

#[test]
fn the_course_is_thin_and_shows_the_whole_run() {
    let course = at_step(ModelName::Proposed, 1e-3).course;
    let length = course.time.len();
    assert!((250..=500).contains(&length), "{length}");
    for column in [&course.spring, &course.friction, &course.velocity] {
        assert_eq!(column.len(), length);
        assert!(column.iter().all(|value| value.is_finite()));
    }
    assert!(course.time[0] == 0.0 && *course.time.last().unwrap() > 59.0);
}
