//! The speeds over which friction was identified.

use friction_model::{AnyModel, MAX_SPEED};

use crate::shown::Shown;
use crate::{Axis, Refusal};

/// Share of the highest speed at which the steady speeds begin, where the recordings come to rest.
const LOWEST_SHARE: f64 = 1e-3;
/// What is assumed where nothing is known, in Stribeck velocities.
const ASSUMED: [f64; 2] = [0.1, 20.0];
/// What is assumed of a model without a Stribeck velocity \[rad/s or m/s\].
const ASSUMED_PLAIN: [f64; 2] = [0.05, 5.0];

/// Where a range of speeds comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpeedsFrom {
    /// The parameter file says so.
    File,
    /// Whoever exports says so.
    Asked,
    /// Nobody says so.
    Assumed,
}

/// A range of speeds \[rad/s or m/s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds {
    low: f64,
    high: f64,
    from: SpeedsFrom,
}

impl Speeds {
    /// From `low` to `high` \[rad/s or m/s\].
    ///
    /// # Errors
    /// [`Refusal::Speeds`] unless `0 <= low <= high`, `high > 0` and both are speeds that models
    /// take.
    pub fn new(low: f64, high: f64, from: SpeedsFrom) -> Result<Self, Refusal> {
        if low >= 0.0 && low <= high && high > 1e-9 && high <= MAX_SPEED {
            Ok(Self { low, high, from })
        } else {
            Err(Refusal::Speeds { low, high })
        }
    }

    /// What is assumed of a model where nothing is known: a tenth to twenty times its Stribeck
    /// velocity, or 0.05 to 5.
    #[must_use]
    pub fn assumed(model: &AnyModel) -> Self {
        let v_s = model.parameter("v_s").filter(|v_s| (1e-6..=1e3).contains(v_s));
        let [low, high] = v_s.map_or(ASSUMED_PLAIN, |v_s| ASSUMED.map(|times| times * v_s));
        Self { low, high, from: SpeedsFrom::Assumed }
    }

    /// The lowest speed, zero where the recordings come to rest.
    #[must_use]
    pub const fn low(&self) -> f64 {
        self.low
    }

    /// The highest speed.
    #[must_use]
    pub const fn high(&self) -> f64 {
        self.high
    }

    /// Who says so.
    #[must_use]
    pub const fn from(&self) -> SpeedsFrom {
        self.from
    }

    /// The lowest speed that is looked at: above zero.
    #[must_use]
    pub fn lowest(&self) -> f64 {
        self.low.max(LOWEST_SHARE * self.high)
    }

    /// So many speeds from the lowest to the highest, even in their logarithm.
    #[must_use]
    pub fn spread(&self, count: u32) -> Vec<f64> {
        let (low, high) = (self.lowest(), self.high);
        if low == high || count < 2 {
            return vec![high];
        }
        let step = (high / low).ln() / f64::from(count - 1);
        let inner = (0..count - 1).map(|k| low * (f64::from(k) * step).exp());
        inner.chain([high]).collect()
    }

    /// The range and where it comes from, in words.
    #[must_use]
    pub fn told(&self, axis: Axis) -> String {
        let range = format!("{} to {} {}", Shown(self.low), Shown(self.high), axis.speed());
        match self.from {
            SpeedsFrom::File => format!("{range}, the speeds of the recordings"),
            SpeedsFrom::Asked => format!("{range}, as asked for"),
            SpeedsFrom::Assumed => {
                format!(
                    "{range}, ASSUMED: the parameter file does not say which speeds were recorded"
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;

    #[test]
    fn a_range_is_checked_and_spread() {
        for (low, high) in [(1.0, 0.5), (-1.0, 1.0), (0.0, 0.0), (0.0, f64::NAN), (1.0, 1e9)] {
            assert!(Speeds::new(low, high, SpeedsFrom::Asked).is_err(), "{low} {high}");
        }
        let speeds = Speeds::new(0.0, 2.0, SpeedsFrom::File).unwrap().spread(7);
        assert_eq!((speeds.len(), speeds[6]), (7, 2.0));
        assert!(
            (speeds[0] - 2e-3).abs() < 1e-12 && (speeds[3] / 2e-3 - 1000f64.sqrt()).abs() < 1e-9
        );
        assert_eq!(Speeds::new(1.0, 1.0, SpeedsFrom::Asked).unwrap().spread(7), [1.0]);
    }

    #[test]
    fn what_is_assumed_says_so() {
        let assumed = Speeds::assumed(&AnyModel::test_bed(ModelName::LuGre));
        assert!((assumed.high() / (20.0 * 0.1407) - 1.0).abs() < 1e-3, "{assumed:?}");
        assert!(assumed.told(Axis::Rotary).contains("ASSUMED"));
        assert_eq!(Speeds::assumed(&AnyModel::test_bed(ModelName::Coulomb)).high(), 5.0);
    }
}
