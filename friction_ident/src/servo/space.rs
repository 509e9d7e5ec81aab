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
}
