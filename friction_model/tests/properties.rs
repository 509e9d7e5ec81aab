//! What must hold for every valid parameter set and every motion.

use friction_model::{
    AnyModel, AnyStepper, Bristle, BristleParameters, FrictionModel, Hysteresis, LuGre, LuGreParameters,
    ModelName, Proposed, ProposedParameters, Stepper, Stribeck, StribeckParameters, TimeStep,
};
use proptest::prelude::*;

prop_compose! {
    /// f_s, f_c, v_s, delta.
    fn stribeck_levels()(f_s in 1e-3..10.0f64, ratio in 0.3..=1.0f64, v_s in 1e-3..1.0f64, delta in 0.5..4.0f64)
        -> (f64, f64, f64, f64) {
        (f_s, f_s * ratio, v_s, delta)
    }
}

prop_compose! {
    fn any_lugre()((f_s, f_c, v_s, delta) in stribeck_levels(), log_sigma0 in 0.0..6.0f64, sigma1 in 0.0..300.0f64,
                   f_v in 0.0..1.0f64) -> LuGre {
        LuGreParameters { f_s, f_c, v_s, delta, sigma0: 10f64.powf(log_sigma0), sigma1, v_d: None, f_v }.try_into().unwrap()
    }
}

prop_compose! {
    fn any_proposed()((f_s, f_c, v_s, delta) in stribeck_levels(), log_sigma in -4.0..3.0f64, log_tau in -5.0..0.0f64,
                      log_z_b in -6.0..0.0f64, f_v in 0.0..1.0f64) -> Proposed {
        let [sigma, tau, z_b] = [log_sigma, log_tau, log_z_b].map(|e| 10f64.powf(e));
        ProposedParameters { f_s, f_c, v_s, delta, sigma, tau, z_b, f_v }.try_into().unwrap()
    }
}

/// Velocities over many decades, both signs, as a sampled motion may throw at an observer.
fn velocities() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec((-6.0..6.0f64, any::<bool>()), 1..300).prop_map(|v| {
        v.into_iter().map(|(e, back)| if back { -10f64.powf(e) } else { 10f64.powf(e) }).collect()
    })
}

fn period() -> impl Strategy<Value = TimeStep> {
    (-5.0..=-2.0f64).prop_map(|e| TimeStep::new(10f64.powf(e).min(0.01)).unwrap())
}

prop_compose! {
    fn any_bristle()(bonds in 1..=128u32, sigma0 in 1e-3..1e3f64, log_delta_s in -8.0..0.0f64, seed in any::<u32>(), f_v in 0.0..1.0f64)
        -> Bristle {
        BristleParameters { bonds, sigma0, delta_s: 10f64.powf(log_delta_s), seed, f_v }.try_into().unwrap()
    }
}

proptest! {
    #[test]
    fn the_bristles_never_pull_more_than_all_of_them_can(model in any_bristle(), dt in period(), path in velocities()) {
        let f_v = model.parameters().f_v;
        let mut stepper = Stepper::new(model, dt);
        for v in path {
            let sliding = stepper.step(v) - f_v * v;
            prop_assert!(sliding.abs() <= model.bound() * (1.0 + 1e-12) + 1e-15 * (f_v * v).abs());
        }
    }

    #[test]
    fn proposed_is_bounded_by_static_friction(model in any_proposed(), dt in period(), path in velocities()) {
        let p = *model.parameters();
        let mut stepper = Stepper::new(model, dt);
        for v in path {
            let sliding = stepper.step(v) - p.f_v * v;
            // f_v v is subtracted from a sum: allow for its rounding.
            prop_assert!(sliding.abs() <= p.f_s * (1.0 + 1e-12) + 1e-15 * (p.f_v * v).abs());
            let [gamma, z] = stepper.state().continuous;
            prop_assert!(z.abs() <= p.z_b && gamma >= p.f_c * (1.0 - 1e-12) && gamma <= p.f_s * (1.0 + 1e-12));
        }
    }

    #[test]
    fn the_bristle_force_of_lugre_is_bounded(model in any_lugre(), dt in period(), path in velocities()) {
        let p = *model.parameters();
        let mut stepper = Stepper::new(model, dt);
        for v in path {
            let force = stepper.step(v);
            prop_assert!(force.is_finite());
            prop_assert!(p.sigma0 * stepper.state().continuous[0].abs() <= p.f_s * (1.0 + 1e-12));
        }
    }

    #[test]
    fn forces_are_odd_in_the_motion(proposed in any_proposed(), lugre in any_lugre(), dt in period(), path in velocities()) {
        let mut pairs = [
            (AnyModel::Proposed(proposed).start(dt), AnyModel::Proposed(proposed).start(dt)),
            (AnyModel::LuGre(lugre).start(dt), AnyModel::LuGre(lugre).start(dt)),
        ];
        for (there, back) in &mut pairs {
            for &v in &path {
                prop_assert_eq!(there.step(v), -back.step(-v));
            }
        }
    }

    /// Friction only ever takes energy out of a closed cycle. Two cycles settle the memory, the third is counted.
    #[test]
    fn proposed_dissipates_over_closed_cycles(model in any_proposed(), amplitude in 0.1..5.0f64, second in 0.0..0.9f64) {
        let p = *model.parameters();
        let dt = TimeStep::new(1e-3).unwrap();
        let mut stepper = Stepper::new(model, dt);
        let n = 400u32;
        let omega = std::f64::consts::TAU / (f64::from(n) * dt.seconds());
        let scale = amplitude * p.z_b;
        let mut work = 0.0;
        let mut magnitude = 0.0;
        for k in 0..3 * n {
            let phase = omega * f64::from(k) * dt.seconds();
            // A closed displacement path with inner loops.
            let v = scale * omega * (phase.cos() + second * (3.0 * phase).cos());
            let power = stepper.step(v) * v * dt.seconds();
            if k >= 2 * n {
                work += power;
                magnitude += power.abs();
            }
        }
        // The rectangle rule takes the force at the beginning of each period: allow for what that shifts.
        prop_assert!(work >= -0.05 * magnitude, "work {work}, of {magnitude} moved");
    }

    #[test]
    fn static_friction_lies_on_its_curve((f_s, f_c, v_s, delta) in stribeck_levels(), f_v in 0.0..1.0f64, v in -10.0..10.0f64) {
        let model = Stribeck::try_from(StribeckParameters { f_s, f_c, v_s, delta, f_v }).unwrap();
        let sliding = model.steady_state(v).abs() - f_v * v.abs();
        prop_assert!(sliding <= f_s * (1.0 + 1e-12) && (v == 0.0 || sliding >= f_c * (1.0 - 1e-9)));
        prop_assert_eq!(model.steady_state(-v), -model.steady_state(v));
    }
}

/// The reversal stack is a Prandtl-Ishlinskii operator: a sum of `N` stops (elastic-perfectly-plastic elements) with
/// thresholds `r` and weights `-f''(r)` gives the same force, to the quadrature error `2 / N^2`.
#[test]
fn the_hysteresis_is_a_sum_of_stops() {
    use rand_free::Sequence;
    let model = Proposed::chapter_3();
    let p = *model.parameters();
    let n = 2000;
    let k = std::f64::consts::FRAC_PI_2;
    let mut stops: Vec<(f64, f64, f64)> = (0..n)
        .map(|i| {
            let r = (f64::from(i) + 0.5) / f64::from(n);
            (r, k * k * (k * r).sin() / f64::from(n), 0.0)
        })
        .collect();
    let mut memory = Hysteresis::default();
    let mut random = Sequence(1);
    let mut z = 0.0f64;
    for _ in 0..3000 {
        let next = (z + 0.6 * random.next()).clamp(-1.0, 1.0);
        let mut sum = 0.0;
        for (r, weight, force) in &mut stops {
            *force = (*force + next - z).clamp(-*r, *r);
            sum += *weight * *force;
        }
        z = next;
        let force = model.hysteresis_force(&mut memory, z * p.z_b) / p.f_s;
        assert!((force - sum).abs() < 2.0 / f64::from(n * n), "z {z}: {force} is not {sum}");
    }
}

/// Loops between the same deflections have the same shape wherever they lie, and an inner loop leaves no trace.
#[test]
fn loops_are_congruent_and_wiped_out() {
    let model = Proposed::chapter_3();
    let z_b = model.parameters().z_b;
    let mut from_virgin = Hysteresis::default();
    let mut from_saturation = Hysteresis::default();
    model.hysteresis_force(&mut from_saturation, z_b);
    let heights = [&mut from_virgin, &mut from_saturation].map(|memory| {
        model.hysteresis_force(memory, 0.4 * z_b);
        let bottom = model.hysteresis_force(memory, -0.1 * z_b);
        let top = model.hysteresis_force(memory, 0.4 * z_b);
        assert!((model.hysteresis_force(memory, -0.1 * z_b) - bottom).abs() < 1e-14, "the loop closes");
        top - bottom
    });
    assert!((heights[0] - heights[1]).abs() < 1e-14, "{heights:?}");
}

/// Whatever a sensor says, a model keeps its numbers and finds back to its steady state.
#[test]
fn nothing_a_sensor_says_makes_a_model_forget_its_numbers() {
    for name in ModelName::ALL {
        for dt in [1e-3, 1e-2] {
            let mut stepper = AnyModel::test_bed(name).start(TimeStep::new(dt).unwrap());
            for v in [
                0.0,
                1e6,
                -1e6,
                f64::NAN,
                f64::INFINITY,
                f64::NEG_INFINITY,
                1e300,
                -0.0,
                f64::MIN_POSITIVE,
                0.1,
            ] {
                assert!(stepper.step(v).is_finite(), "{name} at {v}");
            }
            if name == ModelName::Bristle {
                // Its friction is random: it has no steady state to come back to, but a bound and a mean.
                the_bristles_keep_their_bound_and_their_mean(&mut stepper);
                continue;
            }
            if name == ModelName::Armstrong {
                // Its Stribeck friction is that of the last dwell: the steady state is that of a slip after a long rest.
                for _ in 0..5000 {
                    stepper.step(0.1);
                }
                let (force, rested) = (stepper.step(0.1), AnyModel::test_bed(name).steady_state(0.1));
                assert!(force < rested + 1e-12 && force >= 0.0925 + 0.0403 * 0.1, "{force}");
                stepper.reset();
            }
            for _ in 0..5000 {
                stepper.step(0.1);
            }
            let (force, expected) = (stepper.step(0.1), AnyModel::test_bed(name).steady_state(0.1));
            assert!((force - expected).abs() < 1e-9, "{name} at {dt} s: {force} is not {expected}");
        }
    }
}

fn the_bristles_keep_their_bound_and_their_mean(stepper: &mut AnyStepper) {
    let model = Bristle::test_bed();
    let (v, steps) = (2.0, 20_000);
    let viscous = model.viscous(v);
    let mut sum = 0.0;
    for _ in 0..steps {
        let force = stepper.step(v);
        assert!((force - viscous).abs() <= model.bound() * (1.0 + 1e-12), "{force}");
        sum += force;
    }
    let (mean, expected) = (sum / f64::from(steps) - viscous, model.steady_state(v) - viscous);
    assert!((mean / expected - 1.0).abs() < 0.01, "{mean} is not {expected} in the mean");
}

/// A tiny reproducible sequence in [-1, 1) (Knuth's 64-bit linear congruence): no dependency for one test.
mod rand_free {
    pub struct Sequence(pub u64);

    impl Sequence {
        pub fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }
}
