//! Where a search looks: each free parameter with its bounds, and its place between them.

use super::parameter::ServoParameter;

/// A parameter that a search may choose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Free {
    /// Which.
    pub parameter: ServoParameter,
    /// Least value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
}

impl Free {
    /// With the bounds that suit a servo of half a newton metre.
    pub const fn usual(parameter: ServoParameter) -> Self {
        let (low, high) = parameter.bounds();
        Self { parameter, low, high }
    }

    /// Value at a place in the unit interval: cubic from a zero bound, logarithmic where the bounds
    /// span decades.
    pub fn value_at(&self, place: f64) -> f64 {
        let Self { low, high, .. } = *self;
        if low > 0.0 && high > 10.0 * low {
            low * (high / low).powf(place)
        } else if low == 0.0 {
            high * place * place * place
        } else {
            low + (high - low) * place
        }
    }

    /// The inverse; values beyond a bound have its place.
    pub fn place_of(&self, value: f64) -> f64 {
        let Self { low, high, .. } = *self;
        let place = if low > 0.0 && high > 10.0 * low {
            (value / low).ln() / (high / low).ln()
        } else if low == 0.0 {
            (value / high).cbrt()
        } else {
            (value - low) / (high - low)
        };
        place.clamp(0.0, 1.0)
    }
}

/// All of them with their usual bounds.
pub fn usual(parameters: &[ServoParameter]) -> Vec<Free> {
    parameters.iter().map(|&parameter| Free::usual(parameter)).collect()
}

/// Half the width of a window of ripple counts, over its centre.
const WINDOW: f64 = 0.015;

/// The same, with the ripples of friction a turn held in a narrow window that differs from seed to
/// seed and, over many seeds, fills the whole range evenly by its logarithm.
///
/// The error has a minimum for almost every count, far too narrow for a search over all of them. So
/// each search sees one window, and the data choose between the windows by the error.
pub fn with_ripple_window(free: &[Free], seed: u64) -> Vec<Free> {
    let mut narrowed = free.to_vec();
    for free in narrowed.iter_mut().filter(|f| f.parameter == ServoParameter::RippleCount) {
        // The golden ratio's multiples fill an interval most evenly.
        let place = (0.5 + 0.618_033_988_749_895 * (seed % 1_000_000) as f64).fract();
        let centre = free.low * (free.high / free.low).powf(place);
        let (low, high) = (free.low, free.high);
        free.low = (centre * (1.0 - WINDOW)).max(low);
        free.high = (centre * (1.0 + WINDOW)).min(high);
    }
    narrowed
}

#[cfg(test)]
mod tests {
    use super::*;
    use strum::VariantArray;

    #[test]
    fn places_lead_to_values_and_back() {
        for &parameter in ServoParameter::VARIANTS {
            let free = Free::usual(parameter);
            for place in [0.0, 0.2, 0.7, 1.0] {
                let back = free.place_of(free.value_at(place));
                assert!((back - place).abs() < 1e-9, "{parameter:?} {place} {back}");
            }
            assert_eq!(free.place_of(free.high * 2.0), 1.0);
        }
    }
    #[test]
    fn every_seed_looks_at_its_own_ripples_within_the_bounds() {
        let free = usual(&[ServoParameter::Coulomb, ServoParameter::RippleCount]);
        let mut windows: Vec<Free> =
            (0..10).map(|seed| with_ripple_window(&free, seed)[1]).collect();
        assert_eq!(with_ripple_window(&free, 3)[0], free[0]);
        windows.sort_by(|a, b| a.low.total_cmp(&b.low));
        for window in &windows {
            assert!(window.low >= free[1].low && window.high <= free[1].high);
        }
        assert!(windows.windows(2).all(|pair| pair[0].high < pair[1].low), "{windows:?}");
    }
}
