//! Which models can only take energy out of a motion, and which can give some.
//!
//! A model with the stored energy `E` is passive if `F v >= dE/dt` at every state and velocity:
//! then the work over a closed cycle is not negative. The inequality is checked pointwise, in the
//! derivative form, at states that random motions lead to: no integrator's error blurs it.

use crate::arbitrary::{config, model, model_of, velocities};
use friction_model::{
    AnyModel, AnyParameters, ElastoPlastic, ElastoPlasticParameters, FrictionModel, Gms,
    GmsParameters, Leuven, LeuvenParameters, LuGre, LuGreParameters, ModelName, ModelVisitor,
    ParameterSet, Proposed, State, Stepper, TimeStep, rk4,
};
use proptest::prelude::*;

/// Smallest surplus `F v - dE/dt` along a motion, relative to the size of its parts. `E` is
/// quadratic, so its rate along `x'` is `(E(x + x') - E(x - x')) / 2`, exactly.
struct Surplus<'a>(&'a [f64]);

impl ModelVisitor for Surplus<'_> {
    type Output = f64;

    fn visit<M: FrictionModel>(self, model: M) -> f64 {
        use friction_model::ContinuousState;
        let mut stepper = Stepper::new(model.clone(), TimeStep::new(1e-3).unwrap());
        let mut smallest = f64::INFINITY;
        for &v in self.0 {
            stepper.step(v);
            let State { continuous, memory } = stepper.state();
            for v in [v, -v, 0.1 * v, 10.0 * v] {
                let now = model.evaluate(continuous, memory, v);
                let energy = |h| {
                    let continuous = continuous.plus_scaled(&now.rates, h);
                    model
                        .stored_energy(&State { continuous, memory: memory.clone() })
                        .unwrap_or(0.0)
                };
                let (up, down) = (energy(1.0), energy(-1.0));
                let scale = (now.force * v).abs() + up + down + 1e-300;
                smallest = smallest.min((now.force * v - 0.5 * (up - down)) / scale);
            }
        }
        smallest
    }
}

/// Rounding of the sums above.
const ROUNDING: f64 = -1e-12;

/// Sets the viscous coefficient of LuGre or the elasto-plastic model to `part` of what passivity
/// needs.
fn with_viscous_part(model: &AnyModel, part: f64) -> AnyModel {
    let [f_s, f_c, sigma1] = ["f_s", "f_c", "sigma1"].map(|name| model.parameter(name).unwrap());
    let mut parameters = model.parameters();
    parameters.set("f_v", part * sigma1 * (f_s - f_c) / f_c);
    parameters.try_into().unwrap()
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn static_models_dahl_and_xiong_are_passive(
        model in model_of(&[
            ModelName::Coulomb, ModelName::Viscous, ModelName::CoulombViscous, ModelName::Stiction, ModelName::Stribeck,
            ModelName::RateDependentStiction, ModelName::Karnopp, ModelName::TwoLine, ModelName::RbfNetwork,
            ModelName::BengisuAkay, ModelName::Dahl, ModelName::Xiong,
        ]),
        path in velocities(),
    ) {
        // A network or two lines with arbitrary weights may push: only those whose force opposes
        // the motion are friction.
        prop_assume!(path.iter().all(|&v| model.steady_state(v) * v >= 0.0 && model.steady_state(10.0 * v) * v >= 0.0));
        prop_assume!(path.iter().all(|&v| model.steady_state(0.1 * v) * v >= 0.0));
        // Xiong's rates are small differences of forces over sigma: their rounding counts K / sigma
        // times.
        let stiff = match model.parameters() {
            AnyParameters::Xiong(p) => p.k.iter().zip(p.sigma.iter()).map(|(k, sigma)| k / sigma).fold(0.0, f64::max),
            _ => 0.0,
        };
        let surplus = model.visit(Surplus(&path));
        prop_assert!(surplus >= ROUNDING - 1e-15 * stiff, "{surplus}");
    }

    /// `F v - dE/dt = g |v| u^2 + v^2 [sigma1 (1 - u) + f_v]` with
    /// `u = sigma0 z sgn v / g <= F_s / F_c` for LuGre; the elasto-plastic model likewise (Barahona
    /// and Canudas de Wit 2000 for LuGre).
    #[test]
    fn lugre_and_elasto_plastic_are_passive_with_enough_viscous_friction(
        model in model_of(&[ModelName::LuGre, ModelName::ElastoPlastic]), path in velocities(),
    ) {
        let mut parameters = with_viscous_part(&model, 1.0 + 1e-9).parameters();
        if let AnyParameters::LuGre(p) = &mut parameters {
            p.v_d = None;
        }
        let surplus = AnyModel::try_from(parameters).unwrap().visit(Surplus(&path));
        prop_assert!(surplus >= ROUNDING, "{surplus}");
    }

    /// The contact's power covers what flows into the hysteresis, `F v >= F_hyst z'`; the
    /// hysteresis itself is the next test.
    #[test]
    fn proposed_is_passive(model in model(ModelName::Proposed), path in velocities()) {
        let AnyModel::Proposed(model) = model else { unreachable!() };
        let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
        for v in path {
            stepper.step(v);
            let State { continuous, memory } = stepper.state();
            for v in [v, -v, 0.1 * v, 10.0 * v] {
                let now = model.evaluate(continuous, memory, v);
                let stored = memory.force() * now.rates[1];
                // z' is a small difference of forces over sigma.
                let rounding = 1e-15 * memory.force() * memory.force() / model.parameters().sigma;
                let scale = (now.force * v).abs() + stored.abs();
                prop_assert!(now.force * v - stored >= ROUNDING * scale - rounding, "at {v}");
            }
        }
    }

    /// Leuven: `F v - F_h z' = F_h v sgn(r)|r|^n + v^2 [sigma1 (1 - sgn(r)|r|^n) + f_v]`, where
    /// `|r| <= F_s / F_c`.
    #[test]
    fn leuven_is_passive_with_enough_viscous_friction(model in model(ModelName::Leuven), path in velocities()) {
        let [f_s, f_c, n, sigma1] = ["f_s", "f_c", "n", "sigma1"].map(|name| model.parameter(name).unwrap());
        let mut parameters = model.parameters();
        parameters.set("f_v", sigma1 * ((f_s / f_c).powf(n) - 1.0) * (1.0 + 1e-9));
        let Ok(AnyModel::Leuven(model)) = AnyModel::try_from(parameters) else { return Ok(()) };
        let mut stepper = Stepper::new(model, TimeStep::new(1e-3).unwrap());
        for v in path {
            stepper.step(v);
            let State { continuous, memory } = stepper.state();
            for v in [v, -v, 0.1 * v, 10.0 * v] {
                let now = model.evaluate(continuous, memory, v);
                let stored = memory.force() * now.rates[0];
                let parts = (now.force * v).abs() + stored.abs() + sigma1 * (v * now.rates[0]).abs();
                prop_assert!(now.force * v - stored >= ROUNDING * parts, "at {v}");
            }
        }
    }

    /// Different parameters for each direction, stiffness included: a closed path through
    /// pre-sliding and sliding costs energy. (Dahl's contact is passive so too, with
    /// `int max(F, 0) dF / sigma0` as storage, but it takes many cycles to repeat.)
    #[test]
    fn an_asymmetric_contact_of_a_passive_model_takes_energy(
        (forward, backward) in model_of(&[ModelName::Proposed, ModelName::Xiong])
            .prop_flat_map(|one| (Just(one), model(one.name()))),
        turns in prop::collection::vec(-1.0..1.0f64, 2..12), size in -6.0..-1.0f64,
    ) {
        let model = AnyModel::asymmetric(&forward, &backward).unwrap();
        let dt = 1e-3;
        let mut stepper = model.start(TimeStep::new(dt).unwrap());
        let steps = 100;
        let (mut x, mut work, mut moved) = (0.0, 0.0, 0.0);
        let mut before = 0.0;
        // Three times around: the third begins and ends in the same state.
        for cycle in 0..3 {
            for &turn in &turns {
                let to = turn * 10f64.powf(size);
                let v = (to - x) / (f64::from(steps) * dt);
                before = if cycle == 0 && moved == 0.0 { stepper.clone().step(v) } else { before };
                for _ in 0..steps {
                    stepper.step(v);
                    let force = stepper.clone().step(v);
                    let part = 0.5 * (before + force) * v * dt;
                    if cycle == 2 {
                        work += part;
                        moved += part.abs();
                    }
                    before = force;
                }
                x = to;
            }
        }
        // The trapezoidal rule errs by what a step moves.
        prop_assert!(work >= -0.03 * moved - 1e-300, "{work} J of {moved} J moved");
    }

    /// Along any path the hysteresis takes at least what it stores, and over a closed one it takes
    /// energy.
    #[test]
    fn the_hysteresis_stores_no_more_than_it_takes(turns in prop::collection::vec(-1.0..1.0f64, 2..30)) {
        let model = Proposed::chapter_3();
        let p = *model.parameters();
        let unit = p.f_s * p.z_b;
        let mut state = model.rest();
        let mut take = |from: f64, to: f64| {
            // Simpson's rule on fine pieces; a corner where branches meet costs it little.
            let n = 400;
            let at = |k: f64| (from + (to - from) * k / f64::from(n)) * p.z_b;
            let before = model.stored_energy(&state).unwrap();
            let mut work = 0.0;
            for k in 0..n {
                let start = state.memory.force();
                let middle = model.hysteresis_force(&mut state.memory, at(f64::from(k) + 0.5));
                let end = model.hysteresis_force(&mut state.memory, at(f64::from(k) + 1.0));
                work += (start + 4.0 * middle + end) / 6.0 * (at(1.0) - at(0.0));
            }
            (work, model.stored_energy(&state).unwrap() - before)
        };
        let mut from = 0.0;
        for &to in &turns {
            let (work, stored) = take(from, to);
            prop_assert!(work - stored >= -1e-6 * unit, "to {to}: {work} < {stored}");
            from = to;
        }
        // Twice around: the second cycle starts and ends in the same state.
        let cycle: f64 = (0..2).map(|_| {
            let mut work = 0.0;
            for &to in &turns {
                work += take(from, to).0;
                from = to;
            }
            work
        }).last().unwrap();
        prop_assert!(cycle >= -1e-6 * unit, "{cycle}");
    }
}

/// Work that friction takes in one period of a velocity that alternates between `slow` for `t_slow`
/// and `fast` for `t_fast`, both forward, once the states repeat.
fn work_per_cycle<M: FrictionModel>(
    model: &M,
    [slow, t_slow]: [f64; 2],
    [fast, t_fast]: [f64; 2],
) -> f64 {
    let mut state = model.rest();
    let mut work = 0.0;
    for cycle in 0..30 {
        work = 0.0;
        for (v, duration) in [(slow, t_slow), (fast, t_fast)] {
            // Fine enough for the fastest relaxation, 1e5 per metre of travel.
            let n = (duration / 1e-7f64.max(2e-8 / v)).ceil().clamp(200.0, 20_000.0);
            let dt = duration / n;
            let mut before = model.evaluate(&state.continuous, &state.memory, v).force;
            for _ in 0..n as u32 {
                let after = rk4::step(model, &mut state, [v; 3], dt);
                work += 0.5 * (before + after) * v * dt;
                before = after;
            }
        }
        assert!(cycle < 29 || work.is_finite());
    }
    work
}

/// Chapter 3's LuGre without viscous friction gives energy when the velocity alternates between
/// .001 and 1 m/s; with the viscous friction that passivity asks for, 158 N s/m, it does not.
#[test]
fn lugre_without_enough_viscous_friction_gives_energy() {
    let alternate = |f_v: f64| {
        let model: LuGre =
            LuGreParameters { f_v, ..*LuGre::chapter_3().parameters() }.try_into().unwrap();
        work_per_cycle(&model, [0.001, 0.05], [1.0, 2e-5])
    };
    assert!(alternate(0.0) < -1e-3, "{} J", alternate(0.0));
    assert!(alternate(1e5f64.sqrt() * 0.5) > 0.0);
}

#[test]
fn so_does_the_elasto_plastic_model() {
    let alternate = |f_v: f64| {
        let p = ElastoPlasticParameters { f_v, ..*ElastoPlastic::chapter_3().parameters() };
        work_per_cycle(&ElastoPlastic::try_from(p).unwrap(), [0.001, 0.05], [1.0, 2e-5])
    };
    assert!(alternate(0.0) < -1e-3, "{} J", alternate(0.0));
    assert!(alternate(1e5f64.sqrt() * 0.5) > 0.0);
}

/// Leuven: `z' v = v^2 (1 - r^n)` with `r <= F_s / F_c` needs `f_v >= sigma1 ((F_s / F_c)^n - 1)`.
#[test]
fn so_does_leuven() {
    let alternate = |f_v: f64| {
        let p = LeuvenParameters { f_v, ..*Leuven::chapter_3().parameters() };
        work_per_cycle(&Leuven::try_from(p).unwrap(), [0.001, 5.0], [1.0, 1e-4])
    };
    assert!(alternate(0.0) < -1e-3, "{} J", alternate(0.0));
    assert!(alternate(1e5f64.sqrt() * (1.5f64.powi(2) - 1.0)) > 0.0);
}

/// GMS: a slipping element is drawn to its level at the speed C, whatever the velocity; its damping
/// then pushes, and its spring is loaded without travel. No viscous coefficient mends that for all
/// motions: GMS is not passive.
#[test]
fn gms_gives_energy() {
    let alternate = |damping: f64| {
        let mut p = *Gms::chapter_3().parameters();
        p.scale("sigma1", damping);
        work_per_cycle(&Gms::<10>::try_from(p).unwrap(), [0.001, 0.4], [1.0, 0.01])
    };
    assert!(alternate(1.0) < -1e-4, "{} J", alternate(1.0));
    assert!(alternate(3.0) < -1e-2, "{} J with three times the damping", alternate(3.0));
    assert!(alternate(0.0) > 1e-3, "{} J without damping, forward only", alternate(0.0));
}

/// An element is brought to the edge of slip slowly, let go by a burst of speed, and creeps on: it
/// is drawn up to the static level without travel. On the way back it gives what it was never
/// given, `1/2 sigma0 (W_s^2 - W_c^2)`, and no viscous friction acts on motions this slow.
#[test]
fn gms_gives_energy_whatever_its_viscous_friction() {
    let p = GmsParameters {
        f_s: 1.5,
        f_c: 1.0,
        v_s: 0.01,
        delta: 2.0,
        alpha: [1.0].into(),
        sigma0: [1000.0].into(),
        sigma1: [0.0].into(),
        c: [0.1].into(),
        f_v: 100.0,
    };
    let model = Gms::<1>::try_from(p).unwrap();
    let (mut state, mut work, mut x) = (model.rest(), 0.0, 0.0);
    let slow = 1e-5;
    let mut go = |v: f64, duration: f64, dt: f64| {
        let steps = (duration / dt).round();
        for _ in 0..steps as u32 {
            let before = model.evaluate(&state.continuous, &state.memory, v).force;
            let after = rk4::step(&model, &mut state, [v; 3], dt);
            work += 0.5 * (before + after) * v * dt;
            x += v * dt;
        }
        (work, x, state.continuous[0])
    };
    go(slow, 0.999e-3 / slow, 1e-2);
    go(0.05, 1e-4, 1e-4);
    let (_, there, z) = go(slow, 0.5, 1e-3);
    assert!(
        (z - 1.5e-3).abs() < 1e-9 && there < 1.02e-3,
        "drawn up to {z} m within a travel of {there} m"
    );
    // Back until the spring is slack: the state it began in.
    let (work, _, _) = go(-slow, 1.5e-3 / slow, 1e-2);
    let gain = 0.5 * 1000.0 * (1.5e-3f64.powi(2) - 1e-3f64.powi(2));
    assert!((work + gain).abs() < 0.1 * gain, "{work} J");
}

#[test]
fn a_cycle_through_the_whole_range_costs_energy() {
    // The same alternation takes energy from the passive models.
    assert!(work_per_cycle(&Proposed::chapter_3(), [0.001, 5.0], [1.0, 1e-4]) > 0.0);
}
