//! A model along a motion.

use std::iter;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::ValueEnum;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use recording::trajectory;
use studies::simulate::{
    InMemory, Motion, Scheme, Settings, Stopped, holds_a_tolerance, simulate_into,
};
use work::BadInput;

use crate::arrays::{Table, array, table};
use crate::calls::call;
use crate::models::Model;

/// Columns by name, whether the contact slips, and notes.
type Simulated<'py> = (Bound<'py, PyDict>, Bound<'py, PyArray1<bool>>, Vec<String>);

/// The friction along a motion, a file or a table: the columns of the result by name, whether the
/// contact slips, and notes.
#[pyfunction]
#[pyo3(signature = (model, path, given, *, scheme, dt, tolerance, load_gain))]
#[expect(clippy::too_many_arguments, reason = "one for each option of the command")]
pub fn simulate<'py>(
    py: Python<'py>,
    model: &Model,
    path: Option<PathBuf>,
    given: Option<Table<'py>>,
    scheme: &str,
    dt: f64,
    tolerance: f64,
    load_gain: Option<f64>,
) -> PyResult<Simulated<'py>> {
    let scheme = Scheme::from_str(scheme, true).map_err(|_| {
        let text = format!("the scheme must be `mean`, `held` or `rk4`, but is `{scheme}`");
        crate::errors::bad_input(py, text)
    })?;
    let model = model.0;
    let arrays = given.as_ref().map(table).transpose();
    let settings = Settings { scheme, dt, tolerance, load_gain };
    let (result, notes) = call(py, move |cancel| {
        let mut motion = match (path, arrays?) {
            (Some(path), _) => trajectory::open(&path)?,
            (None, Some(arrays)) => trajectory::from_arrays(&arrays)?,
            (None, None) => return Err(BadInput("a motion is missing".to_owned()).into()),
        };
        let mut notes = std::mem::take(&mut motion.notes);
        let (axis, loaded) = (motion.axis, motion.loaded);
        let points =
            iter::from_fn(|| if cancel.load(Ordering::Relaxed) { None } else { motion.next() });
        let mut result = InMemory::default();
        let motion = Motion { axis, loaded, points };
        let done =
            simulate_into(&model, motion, &settings, &mut result).map_err(
                |stopped| match stopped {
                    Stopped::Motion(error) => anyhow::Error::from(error),
                    other => BadInput(other.to_string()).into(),
                },
            )?;
        if done.held > 0 {
            notes.push(format!(
                "{} rows stand still, where a velocity does not tell the friction: they say 0.",
                done.held
            ));
        }
        if scheme == Scheme::Rk4 && !holds_a_tolerance(&model) {
            notes.push("This model draws at random: no tolerance is held.".to_owned());
        }
        Ok((result, notes))
    })?;
    let columns = PyDict::new(py);
    for (name, values) in result.columns {
        columns.set_item(name, array(py, values))?;
    }
    let slips = result.slips.into_pyarray(py);
    Ok((columns, slips, notes))
}
