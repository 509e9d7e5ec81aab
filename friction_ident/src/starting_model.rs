//! Where a search begins: a model of the right kind and the right size.

use friction_model::{
    AnyModel, AnyParameters, Elements, GmsParameters, ModelError, ModelName, XiongParameters,
};

use crate::static_curve::StribeckValues;

/// The test bed's model of that name, with `elements` elements where it has any.
///
/// # Errors
/// [`ModelError`] if the model has no room for so many.
pub fn with_elements(name: ModelName, elements: usize) -> Result<AnyModel, ModelError> {
    let n = elements.max(1);
    // Shares alike, stiffnesses spread over a decade around the test bed's total.
    let share = Elements::from_fn(n, |_| 1.0 / n as f64);
    let spread = |total: f64| {
        let weight = move |i: usize| 10f64.powf(-(i as f64) / n.max(2) as f64);
        let sum: f64 = (0..n).map(weight).sum();
        Elements::from_fn(n, move |i| total * weight(i) / sum)
    };
    match AnyParameters::test_bed(name) {
        AnyParameters::Gms(p) if n != p.alpha.len() => AnyParameters::Gms(GmsParameters {
            alpha: share,
            sigma0: spread(p.sigma0.iter().sum()),
            sigma1: spread(p.sigma1.iter().sum()),
            c: Elements::from_fn(n, |_| p.c.first().copied().unwrap_or(0.3)),
            ..p
        })
        .try_into(),
        AnyParameters::Xiong(p) if n != p.lambda.len() => AnyParameters::Xiong(XiongParameters {
            lambda: share,
            k: spread(p.k.iter().sum()),
            sigma: spread(p.sigma.iter().sum()),
            ..p
        })
        .try_into(),
        parameters => parameters.try_into(),
    }
}

/// The model with these static parameters and with its stiffness at a breakaway displacement of
/// `reach` [m or rad]: what scales with the level and the reach is scaled, times are kept.
///
/// # Errors
/// [`ModelError`] if the model does not accept them.
pub fn scaled_to(
    model: &AnyModel,
    level: &StribeckValues,
    reach: Option<f64>,
) -> Result<AnyModel, ModelError> {
    let StribeckValues { f_s, f_c, v_s, f_v, delta } = *level;
    let mut parameters = model.parameters();
    let before = model.parameter("f_c").or(model.parameter("f_s")).unwrap_or(f_c);
    let force = f_c / before;
    let old_reach = breakaway_reach(model).unwrap_or(1.0);
    let length = reach.map_or(1.0, |reach| reach / old_reach);
    scale(&mut parameters, force, length);
    // Leuven's bristles must carry the static friction.
    if let (Some(f_h), Some(before)) = (model.parameter("f_h"), model.parameter("f_s")) {
        parameters.set("f_h", f_h / before * f_s * (1.0 + 1e-12));
    }
    for (name, value) in [("f_s", f_s), ("f_c", f_c), ("v_s", v_s), ("f_v", f_v), ("delta", delta)]
    {
        // Dahl's delta is another: the shape of its stress-strain curve.
        if name != "delta" || model.name() != ModelName::Dahl {
            parameters.set(name, value);
        }
    }
    parameters.try_into()
}

/// The parameters of a model whose contact bends `length` times as far at the same friction.
pub fn bent_by(model: &AnyModel, length: f64) -> AnyParameters {
    let mut parameters = model.parameters();
    scale(&mut parameters, 1.0, length);
    parameters
}

/// What belongs to bending, for a level `force` times and a reach `length` times as large.
fn scale(parameters: &mut AnyParameters, force: f64, length: f64) {
    for name in ["sigma0", "k"] {
        parameters.scale(name, force / length);
    }
    for name in ["sigma", "sigma1"] {
        parameters.scale(name, force / length.sqrt());
    }
    for name in ["z_b", "z_ba", "c"] {
        parameters.scale(name, length);
    }
}

/// How far the contact bends before it slides as a whole, roughly [m or rad]: `z_b`, the level over
/// the stiffness, or the width of the widest element.
pub fn breakaway_reach(model: &AnyModel) -> Option<f64> {
    if let Some(z_b) = model.parameter("z_b") {
        return Some(z_b);
    }
    let parameters = model.parameters();
    let level = model.parameter("f_s").or(model.parameter("f_c"))?;
    let widths =
        [("alpha", "sigma0"), ("lambda", "k")].into_iter().flat_map(|(share, stiffness)| {
            parameters
                .values(share)
                .into_iter()
                .zip(parameters.values(stiffness))
                .map(|(share, k)| share * level / k)
        });
    if let Some(widest) = widths.max_by(f64::total_cmp) {
        return Some(widest);
    }
    let stiffness: f64 = parameters.values("sigma0").iter().sum();
    (stiffness > 0.0).then(|| level / stiffness)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_takes_another_size() {
        let level = StribeckValues { f_s: 30.0, f_c: 20.0, v_s: 0.02, f_v: 200.0, delta: 2.0 };
        for name in ModelName::ALL {
            let model = scaled_to(&AnyModel::test_bed(name), &level, Some(1e-5));
            assert!(model.is_ok(), "{name}: {model:?}");
        }
        let lugre = scaled_to(&AnyModel::test_bed(ModelName::LuGre), &level, Some(1e-5)).unwrap();
        assert!((breakaway_reach(&lugre).unwrap() / 1e-5 - 1.0).abs() < 0.5, "{lugre:?}");
        assert_eq!(lugre.steady_state(0.5), level.torque(0.5));
    }

    #[test]
    fn elements_can_be_as_many_as_there_is_room_for() {
        for name in [ModelName::Gms, ModelName::Xiong] {
            for n in [1, 3, 4, 10, 16] {
                let model = with_elements(name, n).unwrap();
                assert!(
                    (model.steady_state(0.5) - AnyModel::test_bed(name).steady_state(0.5)).abs()
                        < 1e-12
                );
            }
            assert!(with_elements(name, 17).is_err());
        }
    }
}
