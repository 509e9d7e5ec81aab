//! How many independent samples a residual is worth.
//!
//! Standard errors of least squares count residuals as white. On real axes neighbours are alike,
//! because the model is not the axis and the filters smooth; the errors are then too small by the
//! root of the integrated correlation time.

/// Share of the residuals that count as independent, above 0 and at most 1: one over the sum of the
/// autocorrelation over all lags, cut by Geyer's initial positive sequence (1992, Statistical
/// Science 7, 473): pairs of neighbouring lags are added while their sum is positive.
///
/// ```
/// // An alternating residual is not worth less than a white one.
/// let alternating: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// assert_eq!(friction_ident::residual_whiteness::effective_share(&alternating), 1.0);
/// ```
pub fn effective_share(residuals: &[f64]) -> f64 {
    effective_share_of(residuals, &[residuals.len()])
}

/// The same of residuals of several stretches, one behind the other, with gaps between them:
/// samples on both sides of a gap are no neighbours. `pieces` are the lengths of the stretches;
/// what goes beyond their sum is another one.
pub fn effective_share_of(residuals: &[f64], pieces: &[usize]) -> f64 {
    let n = residuals.len();
    let mut stretches = Vec::with_capacity(pieces.len() + 1);
    let mut rest = residuals;
    for &length in pieces {
        let (piece, after) = rest.split_at(length.min(rest.len()));
        stretches.push(piece);
        rest = after;
    }
    stretches.push(rest);
    let power: f64 = residuals.iter().map(|r| r * r).sum();
    if n < 4 || !(power > 0.0 && power.is_finite()) {
        return 1.0;
    }
    let lagged = |lag: usize| {
        let of = |piece: &&[f64]| {
            let later = piece.get(lag..).unwrap_or_default();
            later.iter().zip(*piece).map(|(a, b)| a * b).sum::<f64>()
        };
        stretches.iter().map(of).sum::<f64>() / power
    };
    let mut time = -1.0;
    let mut before = f64::INFINITY;
    for pair in 0..n / 4 {
        let both = lagged(2 * pair) + lagged(2 * pair + 1);
        if both <= 0.0 {
            break;
        }
        // Noise in the tail must not add up: the sequence may only fall.
        before = before.min(both);
        time += 2.0 * before;
    }
    (1.0 / time.max(1.0)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    /// A first-order process with coefficient a is worth (1 - a) / (1 + a) of its samples.
    #[test]
    fn a_first_order_process_is_worth_its_closed_form() {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        for a in [0.0, 0.5, 0.9, 0.98] {
            let mut state = 0.0;
            let process: Vec<f64> = (0..200_000)
                .map(|_| {
                    state = a * state + rng.sample::<f64, _>(StandardNormal);
                    state
                })
                .collect();
            let expected = (1.0 - a) / (1.0 + a);
            let share = effective_share(&process);
            assert!((share / expected - 1.0).abs() < 0.1, "{a}: {share}, not {expected}");
        }
        assert_eq!(effective_share(&[0.0; 10]), 1.0);
    }
}
