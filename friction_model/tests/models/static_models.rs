//! What must hold for every valid parameter set of the models without states.

use friction_model::{
    AnyModel, AnyParameters, CoulombViscousParameters, Elements, KarnoppParameters,
    RateDependentStictionParameters, RbfNetworkParameters, StictionParameters, TimeStep,
    TwoLineParameters,
};
use proptest::prelude::*;

/// A positive number, all decades alike.
fn decades(from: f64, to: f64) -> impl Strategy<Value = f64> {
    (from.log10()..to.log10()).prop_map(|e| 10f64.powf(e))
}

prop_compose! {
    /// f_s, f_c, f_v.
    fn levels()(f_s in decades(1e-3, 1e3), ratio in 0.05..=1.0f64, f_v in 0.0..10.0f64) -> (f64, f64, f64) {
        (f_s, f_s * ratio, f_v)
    }
}

fn curves() -> impl Strategy<Value = AnyParameters> {
    (levels(), decades(1e-9, 1e3), 0.01..10.0f64, decades(1e-9, 1e-2)).prop_flat_map(
        |((f_s, f_c, f_v), scale, shape, d_v)| {
            let (v_s, delta, t_s, delta_t) = (scale, shape, scale, shape);
            prop::sample::select(vec![
                AnyParameters::CoulombViscous(CoulombViscousParameters { f_c, f_v }),
                AnyParameters::Stiction(StictionParameters { f_s, f_c, f_v }),
                AnyParameters::RateDependentStiction(RateDependentStictionParameters {
                    f_s,
                    f_c,
                    t_s,
                    delta_t,
                    f_v,
                }),
                AnyParameters::Karnopp(KarnoppParameters { f_s, f_c, v_s, delta, d_v, f_v }),
            ])
        },
    )
}

prop_compose! {
    fn two_line()(a in decades(1e-3, 1e3), ratio in 0.01..0.99f64, v_sw in decades(1e-6, 1e3), b2 in 0.0..10.0f64, falls: bool)
        -> AnyParameters {
        let (a1, a2) = if falls { (a, a * ratio) } else { (a * ratio, a) };
        AnyParameters::TwoLine(TwoLineParameters { a1, b1: b2 - (a1 - a2) / v_sw, a2, b2 })
    }
}

prop_compose! {
    /// The first bell lifts standstill above zero; the others may pull the sum below it elsewhere.
    fn rbf_network()(w0 in 0.0..1.0f64, bells in prop::collection::vec((-2.0..2.0f64, 1.0..5.0f64, 0.01..0.3f64), 0..31))
        -> AnyParameters {
        let list = |first, f: fn(&(f64, f64, f64)) -> f64| {
            Elements::from_fn(bells.len() + 1, |i| i.checked_sub(1).and_then(|i| bells.get(i)).map_or(first, f))
        };
        AnyParameters::RbfNetwork(RbfNetworkParameters {
            w0,
            weights: list(1.0, |bell| bell.0),
            centres: list(0.0, |bell| bell.1),
            widths: list(0.5, |bell| bell.2),
        })
    }
}

fn static_model() -> impl Strategy<Value = AnyModel> {
    prop_oneof![4 => curves(), 1 => two_line(), 1 => rbf_network()]
        .prop_map(|parameters| parameters.try_into().unwrap())
}

proptest! {
    /// At no speed does friction push; it is odd in the velocity, without memory, and always a
    /// number.
    #[test]
    fn friction_opposes_every_motion(
        model in static_model(),
        path in prop::collection::vec((-9.0..9.0f64, any::<bool>()), 1..50),
    ) {
        let mut stepper = model.start(TimeStep::new(1e-3).unwrap());
        for (e, back) in path {
            let v = if back { -10f64.powf(e) } else { 10f64.powf(e) };
            let force = stepper.step(v);
            prop_assert!(force.is_finite() && force * v >= 0.0, "{force} at {v}");
            prop_assert_eq!(force, -stepper.step(-v));
            prop_assert_eq!(force, model.steady_state(v.clamp(-1e6, 1e6)));
            prop_assert!(stepper.internals(v).gamma >= 0.0);
        }
    }
}
