//! Whether a shaft that should rest hunts: a limit cycle of friction and integral action.

/// Swings from which on it is hunting, and up to which it rests: what creeps to its end may turn
/// round once or twice.
const HUNTS: usize = 4;
const RESTS: usize = 2;
/// The smallest swing that counts: in counts of the encoder, and \[rad\].
const COUNTS: f64 = 4.0;
const SMALLEST: f64 = 2e-4;

/// Whether these errors \[rad\] of a shaft that should rest are those of one that hunts.
#[must_use]
pub fn hunts(held: &[f64], encoder_step: f64) -> bool {
    swings(held, smallest(encoder_step)) >= HUNTS
}

/// Whether these are those of one that rests.
#[must_use]
pub fn rests(held: &[f64], encoder_step: f64) -> bool {
    swings(held, smallest(encoder_step)) <= RESTS
}

/// The smallest swing \[rad\] that counts, for an encoder of that step \[rad\].
#[must_use]
pub fn smallest(encoder_step: f64) -> f64 {
    (COUNTS * encoder_step).max(SMALLEST)
}

/// How often a path turns back by at least `smallest`.
fn swings(path: &[f64], smallest: f64) -> usize {
    let Some(&first) = path.first() else { return 0 };
    let (mut low, mut high, mut swings, mut rising) = (first, first, 0, None);
    for &x in path {
        low = low.min(x);
        high = high.max(x);
        let (up, down) = (x - low >= smallest, high - x >= smallest);
        if up && rising != Some(true) {
            (rising, high) = (Some(true), x);
            swings += 1;
        } else if down && rising != Some(false) {
            (rising, low) = (Some(false), x);
            swings += 1;
        }
        match rising {
            Some(true) => low = low.max(high - smallest).min(x),
            Some(false) => high = high.min(low + smallest).max(x),
            None => {}
        }
    }
    swings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swings_are_counted_and_noise_and_creep_are_none() {
        let sine = |cycles: f64| -> Vec<f64> {
            (0..1000)
                .map(|i| (std::f64::consts::TAU * cycles * f64::from(i) / 1000.0).sin())
                .collect()
        };
        assert!((7..=9).contains(&swings(&sine(4.0), 0.5)), "{}", swings(&sine(4.0), 0.5));
        assert_eq!(swings(&sine(4.0), 2.5), 0);
        let creep: Vec<f64> = (0..1000).map(|i| 1e-3 * f64::from(i)).collect();
        assert_eq!(swings(&creep, 0.1), 1);
    }
}
