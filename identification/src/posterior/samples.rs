//! Parameters of a model, drawn together.

use friction_ident::posterior::{Marginal, draw};
use friction_model::{AnyModel, ModelName};
use work::BadInput;

use super::reported::Reported;

/// Samples of a model's parameters.
#[derive(Debug, Clone)]
pub struct Samples {
    /// The model.
    pub model: ModelName,
    /// The parameters, in the order of the document.
    pub names: Vec<String>,
    /// Their units.
    pub units: Vec<String>,
    /// A row a sample.
    pub rows: Vec<Vec<f64>>,
    /// The same as models.
    pub models: Vec<AnyModel>,
    /// What must be known to use them.
    pub notes: Vec<String>,
}

/// `count` samples of the parameters of a model, the same for the same seed. Those that were not
/// estimated are held, and sets that the model does not accept are drawn again.
///
/// # Errors
/// [`BadInput`] where nothing was estimated, or where next to no set is accepted.
pub fn samples(of: &Reported, count: usize, seed: u64) -> Result<Samples, BadInput> {
    let estimated = |row: &super::reported::Row| row.standard_error.is_some_and(|se| se > 0.0);
    if !of.rows.iter().any(estimated) {
        return Err(BadInput(format!("no parameter of {} was estimated with an error", of.model)));
    }
    if let Some(row) = of.rows.iter().find(|row| !row.value.is_finite()) {
        return Err(BadInput(format!("{} of {} has no value", row.name, of.model)));
    }
    let marginals: Vec<Marginal> = of
        .rows
        .iter()
        .map(|row| match row.standard_error {
            Some(standard_error) => {
                Marginal { value: row.value, standard_error, interval: row.interval() }
            }
            None => Marginal { value: row.value, standard_error: 0.0, interval: None },
        })
        .collect();
    let (correlation, alone) = correlation(of);
    let mut models = Vec::with_capacity(count);
    let values: Vec<f64> = of.rows.iter().map(|row| row.value).collect();
    // What the model does not take even as it was found says nothing of what is drawn.
    of.with(&values).map_err(BadInput)?;
    let drawn = draw(&marginals, &correlation, count, seed, |row| match of.with(row) {
        Ok(model) => {
            models.push(model);
            true
        }
        Err(_) => false,
    });
    let drawn = drawn.map_err(|error| BadInput(format!("{}: {error}", of.model)))?;
    let named = |names: Vec<&str>| names.join(", ");
    let rows = || of.rows.iter();
    let mut notes = Vec::new();
    let held: Vec<_> = rows().filter(|row| !estimated(row)).map(|row| row.name.as_str()).collect();
    if !held.is_empty() {
        notes.push(format!("Held as they are, because they were not estimated: {}.", named(held)));
    }
    let vague: Vec<_> = rows()
        .filter(|row| estimated(row) && !row.identified)
        .map(|row| row.name.as_str())
        .collect();
    if !vague.is_empty() {
        notes.push(format!("Drawn, though the recordings do not tell them: {}.", named(vague)));
    }
    if !alone.is_empty() {
        notes.push(format!(
            "Drawn apart from the others, because the last fit holds no correlations of them: {}.",
            named(alone)
        ));
    }
    if drawn.refused > count {
        notes.push(format!(
            "{} of {} sets were drawn again, because the model does not accept them: the limits shape the samples.",
            drawn.refused,
            drawn.refused + count
        ));
    }
    Ok(Samples {
        model: of.model,
        names: rows().map(|row| row.name.clone()).collect(),
        units: rows().map(|row| row.unit.clone()).collect(),
        rows: drawn.rows,
        models,
        notes,
    })
}

/// The correlations of all rows, and which estimated ones the last fit has none of.
fn correlation(of: &Reported) -> (Vec<Vec<f64>>, Vec<&str>) {
    let place = |name: &str| {
        let names = &of.correlation.as_ref()?.names;
        names.iter().position(|other| other == name)
    };
    let between = |i: usize, j: usize| {
        let matrix = &of.correlation.as_ref()?.matrix;
        *matrix.get(i)?.get(j)?
    };
    let places: Vec<_> = of.rows.iter().map(|row| place(&row.name)).collect();
    let entry = |i: usize, j: usize| match (places[i], places[j]) {
        _ if i == j => 1.0,
        (Some(a), Some(b)) => {
            between(a, b).filter(|r| r.is_finite()).unwrap_or(0.0).clamp(-1.0, 1.0)
        }
        _ => 0.0,
    };
    let n = places.len();
    let matrix = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    let lacks = of.rows.iter().zip(&places).filter(|(row, place)| {
        place.is_none() && row.standard_error.is_some_and(|error| error > 0.0)
    });
    (matrix, lacks.map(|(row, _)| row.name.as_str()).collect())
}
