//! Describing functions in closed form.
//!
//! In the steady loop the displacement comes down from `A` as `x = A cos(theta)`, `theta` from 0 to
//! pi, and the way up is the same with both signs changed. So
//!
//! ```text
//! b1 = (2/pi) int_0^pi F cos(theta) d theta           a1 = (area of the loop) / (pi A)
//! ```

use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI, SQRT_2};

use num_complex::Complex;
use serde::{Deserialize, Serialize};

/// Coulomb friction `F_c sgn(x')` at the `amplitude` A: `j 4 F_c / (pi A)`. A relay switched by the
/// velocity.
#[must_use]
pub fn coulomb(f_c: f64, amplitude: f64) -> Complex<f64> {
    Complex::new(0.0, 4.0 * f_c / (PI * amplitude))
}

/// Ideal relay `M sgn(x)` at the `amplitude` A: `4 M / (pi A)`. Switched by the displacement: no
/// friction, but the classical example of a loop that has a limit cycle.
#[must_use]
pub fn relay(level: f64, amplitude: f64) -> Complex<f64> {
    Complex::new(4.0 * level / (PI * amplitude), 0.0)
}

/// Viscous friction `f_v x'` at the angular frequency w: `j f_v w`.
#[must_use]
pub fn viscous(f_v: f64, angular_frequency: f64) -> Complex<f64> {
    Complex::new(0.0, f_v * angular_frequency)
}

/// Elastic-perfectly-plastic friction, the stop of `stiffness` k and level `F_c`, at the
/// `amplitude` A.
///
/// With the yield deflection `d = F_c/k`: `N = k` for `A <= d`, and beyond, with
/// `cos(theta) = 1 - 2d/A`, `N = (k/pi) (theta - sin(theta) cos(theta) + j sin^2(theta))`. The
/// imaginary part is the parallelogram `4 F_c (A - d)` over `pi A^2`.
#[must_use]
pub fn elastic_plastic(stiffness: f64, f_c: f64, amplitude: f64) -> Complex<f64> {
    let ratio = f_c / (stiffness * amplitude);
    if ratio >= 1.0 {
        return Complex::new(stiffness, 0.0);
    }
    let cos = 1.0 - 2.0 * ratio;
    let theta = cos.acos();
    let sin = theta.sin();
    stiffness / PI * Complex::new(theta - sin * cos, sin * sin)
}

/// The hysteresis of the thesis's own model with its virgin curve `F_s sin(pi z / (2 Z_b))`, as an
/// operator on the displacement; see [`friction_model::Hysteresis`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SineHysteresis {
    /// Static friction F_s \[N or N m\], above zero.
    pub f_s: f64,
    /// Breakaway deflection Z_b \[m or rad\], above zero.
    pub z_b: f64,
}

impl SineHysteresis {
    /// N at the `amplitude` A > 0 \[m or rad\] where the bristle slips: it carries at most `Z_b`,
    /// and unloads from the moment of reversal, `z = clamp(z + dx, -Z_b, Z_b)`. This is what the
    /// model does.
    ///
    /// With `c = pi A / (4 Z_b)`, for `A <= Z_b` (Masing's branches, no slip)
    ///
    /// ```text
    /// b1 = 4 F_s cos(c) J_1(c)
    /// a1 = [ 8 F_s (2 Z_b/pi) (1 - cos(2c)) - 4 A F_s sin(2c) ] / (pi A)
    /// ```
    ///
    /// and for `A >= Z_b`, where the branch reaches `-F_s` at `cos(theta_s) = 1 - 2 Z_b/A`,
    ///
    /// ```text
    /// b1 = (4 F_s/pi) [ sin(theta_s) - int_0^theta_s sin(c (1 - cos(theta))) cos(theta) d theta ]
    /// a1 = 4 F_s (A - 2 Z_b + 4 Z_b/pi) / (pi A)
    /// ```
    ///
    /// whose integral (an incomplete Bessel function) is computed to 1e-12.
    #[must_use]
    pub fn gain(&self, amplitude: f64) -> Complex<f64> {
        let Self { f_s, z_b } = *self;
        let c = FRAC_PI_4 * amplitude / z_b;
        let (b1, a1) = if amplitude <= z_b {
            let tip = (2.0 * c).sin();
            // 1 - cos(2c), without cancellation at small amplitudes.
            let versine = 2.0 * c.sin() * c.sin();
            let area = 8.0 * f_s * (z_b / FRAC_PI_2) * versine - 4.0 * amplitude * f_s * tip;
            (4.0 * f_s * c.cos() * bessel_j1(c), area / (PI * amplitude))
        } else {
            let end = (1.0 - 2.0 * z_b / amplitude).acos();
            let branch = integral(0.0, end, |theta| (c * (1.0 - theta.cos())).sin() * theta.cos());
            let area = 4.0 * f_s * (amplitude - 2.0 * z_b + z_b / FRAC_PI_4);
            (4.0 * f_s / PI * (end.sin() - branch), area / (PI * amplitude))
        };
        Complex::new(b1, a1) / amplitude
    }

    /// N at the `amplitude` A > 0 with the rule of thesis eq. 3.57: the force is `+-F_s` wherever
    /// `|x| > Z_b`, on the way back too, as if the bristle did not slip but waited. Beyond `Z_b`
    /// the loop's area stays what it was, `F_s Z_b (16/pi - 4)`. Up to `Z_b` there is no difference
    /// to [`gain`](Self::gain).
    ///
    /// For comparison only: no contact behaves so, and the thesis's own model does not.
    #[must_use]
    pub fn gain_without_slip(&self, amplitude: f64) -> Complex<f64> {
        let Self { f_s, z_b } = *self;
        if amplitude <= z_b {
            return self.gain(amplitude);
        }
        let c = FRAC_PI_4 * amplitude / z_b;
        let start = (z_b / amplitude).acos();
        // F = F_s [1 - 2 sin(pi/4 - c cos(theta))] between +-Z_b; the even parts drop out.
        let branch = integral(start, PI - start, |theta| (c * theta.cos()).sin() * theta.cos());
        let b1 = 4.0 * f_s / PI * (start.sin() + FRAC_1_SQRT_2 * branch);
        let a1 = f_s * z_b * (4.0 / FRAC_PI_4 - 4.0) / (PI * amplitude);
        Complex::new(b1, a1) / amplitude
    }

    /// N at the `amplitude` A >= Z_b as thesis eq. 3.63 prints it. **It is wrong**, and kept so
    /// that the thesis's prediction can be compared.
    ///
    /// Its imaginary part turns negative for `A` well above `Z_b`: friction would deliver
    /// `pi A |a1|` a cycle. Its real part `4 F_s Z_b / (pi A^2)` is the magnitude of the imaginary
    /// part of a relay with a dead zone of hysteresis, and has nothing of the sine branch between.
    /// It agrees neither with the slipping bristle nor with the rule 3.57 that it starts from, not
    /// even at `A = Z_b`, where these two meet. `None` below `Z_b`, where the thesis gives no
    /// formula.
    #[must_use]
    pub fn gain_as_printed(&self, amplitude: f64) -> Option<Complex<f64>> {
        let Self { f_s, z_b } = *self;
        if amplitude < z_b {
            return None;
        }
        let ratio = z_b / amplitude;
        let root = (1.0 - ratio * ratio).sqrt();
        let bracket = root
            - 4.0 * SQRT_2 * z_b * (amplitude * PI * root / (4.0 * z_b)).sin() / (amplitude * PI);
        let scale = 4.0 * f_s / (amplitude * PI);
        Some(Complex::new(scale * ratio, -scale * bracket))
    }
}

/// Bessel function `J_1(c)` for `0 <= c <= pi/4` by its power series; nine terms leave less than
/// 1e-20.
fn bessel_j1(c: f64) -> f64 {
    let half = 0.5 * c;
    let mut term = half;
    let mut sum = term;
    for k in 1..9u32 {
        term *= -half * half / f64::from(k * (k + 1));
        sum += term;
    }
    sum
}

/// `int_from^to f` by Gauss and Legendre's rule of five points on 32 panels.
fn integral(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    const PANELS: u32 = 32;
    /// Nodes on \[0, 1\] and weights; the rule is symmetric about zero.
    const RULE: [(f64, f64); 3] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    let half = 0.5 * (to - from) / f64::from(PANELS);
    let panel = |i: u32| {
        let middle = from + half * f64::from(2 * i + 1);
        let pair = |(node, weight): (f64, f64)| {
            let values = if node == 0.0 {
                f(middle)
            } else {
                f(middle - half * node) + f(middle + half * node)
            };
            weight * values
        };
        RULE.into_iter().map(pair).sum::<f64>()
    };
    half * (0..PANELS).map(panel).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use friction_model::{FrictionModel, Hysteresis, Proposed};

    use super::*;

    const UNIT: SineHysteresis = SineHysteresis { f_s: 1.0, z_b: 1.0 };

    /// `N Z_b/F_s` to as many digits as are printed.
    fn assert_table(gain: impl Fn(f64) -> Complex<f64>, digits: i32, rows: &[(f64, f64, f64)]) {
        let last = 0.5 * 10f64.powi(-digits) * 1.0001;
        for &(ratio, re, im) in rows {
            let got = gain(ratio);
            assert!(
                (got.re - re).abs() <= last && (got.im - im).abs() <= last,
                "A/Zb {ratio}: {got}"
            );
        }
    }

    #[test]
    fn the_slipping_bristle_has_the_published_values() {
        assert_table(
            |a| UNIT.gain(a),
            6,
            &[
                (0.25, 1.533201, 0.025439),
                (0.5, 1.423431, 0.098650),
                (0.9, 1.121380, 0.291024),
                (1.0, 1.027250, 0.347899),
                (1.2, 0.846327, 0.418436),
                (2.0, 0.443310, 0.405285),
                (5.0, 0.121952, 0.217634),
                (20.0, 0.015810, 0.061349),
            ],
        );
    }

    #[test]
    fn the_rule_without_slip_has_the_published_values() {
        let rows =
            [(1.2, 0.933483, 0.241597), (2.0, 0.611455, 0.086975), (5.0, 0.253090, 0.013916)];
        assert_table(|a| UNIT.gain_without_slip(a), 6, &rows);
    }

    #[test]
    #[expect(
        clippy::approx_constant,
        reason = "the table prints four digits of what happens to be 1/pi"
    )]
    fn the_printed_formula_has_the_published_values() {
        let rows = [
            (1.0, 1.2732, 0.0),
            (2.0, 0.3183, 0.0092),
            (5.0, 0.0509, -0.3090),
            (20.0, 0.0032, -0.0635),
        ];
        assert_table(|a| UNIT.gain_as_printed(a).unwrap(), 4, &rows);
        assert_eq!(UNIT.gain_as_printed(0.9), None);
    }

    #[test]
    fn the_printed_formula_is_wrong() {
        // At A = Z_b the two rules are one loop, and the formula misses both its parts.
        let (printed, loop_) = (UNIT.gain_as_printed(1.0).unwrap(), UNIT.gain(1.0));
        assert!((UNIT.gain_without_slip(1.0 + 1e-12) - loop_).norm() < 1e-9);
        assert!(
            printed.re - loop_.re > 0.2 && loop_.im - printed.im > 0.3,
            "{printed} and {loop_}"
        );
        // Beyond, it would have friction drive the motion.
        for ratio in [3.0, 5.0, 20.0, 1000.0] {
            assert!(UNIT.gain_as_printed(ratio).unwrap().im < 0.0, "A/Zb {ratio}");
            assert!(UNIT.gain(ratio).im > 0.0 && UNIT.gain_without_slip(ratio).im > 0.0);
        }
    }

    /// Fourier sums along the operator of `friction_model` itself, the second cycle, against the
    /// closed forms.
    #[test]
    fn the_closed_forms_are_the_operator() {
        let model = Proposed::test_bed();
        let p = *model.parameters();
        let closed = SineHysteresis { f_s: p.f_s, z_b: p.z_b };
        let n = 1_000_000;
        for ratio in [0.1, 0.5, 0.99, 1.0, 1.01, 3.0, 40.0] {
            let amplitude = ratio * p.z_b;
            let mut memory = Hysteresis::default();
            let (mut z, mut before) = (0.0, 0.0);
            let mut sum = Complex::new(0.0, 0.0);
            for k in 0..2 * n {
                let (sin, cos) = (TAU * f64::from(k) / f64::from(n)).sin_cos();
                z = f64::clamp(z + amplitude * sin - before, -p.z_b, p.z_b);
                before = amplitude * sin;
                let force = model.hysteresis_force(&mut memory, z);
                if k >= n {
                    sum += 2.0 / f64::from(n) * force * Complex::new(sin, cos);
                }
            }
            let (got, expected) = (sum / amplitude, closed.gain(amplitude));
            assert!(
                (got - expected).norm() < 1e-9 * p.f_s / p.z_b,
                "A/Zb {ratio}: {got} is not {expected}"
            );
        }
    }

    #[test]
    fn an_elastic_plastic_contact_lies_between_a_spring_and_a_relay() {
        assert_eq!(elastic_plastic(50.0, 1.0, 0.02), Complex::new(50.0, 0.0));
        let (k, f_c, amplitude) = (50.0, 1.0, 0.05);
        let n = elastic_plastic(k, f_c, amplitude);
        let area = 4.0 * f_c * (amplitude - f_c / k);
        assert!((PI * amplitude * amplitude * n.im - area).abs() < 1e-15);
        // The in-phase part by its definition.
        let force = |theta: f64| (f_c - k * amplitude * (1.0 - theta.cos())).max(-f_c);
        let kink = (1.0 - 2.0 * f_c / (k * amplitude)).acos();
        let product = |theta: f64| force(theta) * theta.cos();
        let b1 = 2.0 / PI * (integral(0.0, kink, product) + integral(kink, PI, product));
        assert!((n.re * amplitude - b1).abs() < 1e-14);
        let stiff = elastic_plastic(1e12, f_c, amplitude);
        assert!((stiff - coulomb(f_c, amplitude)).norm() < 1e-5 * stiff.norm());
    }

    #[test]
    fn the_bessel_function_is_that_of_the_tables() {
        assert!((bessel_j1(0.5) - 0.242_268_457_674_873_9).abs() < 1e-16);
        assert!((bessel_j1(0.7) - 0.328_995_741_540_058_9).abs() < 1e-15);
    }
}
