//! Weights of a first-order lag between two samples, exact for the quintic through six samples.

/// Samples that one step of the filter sees.
pub(super) const TAPS: usize = 6;

/// One step `gamma[k+1] = decay gamma[k] + sum_j taps[j] g[k - before + j]` of the lag, where
/// `before` samples of the stencil lie before `k`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub decay: f64,
    pub taps: [f64; TAPS],
}

/// The step over one sampling period for `rho = dt / tau`.
///
/// With the polynomial `sum_n c_n s^n` through the samples, `s` from 0 to 1 over the period, the
/// input adds `sum_n c_n m_n` with the moments `m_n = rho int_0^1 s^n exp(-rho (1 - s)) ds`.
pub(super) fn step(rho: f64, before: usize) -> Step {
    let moments = moments(rho);
    let node = |j: usize| j as f64 - before as f64;
    let taps = std::array::from_fn(|j| {
        // Coefficients of the Lagrange polynomial of node j, lowest power first.
        let mut coefficients = [0.0; TAPS];
        coefficients[0] = 1.0;
        for (degree, other) in (0..TAPS).filter(|&other| other != j).enumerate() {
            let scale = 1.0 / (node(j) - node(other));
            for n in (0..=degree + 1).rev() {
                let lower = if n > 0 { coefficients[n - 1] } else { 0.0 };
                coefficients[n] = scale * (lower - node(other) * coefficients[n]);
            }
        }
        coefficients.iter().zip(moments).map(|(c, m)| c * m).sum()
    });
    Step { decay: (-rho).exp(), taps }
}

/// The moments `m_0 .. m_5`, by the stable direction of `m_n = 1 - n m_{n-1} / rho`.
fn moments(rho: f64) -> [f64; TAPS] {
    let mut moments = [0.0; TAPS];
    if rho > 6.0 {
        moments[0] = -(-rho).exp_m1();
        for n in 1..TAPS {
            moments[n] = 1.0 - n as f64 / rho * moments[n - 1];
        }
        return moments;
    }
    // Backwards from far above, where any value will do.
    let mut moment = 0.0;
    for n in (1..=60).rev() {
        moment = rho / n as f64 * (1.0 - moment);
        if let Some(place) = moments.get_mut(n - 1) {
            *place = moment;
        }
    }
    moments
}

/// The two weights of a step that is exact for the straight line between its ends.
pub(super) fn linear(rho: f64) -> [f64; 2] {
    let [m0, m1, ..] = moments(rho);
    [m0 - m1, m1]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The response to `t^n`, n to 5, against the closed form of the lag.
    #[test]
    fn polynomials_to_the_fifth_degree_are_exact() {
        for rho in [1e-3, 0.09, 1.0, 5.9, 6.1, 40.0] {
            for before in 0..5 {
                let step = step(rho, before);
                for n in 0..6i32 {
                    let input = |j: usize| (j as f64 - before as f64).powi(n);
                    let got: f64 = step.taps.iter().enumerate().map(|(j, w)| w * input(j)).sum();
                    // rho int s^n exp(-rho (1 - s)) by a fine Simpson rule.
                    let m = 20_000;
                    let f = |i: usize| {
                        let s = i as f64 / m as f64;
                        rho * s.powi(n) * (-rho * (1.0 - s)).exp()
                    };
                    let inner: f64 =
                        (1..m).map(|i| if i % 2 == 1 { 4.0 * f(i) } else { 2.0 * f(i) }).sum();
                    let expected = (f(0) + f(m) + inner) / (3.0 * m as f64);
                    assert!(
                        (got - expected).abs() < 1e-11,
                        "rho {rho}, before {before}, power {n}: {got} {expected}"
                    );
                }
            }
            assert!((linear(rho).iter().sum::<f64>() + (-rho).exp() - 1.0).abs() < 1e-14);
        }
    }
}
