//! The nearest that a target can hold to a model: by least squares over the steady speeds, and by
//! the stiffness in pre-sliding.

use friction_model::{AnyModel, LuGreParameters, Scheme, StribeckParameters, TimeStep};
use nalgebra::{DMatrix, DVector};

use crate::Speeds;
use crate::cost::both_ways;

/// Stribeck velocities that are tried.
const TRIED: u32 = 200;
/// Share of the highest speed at which a contact is bent to learn its stiffness.
const SLOW: f64 = 1e-4;
/// Step of that \[s\].
const STEP: f64 = 1e-3;
/// Steps after which a contact that has not come to half its level has no stiffness to speak of.
const PATIENCE: u32 = 1_000_000;

/// Speed and magnitude of the friction there, both ways.
fn curve(model: &AnyModel, speeds: &Speeds) -> Vec<(f64, f64)> {
    both_ways(speeds).map(|v| (v.abs(), model.steady_state(v).abs())).collect()
}

/// The level and the viscous coefficient that are nearest.
pub(crate) fn coulomb_viscous(model: &AnyModel, speeds: &Speeds) -> (f64, f64) {
    let curve = curve(model, speeds);
    let (x, _) = least_squares(&curve, &[&|_| 1.0, &|v| v]);
    (x[0], x[1])
}

/// The level up to which the model holds: that of sliding without end, infinitely slowly.
pub(crate) fn level_at_rest(model: &AnyModel, speeds: &Speeds) -> f64 {
    let creep = 1e-9 * speeds.high();
    0.5 * (model.steady_state(creep).abs() + model.steady_state(-creep).abs())
}

/// The Stribeck curve of Gaussian form that is nearest.
pub(crate) fn stribeck(model: &AnyModel, speeds: &Speeds) -> StribeckParameters {
    let curve = curve(model, speeds);
    let (low, high) = (0.3 * speeds.lowest(), speeds.high());
    let step = (high / low).ln() / f64::from(TRIED - 1);
    let tried = (0..TRIED).map(|k| low * (f64::from(k) * step).exp());
    let mut best: Option<(f64, StribeckParameters)> = None;
    for v_s in tried.chain(model.parameter("v_s")) {
        let dip = |v: f64| (-(v / v_s).powi(2)).exp();
        let (x, left) = least_squares(&curve, &[&|_| 1.0, &dip, &|v| v]);
        let f_c = x[0].max(1e-9 * (x[0] + x[1]).max(f64::MIN_POSITIVE));
        let found = StribeckParameters { f_s: f_c + x[1], f_c, v_s, delta: 2.0, f_v: x[2] };
        if best.as_ref().is_none_or(|(least, _)| left < *least) {
            best = Some((left, found));
        }
    }
    best.map_or(
        StribeckParameters { f_s: 1.0, f_c: 1.0, v_s: 1.0, delta: 2.0, f_v: 0.0 },
        |(_, found)| found,
    )
}

/// LuGre with that Stribeck curve, and with the model's stiffness and micro-damping; none for a
/// model without pre-sliding.
pub(crate) fn lugre(model: &AnyModel, speeds: &Speeds) -> Option<LuGreParameters> {
    let half = travel_to_half(model, speeds)?;
    let StribeckParameters { f_s, f_c, v_s, delta, f_v } = stribeck(model, speeds);
    // LuGre's force as it is bent: F_s (1 - exp(-sigma0 x / F_s)).
    let sigma0 = std::f64::consts::LN_2 * level_at_rest(model, speeds) / half;
    let sigma1 = model.parameters().values("sigma1").iter().sum();
    Some(LuGreParameters { f_s, f_c, v_s, delta, sigma0, sigma1, v_d: None, f_v })
}

/// How far the contact bends until it carries half the level at which it slides; none where it does
/// so at once.
fn travel_to_half(model: &AnyModel, speeds: &Speeds) -> Option<f64> {
    let velocity = SLOW * speeds.high();
    let mut contact = model.start_by(Scheme::Mean, TimeStep::new(STEP).ok()?);
    let viscous = contact.viscous(velocity);
    let half = 0.5 * (model.steady_state(velocity) - viscous);
    let mut before = contact.step(velocity) - viscous;
    if !(half > 0.0 && before < half) {
        return None;
    }
    for k in 1..PATIENCE {
        let now = contact.step(velocity) - viscous;
        if now >= half {
            let part = (half - before) / (now - before);
            return Some(velocity * STEP * (f64::from(k - 1) + part)).filter(|x| *x > 0.0);
        }
        before = now;
    }
    None
}

/// Coefficients, none below zero, of the sum of terms that is nearest to the points; and the sum of
/// the squares that are left. Every set of terms is tried, of which there are few.
fn least_squares(points: &[(f64, f64)], terms: &[&dyn Fn(f64) -> f64]) -> (Vec<f64>, f64) {
    let mut best = (vec![0.0; terms.len()], f64::INFINITY);
    for set in 0..1u32 << terms.len() {
        let chosen: Vec<usize> = (0..terms.len()).filter(|k| set >> k & 1 == 1).collect();
        let target = DVector::from_iterator(points.len(), points.iter().map(|(_, y)| *y));
        let mut x = vec![0.0; terms.len()];
        let mut left = target.norm_squared();
        if !chosen.is_empty() {
            let matrix = DMatrix::from_fn(points.len(), chosen.len(), |row, column| {
                terms[chosen[column]](points[row].0)
            });
            let Ok(found) = matrix.clone().svd(true, true).solve(&target, 1e-12) else { continue };
            if found.iter().any(|x| *x < 0.0 || !x.is_finite()) {
                continue;
            }
            left = (&matrix * &found - &target).norm_squared();
            for (place, value) in chosen.iter().zip(found.iter()) {
                x[*place] = *value;
            }
        }
        if left < best.1 {
            best = (x, left);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;
    use crate::SpeedsFrom;

    fn range() -> Speeds {
        Speeds::new(0.01, 3.0, SpeedsFrom::Asked).unwrap()
    }

    #[test]
    fn what_can_be_held_is_found_again() {
        let model = AnyModel::test_bed(ModelName::CoulombViscous);
        let (f_c, f_v) = coulomb_viscous(&model, &range());
        assert!((f_c / model.parameter("f_c").unwrap() - 1.0).abs() < 1e-9);
        assert!((f_v / model.parameter("f_v").unwrap() - 1.0).abs() < 1e-9);
        let model = AnyModel::test_bed(ModelName::Stribeck);
        let found = stribeck(&model, &range());
        assert!((found.f_s / model.parameter("f_s").unwrap() - 1.0).abs() < 1e-6, "{found:?}");
        assert!((level_at_rest(&model, &range()) - found.f_s).abs() < 1e-6);
    }

    #[test]
    fn lugre_is_found_again_from_its_force_alone() {
        let model = AnyModel::test_bed(ModelName::LuGre);
        let found = lugre(&model, &range()).unwrap();
        for (name, value) in [
            ("f_s", found.f_s),
            ("f_c", found.f_c),
            ("sigma0", found.sigma0),
            ("sigma1", found.sigma1),
        ] {
            let own = model.parameter(name).unwrap();
            assert!((value / own - 1.0).abs() < 0.01, "{name}: {value}, {own}");
        }
    }

    #[test]
    fn a_model_without_pre_sliding_is_no_lugre() {
        for name in [ModelName::Stribeck, ModelName::CoulombViscous, ModelName::Viscous] {
            assert_eq!(lugre(&AnyModel::test_bed(name), &range()), None, "{name}");
        }
        for name in [ModelName::Dahl, ModelName::Gms, ModelName::ElastoPlastic, ModelName::Proposed]
        {
            assert!(lugre(&AnyModel::test_bed(name), &range()).is_some(), "{name}");
        }
    }
}
