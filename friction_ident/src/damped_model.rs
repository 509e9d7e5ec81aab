//! A model with its micro-damping computed from the inertia that moves on the bristles, see
//! [`crate::micro_damping`]; of models with elements each element's from its own stiffness.

use friction_model::{AnyModel, AnyParameters};

use crate::IdentError;
use crate::estimate::{Estimate, Estimates};
use crate::micro_damping::Oscillator;
use crate::parameter_id::{ParameterId, Side};
use crate::uncertain::Uncertain;

/// Share of the whole damping that a contact gets where viscous friction leaves nothing to it.
const TRACE: f64 = 1e-2;

/// The model with its micro-damping computed, and the values with the standard error that the
/// inertia's brings.
///
/// # Errors
/// [`IdentError::NotAnOscillator`] for an impossible inertia, stiffness or damping ratio.
pub fn with_computed_damping(
    model: &AnyModel,
    inertia: Uncertain,
    damping_ratio: f64,
    rotary: bool,
) -> Result<(AnyModel, Estimates), IdentError> {
    let (mut forward, mut backward) = model.parameters().sides();
    let mut estimates = Estimates::default();
    let asymmetric = matches!(model.parameters(), AnyParameters::Asymmetric(_));
    for (side, parameters) in [(Side::Forward, &mut forward), (Side::Backward, &mut backward)] {
        let f_v = parameters.values("f_v").first().copied().unwrap_or(0.0);
        let stiffness = stiffness(parameters);
        let name = if parameters.values("sigma1").is_empty() { "sigma" } else { "sigma1" };
        let list = parameters.values(name).len() > 1;
        let unit = if rotary { "N m s/rad" } else { "N s/m" };
        for (element, k) in stiffness.into_iter().enumerate() {
            let oscillator = Oscillator {
                inertia,
                stiffness: Uncertain::exact(k),
                f_v: Uncertain::exact(f_v),
                zeta: damping_ratio,
            };
            let whole = Oscillator { f_v: Uncertain::exact(0.0), ..oscillator };
            let whole = whole.micro_damping()?.value;
            // Beside a soft contact viscous friction alone may damp more than was asked for: it gets
            // a trace, with no error of its own.
            let (computed, source) = if whole <= f_v {
                (
                    Uncertain::exact(TRACE * whole),
                    "a trace: viscous friction alone damps more than was asked for",
                )
            } else {
                (oscillator.micro_damping()?, "computed from the inertia and the damping ratio")
            };
            let Uncertain { value: damping, standard_error } = computed;
            if !parameters.set_at(name, element, damping) {
                continue;
            }
            let id = ParameterId {
                name,
                element: list.then_some(element),
                side: if asymmetric { side } else { Side::Both },
            };
            let mut estimate = Estimate::given(id, unit, damping, source);
            estimate.standard_error = Some(standard_error);
            estimates.parameters.push(estimate);
        }
        if !asymmetric {
            break;
        }
    }
    Ok((model.parameters().with_sides(forward, backward)?, estimates))
}

/// Stiffness at rest, one an element \[N/m or N m/rad\].
fn stiffness(parameters: &AnyParameters) -> Vec<f64> {
    let first = |name: &str| parameters.values(name).first().copied();
    match (first("f_s"), first("z_b")) {
        (Some(f_s), Some(z_b)) => vec![f_s * std::f64::consts::PI / (2.0 * z_b)],
        _ if !parameters.values("k").is_empty() => parameters.values("k"),
        _ => parameters.values("sigma0"),
    }
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;

    #[test]
    fn a_soft_contact_beside_strong_viscous_friction_gets_a_trace() {
        let mut parameters = AnyModel::test_bed(ModelName::Gms).parameters();
        parameters.set_at("sigma0", 3, 0.01);
        let (model, found) = with_computed_damping(
            &parameters.try_into().unwrap(),
            Uncertain::exact(0.0026),
            0.7,
            true,
        )
        .unwrap();
        let sigma1 = model.parameters().values("sigma1");
        assert!(sigma1[3] > 0.0 && sigma1[3] < 1e-4 && sigma1[0] > 0.1, "{sigma1:?}");
        assert!(
            matches!(found.parameters[3].verdict, crate::Verdict::Given { source } if source.contains("trace"))
        );
        // So does a contact without elements; an impossible inertia is refused.
        let lugre = AnyModel::test_bed(ModelName::LuGre).scaled("f_v", 50.0).unwrap();
        let (model, _) =
            with_computed_damping(&lugre, Uncertain::exact(0.0026), 0.7, true).unwrap();
        assert!(model.parameter("sigma1").unwrap() < 0.01);
        assert!(with_computed_damping(&lugre, Uncertain::exact(0.0), 0.7, true).is_err());
    }

    /// Errata 2: J = 0.0026, zeta = 0.7, f_v = 0.0403 and the stiffnesses of tables 4.4 to 4.7 give
    /// all ten printed values.
    #[test]
    fn the_printed_values_come_out() {
        let inertia = Uncertain::relative(0.0026, 0.01);
        for (name, printed) in [
            (ModelName::Proposed, &[0.32129][..]),
            (ModelName::LuGre, &[0.24940]),
            (ModelName::Gms, &[0.16111, 0.11733, 0.07489, 0.03211]),
            (ModelName::Xiong, &[0.19637, 0.07880, 0.06032, 0.02271]),
        ] {
            let mut parameters = AnyModel::test_bed(name).parameters();
            // The pre-sliding stage's own F_s.
            if name == ModelName::Proposed {
                parameters.set("f_s", 0.0980);
            }
            let (model, found) =
                with_computed_damping(&parameters.try_into().unwrap(), inertia, 0.7, true).unwrap();
            assert_eq!(found.parameters.len(), printed.len());
            for (estimate, printed) in found.parameters.iter().zip(printed) {
                assert!(
                    (estimate.value - printed).abs() < 1e-5,
                    "{name} {estimate:?}, printed {printed}"
                );
                // A percent of inertia is half a percent of the damping before f_v is taken off.
                let expected = 0.005 * (estimate.value + 0.0403);
                assert!((estimate.standard_error.unwrap() - expected).abs() < 1e-12);
            }
            let name = if name == ModelName::Proposed || name == ModelName::Xiong {
                "sigma"
            } else {
                "sigma1"
            };
            assert_eq!(model.parameters().values(name)[0], found.parameters[0].value);
        }
    }
}
