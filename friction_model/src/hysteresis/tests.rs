//! What the hysteresis must do: hand-worked forces, Masing's loops, stored energy, bounded memory.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};

use super::*;

/// `F_s = Z_b = 1`: the thesis's sine.
struct Sine;

impl VirginCurve for Sine {
    fn force(&self, z: f64) -> f64 {
        (FRAC_PI_2 * z).sin()
    }
    fn slope(&self, z: f64) -> f64 {
        FRAC_PI_2 * (FRAC_PI_2 * z).cos()
    }
    fn integral(&self, z: f64) -> f64 {
        (1.0 - (FRAC_PI_2 * z).cos()) / FRAC_PI_2
    }
    fn limit(&self) -> f64 {
        1.0
    }
}

#[test]
fn worked_example_with_nested_and_closed_loops() {
    // Every force by hand: the virgin curve, or the doubled branch from the reversal named.
    let virgin = |z: f64| (FRAC_PI_2 * z).sin();
    let branch = |(z_r, f_r): (f64, f64), z: f64| f_r + 2.0 * (FRAC_PI_4 * (z - z_r)).sin();
    let a = (0.9, virgin(0.9));
    let b = (-0.5, branch(a, -0.5));
    let c = (0.6, branch(b, 0.6));
    let d = (-0.1, branch(c, -0.1));
    let e = (0.3, branch(d, 0.3));
    let path = [
        (a.0, a.1, 0),
        (b.0, b.1, 1),
        (c.0, c.1, 2),
        (d.0, d.1, 3),
        (e.0, e.1, 4),
        (d.0, d.1, 3),
        (b.0, b.1, 1),
        (-0.9, -a.1, 0),
        (-1.0, -1.0, 0),
        (0.0, -1.0 + SQRT_2, 1),
        (1.0, 1.0, 0),
    ];
    let mut memory = Hysteresis::default();
    for (z, force, depth) in path {
        let peeked = memory.peek(&Sine, z);
        let committed = memory.commit(&Sine, z);
        assert_eq!(peeked, committed, "z {z}");
        assert!((committed - force).abs() < 1e-12, "z {z}: {committed} is not {force}");
        assert_eq!(memory.depth(), depth, "z {z}");
    }
}

/// Area of the loop between `+-a`, by the trapezoidal rule along fine steps, against the closed
/// form of Masing's branches.
#[test]
fn loop_area_is_masings() {
    use std::f64::consts::PI;
    for a in [0.25f64, 0.5, 1.0] {
        let expected = 16.0 / PI * (1.0 - (PI * a / 2.0).cos()) - 4.0 * a * (PI * a / 2.0).sin();
        let mut memory = Hysteresis::default();
        memory.commit(&Sine, a);
        let (mut area, mut before) = (0.0, (a, memory.force()));
        let n = 20_000;
        for k in 1..=2 * n {
            let phase = f64::from(k) / f64::from(n);
            let z = if phase <= 1.0 { a * (1.0 - 2.0 * phase) } else { a * (2.0 * phase - 3.0) };
            let f = memory.commit(&Sine, z);
            area += 0.5 * (f + before.1) * (z - before.0);
            before = (z, f);
        }
        assert!((area - expected).abs() < 1e-7, "a {a}: {area} is not {expected}");
    }
}

/// The energy in closed form equals that of 4000 stops, on a path with nested, closed and saturated
/// branches.
#[test]
fn stored_energy_is_that_of_the_stops() {
    let n = 4000;
    let mut stops: Vec<(f64, f64, f64)> = (0..n)
        .map(|i| {
            let r = (f64::from(i) + 0.5) / f64::from(n);
            (r, FRAC_PI_2 * FRAC_PI_2 * (FRAC_PI_2 * r).sin() / f64::from(n), 0.0)
        })
        .collect();
    let mut memory = Hysteresis::default();
    let mut before = 0.0;
    for z in [0.3, 0.9, -0.5, 0.6, -0.1, 0.3, 0.1, -0.1, -0.5, 0.2, -0.9, -1.0, 0.0, 0.4, 1.0, 0.7]
    {
        memory.commit(&Sine, z);
        let mut expected = 0.0;
        for (r, weight, stop) in &mut stops {
            *stop = (*stop + z - before).clamp(-*r, *r);
            expected += 0.5 * *weight * *stop * *stop;
        }
        before = z;
        let energy = memory.stored_energy(&Sine);
        assert!((energy - expected).abs() < 1e-6, "z {z}: {energy} is not {expected}");
    }
}

proptest::proptest! {
    /// What the stages of an integrator see is what the accepted step gets.
    #[test]
    fn peeking_tells_what_committing_will_give(
        path in proptest::collection::vec(-1.2f64..1.2, 1..200),
    ) {
        let mut memory = Hysteresis::default();
        for z in path {
            let (before, peeked) = (memory.clone(), memory.peek(&Sine, z));
            proptest::prop_assert_eq!(&memory, &before);
            proptest::prop_assert_eq!(peeked, memory.commit(&Sine, z));
            // The branch that is kept is the one that the points give.
            if memory.course.s != 0.0 {
                proptest::prop_assert_eq!(memory.course, Course::behind(memory.reversals(), memory.course.s));
            }
        }
    }
}

#[test]
fn two_hundred_nested_reversals_stay_within_the_stack() {
    let mut memory = Hysteresis::default();
    let mut z = 1.0;
    for _ in 0..200 {
        let peeked = memory.peek(&Sine, z);
        assert_eq!(peeked, memory.commit(&Sine, z), "z {z}, a full stack included");
        assert!(memory.depth() <= CAPACITY);
        assert_eq!(memory.course, Course::behind(memory.reversals(), memory.course.s), "z {z}");
        z *= -0.98;
    }
    assert!(memory.depth() > 100);
    // Coming back out closes every loop that is left.
    assert_eq!(memory.commit(&Sine, 1.0), 1.0);
    assert_eq!(memory.depth(), 0);
}
