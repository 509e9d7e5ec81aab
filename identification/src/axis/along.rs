//! Where along the axis the forces of a structure are meant: its polynomials run from -1 to 1.

use friction_ident::Estimates;
use friction_ident::axis_structure::{PositionScale, StructureFit};
use recording::AxisKind;
use report::numbers::{significant, with_error};
use serde_json::{Value, json};

/// A structure's travel, and its spring and offset in terms of the position itself.
pub(super) struct Along {
    scale: PositionScale,
    axis: AxisKind,
    /// Force by position, and its standard error \[N/m or N m/rad\].
    stiffness: (f64, f64),
    /// The constant force at position zero, and its standard error \[N or N m\]; none where friction of
    /// each direction has taken the place of an offset.
    at_zero: Option<(f64, f64)>,
}

impl Along {
    /// None where nothing of the structure depends on the place along the travel.
    pub(super) fn of(fit: &StructureFit, axis: AxisKind) -> Option<Self> {
        let (scale, estimates) = (fit.position_scale, &fit.estimates);
        let spring = estimates.get("spring")?;
        let error = spring.standard_error.unwrap_or(f64::NAN);
        let at_zero = estimates.value("offset").map(|offset| {
            let share = -scale.middle / scale.half;
            (offset + share * spring.value, sum_error(estimates, share))
        });
        let stiffness = (spring.value / scale.half, error / scale.half);
        Some(Self { scale, axis, stiffness, at_zero })
    }

    /// The travel alone, in one sentence.
    pub(super) fn travel(&self) -> String {
        let unit = self.axis.position_unit();
        let PositionScale { middle, half } = self.scale;
        format!(
            "The middle of the travel is at {} {unit}, half of it is {} {unit}; xi = (position - middle) / half runs from -1 to 1.",
            significant(middle, 4),
            significant(half, 4)
        )
    }

    /// What the numbers of the table mean.
    pub(super) fn note(&self) -> String {
        let force = self.axis.force_unit();
        let (stiffness, error) = self.stiffness;
        let spring = format!(
            "spring is the force that half the travel adds; by the position it is {} {}.",
            with_error(stiffness, error),
            stiffness_unit(self.axis)
        );
        let offset = self.at_zero.map_or(String::new(), |(value, error)| {
            format!(
                " offset is the constant force at the middle of the travel; carried on to position zero it is {} {force}.",
                with_error(value, error)
            )
        });
        format!(
            "{} {spring}{offset} f_c is the level at the middle: along the travel it is f_c + f_c_slope xi + f_c_curvature xi^2.",
            self.travel()
        )
    }

    /// The same for programs.
    pub(super) fn document(&self) -> Value {
        let number = |(value, error): (f64, f64), unit: &str| json!({ "value": value, "standard_error": error, "unit": unit });
        json!({
            "middle": self.scale.middle,
            "half_travel": self.scale.half,
            "unit": self.axis.position_unit(),
            "stiffness": number(self.stiffness, stiffness_unit(self.axis)),
            "offset_at_position_zero": self.at_zero.map(|at| number(at, self.axis.force_unit())),
        })
    }
}

/// Unit of a force by position.
pub(super) const fn stiffness_unit(axis: AxisKind) -> &'static str {
    match axis {
        AxisKind::Linear => "N/m",
        AxisKind::Rotary => "N m/rad",
    }
}

/// Standard error of the offset and a share of the spring; none where one of them has none.
fn sum_error(estimates: &Estimates, share: f64) -> f64 {
    let of = |a: &'static str, b: &'static str| {
        let row = estimates.covariance.get(estimates.place(a)?)?;
        row.get(estimates.place(b)?).copied()
    };
    let variance = || {
        let both = of("offset", "offset")? + share * share * of("spring", "spring")?;
        Some(both + 2.0 * share * of("offset", "spring")?)
    };
    variance().filter(|variance| *variance >= 0.0).map_or(f64::NAN, f64::sqrt)
}

#[cfg(test)]
mod tests {
    use friction_ident::axis_structure::fit_structure;
    use friction_ident::{Conditioning, Signals, condition};

    use super::*;
    use crate::axis::structure::units;

    /// A spring of 900 N/m about 4 N at position zero, on a travel from 10 to 40 mm, was told as 13.5 N
    /// and 26.5 N, and nothing said of what.
    #[test]
    fn spring_and_offset_are_told_by_the_metre_and_at_position_zero() {
        let time = || (0..12_000).map(|k| f64::from(k) * 1e-3);
        let at = |t: f64| 0.025 + 0.010 * (1.1 * t).sin() + 0.005 * (3.7 * t).sin();
        let force = |t: f64| {
            let v = 0.011 * (1.1 * t).cos() + 0.0185 * (3.7 * t).cos();
            let a = -0.0121 * (1.1 * t).sin() - 0.06845 * (3.7 * t).sin();
            5.0 * a + 20.0 * v + 3.0 * v.signum() + 4.0 + 900.0 * at(t)
        };
        let place: Vec<f64> = time().map(at).collect();
        let force: Vec<f64> = time().map(force).collect();
        let signals = Signals {
            time_step: 1e-3,
            position: Some(&place),
            readings: None,
            velocity: None,
            force: &force,
        };
        let recording = condition(&signals, &Conditioning::for_time_step(1e-3)).unwrap();
        let fit = |name: &str| {
            let units = units(AxisKind::Linear);
            fit_structure(&recording, name.parse().unwrap(), units).unwrap()
        };
        let along = Along::of(&fit("symmetric+position"), AxisKind::Linear).unwrap();
        let (stiffness, at_zero) = (along.stiffness.0, along.at_zero.unwrap().0);
        assert!((stiffness - 900.0).abs() < 20.0, "{stiffness}");
        assert!((at_zero - 4.0).abs() < 0.5, "{at_zero}");
        let document = along.document();
        assert!((document["middle"].as_f64().unwrap() - 0.025).abs() < 1e-3, "{document}");
        assert!((document["half_travel"].as_f64().unwrap() - 0.015).abs() < 1e-3, "{document}");
        let note = along.note();
        for said in ["N/m", "position zero", "middle of the travel", "f_c_slope xi"] {
            assert!(note.contains(said), "{note}");
        }
        let along = Along::of(&fit("asymmetric+position"), AxisKind::Linear).unwrap();
        assert_eq!(along.at_zero, None);
        assert!(Along::of(&fit("symmetric"), AxisKind::Linear).is_none());
    }
}
