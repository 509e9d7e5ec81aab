//! `export`: identified friction for simulators, robots and firmware.

use pyo3::prelude::*;
use studies::export::asked::ExportOptions;
use work::line;

use crate::calls::call;

/// What a file of an export is and costs: its text, target and version, what the target cannot hold,
/// and the root mean square errors in steady sliding and along swings \[% of the Coulomb level\].
type Written = (String, &'static str, String, Vec<String>, f64, f64);

/// Exports the friction in a parameter file's text as the command does with these options; `name`
/// is what the file that is written calls it.
#[pyfunction]
pub fn export(
    py: Python<'_>,
    options: Vec<String>,
    name: String,
    parameters: String,
) -> PyResult<Written> {
    call(py, move |_| {
        let asked: ExportOptions = line::parse(&options)?;
        let found = asked.export(&name, &parameters)?;
        let [sliding, swings] =
            [found.cost.sliding, found.cost.swings].map(|errors| found.cost.percent(errors.rms));
        let version = found.version.to_string();
        Ok((found.text, found.target.name(), version, found.lost, sliding, swings))
    })
}
