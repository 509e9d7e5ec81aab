//! How large a friction force can get, model by model.

use crate::arbitrary::{config, model, model_of, period, velocities};
use friction_model::{AnyModel, AnyParameters, FrictionModel, ModelName, State, Stepper, TimeStep};
use proptest::prelude::*;

/// Models whose force without the viscous part never exceeds the static level.
const BY_STATIC_FRICTION: &[ModelName] = &[
    ModelName::Coulomb,
    ModelName::CoulombViscous,
    ModelName::Stiction,
    ModelName::Stribeck,
    ModelName::RateDependentStiction,
    ModelName::Karnopp,
    ModelName::Dahl,
    ModelName::Xiong,
    ModelName::Proposed,
    ModelName::ProposedLinear,
];

/// `bound (1 + 1e-12)`, with room for the rounding of the viscous part that is subtracted from the
/// force.
fn within(value: f64, bound: f64, subtracted: f64) -> bool {
    value.abs() <= bound * (1.0 + 1e-12) + 1e-15 * subtracted.abs()
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn static_friction_bounds_the_contact(model in model_of(BY_STATIC_FRICTION), dt in period(), path in velocities()) {
        let level = model.parameter("f_s").or(model.parameter("f_c")).unwrap();
        let f_v = model.parameter("f_v").unwrap_or(0.0);
        let mut stepper = model.start(dt);
        for v in path {
            let contact = stepper.step(v) - f_v * v;
            prop_assert!(within(contact, level, f_v * v), "{contact} at {v}");
        }
    }

    /// LuGre and the elasto-plastic model: `sigma0 |z| <= F_s` and `|z'| <= |v| (1 + F_s / F_c)`.
    #[test]
    fn the_bristle_force_is_bounded_and_the_damping_has_its_own_bound(
        model in model_of(&[ModelName::LuGre, ModelName::ElastoPlastic]), dt in period(), path in velocities(),
    ) {
        let [f_s, f_c, sigma0, sigma1, f_v] =
            ["f_s", "f_c", "sigma0", "sigma1", "f_v"].map(|name| model.parameter(name).unwrap());
        let mut stepper = model.start(dt);
        for v in path {
            let force = stepper.step(v);
            prop_assert!(within(sigma0 * stepper.internals(v).deflection, f_s, 0.0));
            let damping = sigma1 * v.abs() * (1.0 + f_s / f_c);
            prop_assert!(within(force - f_v * v, f_s + damping, f_v * v), "{force} at {v}");
        }
    }

    /// Leuven: `|F_h| <= f_h`, `|z'| <= |v| (1 + (f_h / F_c)^n)`.
    #[test]
    fn leuvens_hysteresis_is_bounded(model in model(ModelName::Leuven), dt in period(), path in velocities()) {
        let [f_h, f_c, z_b, n, sigma1, f_v] =
            ["f_h", "f_c", "z_b", "n", "sigma1", "f_v"].map(|name| model.parameter(name).unwrap());
        let mut stepper = model.start(dt);
        for v in path {
            let force = stepper.step(v);
            prop_assert!(stepper.internals(v).deflection.abs() <= z_b);
            let damping = sigma1 * v.abs() * (1.0 + (f_h / f_c).powf(n));
            prop_assert!(within(force - f_v * v, f_h + damping, f_v * v), "{force} at {v}");
        }
    }

    /// GMS: `|sum sigma0 z| <= F_s`; an element's damping is `sigma1 |v|` in stick and at most
    /// `sigma1 C F_s / F_c` in slip.
    #[test]
    fn the_elements_of_gms_are_bounded(model in model(ModelName::Gms), dt in period(), path in velocities()) {
        let AnyParameters::Gms(p) = model.parameters() else { unreachable!() };
        let mut stepper = model.start(dt);
        for v in path {
            let force = stepper.step(v);
            let damping: f64 =
                p.sigma1.iter().zip(p.c.iter()).map(|(sigma1, c)| sigma1 * v.abs().max(c * p.f_s / p.f_c)).sum();
            prop_assert!(within(force - p.f_v * v, p.f_s + damping, p.f_v * v), "{force} at {v}");
        }
    }

    /// Under the integrator too: forces that a simulated body sees keep to the level.
    #[test]
    fn static_friction_bounds_the_derivative_form(
        model in model_of(&[ModelName::Dahl, ModelName::Xiong, ModelName::Proposed]),
        path in prop::collection::vec(-2.0..2.0f64, 1..100),
    ) {
        let bound = model.parameter("f_s").or(model.parameter("f_c")).unwrap();
        let f_v = model.parameter("f_v").unwrap();
        for contact in model.visit(ContactForces { path: &path, f_v }) {
            prop_assert!(within(contact, bound, f_v));
        }
    }
}

struct ContactForces<'a> {
    path: &'a [f64],
    f_v: f64,
}

impl friction_model::ModelVisitor for ContactForces<'_> {
    type Output = Vec<f64>;

    fn visit<M: FrictionModel>(self, model: M) -> Vec<f64> {
        let dt = TimeStep::new(1e-3).unwrap();
        let mut stepper = Stepper::new(model.clone(), dt);
        self.path
            .iter()
            .map(|&v| {
                stepper.step(v);
                let State { continuous, memory } = stepper.state();
                model.evaluate(continuous, memory, v).force - self.f_v * v
            })
            .collect()
    }
}

/// The bound is not loose: slow sliding reaches it.
#[test]
fn the_static_level_is_reached() {
    for name in [ModelName::Proposed, ModelName::Xiong] {
        let model = AnyModel::chapter_3(name);
        let mut stepper = model.start(TimeStep::new(1e-3).unwrap());
        let largest = (0..20_000).map(|_| stepper.step(2e-4)).fold(0.0, f64::max);
        assert!(largest > 0.9995 * 1.5 && largest <= 1.5 * (1.0 + 1e-12), "{name}: {largest}");
    }
}
