//! Trails of a known load.

use super::*;

const SPEEDS: [f64; 8] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0];

/// Blocks of these speeds over a load, with a little scatter that is never the same.
fn trails(blocks: usize, begins: f64, load: impl Fn(f64) -> f64) -> Vec<Trail> {
    (0..blocks)
        .map(|block| {
            let velocity = SPEEDS[block % SPEEDS.len()] * (1.0 + 0.01 * block as f64);
            let length = velocity * 2.0 / PARTS as f64;
            let part = |i: usize, sign: f64| {
                let place = begins + 0.3 * (block as f64).sin() + (i as f64 + 0.5) * length;
                let scatter = 2e-3 * (7.3 * (block * 131 + i) as f64 + sign).sin();
                (place, sign * (0.5 + 0.01 * velocity) + load(place) + scatter)
            };
            Trail {
                velocity,
                length,
                forward: (1..PARTS - 1).map(|i| part(i, 1.0)).collect(),
                backward: (1..PARTS - 1).rev().map(|i| part(i, -1.0)).collect(),
            }
        })
        .collect()
}

fn known(value: f64) -> Ranged {
    Ranged::new(value, 0.99 * value, 1.01 * value)
}

fn told(load: impl Fn(f64) -> f64 + Copy) -> Structure {
    let curve = Curve {
        f_s: known(0.5),
        f_c: known(0.5),
        v_s: known(1.0),
        slope: known(0.7),
        dips: false,
        deviation: 1e-3,
        one_way: 0.0,
    };
    let drive = Drive {
        gain: known(1.4),
        time_constant: known(0.05),
        delay: Ranged::new(1e-3, 0.9e-3, 1.1e-3),
        peak: 3.0,
        missed: 1e-3,
        encoder_step: 1e-5,
    };
    structure(&trails(24, 0.0, load), &trails(32, 0.1, load)[28..], &curve, &drive)
}

fn holds(finding: &Finding, truth: f64) -> bool {
    matches!(finding, Finding::There { size } if size.holds(truth))
}

#[test]
fn a_load_that_hangs_is_told_with_an_interval_and_can_be_fed_forward() {
    let load = |q: f64| 0.1 * (q - 0.4).sin();
    let found = told(load);
    assert!(holds(&found.gravity, 0.1), "{found:?}");
    assert!(matches!(found.spring, Finding::NotThere { .. }), "{found:?}");
    assert!(matches!(found.direction, Finding::NotThere { .. }), "{found:?}");
    let fed = found.load.unwrap();
    for q in [-1.0, 0.0, 2.0, 5.0] {
        assert!((fed.at(q) - load(q)).abs() < 3e-3, "{q}: {fed:?}");
    }
    assert!(found.errors.1 < 0.2 * found.errors.0, "{found:?}");
}

#[test]
fn a_cable_is_told_from_a_load_that_hangs_and_one_direction_that_is_stickier_beside_it() {
    let found = told(|q: f64| 0.02 * q + 0.03);
    assert!(holds(&found.spring, 0.02), "{found:?}");
    assert!(holds(&found.direction, 0.03), "{found:?}");
    assert!(matches!(found.gravity, Finding::NotThere { .. }), "{found:?}");
}

#[test]
fn waves_are_told_with_how_often_they_come_and_nothing_is_told_where_nothing_is() {
    let found = told(|q: f64| 0.02 * (30.0 * q + 1.0).sin() + 0.01 * (6.0 * q).cos());
    assert!(found.ripple.len() >= 2, "{found:?}");
    for (wave, (waves, size)) in found.ripple.iter().zip([(30.0, 0.02), (6.0, 0.01)]) {
        assert!((wave.per_turn / TAU / waves - 1.0).abs() < 0.01, "{found:?}");
        assert!((wave.size.value / size - 1.0).abs() < 0.2, "{found:?}");
    }
    let nothing = told(|_| 0.0);
    assert!(nothing.ripple.is_empty() && nothing.load.is_none(), "{nothing:?}");
    assert!(matches!(nothing.gravity, Finding::NotThere { .. }), "{nothing:?}");
}

#[test]
fn where_the_shaft_went_over_a_part_of_a_turn_only_the_two_are_not_told_apart() {
    let short: Vec<Trail> = trails(24, 0.0, |q: f64| 0.1 * q.sin())
        .into_iter()
        .filter(|trail| trail.velocity < 0.6)
        .collect();
    let found = structure(
        &short,
        &[],
        &Curve {
            f_s: known(0.5),
            f_c: known(0.5),
            v_s: known(1.0),
            slope: known(0.7),
            dips: false,
            deviation: 1e-3,
            one_way: 0.0,
        },
        &Drive {
            gain: known(1.4),
            time_constant: known(0.05),
            delay: Ranged::new(-2e-3, -3e-3, -1e-3),
            peak: 3.0,
            missed: 1e-3,
            encoder_step: 1e-5,
        },
    );
    assert!(matches!(&found.gravity, Finding::Unknown { why } if why.contains("look alike")));
    assert!(matches!(found.spring, Finding::There { .. }), "{found:?}");
    assert!(matches!(found.play, Finding::Likely { .. }), "{found:?}");
}
