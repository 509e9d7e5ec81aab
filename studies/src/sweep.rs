//! Many parameter sets of one model along one motion, in lanes and on all cores.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use friction_lanes::WIDTH;
use friction_model::{AnyModel, MAX_SPEED, ModelError, Scheme, TimeStep};
use recording::grid::MOST_VALUES;

/// Why sets cannot be evaluated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// A set that the model does not accept.
    #[error("parameter set {set}: {source}")]
    Set {
        /// Its number, from 0.
        set: usize,
        /// Why.
        source: ModelError,
    },
    /// A parameter that the model does not have.
    #[error("{model} has no parameter `{name}`; expected some of: {}", known.join(", "))]
    Unknown {
        /// The model.
        model: &'static str,
        /// What was asked for.
        name: String,
        /// What there is; a list with its places, as in `kappa[0]`.
        known: Vec<String>,
    },
    /// Parameters with different numbers of values.
    #[error("`{name}` has {values} values, but there are {sets} sets; give one for each")]
    Uneven {
        /// The parameter.
        name: String,
        /// How many it has.
        values: usize,
        /// How many the first has.
        sets: usize,
    },
    /// A velocity that no model is asked for.
    #[error("a velocity must be a finite number of at most {MAX_SPEED:e} either way, but is {0}")]
    Velocity(f64),
    /// More results than fit.
    #[error("{sets} sets along {samples} samples are more than {MOST_VALUES} numbers; take fewer")]
    TooMany {
        /// Sets.
        sets: usize,
        /// Samples.
        samples: usize,
    },
}

/// The sets of a model: its own parameters but for those that vary, each with a value a set. A
/// number of a list is named by its place, as in `kappa[0]`.
///
/// # Errors
/// [`SweepError`] names the parameter or the set at fault.
pub fn sets(model: &AnyModel, varied: &[(String, Vec<f64>)]) -> Result<Vec<AnyModel>, SweepError> {
    let own = model.parameters();
    let places: Vec<(String, &'static str, usize)> = own
        .table()
        .iter()
        .flat_map(|row| match own.values(row.name).len() {
            1 => vec![(row.name.to_owned(), row.name, 0)],
            count => (0..count).map(|at| (format!("{}[{at}]", row.name), row.name, at)).collect(),
        })
        .collect();
    let count = varied.first().map_or(0, |(_, values)| values.len());
    let mut sets = vec![own; count];
    for (name, values) in varied {
        let Some((_, row, at)) = places.iter().find(|(known, ..)| known == name) else {
            let known = places.into_iter().map(|(known, ..)| known).collect();
            return Err(SweepError::Unknown {
                model: model.name().as_str(),
                name: name.clone(),
                known,
            });
        };
        if values.len() != count {
            let (name, values) = (name.clone(), values.len());
            return Err(SweepError::Uneven { name, values, sets: count });
        }
        for (set, value) in sets.iter_mut().zip(values) {
            set.set_at(row, *at, *value);
        }
    }
    let made = sets.into_iter().enumerate().map(|(set, parameters)| {
        AnyModel::try_from(parameters).map_err(|source| SweepError::Set { set, source })
    });
    made.collect()
}

/// The friction of each model along velocities that are `dt` apart, from rest: all samples of the
/// first, then of the second, ... None once `cancel` is set. The result does not depend on
/// `workers`, the number of threads.
///
/// # Errors
/// [`SweepError::Velocity`], [`SweepError::TooMany`].
pub fn sweep(
    models: &[AnyModel],
    velocity: &[f64],
    how: (TimeStep, Scheme),
    workers: usize,
    cancel: &AtomicBool,
) -> Result<Option<Vec<f64>>, SweepError> {
    // What is no number fails the comparison too.
    let allowed = |v: &&f64| v.abs() <= MAX_SPEED;
    if let Some(v) = velocity.iter().find(|v| !allowed(v)) {
        return Err(SweepError::Velocity(*v));
    }
    let (sets, samples) = (models.len(), velocity.len());
    let Some(count) = sets.checked_mul(samples).filter(|count| *count <= MOST_VALUES) else {
        return Err(SweepError::TooMany { sets, samples });
    };
    let mut forces = vec![0.0; count];
    if count > 0 {
        // Whole blocks of lanes to each thread.
        let each = sets.div_ceil(workers.max(1)).next_multiple_of(WIDTH);
        let stop = || cancel.load(Ordering::Relaxed);
        thread::scope(|scope| {
            for (models, rows) in models.chunks(each).zip(forces.chunks_mut(each * samples)) {
                let of_these = move || friction_lanes::forces(models, velocity, how, rows, stop);
                scope.spawn(of_these);
            }
        });
    }
    Ok((!cancel.load(Ordering::Relaxed)).then_some(forces))
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;

    fn along(
        models: &[AnyModel],
        velocity: &[f64],
        workers: usize,
    ) -> Result<Vec<f64>, SweepError> {
        let how = (TimeStep::new(1e-3).unwrap(), Scheme::Mean);
        let found = sweep(models, velocity, how, workers, &AtomicBool::new(false))?;
        Ok(found.expect("nobody cancels"))
    }

    #[test]
    fn every_set_gives_what_its_model_gives_alone_on_any_number_of_threads() {
        let velocity: Vec<f64> = (0..300).map(|k| 0.3 * (0.02 * f64::from(k)).sin()).collect();
        for name in ModelName::ALL {
            let model = AnyModel::test_bed(name);
            let row = model.parameters().table()[0].name;
            let value = model.parameters().values(row)[0];
            let known = if model.parameters().values(row).len() == 1 {
                row.to_owned()
            } else {
                format!("{row}[0]")
            };
            let varied = [(known, (0..5).map(|k| value * (1.0 + 1e-3 * f64::from(k))).collect())];
            let Ok(models) = sets(&model, &varied) else { continue };
            let one = along(&models, &velocity, 1).unwrap();
            assert_eq!(one, along(&models, &velocity, 3).unwrap(), "{name}");
            let mut alone = models[4].start_by(Scheme::Mean, TimeStep::new(1e-3).unwrap());
            let alone: Vec<f64> = velocity.iter().map(|v| alone.step(*v)).collect();
            for (of_all, alone) in one[4 * 300..].iter().zip(alone) {
                assert!((of_all - alone).abs() < 1e-13, "{name}: {of_all} {alone}");
            }
        }
    }

    #[test]
    fn what_cannot_be_evaluated_is_named() {
        let lugre = AnyModel::test_bed(ModelName::LuGre);
        let said = |varied: &[(&str, &[f64])]| {
            let varied: Vec<_> =
                varied.iter().map(|(name, values)| ((*name).to_owned(), values.to_vec())).collect();
            sets(&lugre, &varied).unwrap_err().to_string()
        };
        assert!(said(&[("f_x", &[1.0])]).contains("no parameter `f_x`"));
        assert!(said(&[("f_v", &[0.1, 0.2]), ("f_s", &[1.0])]).contains("`f_s` has 1 values"));
        let wrong = said(&[("sigma0", &[1.0, -1.0])]);
        assert!(wrong.contains("parameter set 1") && wrong.contains("sigma0"), "{wrong}");
        let velocity = along(&[lugre], &[0.1, f64::NAN], 1).unwrap_err().to_string();
        assert!(velocity.contains("finite number"), "{velocity}");
        assert!(along(&[], &[0.1], 2).unwrap().is_empty());
        assert!(along(&[lugre], &[], 2).unwrap().is_empty());
    }
}
