//! Samples of what an identification leaves open, and whether two identifications differ.

use clap::ValueEnum;
use friction_model::ModelName;
use identification::posterior::{Report, Table, compare as compared, samples as drawn, table};
use numpy::{PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use work::BadInput;
use work::model_name::model_name;

use crate::arrays::array;
use crate::calls::call;

/// Names, units, a row a sample, and notes.
type Drawn<'py> = (Vec<String>, Vec<String>, Bound<'py, PyArray2<f64>>, Vec<String>);

fn named(model: Option<String>) -> anyhow::Result<Option<ModelName>> {
    let named = model.map(|name| model_name(&name)).transpose();
    Ok(named.map_err(|error| BadInput(error.to_string()))?)
}

/// Samples of the parameters of a model in the text of a document.
#[pyfunction]
pub fn samples(
    py: Python<'_>,
    document: String,
    model: Option<String>,
    count: usize,
    seed: u64,
) -> PyResult<Drawn<'_>> {
    let found = call(py, move |_| {
        let report = Report::read("the identification", &document)?;
        Ok(drawn(report.model(named(model)?)?, count, seed)?)
    })?;
    let shape = [count, found.names.len()];
    let rows = array(py, found.rows.concat()).reshape(shape)?;
    Ok((found.names, found.units, rows, found.notes))
}

/// The same as a table for a simulator.
#[pyfunction]
pub fn randomisation(
    py: Python<'_>,
    document: String,
    model: Option<String>,
    count: usize,
    seed: u64,
    target: String,
    joint: String,
) -> PyResult<String> {
    call(py, move |_| {
        let report = Report::read("the identification", &document)?;
        let of = Table::from_str(&target.replace('_', "-"), true).map_err(|_| {
            BadInput(format!("expected csv, mjlab or isaac_lab, but got `{target}`"))
        })?;
        let found = drawn(report.model(named(model)?)?, count, seed)?;
        Ok(table(&found, of, &report.name, &joint)?)
    })
}

/// Compares two documents, each a name and a text: JSON and text.
#[pyfunction]
pub fn compare(
    py: Python<'_>,
    first: (String, String),
    second: (String, String),
    model: Option<String>,
    speeds: Option<[f64; 2]>,
    seed: u64,
) -> PyResult<(String, String)> {
    call(py, move |_| {
        let [a, b] = [first, second].map(|(name, text)| Report::read(&name, &text));
        let found = compared([&a?, &b?], named(model)?, speeds, seed)?;
        Ok((serde_json::to_string(&found)?, found.terminal()))
    })
}
