//! Section 11.

use friction_features::{
    BreakawaySettings, Elasticities, Sensitivity, SensitivitySettings, sensitivity,
};
use friction_model::{AnyModel, ModelName};

use crate::assert_close;

fn of(name: ModelName) -> Sensitivity {
    sensitivity(&AnyModel::chapter_3(name), &SensitivitySettings::default())
}

fn elasticities(of: &Sensitivity, parameter: &str) -> Elasticities {
    of.parameters.iter().find(|p| p.parameter == parameter).unwrap().elasticities.unwrap()
}

/// Parameter; printed elasticities of the breakaway force, the breakaway displacement and the lag;
/// half a unit of each printed last digit, and a fifth of it for what the independent
/// implementation's steps may add.
type Row = (&'static str, [(f64, f64); 3]);

#[track_caller]
fn assert_elasticities(name: &str, result: &Sensitivity, rows: &[Row]) {
    for (parameter, expected) in rows {
        let found = elasticities(result, parameter);
        let found = [found.breakaway_force, found.breakaway_displacement, found.lag_area];
        for ((value, (expected, unit)), what) in
            found.iter().zip(expected).zip(["breakaway force", "breakaway displacement", "lag"])
        {
            let what = format!("{name}, {what} by {parameter}");
            assert_close(
                &what,
                value.unwrap_or_else(|| panic!("{what}: none")),
                *expected,
                0.7 * unit,
            );
        }
    }
}

#[test]
fn the_proposed_model_is_as_sensitive_as_the_independent_implementation() {
    let result = of(ModelName::Proposed);
    assert_elasticities(
        "proposed",
        &result,
        &[
            ("sigma", [(4e-5, 1e-5), (-0.06, 0.01), (0.0, 1e-9)]),
            ("v_s", [(2e-4, 1e-4), (0.0, 0.01), (0.35, 0.01)]),
            ("z_b", [(-1e-4, 1e-4), (0.94, 0.01), (0.0, 1e-9)]),
            ("tau", [(0.0, 1e-5), (0.0, 0.01), (1.0, 0.1)]),
        ],
    );
    assert_close("rms", result.rms_elasticity.unwrap(), 0.41, 0.005);
}

#[test]
fn lugre_is_as_sensitive_as_the_independent_implementation() {
    let result = of(ModelName::LuGre);
    let sigma0 = elasticities(&result, "sigma0");
    assert_close("force by sigma0", sigma0.breakaway_force.unwrap(), 0.001, 0.0006);
    assert_close("displacement by sigma0", sigma0.breakaway_displacement.unwrap(), -0.85, 0.006);
    assert_close("lag by sigma0", sigma0.lag_area.unwrap(), -1.0, 0.06);
    let v_s = elasticities(&result, "v_s");
    assert_close("force by v_s", v_s.breakaway_force.unwrap(), 0.001, 0.0006);
    assert_close("displacement by v_s", v_s.breakaway_displacement.unwrap(), 0.18, 0.006);
    let sigma1 = result.parameters.iter().find(|p| p.parameter == "sigma1").unwrap();
    assert!(sigma1.lag_reverses, "the loop crosses itself and changes its sense");
    assert_eq!(sigma1.elasticities.unwrap().lag_area, None);
    assert_close("rms", result.rms_elasticity.unwrap(), 0.87, 0.006);
}

/// What is printed for all parameters but the shares.
const XIONG: [Row; 4] = [
    ("k", [(0.0, 0.01), (-1.0, 0.1), (0.0, 0.01)]),
    ("sigma", [(0.0, 0.01), (0.0, 0.01), (0.0, 0.01)]),
    ("v_s", [(0.0, 0.01), (0.0, 0.01), (0.35, 0.01)]),
    ("tau", [(0.0, 0.01), (0.0, 0.01), (1.0, 0.1)]),
];
const GMS: [Row; 4] = [
    ("sigma0", [(-0.01, 0.01), (-0.80, 0.01), (-0.62, 0.01)]),
    ("sigma1", [(0.06, 0.01), (0.0, 0.01), (1.8, 0.1)]),
    ("c", [(-0.03, 0.01), (-0.18, 0.01), (1.07, 0.01)]),
    ("v_s", [(0.11, 0.01), (0.59, 0.01), (0.31, 0.01)]),
];

/// Contacts of doubled level break away too when the ramp goes far enough: the force is then
/// proportional to the level, and so are the displacements of an elastic loading.
#[test]
fn shares_scale_breakaway_in_proportion() {
    let xiong = of(ModelName::Xiong);
    assert_elasticities("Xiong", &xiong, &XIONG);
    assert_elasticities("Xiong", &xiong, &[("lambda", [(1.0, 0.01), (1.0, 0.01), (1.0, 0.01)])]);
    assert_close("rms of Xiong", xiong.rms_elasticity.unwrap(), 0.584, 0.002);
    let gms = of(ModelName::Gms);
    assert_elasticities("GMS", &gms, &GMS);
    assert_elasticities("GMS", &gms, &[("alpha", [(0.91, 0.01), (0.85, 0.01), (-0.07, 0.01)])]);
    assert_close("rms of GMS", gms.rms_elasticity.unwrap(), 0.712, 0.002);
}

/// The printed figures for the shares, +.67 and +.66 for the force: the ramp ended at 1.9 N, short
/// of the doubled level of 3 N, so the contact never broke away and the "breakaway" displacement
/// was that of an elastic contact under 1.9 N. Here such a contact has no displacement at
/// breakaway.
#[test]
fn the_printed_figures_for_the_shares_are_those_of_a_contact_that_did_not_break_away() {
    let breakaway =
        BreakawaySettings { limit: 1.9, rates: vec![0.1], ..BreakawaySettings::default() };
    let settings = SensitivitySettings { breakaway, reach: 0.0, ..SensitivitySettings::default() };
    for (name, parameter, force, displacement, stiffness) in [
        (ModelName::Xiong, "lambda", 0.67, -0.39, 46_000.0),
        (ModelName::Gms, "alpha", 0.66, 0.26, 460.0),
    ] {
        let result = sensitivity(&AnyModel::chapter_3(name), &settings);
        let shares = result.parameters.iter().find(|p| p.parameter == parameter).unwrap();
        let found = shares.elasticities.unwrap();
        assert_close(name.title(), found.breakaway_force.unwrap(), force, 0.006);
        assert_eq!(found.breakaway_displacement, None);
        let broken = shares.responses[0].unwrap().breakaway_displacement.unwrap();
        let elastic = (1.9 / stiffness / broken).ln() / 4.0f64.ln();
        assert_close(name.title(), elastic, displacement, 0.03);
    }
}

#[test]
fn the_proposed_model_is_the_least_sensitive_and_lugre_the_most() {
    let rms = [ModelName::Proposed, ModelName::Xiong, ModelName::Gms, ModelName::LuGre]
        .map(|name| of(name).rms_elasticity.unwrap());
    assert!(rms.windows(2).all(|pair| pair[0] < pair[1]), "{rms:?}");
}

/// `f_s` cannot be halved below `f_c`; the elasticities are then left out and do not count.
#[test]
fn what_is_no_valid_model_is_left_out() {
    let result = of(ModelName::Stribeck);
    let f_s = result.parameters.iter().find(|p| p.parameter == "f_s").unwrap();
    assert!(f_s.responses[0].is_none() && f_s.responses[1].is_some() && f_s.elasticities.is_none());
    assert!(!result.parameters.iter().any(|p| p.parameter == "f_v"), "it is zero there");
    let v_s = elasticities(&result, "v_s");
    assert_eq!(
        (v_s.breakaway_displacement, v_s.lag_area),
        (None, None),
        "a static model has neither"
    );
    // Coulomb's one parameter is a level: its force is in proportion to it, and nothing counts.
    let coulomb = of(ModelName::Coulomb);
    assert_close("force", elasticities(&coulomb, "f_c").breakaway_force.unwrap(), 1.0, 1e-6);
    assert_eq!(coulomb.rms_elasticity, None);
}
