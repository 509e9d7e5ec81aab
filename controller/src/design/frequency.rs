//! Open loop over frequency: crossover, margins, sensitivity.

use nalgebra::Complex;

use super::LinearLoop;

/// Margins of a loop. Where the gain or phase is crossed more than once, the smallest margin
/// counts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Margins {
    /// Highest frequency at which the open loop's gain is 1 \[rad/s\].
    pub crossover: Option<f64>,
    /// Phase margin \[degrees\].
    pub phase_margin: Option<f64>,
    /// Factor by which the gain may grow.
    pub gain_margin: Option<f64>,
    /// Factor, below 1, down to which the gain may fall.
    pub gain_reduction: Option<f64>,
    /// Delay that may be added \[s\]: phase margin over crossover.
    pub delay_margin: Option<f64>,
    /// Largest sensitivity `|1 / (1 + L)|`; one over the distance of the Nyquist curve from -1.
    pub sensitivity_peak: f64,
    /// Where it is \[rad/s\].
    pub sensitivity_frequency: f64,
}

/// Points a decade of the frequencies that are searched.
const POINTS_A_DECADE: f64 = 400.0;

/// So many frequencies from `lowest` to `highest` \[rad/s\], equally spaced on a logarithmic scale,
/// both ends included.
#[must_use]
pub fn frequencies(lowest: f64, highest: f64, a_decade: f64) -> Vec<f64> {
    let decades = (highest / lowest).log10();
    // A range that is none has no frequencies.
    let steps = (decades * a_decade).ceil();
    if !(steps > 0.0 && steps < 1e7) {
        return Vec::new();
    }
    (0..=steps as usize).map(|k| lowest * 10f64.powf(decades * k as f64 / steps)).collect()
}

/// Margins of the open loop `open(w)` between `lowest` and `highest` \[rad/s\].
///
/// Crossings are bracketed on 400 frequencies a decade and then bisected.
#[must_use]
pub fn margins(open: impl Fn(f64) -> Complex<f64>, lowest: f64, highest: f64) -> Margins {
    let grid = frequencies(lowest, highest, POINTS_A_DECADE);
    let mut found = Margins::default();
    let smaller =
        |a: Option<f64>, b: f64| Some(a.map_or(b, |a| if b.abs() < a.abs() { b } else { a }));
    for pair in grid.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        let (at_low, at_high) = (open(low), open(high));
        if (at_low.norm() >= 1.0) != (at_high.norm() >= 1.0) {
            let w = bisect(low, high, |w| (open(w).norm() >= 1.0) == (at_low.norm() >= 1.0));
            // From -180 to 180: negative if the curve passes -1 on the wrong side.
            let margin = (-open(w)).arg().to_degrees();
            found.crossover = Some(w);
            found.phase_margin = smaller(found.phase_margin, margin);
            if margin > 0.0 {
                found.delay_margin = smaller(found.delay_margin, margin.to_radians() / w);
            }
        }
        if (at_low.im >= 0.0) != (at_high.im >= 0.0) && at_low.re < 0.0 && at_high.re < 0.0 {
            let w = bisect(low, high, |w| (open(w).im >= 0.0) == (at_low.im >= 0.0));
            let factor = 1.0 / open(w).norm();
            if factor > 1.0 {
                found.gain_margin = smaller(found.gain_margin, factor);
            } else {
                found.gain_reduction =
                    Some(found.gain_reduction.map_or(factor, |before| before.max(factor)));
            }
        }
    }
    let sensitivity = |w: f64| 1.0 / (1.0 + open(w)).norm();
    for &w in &grid {
        if sensitivity(w) > found.sensitivity_peak {
            (found.sensitivity_peak, found.sensitivity_frequency) = (sensitivity(w), w);
        }
    }
    found
}

/// Margins of a loop as it runs at the period `dt` \[s\], from `lowest` \[rad/s\] to the Nyquist
/// frequency, where a sampled loop is real and may be at -180 degrees.
#[must_use]
pub fn margins_sampled(linear: &LinearLoop, dt: f64, lowest: f64) -> Margins {
    // The bilinear rule sees the Nyquist frequency itself at infinity.
    let nyquist = std::f64::consts::PI / dt * (1.0 - 1e-9);
    let mut found = margins(|w| linear.open_sampled(w, dt), lowest, nyquist);
    let last = linear.open_sampled(nyquist, dt);
    if last.re < 0.0 && last.im.abs() < 1e-3 * last.re.abs() && last.norm() < 1.0 {
        let factor = 1.0 / last.norm();
        found.gain_margin = Some(found.gain_margin.map_or(factor, |before| before.min(factor)));
    }
    found
}

/// The end of the part of the interval, from its beginning, in which `same` holds.
fn bisect(mut low: f64, mut high: f64, same: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if same(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{LinearDrive, LoopLaw};
    use crate::{DerivativeOn, LagGains, PidGains, VelocityLaw};

    fn of(law: LoopLaw) -> Margins {
        let linear = LinearLoop { drive: LinearDrive::THESIS, law };
        margins(|w| linear.open(w), 1e-2, 1e5)
    }

    /// Expected: crossover 111.03 rad/s, phase margin 105.2 degrees.
    #[test]
    fn the_thesis_lag_has_the_expected_margins() {
        let found = of(LoopLaw::Velocity(VelocityLaw::Lag(LagGains::THESIS)));
        assert!((found.crossover.unwrap() / 111.03 - 1.0).abs() < 1e-3, "{found:?}");
        assert!((found.phase_margin.unwrap() - 105.2).abs() < 0.1, "{found:?}");
        assert_eq!(found.gain_margin, None);
        // The gain at zero frequency, 53.140 with the exact gains, crosses over at 4145.5 rad/s on
        // its own.
        let alone = margins(
            |w| {
                53.140
                    * LinearLoop {
                        drive: LinearDrive::THESIS,
                        law: LoopLaw::Velocity(VelocityLaw::default()),
                    }
                    .plant()
                    .at_frequency(w)
            },
            1.0,
            1e5,
        );
        assert!((alone.crossover.unwrap() / 4145.5 - 1.0).abs() < 1e-3);
        // The drive alone crosses over at 65.824 rad/s.
        let drive = margins(
            |w| {
                LinearLoop {
                    drive: LinearDrive::THESIS,
                    law: LoopLaw::Velocity(VelocityLaw::default()),
                }
                .plant()
                .at_frequency(w)
            },
            1.0,
            1e5,
        );
        assert!((drive.crossover.unwrap() / 65.824 - 1.0).abs() < 1e-4);
    }

    /// A sampled first-order loop under a proportional gain goes unstable at z = -1:
    /// `k K (1 - a) = 1 + a`.
    #[test]
    fn a_sampled_loop_has_a_gain_margin_at_the_nyquist_frequency() {
        let drive = LinearDrive::THESIS;
        let law = LoopLaw::Velocity(VelocityLaw::Pi(crate::PiGains { k_p: 2.0, k_i: 0.0 }));
        let a = (-1e-3 / drive.time_constant).exp();
        let expected = (1.0 + a) / (2.0 * drive.gain * (1.0 - a));
        let found = margins_sampled(&LinearLoop { drive, law }, 1e-3, 0.1).gain_margin.unwrap();
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }

    /// `k / (s (s + 1)^2)`: phase -180 degrees at 1 rad/s, where the gain is k / 2.
    #[test]
    fn gain_and_sensitivity_of_a_loop_in_closed_form() {
        let open = |w: f64| {
            let s = Complex::new(0.0, w);
            0.5 / (s * (s + 1.0) * (s + 1.0))
        };
        let found = margins(open, 1e-3, 1e3);
        assert!((found.gain_margin.unwrap() - 4.0).abs() < 1e-9);
        let w = found.crossover.unwrap();
        // |L| = 1: w (1 + w^2) = 0.5.
        assert!((w * (1.0 + w * w) - 0.5).abs() < 1e-9);
        assert!((found.phase_margin.unwrap() - (90.0 - 2.0 * w.atan().to_degrees())).abs() < 1e-9);
        assert!(
            (found.sensitivity_peak - 1.0 / (1.0 + open(found.sensitivity_frequency)).norm()).abs()
                < 1e-12
        );
        assert!(found.sensitivity_peak > 4.0 / 3.0);
    }

    /// The gains may fall until Routh's criterion fails: `(1 + K k K_d) K_p = T K_i` for the factor
    /// k.
    #[test]
    fn a_pid_may_also_lose_gain_only_so_far() {
        let gains = PidGains { k_i: 300.0, ..PidGains::THESIS };
        let found =
            of(LoopLaw::Position { gains, derivative_on: DerivativeOn::Error, filter: 0.0 });
        let routh = (0.02388 * 300.0 / 5.7517 - 1.0) / (1.863 * 0.0768);
        assert!(
            (found.gain_reduction.or(found.gain_margin).unwrap() / routh - 1.0).abs() < 1e-9,
            "{found:?} {routh}"
        );
    }
}
