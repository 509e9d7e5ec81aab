use super::*;

const BARE: Angle = Angle { axis: None, scale: 1.0, in_rad: false };

fn times(n: usize) -> Vec<f64> {
    (0..n).map(|k| k as f64 * 1e-3).collect()
}

/// Three turns forth and back.
fn motion(n: usize) -> Vec<f64> {
    (0..n).map(|k| 10.0 * (2.0 * PI * k as f64 / n as f64).sin()).collect()
}

/// Noise that is the same each time, from -1 to 1.
fn noise(k: usize) -> f64 {
    let mixed = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    f64::from((mixed >> 40) as u32) / f64::from(1u32 << 23) - 1.0
}

fn check(true_path: &[f64], turn: f64, low: f64, angle: Angle) -> Option<Wrapped> {
    let mut position: Vec<f64> =
        true_path.iter().map(|q| (q - low).rem_euclid(turn) + low).collect();
    let found = unwrap(&times(true_path.len()), &mut position, angle);
    if found.is_some() {
        let start = position[0] - true_path[0];
        for (unwrapped, real) in position.iter().zip(true_path) {
            assert!((unwrapped - start - real).abs() < 1e-6 * turn, "{unwrapped} {real}");
        }
    }
    found
}

#[test]
fn a_turn_is_counted_in_both_directions_whatever_its_rim() {
    let path = motion(3000);
    for low in [0.0, -PI] {
        let found = check(&path, 2.0 * PI, low, Angle::RADIANS).unwrap();
        assert!(found.one_turn && found.jumps >= 5, "{found:?}");
        assert!(found.describe().contains("one turn"));
    }
    // One jump is enough where it is a turn.
    let once: Vec<f64> = (0..400).map(|k| 0.01 * f64::from(k)).collect();
    assert_eq!(check(&once, 2.0 * PI, -PI, Angle::RADIANS).unwrap().jumps, 1);
    let back: Vec<f64> = once.iter().map(|q| -q).collect();
    assert_eq!(check(&back, 2.0 * PI, -PI, Angle::RADIANS).unwrap().jumps, 1);
}

#[test]
fn degrees_without_a_unit_and_counts_are_turns_too() {
    let degrees: Vec<f64> = motion(3000).iter().map(|q| q * 180.0 / PI).collect();
    assert!((check(&degrees, 360.0, 0.0, BARE).unwrap().turn - 360.0).abs() < 1e-9);
    for turn in [4096.0, 5000.0] {
        let counts: Vec<f64> =
            motion(60_000).iter().map(|q| (q * turn / (2.0 * PI)).floor()).collect();
        let found = check(&counts, turn, 0.0, BARE).unwrap();
        assert!((found.turn - turn).abs() < 1e-9 && !found.one_turn, "{found:?}");
        let scale = 2.0 * PI / turn;
        let scaled: Vec<f64> = counts.iter().map(|count| count * scale).collect();
        assert!(check(&scaled, 2.0 * PI, 0.0, Angle { scale, ..BARE }).unwrap().one_turn);
    }
}

#[test]
fn noise_at_the_rim_jumps_back_and_forth() {
    let slow: Vec<f64> =
        (0..2000).map(|k| 0.5 * (2.0 * PI * k as f64 / 2000.0).sin() + 0.01 * noise(k)).collect();
    let found = check(&slow, 2.0 * PI, 0.0, Angle::RADIANS).unwrap();
    assert!(found.jumps > 3, "{found:?}");
}

#[test]
fn what_does_not_clearly_wrap_is_left_alone() {
    let left = |name: &str, path: Vec<f64>, angle: Angle| {
        let mut read = path.clone();
        assert_eq!(unwrap(&times(path.len()), &mut read, angle), None, "{name}");
        assert_eq!(read, path, "{name}");
    };
    let linear = Angle { axis: Some(AxisKind::Linear), ..BARE };
    let sawtooth = |k: usize| (k % 100) as f64 * 0.01;
    left("a linear axis", (0..2000).map(sawtooth).collect(), linear);
    left("a motion", motion(3000), Angle::RADIANS);
    let square = |k: usize| if (k / 100).is_multiple_of(2) { PI } else { -PI };
    left("a switched signal", (0..2000).map(square).collect(), Angle::RADIANS);
    let noisy = |k: usize| 2.0 * square(k) + 0.01 * noise(k);
    left("a noisy one of another size", (0..2000).map(noisy).collect(), Angle::RADIANS);
    let jumping = |k: usize| 0.002 * (k % 200) as f64 + 3.0 * noise(k / 200);
    left("one that jumps anywhere", (0..4000).map(jumping).collect(), Angle::RADIANS);
    // Runs that begin anew: each comes to rest, and the next starts from rest.
    let run = |k: usize| 1.5 * (1.0 - (PI * (k % 400) as f64 / 399.0).cos());
    left("runs that begin anew", (0..4000).map(run).collect(), Angle::RADIANS);
    left("nothing", vec![], BARE);
    left("a standstill", vec![1.0; 100], BARE);
}
