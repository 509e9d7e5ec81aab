//! `design`: gains from specifications, or what gains are worth.

use pyo3::prelude::*;
use studies::design::asked::{DesignArgs, contents, designed};
use studies::design::summary;
use work::line;

use crate::calls::call;

/// Designs as the command does with these words: JSON, page, parameter file and text.
#[pyfunction]
pub fn design(py: Python<'_>, words: Vec<String>) -> PyResult<(String, String, String, String)> {
    call(py, move |_| {
        let args: DesignArgs = line::parse(&words)?;
        let found = designed(&args)?;
        let [(_, page), (_, parameters), (_, json)] = contents(&found);
        Ok((json, page, parameters, summary(&found)))
    })
}
