//! Dither: a fast, small oscillation of the voltage that keeps the contact from sticking
//! (Armstrong-Helouvry, Dupont and Canudas de Wit 1994, section 5.1).
//!
//! Averaged over one of its periods a relay-like friction acts as a smooth function of the mean
//! velocity; the price is wear, noise and a ripple of the shaft.

use std::f64::consts::TAU;

use ::parameters::{ValueRange, parameters};
use serde::{Deserialize, Serialize};

use crate::ControllerError;
use crate::error::non_negative;

/// Shape of a dither.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Serialize,
    Deserialize,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum DitherShape {
    /// A sine.
    #[default]
    Sine,
    /// A square wave.
    Square,
}

parameters! {
    /// A dither: its amplitude is at most the voltage limit, its frequency at most a quarter of the
    /// control rate.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct Dither {
        shape: DitherShape, "Shape of the dither";
        amplitude: f64, "Amplitude of the dither", unit("V"), more("0 for none"),
            range(ValueRange::NON_NEGATIVE);
        frequency: f64, "Frequency of the dither", unit("Hz"), range(ValueRange::POSITIVE);
    }
}

/// A dither running at a fixed period.
#[derive(Debug, Clone)]
pub struct DitherGenerator {
    dither: Dither,
    /// Phase in turns, from 0 to 1, and its step a cycle.
    phase: f64,
    step: f64,
}

impl DitherGenerator {
    /// A generator at phase zero, called every `dt` \[s\].
    ///
    /// # Errors
    /// [`ControllerError::OutOfRange`] names amplitude or frequency.
    pub fn new(dither: Dither, dt: f64) -> Result<Self, ControllerError> {
        non_negative("dither amplitude", dither.amplitude)?;
        let step = dither.frequency * dt;
        // Of a square wave faster than this every period looks different from the one before.
        if !(step > 0.0 && step <= 0.25) {
            return Err(ControllerError::OutOfRange {
                name: "dither frequency",
                value: dither.frequency,
                expected: "above 0 and at most a quarter of the control rate in Hz".into(),
            });
        }
        Ok(Self { dither, phase: 0.0, step })
    }

    /// Voltage of the present cycle \[V\].
    #[inline]
    #[must_use]
    pub fn output(&self) -> f64 {
        self.dither.amplitude
            * match self.dither.shape {
                DitherShape::Sine => (TAU * self.phase).sin(),
                DitherShape::Square if self.phase < 0.5 => 1.0,
                DitherShape::Square => -1.0,
            }
    }

    /// On to the next cycle.
    #[inline]
    pub fn advance(&mut self) {
        self.phase += self.step;
        if self.phase >= 1.0 {
            self.phase -= 1.0;
        }
    }

    /// Back to phase zero.
    pub fn reset(&mut self) {
        self.phase = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(shape: DitherShape, frequency: f64) -> Vec<f64> {
        let mut generator =
            DitherGenerator::new(Dither { shape, amplitude: 0.5, frequency }, 1e-3).unwrap();
        (0..1000)
            .map(|_| {
                let u = generator.output();
                generator.advance();
                u
            })
            .collect()
    }

    #[test]
    fn a_second_of_it_has_no_mean_and_the_right_power() {
        for (shape, power) in [(DitherShape::Sine, 0.125), (DitherShape::Square, 0.25)] {
            let u = samples(shape, 50.0);
            assert!(u.iter().sum::<f64>().abs() / 1000.0 < 0.011, "{shape:?}");
            assert!(
                (u.iter().map(|u| u * u).sum::<f64>() / 1000.0 - power).abs() < 1e-3,
                "{shape:?}"
            );
            assert_eq!(
                u.windows(2).filter(|w| w[0] <= 0.0 && w[1] > 0.0).count(),
                50 - usize::from(shape == DitherShape::Square)
            );
        }
    }

    #[test]
    fn faster_than_a_quarter_of_the_rate_is_refused() {
        let dither = Dither { shape: DitherShape::Square, amplitude: 0.5, frequency: 251.0 };
        let message = DitherGenerator::new(dither, 1e-3).unwrap_err().to_string();
        assert!(message.starts_with("dither frequency"), "{message}");
        assert!(DitherGenerator::new(Dither { frequency: 250.0, ..dither }, 1e-3).is_ok());
    }
}
