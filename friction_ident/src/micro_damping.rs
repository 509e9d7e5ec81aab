//! Micro-damping from a chosen damping ratio.
//!
//! In pre-sliding a body of inertia `J` on a contact of stiffness `k` is an oscillator; with the
//! damping ratio `zeta` its damping is `2 zeta sqrt(J k)`, of which the viscous friction is one
//! part and the micro-damping the rest:
//!
//! ```text
//! sigma = 2 zeta sqrt(J k) - f_v
//! ```
//!
//! (thesis eqs. 4.36 to 4.40; the printed 4.37 lacks the root around `J`, the values in the text
//! follow from this form.) The stiffness is `F_s pi / (2 Z_b)` for the proposed model and `sigma0`
//! or `K` for the others; GMS and Xiong's model use it element by element. The result is a choice,
//! not a measurement: it is as good as `zeta` is.

use friction_model::Unit;

use crate::IdentError;
use crate::derived::{Derived, derive};
use crate::estimate::{Estimates, Unknown};
use crate::uncertain::Uncertain;

/// The damping ratio of the thesis.
pub const THESIS_ZETA: f64 = 0.7;

/// What the micro-damping of one contact is computed from. Errors count as independent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    /// Inertia or mass \[kg m^2 or kg\], above zero.
    pub inertia: Uncertain,
    /// Stiffness of the contact at rest \[N m/rad or N/m\], above zero.
    pub stiffness: Uncertain,
    /// Viscous friction \[N m s/rad or N s/m\], zero or more.
    pub f_v: Uncertain,
    /// Damping ratio, above zero; the thesis takes 0.7.
    pub zeta: f64,
}

impl Oscillator {
    /// The micro-damping \[N m s/rad or N s/m\] and its standard error.
    ///
    /// # Errors
    /// [`IdentError::NotAnOscillator`] unless inertia, stiffness and damping ratio are positive and
    /// the viscous friction leaves something over.
    ///
    /// ```
    /// use friction_ident::Uncertain;
    /// use friction_ident::micro_damping::{Oscillator, THESIS_ZETA};
    ///
    /// // LuGre on the thesis's test bed.
    /// let sigma = Oscillator {
    ///     inertia: Uncertain::exact(0.0026),
    ///     stiffness: Uncertain { value: 16.469, standard_error: 0.2 },
    ///     f_v: Uncertain::exact(0.0403),
    ///     zeta: THESIS_ZETA,
    /// }
    /// .micro_damping()?;
    /// assert!((sigma.value - 0.2494).abs() < 1e-4);
    /// assert!((sigma.standard_error - 0.5 * 0.2 / 16.469 * (0.2494 + 0.0403)).abs() < 1e-6);
    /// # Ok::<(), friction_ident::IdentError>(())
    /// ```
    pub fn micro_damping(&self) -> Result<Uncertain, IdentError> {
        let Self { inertia, stiffness, f_v, zeta } = *self;
        let refuse = |what, value| Err(IdentError::NotAnOscillator { what, value });
        for (what, value) in [
            ("the inertia", inertia.value),
            ("the stiffness", stiffness.value),
            ("the damping ratio", zeta),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return refuse(what, value);
            }
        }
        if !(f_v.value >= 0.0 && f_v.value.is_finite()) {
            return refuse("the viscous friction", f_v.value);
        }
        let whole = 2.0 * zeta * (inertia.value * stiffness.value).sqrt();
        let value = whole - f_v.value;
        if value <= 0.0 {
            return refuse("the micro-damping left beside the viscous friction", value);
        }
        let relative = (inertia.standard_error / inertia.value)
            .hypot(stiffness.standard_error / stiffness.value);
        Ok(Uncertain { value, standard_error: (0.5 * whole * relative).hypot(f_v.standard_error) })
    }
}

/// Stiffness at rest of the proposed model, `F_s pi / (2 Z_b)` \[N m/rad or N/m\], from estimates
/// of `f_s` and `z_b` with their correlation. None where one of the two is missing.
pub fn proposed_stiffness(pre_sliding: &Estimates) -> Option<Uncertain> {
    let (f_s, z_b) = (pre_sliding.value("f_s")?, pre_sliding.value("z_b")?);
    let value = 0.5 * std::f64::consts::PI * f_s / z_b;
    let gradient = pre_sliding
        .parameters
        .iter()
        .map(|estimate| match estimate.id.name {
            "f_s" => value / f_s,
            "z_b" => -value / z_b,
            _ => 0.0,
        })
        .collect();
    let unknown = Unknown { id: "stiffness".into(), unit: Unit::Stiffness.rotary(), remedy: "" };
    let derived = derive(pre_sliding, &[Derived { unknown, value, gradient }]);
    let error = derived.parameters.first().and_then(|estimate| estimate.standard_error);
    Some(Uncertain { value, standard_error: error.unwrap_or(0.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pre_sliding::{Operator, PreSlidingModel, PreSlidingPath, fit_pre_sliding};

    fn sigma(stiffness: f64) -> f64 {
        let exact = Uncertain::exact;
        Oscillator {
            inertia: exact(0.0026),
            stiffness: exact(stiffness),
            f_v: exact(0.0403),
            zeta: THESIS_ZETA,
        }
        .micro_damping()
        .unwrap()
        .value
    }

    /// Erratum 2: all ten values of section 4.6.3, for the proposed model, LuGre, GMS and Xiong's
    /// model.
    #[test]
    fn the_ten_printed_values_follow() {
        let stiffness = [
            0.098 * std::f64::consts::PI / 0.012,
            16.469,
            7.9605,
            4.8757,
            2.6039,
            1.0290,
            10.9915,
            2.7836,
            1.9866,
            0.7792,
        ];
        let printed = [
            0.32129, 0.24940, 0.16111, 0.11733, 0.07489, 0.03211, 0.19637, 0.07880, 0.06032,
            0.02271,
        ];
        for (stiffness, printed) in stiffness.into_iter().zip(printed) {
            assert!(
                (sigma(stiffness) - printed).abs() < 1e-5,
                "{stiffness}: {} {printed}",
                sigma(stiffness)
            );
        }
    }

    /// To first order, against differences.
    #[test]
    fn errors_are_carried_along() {
        let at = |j: f64, k: f64, f_v: f64| 2.0 * 0.7 * (j * k).sqrt() - f_v;
        let (j, k, f_v) = (0.0026, 16.469, 0.0403);
        let (dj, dk, df) = (1e-5, 0.1, 4e-4);
        let expected = [
            at(j + dj, k, f_v) - at(j - dj, k, f_v),
            at(j, k + dk, f_v) - at(j, k - dk, f_v),
            at(j, k, f_v + df) - at(j, k, f_v - df),
        ]
        .iter()
        .map(|d| (0.5 * d).powi(2))
        .sum::<f64>()
        .sqrt();
        let uncertain = |value, error| Uncertain { value, standard_error: error };
        let got = Oscillator {
            inertia: uncertain(j, dj),
            stiffness: uncertain(k, dk),
            f_v: uncertain(f_v, df),
            zeta: 0.7,
        }
        .micro_damping()
        .unwrap();
        assert!(
            (got.standard_error / expected - 1.0).abs() < 1e-4,
            "{} {expected}",
            got.standard_error
        );
    }

    #[test]
    fn the_stiffness_of_the_proposed_model_comes_from_its_pre_sliding_fit() {
        let x: Vec<f64> = (1..=500).map(|i| 0.0055 * (f64::from(i) * 0.05).sin()).collect();
        let mut y = vec![0.0; x.len()];
        assert!(Operator::Sine.run(&[0.006], &x, &mut y));
        y.iter_mut()
            .enumerate()
            .for_each(|(i, y)| *y = 0.098 * *y + 1e-3 * (i as f64 * 12.9898).sin());
        let path = PreSlidingPath { displacement: &x, torque: &y };
        let fit = fit_pre_sliding(&[path], PreSlidingModel::Proposed).unwrap();
        let stiffness = proposed_stiffness(&fit.estimates).unwrap();
        let error = |name: &'static str| {
            let estimate = fit.estimates.get(name).unwrap();
            estimate.standard_error.unwrap() / estimate.value
        };
        let rho = fit.estimates.correlation[0][1];
        let (a, b) = (error("f_s"), error("z_b"));
        let expected = (a * a + b * b - 2.0 * rho * a * b).sqrt();
        assert!((stiffness.standard_error / stiffness.value / expected - 1.0).abs() < 1e-9);
        assert!((stiffness.value - 25.656).abs() < 0.5, "{stiffness:?}");
    }

    #[test]
    fn what_is_no_oscillator_is_refused() {
        let exact = Uncertain::exact;
        let good = Oscillator {
            inertia: exact(0.0026),
            stiffness: exact(16.0),
            f_v: exact(0.04),
            zeta: 0.7,
        };
        for bad in [
            Oscillator { inertia: exact(0.0), ..good },
            Oscillator { stiffness: exact(f64::NAN), ..good },
            Oscillator { zeta: -0.7, ..good },
            Oscillator { f_v: exact(-0.1), ..good },
            Oscillator { f_v: exact(0.5), ..good },
        ] {
            assert!(
                matches!(bad.micro_damping(), Err(IdentError::NotAnOscillator { .. })),
                "{bad:?}"
            );
        }
    }
}
