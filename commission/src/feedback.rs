//! What a loop may feed back beside its linear law.

use friction_observer::{
    DisturbanceObserverOptions, EstimatorOptions, FilterOrder, FuzzyOptions, NominalDrive,
    SuperTwistingOptions, Technique, VelocitySource,
};
use serde::{Deserialize, Serialize};

use crate::loop_design::{LoopDesign, Plant};

/// A technique that feeds back.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    strum::Display,
    strum::VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Kind {
    /// The model at the shaft's velocity, for a share of the model at the reference's.
    Model,
    /// What the nominal drive does not explain.
    DisturbanceObserver,
    /// Sliding mode of second order.
    SuperTwisting,
    /// A fuzzy table over the error.
    Fuzzy,
}

impl Kind {
    /// Strengths that are tried, the weakest first.
    #[must_use]
    pub const fn strengths(self) -> [f64; 3] {
        match self {
            // Share of the model that has the shaft's velocity.
            Self::Model => [0.25, 0.5, 1.0],
            // Bandwidth over that of the loop.
            Self::DisturbanceObserver => [0.1, 0.3, 1.0],
            // One over its horizon, over the frequency of the loop.
            Self::SuperTwisting => [0.25, 0.5, 1.0],
            // Gain over that of the loop.
            Self::Fuzzy => [0.1, 0.25, 0.5],
        }
    }

    /// What its strength is, in words.
    #[must_use]
    pub const fn strength_is(self) -> &'static str {
        match self {
            Self::Model => "share of the model at the shaft's velocity",
            Self::DisturbanceObserver => "bandwidth over that of the loop",
            Self::SuperTwisting => "rate of return over the frequency of the loop",
            Self::Fuzzy => "gain next to zero over that of the loop",
        }
    }
}

/// A technique with its strength, and the linear loop under it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FedBack {
    /// Which.
    pub kind: Kind,
    /// How strong, by [`Kind::strength_is`].
    pub strength: f64,
    /// The loop that is left beside it.
    pub design: LoopDesign,
}

/// How much faster than the loop the encoder's velocity is.
const FASTER: f64 = 10.0;
/// The most that is fed back, over the static level: friction and as much again.
const MOST: f64 = 2.0;
/// Share of the static level that the fuzzy table gives.
const FUZZY: f64 = 0.5;

impl FedBack {
    /// The estimator, where friction at rest is `level` \[V\].
    #[must_use]
    pub fn estimator(&self, plant: &Plant, level: f64) -> EstimatorOptions {
        let drive = NominalDrive {
            gain: plant.drive.gain,
            time_constant: plant.drive.time_constant,
            volts_per_newton_metre: 1.0,
        };
        let w = self.design.natural_frequency;
        let limit = (MOST * level).max(1e-3);
        let technique = match self.kind {
            Kind::Model => Technique::Both { share: (1.0 - self.strength).clamp(0.0, 1.0) },
            Kind::DisturbanceObserver => {
                Technique::DisturbanceObserver(DisturbanceObserverOptions {
                    bandwidth: (self.strength * w).clamp(0.1, 1e4),
                    order: FilterOrder::First,
                    limit,
                })
            }
            Kind::SuperTwisting => {
                let back = self.strength * w;
                Technique::SuperTwisting(SuperTwistingOptions {
                    slope: 0.5 * w,
                    // A reversal turns twice the level over within the horizon.
                    rate: limit * back,
                    horizon: (1.0 / back).clamp(1e-4, 1.0),
                    limit,
                })
            }
            Kind::Fuzzy => {
                let limit = (FUZZY * level).max(1e-3);
                let error = 1.4 * limit / (self.strength * self.design.gains.k_p);
                Technique::Fuzzy(FuzzyOptions { error, rate: error * w, limit })
            }
        };
        let bandwidth = (FASTER * w).min(0.5 / plant.period).clamp(1.0, 1e4);
        EstimatorOptions {
            technique,
            drive,
            ahead: 1.0,
            velocity: VelocitySource::EncoderTrackingLoop { bandwidth },
            ..EstimatorOptions::default()
        }
    }
}
