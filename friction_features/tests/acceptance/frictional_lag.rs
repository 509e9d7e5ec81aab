//! Section 5.5.

use std::f64::consts::{PI, TAU};

use friction_features::{Contact, FrictionalLag, FrictionalLagSettings, frictional_lag};
use friction_model::{AnyModel, ModelName};

use crate::{assert_relative, chapter_3, from_file};

/// Table 4.8, with the time constant as the tables 4.8 and 4.13 give it, and the bristles of table
/// 4.13.
fn table_4_8(tau: f64) -> Contact {
    from_file(&format!(
        r#"{{"proposed": {{"f_s": 0.0986, "f_c": 0.0925, "v_s": 0.1526, "sigma": 0.3213, "tau": {tau}, "z_b": 0.006, "f_v": 0.0403}}}}"#
    ))
}

/// Table 4.13, with its ten times smaller time constant.
fn test_bed() -> Contact {
    Contact::new(&AnyModel::test_bed(ModelName::Proposed))
}

/// Table 4.9.
fn table_4_9() -> Contact {
    from_file(
        r#"{"lugre": {"f_s": 0.0994, "f_c": 0.0929, "v_s": 0.1468, "sigma0": 15, "sigma1": 0.1307, "f_v": 0.0603}}"#,
    )
}

/// Table 4.10: the shares sum to .6 there, so a quarter each of .6 times the levels.
fn table_4_10(sigma1: f64) -> Contact {
    from_file(&format!(
        r#"{{"gms": {{"f_s": 0.0988, "f_c": 0.0924, "v_s": 0.1536, "alpha": [0.25, 0.25, 0.25, 0.25],
            "sigma0": [15, 15, 15, 15], "sigma1": [{sigma1}, {sigma1}, {sigma1}, {sigma1}],
            "c": [0.6539, 0.6539, 0.6539, 0.6539], "f_v": 0.0403}}}}"#
    ))
}

/// Table 4.11 with its consistent `F_s`, the shares over their sum, and the bristles of table 4.16.
fn table_4_11() -> Contact {
    let [large, small] = [0.2998 / 0.9999, 0.1005 / 0.9999];
    from_file(&format!(
        r#"{{"xiong": {{"f_s": 0.10057, "f_c": 0.09237, "v_s": 0.13121, "tau": 0.0124,
            "lambda": [{large}, {large}, {large}, {small}], "k": [10.9915, 2.7836, 1.9866, 0.7792],
            "sigma": [0.1964, 0.0788, 0.0603, 0.0227], "f_v": 0.0403}}}}"#
    ))
}

fn lags(contact: &Contact, frequencies: &[f64]) -> Vec<FrictionalLag> {
    let settings = FrictionalLagSettings {
        frequencies: frequencies.to_vec(),
        ..FrictionalLagSettings::default()
    };
    frictional_lag(contact, &settings)
}

fn finely(contact: &Contact, settings: &FrictionalLagSettings, step: f64) -> Vec<FrictionalLag> {
    frictional_lag(contact, &FrictionalLagSettings { step: Some(step), ..settings.clone() })
}

/// A first-order lag of `g(v(t))`, exactly: `g` along the period is an even function of the phase,
/// `sum_n g_n cos(n w t)`, and each harmonic comes through the lag as
/// `g_n (cos + n w tau sin) / (1 + (n w tau)^2)`. The area of the loop against `-amplitude cos`
/// takes the first sine alone; its width at the phase p is twice the sum of the sines.
struct FirstOrderLag {
    area: f64,
    widest: f64,
}

impl FirstOrderLag {
    fn of(g: impl Fn(f64) -> f64, settings: &FrictionalLagSettings, omega: f64, tau: f64) -> Self {
        const SAMPLES: usize = 4096;
        const HARMONICS: usize = 400;
        let phase = |k: usize| TAU * k as f64 / SAMPLES as f64;
        let samples: Vec<f64> =
            (0..SAMPLES).map(|k| g(settings.mean - settings.amplitude * phase(k).cos())).collect();
        let sines: Vec<f64> = (1..=HARMONICS)
            .map(|n| {
                let sum: f64 =
                    samples.iter().enumerate().map(|(k, g)| g * phase(n * k % SAMPLES).cos()).sum();
                let lag = n as f64 * omega * tau;
                2.0 * sum / SAMPLES as f64 * lag / (1.0 + lag * lag)
            })
            .collect();
        let width = |k: usize| {
            2.0 * sines
                .iter()
                .enumerate()
                .map(|(i, b)| b * phase((i + 1) * k % SAMPLES).sin())
                .sum::<f64>()
        };
        Self {
            area: PI * settings.amplitude * sines[0],
            widest: (0..SAMPLES / 2).map(width).fold(0.0, f64::max),
        }
    }
}

fn stribeck(f_s: f64, f_c: f64, v_s: f64) -> impl Fn(f64) -> f64 {
    move |v| f_c + (f_s - f_c) * (-(v / v_s) * (v / v_s)).exp()
}

#[test]
fn the_proposed_model_and_xiongs_lag_as_the_exact_first_order_lag() {
    let test_bed = FrictionalLagSettings::default();
    let chapter = FrictionalLagSettings::chapter_3();
    for (what, contact, settings, g, tau, step) in [
        ("proposed", table_4_8(0.0111), &test_bed, stribeck(0.0986, 0.0925, 0.1526), 0.0111, 2e-4),
        (
            "proposed, fast",
            table_4_8(0.0011),
            &test_bed,
            stribeck(0.0986, 0.0925, 0.1526),
            0.0011,
            2e-4,
        ),
        ("Xiong", table_4_11(), &test_bed, stribeck(0.10057, 0.09237, 0.13121), 0.0124, 2e-4),
        (
            "proposed, ch. 3",
            chapter_3(ModelName::Proposed),
            &chapter,
            stribeck(1.5, 1.0, 0.01),
            0.002,
            2e-4,
        ),
        (
            "Xiong, ch. 3",
            chapter_3(ModelName::Xiong),
            &chapter,
            stribeck(1.5, 1.0, 0.01),
            0.002,
            2e-4,
        ),
    ] {
        for result in finely(&contact, settings, step) {
            let exact = FirstOrderLag::of(&g, settings, result.frequency, tau);
            let at = format!("{what} at {} rad/s", result.frequency);
            assert_relative(&format!("{at}, area"), result.area, exact.area, 1e-5);
            assert_relative(&format!("{at}, width"), result.widest, exact.widest, 1e-4);
            assert!(result.narrowest >= 0.0, "{at}: the loop does not cross itself");
        }
    }
}

#[test]
fn areas_and_widths_are_those_of_the_independent_implementation() {
    let proposed = lags(&table_4_8(0.0111), &[1.0, 2.0, 5.0, 10.0]);
    let areas = [4.7228e-5, 9.4420e-5, 2.35442e-4, 4.66586e-4];
    let widths = [2.82e-4, 5.58e-4, 1.304e-3, 2.221e-3];
    for ((result, area), width) in proposed.iter().zip(areas).zip(widths) {
        assert_relative("proposed, area", result.area, area, 1e-4);
        assert_relative("proposed, width", result.widest, width, 2e-3);
        assert!(result.evidence.holds_to(1e-4), "{:?}", result.evidence);
    }
    for (what, contact, areas) in [
        ("proposed, tau .0011", test_bed(), [9.87e-6, 2.4665e-5, 4.9326e-5]),
        ("Xiong", table_4_11(), [1.2385e-4, 3.0863e-4, 6.1026e-4]),
        ("LuGre", table_4_9(), [2.631e-4, 4.181e-4, 4.561e-4]),
    ] {
        for (result, area) in lags(&contact, &[2.0, 5.0, 10.0]).iter().zip(areas) {
            assert_relative(&format!("{what}, area"), result.area, area, 4e-4);
        }
    }
}

/// The larger the frequency, the more the proposed model lags; LuGre's loop is widest in between.
#[test]
fn only_lugres_width_is_not_monotone() {
    let widths = |contact: &Contact| {
        lags(contact, &[1.0, 2.0, 5.0, 10.0]).iter().map(|l| l.widest).collect::<Vec<_>>()
    };
    let rises = |widths: &[f64]| widths.windows(2).all(|pair| pair[1] > pair[0]);
    assert!(rises(&widths(&table_4_8(0.0111))) && rises(&widths(&table_4_11())));
    assert!(!rises(&widths(&table_4_9())), "{:?}", widths(&table_4_9()));
}

/// The `sigma1 z'` term of slipping elements runs the loop backwards; without it the lag has the
/// measured sense.
#[test]
fn the_damping_of_gms_reverses_its_loop() {
    for (result, area) in
        lags(&table_4_10(0.0686), &[2.0, 5.0, 10.0]).iter().zip([-1.9e-5, -4.9e-5, -9.7e-5])
    {
        assert_relative("GMS, area", result.area, area, 0.03);
    }
    assert!(lags(&table_4_10(0.0), &[2.0, 5.0, 10.0]).iter().all(|result| result.area > 1e-6));
}

#[test]
fn the_chapter_3_sets_lag_as_the_independent_implementation() {
    let lag =
        |name| frictional_lag(&chapter_3(name), &FrictionalLagSettings::chapter_3()).remove(0);
    for name in [ModelName::Proposed, ModelName::Xiong] {
        assert_relative(name.title(), lag(name).area, 5.671e-5, 1e-4);
    }
    let lugre = lag(ModelName::LuGre);
    assert_relative("LuGre", lugre.area, -4.217e-5, 2e-4);
    assert!(lugre.widest > 1e-3 && lugre.narrowest < -1e-3, "its loop crosses itself");
    assert_relative("GMS", lag(ModelName::Gms).area, -8.6e-3, 0.006);
}

#[test]
fn models_whose_force_depends_on_the_velocity_alone_do_not_lag() {
    for name in [ModelName::Coulomb, ModelName::Viscous, ModelName::Stribeck] {
        for result in lags(&chapter_3(name), &[1.0, 10.0]) {
            assert_eq!((result.area, result.widest, result.narrowest), (0.0, 0.0, 0.0), "{name}");
        }
    }
}
