//! NumPy arrays in and out. The package `frictionlab` has made them arrays of `float64` before.

use numpy::ndarray::Dimension;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use recording::grid::{Array, Arrays};

/// A table in memory: its name, and its columns with their names, a matrix for each.
pub type Table<'py> = (String, Vec<(String, PyReadonlyArray2<'py, f64>)>);

/// The values, wherever they stand.
pub fn values(array: &PyReadonlyArray1<'_, f64>) -> Vec<f64> {
    array.as_array().iter().copied().collect()
}

/// The columns of a table.
///
/// # Errors
/// Arrays of different lengths, or none.
pub fn table((name, columns): &Table<'_>) -> anyhow::Result<Arrays> {
    let array = |(name, matrix): &(String, PyReadonlyArray2<'_, f64>)| {
        let matrix = matrix.as_array();
        let (rows, _) = matrix.raw_dim().into_pattern();
        Array { name: name.clone(), rows, values: matrix.t().iter().copied().collect() }
    };
    Ok(Arrays::new(name, columns.iter().map(array).collect())?)
}

/// Values as an array.
pub fn array(py: Python<'_>, values: Vec<f64>) -> Bound<'_, PyArray1<f64>> {
    values.into_pyarray(py)
}
