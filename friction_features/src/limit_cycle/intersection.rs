//! The condition for a limit cycle: where the linear part meets the describing function.

use core::f64::consts::{PI, TAU};

use num_complex::Complex;
use serde::{Deserialize, Serialize};

use crate::describing_function::{HarmonicError, positive};

/// A linear part `G(s)`: two polynomials in `s`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TransferFunction {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

impl TransferFunction {
    /// From the coefficients, the constant terms first.
    ///
    /// # Errors
    /// [`HarmonicError`] if a coefficient is not finite, or the denominator is zero.
    pub fn new(numerator: Vec<f64>, denominator: Vec<f64>) -> Result<Self, HarmonicError> {
        let what = "a coefficient of the transfer function";
        if let Some(&value) = numerator.iter().chain(&denominator).find(|value| !value.is_finite())
        {
            return Err(HarmonicError { what, expected: "a finite number", value });
        }
        if denominator.iter().all(|&value| value == 0.0) {
            let what = "the denominator of the transfer function";
            return Err(HarmonicError { what, expected: "other than zero", value: 0.0 });
        }
        Ok(Self { numerator, denominator })
    }

    /// `G(j w)` at the angular frequency w \[rad/s\]; not finite at a pole.
    #[must_use]
    pub fn at(&self, angular_frequency: f64) -> Complex<f64> {
        polynomial(&self.numerator, angular_frequency)
            / polynomial(&self.denominator, angular_frequency)
    }
}

/// The polynomial with these coefficients at `s = j w`.
fn polynomial(coefficients: &[f64], angular_frequency: f64) -> Complex<f64> {
    let s = Complex::new(0.0, angular_frequency);
    coefficients
        .iter()
        .rev()
        .fold(Complex::new(0.0, 0.0), |sum, &coefficient| sum * s + coefficient)
}

/// Values from `from` to `to`, evenly spaced on a logarithmic scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Span {
    /// The first, above zero.
    pub from: f64,
    /// The last, above the first.
    pub to: f64,
    /// How many, at least two.
    pub points: usize,
}

impl Span {
    /// The values.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        let last = self.points.saturating_sub(1).max(1) as f64;
        (0..self.points).map(|i| self.from * (self.to / self.from).powf(i as f64 / last)).collect()
    }

    fn check(&self, what: &'static str) -> Result<(), HarmonicError> {
        positive(what, self.from)?;
        let refuse = |expected, value| Err(HarmonicError { what, expected, value });
        if !(self.to > self.from && self.to.is_finite()) {
            return refuse("a range whose end is finite and above its start", self.to);
        }
        if self.points < 2 {
            return refuse("a range of at least two points", self.points as f64);
        }
        Ok(())
    }
}

/// Where to look for limit cycles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// Amplitudes \[m or rad\].
    pub amplitude: Span,
    /// Angular frequencies \[rad/s\].
    pub angular_frequency: Span,
}

/// A predicted limit cycle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Intersection {
    /// Amplitude at the input of the nonlinear part \[m or rad\].
    pub amplitude: f64,
    /// Angular frequency \[rad/s\].
    pub angular_frequency: f64,
    /// Whether oscillations near it approach it (Loeb's criterion), provided that the rest of the
    /// loop is stable.
    pub stable: bool,
}

/// Solutions of `G(j w) N(A, w) = -1`, thesis eq. 3.52, within the grid.
///
/// With `G = P/Q` the function `h = Q + P N` of the plane (A, w) is zero there, without the poles
/// of G. A cell of the grid holds a solution when `h` turns once about zero along its edge; it is
/// then divided until the solution is known to 12 digits, and accepted only if `h` does vanish
/// there (a jump of N can turn `h` too). Two solutions in one cell cancel and are missed, and so is
/// a tangency: a finer grid separates the former. An empty list means that there is none in the
/// grid, to that resolution.
///
/// Loeb's criterion: with `U + jV = h`, a limit cycle is stable if `dU/dA dV/dw - dU/dw dV/dA > 0`.
///
/// # Errors
/// [`HarmonicError`] for an impossible grid.
pub fn intersections(
    linear: &TransferFunction,
    mut gain: impl FnMut(f64, f64) -> Complex<f64>,
    grid: &Grid,
) -> Result<Vec<Intersection>, HarmonicError> {
    grid.amplitude.check("the grid of amplitudes [m or rad]")?;
    grid.angular_frequency.check("the grid of angular frequencies [rad/s]")?;
    // Both terms, so that their sum can be compared with them.
    let mut terms = |amplitude: f64, w: f64| {
        (polynomial(&linear.denominator, w), polynomial(&linear.numerator, w) * gain(amplitude, w))
    };
    let mut h = |amplitude: f64, w: f64| {
        let (q, pn) = terms(amplitude, w);
        q + pn
    };
    let (amplitudes, frequencies) = (grid.amplitude.values(), grid.angular_frequency.values());
    let values: Vec<Vec<Complex<f64>>> =
        amplitudes.iter().map(|&a| frequencies.iter().map(|&w| h(a, w)).collect()).collect();

    let mut cells = Vec::new();
    for (a, rows) in amplitudes.windows(2).zip(values.windows(2)) {
        for (j, w) in frequencies.windows(2).enumerate() {
            let corners = [rows[0][j], rows[1][j], rows[1][j + 1], rows[0][j + 1]];
            if turns(corners) {
                cells.push(Cell { amplitude: [a[0], a[1]], frequency: [w[0], w[1]], corners });
            }
        }
    }

    let mut found: Vec<Intersection> = Vec::new();
    for cell in cells {
        let (amplitude, w) = cell.refined(&mut h);
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b;
        if found
            .iter()
            .any(|other| near(amplitude, other.amplitude) && near(w, other.angular_frequency))
        {
            continue;
        }
        let step = 1e-5;
        let by_amplitude = h(amplitude * (1.0 + step), w) - h(amplitude * (1.0 - step), w);
        let by_frequency = h(amplitude, w * (1.0 + step)) - h(amplitude, w * (1.0 - step));
        let stable = by_amplitude.re * by_frequency.im - by_frequency.re * by_amplitude.im > 0.0;
        let size = polynomial(&linear.denominator, w).norm();
        if h(amplitude, w).norm() <= 1e-7 * size {
            found.push(Intersection { amplitude, angular_frequency: w, stable });
        }
    }
    Ok(found)
}

/// A rectangle of the plane (A, w) with `h` at its corners, counterclockwise from the lowest
/// values.
#[derive(Debug, Clone, Copy)]
struct Cell {
    amplitude: [f64; 2],
    frequency: [f64; 2],
    corners: [Complex<f64>; 4],
}

impl Cell {
    /// The zero of `h` in it, by division into four.
    fn refined(mut self, h: &mut impl FnMut(f64, f64) -> Complex<f64>) -> (f64, f64) {
        for _ in 0..60 {
            let ([a0, a1], [w0, w1]) = (self.amplitude, self.frequency);
            let (a, w) = ((a0 * a1).sqrt(), (w0 * w1).sqrt());
            if a1 - a0 <= 1e-13 * a1 && w1 - w0 <= 1e-13 * w1 {
                break;
            }
            let [h00, h10, h11, h01] = self.corners;
            let (south, north, west, east) = (h(a, w0), h(a, w1), h(a0, w), h(a1, w));
            let middle = h(a, w);
            let quarters = [
                Self {
                    amplitude: [a0, a],
                    frequency: [w0, w],
                    corners: [h00, south, middle, west],
                },
                Self {
                    amplitude: [a, a1],
                    frequency: [w0, w],
                    corners: [south, h10, east, middle],
                },
                Self {
                    amplitude: [a, a1],
                    frequency: [w, w1],
                    corners: [middle, east, h11, north],
                },
                Self {
                    amplitude: [a0, a],
                    frequency: [w, w1],
                    corners: [west, middle, north, h01],
                },
            ];
            // Where rounding hides the turn, the quarter with the smallest values goes on; whether
            // it was right is checked at the end.
            let turning = quarters.into_iter().find(|quarter| turns(quarter.corners));
            let smallest = || quarters.into_iter().min_by(|x, y| x.size().total_cmp(&y.size()));
            self = turning.or_else(smallest).unwrap_or(self);
        }
        let middle = |[low, high]: [f64; 2]| (low * high).sqrt();
        (middle(self.amplitude), middle(self.frequency))
    }

    fn size(&self) -> f64 {
        self.corners.iter().map(|value| value.norm()).sum()
    }
}

/// Whether `h` turns about zero along the edge between these corners, or is zero at one of them.
fn turns(corners: [Complex<f64>; 4]) -> bool {
    let [a, b, c, d] = corners;
    if corners.contains(&Complex::new(0.0, 0.0)) {
        return true;
    }
    let angle: f64 =
        [(a, b), (b, c), (c, d), (d, a)].iter().map(|(from, to)| (to * from.conj()).arg()).sum();
    // Zero or a whole turn; what is not a number turns not.
    angle.abs() > PI && angle.abs() < 1.5 * TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::describing_function::closed_form::{coulomb, relay};

    fn grid() -> Grid {
        Grid {
            amplitude: Span { from: 1e-3, to: 1e2, points: 120 },
            angular_frequency: Span { from: 1e-2, to: 1e2, points: 120 },
        }
    }

    /// Textbook: a relay and `K / (s (s + 1) (s + 2))`. The phase is -180 degrees at `w = sqrt(2)`,
    /// where `|G| = K/6`; so `A = (4 M/pi) K/6`, and the cycle is stable.
    #[test]
    fn a_relay_with_a_plant_of_third_order_oscillates_as_in_the_textbook() {
        let (k, level) = (5.0, 0.7);
        let plant = TransferFunction::new(vec![k], vec![0.0, 2.0, 3.0, 1.0]).unwrap();
        let found = intersections(&plant, |a, _| relay(level, a), &grid()).unwrap();
        let [cycle] = found[..] else { panic!("{found:?}") };
        let expected = 4.0 * level / PI * plant.at(2f64.sqrt()).norm();
        assert!((plant.at(2f64.sqrt()).norm() - k / 6.0).abs() < 1e-12);
        assert!((cycle.amplitude - expected).abs() < 1e-10 * expected, "{cycle:?}");
        assert!((cycle.angular_frequency - 2f64.sqrt()).abs() < 1e-10);
        assert!(cycle.stable);
    }

    /// A mass on a spring with negative damping `-c`: Coulomb friction balances it at
    /// `A = 4 F_c / (pi c w)`, `w = sqrt(k/m)`, and loses beyond. This needs the sign of the
    /// imaginary part: friction leads.
    #[test]
    fn coulomb_friction_bounds_the_region_where_negative_damping_is_harmless() {
        let (m, c, k, f_c) = (2.0, 0.3, 50.0, 0.4);
        let plant = TransferFunction::new(vec![1.0], vec![k, -c, m]).unwrap();
        let found = intersections(&plant, |a, _| coulomb(f_c, a), &grid()).unwrap();
        let [cycle] = found[..] else { panic!("{found:?}") };
        let w = f64::sqrt(k / m);
        assert!((cycle.angular_frequency - w).abs() < 1e-10 * w);
        assert!((cycle.amplitude - 4.0 * f_c / (PI * c * w)).abs() < 1e-10);
        assert!(!cycle.stable, "smaller oscillations die out, larger ones grow");
    }

    #[test]
    fn a_second_order_plant_with_a_relay_has_none() {
        let plant = TransferFunction::new(vec![1.0], vec![1.0, 1.0, 1.0]).unwrap();
        assert_eq!(intersections(&plant, |a, _| relay(1.0, a), &grid()), Ok(vec![]));
    }

    /// A gain that jumps over the solution: `h` turns about zero, but never is zero.
    #[test]
    fn a_jump_is_no_solution() {
        let plant = TransferFunction::new(vec![5.0], vec![0.0, 2.0, 3.0, 1.0]).unwrap();
        let jump = |a: f64, _: f64| Complex::new(if a < 1.0 { 3.0 } else { 0.3 }, 0.0);
        assert_eq!(intersections(&plant, jump, &grid()), Ok(vec![]));
    }

    /// The gain 6/5 that the loop needs is met at two amplitudes; on a grid point and between.
    #[test]
    fn two_cycles_are_found_and_a_solution_on_a_grid_point_counts_once() {
        let plant = TransferFunction::new(vec![5.0], vec![0.0, 2.0, 3.0, 1.0]).unwrap();
        let grid = Grid {
            amplitude: Span { from: 0.5, to: 8.0, points: 5 },
            angular_frequency: Span { from: 1.0, to: 2.0, points: 3 },
        };
        let hat = |a: f64, _: f64| Complex::new(1.2 - (a - 1.0) * (a - 3.0), 0.0);
        let found = intersections(&plant, hat, &grid).unwrap();
        let [first, second] = found[..] else { panic!("{found:?}") };
        assert!((first.amplitude - 1.0).abs() < 1e-9 && !first.stable, "{first:?}");
        assert!((second.amplitude - 3.0).abs() < 1e-9 && second.stable, "{second:?}");
    }

    #[test]
    fn impossible_inputs_are_refused() {
        assert!(TransferFunction::new(vec![f64::NAN], vec![1.0]).is_err());
        assert!(TransferFunction::new(vec![1.0], vec![0.0]).is_err());
        let plant = TransferFunction::new(vec![1.0], vec![1.0]).unwrap();
        for span in [
            Span { from: 0.0, to: 1.0, points: 10 },
            Span { from: 1.0, to: 1.0, points: 10 },
            Span { from: 1.0, to: 2.0, points: 1 },
        ] {
            let grid = Grid { amplitude: span, ..grid() };
            assert!(intersections(&plant, |a, _| relay(1.0, a), &grid).is_err(), "{span:?}");
        }
    }
}
