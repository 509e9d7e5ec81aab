//! Hysteresis with non-local memory: what the reversal stack is, and what the models make of it in
//! pre-sliding.

use crate::arbitrary::config;
use friction_model::{
    AnyModel, FrictionModel, Hysteresis, ModelName, ModelVisitor, Proposed, State, VirginCurve, rk4,
};
use proptest::prelude::*;

/// A Prandtl-Ishlinskii operator: `n` stops (elastic, perfectly plastic) with thresholds `r` and
/// weights `-f''(r)`.
struct Stops(Vec<(f64, f64, f64)>);

impl Stops {
    /// Those of `sin(pi z / 2)`.
    fn of_the_sine(n: u32) -> Self {
        let k = std::f64::consts::FRAC_PI_2;
        Self(
            (0..n)
                .map(|i| {
                    let r = (f64::from(i) + 0.5) / f64::from(n);
                    (r, k * k * (k * r).sin() / f64::from(n), 0.0)
                })
                .collect(),
        )
    }

    fn move_by(&mut self, dz: f64) -> f64 {
        self.0
            .iter_mut()
            .map(|(r, weight, stop)| {
                *stop = (*stop + dz).clamp(-*r, *r);
                *weight * *stop
            })
            .sum()
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: config().cases.min(2000), ..config() })]

    /// The quadrature error of `N` stops is `2 / N^2`.
    #[test]
    fn the_hysteresis_is_a_sum_of_stops(path in prop::collection::vec(-1.0..1.0f64, 1..60)) {
        let model = Proposed::chapter_3();
        let p = *model.parameters();
        let n = 1000;
        let mut stops = Stops::of_the_sine(n);
        let mut memory = Hysteresis::default();
        let mut before = 0.0;
        for z in path {
            let sum = stops.move_by(z - before);
            before = z;
            let force = model.hysteresis_force(&mut memory, z * p.z_b) / p.f_s;
            prop_assert!((force - sum).abs() < 2.0 / f64::from(n * n), "z {z}: {force} is not {sum}");
        }
    }
}

proptest! {
    #![proptest_config(config())]

    /// Loops between the same deflections have the same shape wherever they lie, and an inner loop
    /// leaves no trace.
    #[test]
    fn loops_are_congruent_and_wiped_out(
        history in prop::collection::vec(-1.0..1.0f64, 0..20), low in -0.9..0.9f64, width in 0.01..0.5f64, way in 0.0..=1.0f64,
    ) {
        let model = Proposed::chapter_3();
        let p = *model.parameters();
        let high = (low + width).min(1.0);
        let at = |memory: &mut Hysteresis, z: f64| model.hysteresis_force(memory, z * p.z_b) / p.f_s;
        let shape = |memory: &mut Hysteresis| {
            at(memory, low);
            at(memory, high);
            let bottom = at(memory, low);
            let between = at(memory, low + way * (high - low));
            let top = at(memory, high);
            let again = at(memory, low);
            (bottom, between - bottom, top - bottom, again)
        };
        let (mut fresh, mut used) = (Hysteresis::default(), Hysteresis::default());
        for z in history {
            at(&mut used, z);
        }
        let (a, b) = (shape(&mut fresh), shape(&mut used));
        prop_assert!((a.0 - a.3).abs() < 1e-14 && (b.0 - b.3).abs() < 1e-14, "a loop closes");
        prop_assert!((a.1 - b.1).abs() < 1e-14 && (a.2 - b.2).abs() < 1e-14, "{a:?} {b:?}");
        // Out of the loop: as if it had not been.
        let mut without = used.clone();
        at(&mut used, high);
        at(&mut used, low);
        let outside = low - 0.5 * (low + 1.0);
        prop_assert_eq!(at(&mut used, outside), at(&mut without, outside));
    }

    /// Nested deeper than there is room for: each loss costs at most the innermost loop of that
    /// moment.
    #[test]
    fn a_full_stack_loses_at_most_the_innermost_loop(shrink in 0.97..0.995f64, reversals in 120..400u32) {
        let model = Proposed::chapter_3();
        let p = *model.parameters();
        let mut stops = Stops::of_the_sine(4000);
        let mut memory = Hysteresis::default();
        let (mut z, mut before) = (1.0f64, 0.0);
        let mut height = 0.0;
        for k in 0..reversals {
            let last = memory.force() / p.f_s;
            let force = model.hysteresis_force(&mut memory, z * p.z_b) / p.f_s;
            let exact = stops.move_by(z - before);
            prop_assert!(memory.depth() <= 120);
            if k == 118 {
                height = (force - last).abs();
            }
            let allowed = if k < 119 { 5e-7 } else { height + 5e-7 };
            prop_assert!((force - exact).abs() <= allowed, "{k}: {force} is not {exact}, loops are {height} high");
            before = z;
            z *= -shrink;
        }
    }
}

/// Force along a displacement path at a constant speed.
struct Along<'a> {
    turns: &'a [f64],
    speed: f64,
    largest_step: f64,
}

impl ModelVisitor for Along<'_> {
    type Output = Vec<f64>;

    fn visit<M: FrictionModel>(self, model: M) -> Vec<f64> {
        let mut state: State<_, _> = model.rest();
        let (mut x, mut forces) = (0.0, Vec::new());
        for &turn in self.turns {
            let v = self.speed.copysign(turn - x);
            // Ten forces a way, with as many steps between them as the model needs.
            let steps = ((turn - x) / v / 10.0 / self.largest_step).ceil().max(200.0);
            let dt = (turn - x) / v / 10.0 / steps;
            for _ in 0..10 {
                forces.extend(
                    (0..steps as u32).map(|_| rk4::step(&model, &mut state, [v; 3], dt)).last(),
                );
            }
            x = turn;
        }
        forces
    }
}

/// In slow pre-sliding the force depends on the path alone: a tenth of the speed gives the same
/// forces, to a tenth of the damping.
#[test]
fn pre_sliding_is_rate_independent_when_it_is_slow() {
    use ModelName::{
        BlimanSorine, Dahl, ElastoPlastic, Gms, Leuven, LuGre, Proposed, ProposedLinear, Xiong,
    };
    for (name, amplitude, largest_step) in [
        (Dahl, 1e-5, 1.0),
        (LuGre, 1e-5, 1.0),
        (ElastoPlastic, 1e-5, 1.0),
        (BlimanSorine, 3e-4, 1.0),
        (Leuven, 4e-4, 1.0),
        (Gms, 1e-3, 0.1),
        // sigma / K is 5 ms.
        (Xiong, 2e-5, 5e-3),
        (Proposed, 6e-4, 0.1),
        (ProposedLinear, 6e-4, 0.1),
    ] {
        let model = AnyModel::chapter_3(name);
        let turns = [1.0, -0.5, 0.5, -0.1, 0.5, 0.8].map(|turn| turn * amplitude);
        let at = |speed: f64| model.visit(Along { turns: &turns, speed, largest_step });
        let (slow, slower, slowest) =
            (at(amplitude / 10.0), at(amplitude / 100.0), at(amplitude / 1000.0));
        let largest = slowest.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let difference =
            |a: &[f64]| a.iter().zip(&slowest).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        let (coarse, fine) = (difference(&slow), difference(&slower));
        assert!(fine < 0.01 * largest, "{name}: {fine} N of {largest} N");
        assert!(fine <= 0.15 * coarse + 1e-9 * largest, "{name}: {coarse} N, then {fine} N");
    }
}

/// The straight virgin curve is one stop: no weight below the limit.
#[test]
fn a_straight_branch_has_no_stops_inside() {
    let line = friction_model::Line::new(2.0, 0.5);
    assert_eq!((line.slope(0.1), line.slope(0.4), line.force(0.25)), (4.0, 4.0, 1.0));
}
