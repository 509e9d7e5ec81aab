//! Errors of what the compensation believes, drawn at random.
//!
//! Every number of a model and every constant of the drive is multiplied by its own factor, even in
//! `[1 - e, 1 + e]`. A factor is a pure function of seed, draw and the name of what it multiplies.
//! So it depends neither on the threads nor on which models and techniques are compared, and all
//! techniques over a model meet the same errors.
//!
//! Conditions between parameters are kept in this order:
//! * shares that add up to one (lists of pure numbers) are divided by their new sum;
//! * where F_s would come out below F_c the two change places;
//! * what the model still refuses is drawn again.

use friction_model::{AnyModel, AnyParameters, ModelError, Unit};
use friction_observer::NominalDrive;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

/// Which models share an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Sharing {
    /// Parameters of one name have one factor in every model, as if all were identified from one
    /// recording
    #[default]
    Common,
    /// Every model has factors of its own
    Own,
}

/// How wrong the beliefs are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BeliefErrors {
    /// Largest error as a fraction e, from 0 to below 1.
    pub fraction: f64,
    /// Which models share an error.
    pub sharing: Sharing,
    /// Seed of all draws.
    pub seed: u64,
}

/// Times a set is drawn before its model is given up. The conditions that remain hold in at least a
/// third of the draws of every model.
const ATTEMPTS: u32 = 1000;

impl BeliefErrors {
    /// The factor on `what` in a draw, even in `[1 - e, 1 + e]`.
    #[must_use]
    pub fn factor(&self, draw: u32, what: &str) -> f64 {
        let even: f64 = Pcg64Mcg::seed_from_u64(self.hash(draw, what)).random();
        1.0 + self.fraction * (2.0 * even - 1.0)
    }

    /// Seed of the sensors' noise in a draw.
    #[must_use]
    pub fn noise_seed(&self, draw: u32) -> u64 {
        self.hash(draw, "noise of the sensors")
    }

    /// What is believed in a draw of a `drive` that is known exactly otherwise.
    #[must_use]
    pub fn drive(&self, draw: u32, drive: &NominalDrive) -> NominalDrive {
        NominalDrive {
            gain: drive.gain * self.factor(draw, "drive.gain"),
            time_constant: drive.time_constant * self.factor(draw, "drive.time_constant"),
            volts_per_newton_metre: drive.volts_per_newton_metre
                * self.factor(draw, "drive.volts_per_newton_metre"),
        }
    }

    /// What is believed in a draw of `model`.
    ///
    /// # Errors
    /// [`ModelError`] if no set near it is accepted.
    pub fn model(&self, draw: u32, model: &AnyModel) -> Result<AnyModel, ModelError> {
        let mut attempt = 0;
        loop {
            let drawn = AnyModel::try_from(self.parameters(draw, attempt, model.parameters()));
            attempt += 1;
            if drawn.is_ok() || attempt == ATTEMPTS {
                return drawn;
            }
        }
    }

    fn parameters(&self, draw: u32, attempt: u32, mut parameters: AnyParameters) -> AnyParameters {
        let owner = match self.sharing {
            Sharing::Common => "",
            Sharing::Own => parameters.name().as_str(),
        };
        for row in parameters.table() {
            let before = parameters.values(row.name);
            let mut after: Vec<f64> = (0..before.len())
                .map(|i| self.factor(draw, &format!("{owner}.{}.{i}.{attempt}", row.name)))
                .zip(&before)
                .map(|(factor, value)| factor * value)
                .collect();
            if row.unit == Unit::None && after.len() > 1 {
                let (old, new): (f64, f64) = (before.iter().sum(), after.iter().sum());
                after.iter_mut().for_each(|value| *value *= old / new);
            }
            for (i, value) in after.into_iter().enumerate() {
                parameters.set_at(row.name, i, value);
            }
        }
        let level = |name: &str| parameters.values(name).first().copied();
        if let (Some(f_s), Some(f_c)) = (level("f_s"), level("f_c"))
            && f_s < f_c
        {
            parameters.set("f_s", f_c);
            parameters.set("f_c", f_s);
        }
        parameters
    }

    /// FNV-1a over seed, draw and name; the generator's own seeding mixes it further.
    fn hash(&self, draw: u32, what: &str) -> u64 {
        let bytes =
            self.seed.to_le_bytes().into_iter().chain(draw.to_le_bytes()).chain(what.bytes());
        bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        })
    }
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;

    const ERRORS: BeliefErrors = BeliefErrors { fraction: 0.2, sharing: Sharing::Common, seed: 1 };

    /// Mean 1 and variance e^2/3; uncorrelated between names and between draws.
    #[test]
    fn factors_are_even_and_independent() {
        let n = 20_000u32;
        let of = |what: &str, shift: u32| -> Vec<f64> {
            (0..n).map(|draw| (ERRORS.factor(draw + shift, what) - 1.0) / 0.2).collect()
        };
        let (a, b, next) = (of("f_s", 0), of("f_c", 0), of("f_s", 1));
        assert!(a.iter().all(|x| x.abs() <= 1.0));
        let mean =
            |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>() / f64::from(n);
        let bound = 4.0 / f64::from(n).sqrt();
        assert!(mean(&a, &vec![1.0; a.len()]).abs() < bound / 3f64.sqrt());
        assert!((mean(&a, &a) - 1.0 / 3.0).abs() < 0.3 * bound);
        assert!(mean(&a, &b).abs() < bound / 3.0 && mean(&a, &next).abs() < bound / 3.0);
        for tenth in 0..10 {
            let low = f64::from(tenth) / 5.0 - 1.0;
            let within = a.iter().filter(|x| (low..low + 0.2).contains(*x)).count();
            assert!((within as f64 - 2000.0).abs() < 4.0 * 1800f64.sqrt(), "{low}: {within}");
        }
    }

    #[test]
    fn every_model_accepts_its_draws_with_its_levels_in_order() {
        for name in ModelName::ALL {
            let model = AnyModel::test_bed(name);
            for draw in 0..200 {
                let drawn = ERRORS
                    .model(draw, &model)
                    .unwrap_or_else(|e| panic!("{name}, draw {draw}: {e}"));
                assert_ne!(drawn, model, "{name}");
                if let (Some(f_s), Some(f_c)) = (drawn.parameter("f_s"), drawn.parameter("f_c")) {
                    assert!(f_s >= f_c, "{name}: {f_s} {f_c}");
                }
                for row in model.parameters().table() {
                    let (before, after) =
                        (model.parameters().values(row.name), drawn.parameters().values(row.name));
                    for (before, after) in before.iter().zip(&after) {
                        // Levels that changed places and shares that were normalised go a little
                        // further.
                        assert!(
                            (after - before).abs() <= 0.5 * before.abs(),
                            "{name}.{}: {before} became {after}",
                            row.name
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn models_share_errors_only_if_asked() {
        let ratio = |errors: &BeliefErrors, name| {
            let model = AnyModel::test_bed(name);
            errors.model(3, &model).unwrap().parameter("f_v").unwrap()
                / model.parameter("f_v").unwrap()
        };
        let both = |errors| (ratio(&errors, ModelName::LuGre), ratio(&errors, ModelName::Proposed));
        let (a, b) = both(ERRORS);
        assert!((a - b).abs() < 1e-12);
        let (a, b) = both(BeliefErrors { sharing: Sharing::Own, ..ERRORS });
        assert!((a - b).abs() > 1e-3);
    }

    #[test]
    fn without_errors_everything_is_as_it_was() {
        let exact = BeliefErrors { fraction: 0.0, ..ERRORS };
        for name in [ModelName::Stribeck, ModelName::LuGre, ModelName::Proposed] {
            assert_eq!(
                exact.model(5, &AnyModel::test_bed(name)).unwrap(),
                AnyModel::test_bed(name)
            );
        }
        assert_eq!(exact.drive(5, &NominalDrive::SRV02), NominalDrive::SRV02);
    }
}
