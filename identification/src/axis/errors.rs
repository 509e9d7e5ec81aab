//! How well the models of an axis fit, as a table.

use recording::Recording;
use report::figure::Table;

use super::structure::Structured;
use super::structure_page::remark;
use super::{Identification, ModelResult};

/// How far a model is off.
struct Error {
    name: String,
    relative: f64,
    cross_test: Option<f64>,
    rms: f64,
    remark: String,
}

impl Error {
    fn of_plain(result: &ModelResult) -> Self {
        let name = if result.fit.model.asymmetric { "asymmetric" } else { "symmetric" };
        Self {
            name: name.to_owned(),
            relative: result.fit.relative_error,
            cross_test: result.validation.as_ref().map(|prediction| prediction.relative_error),
            rms: result.fit.residual_rms,
            remark: remark(false, result.warned),
        }
    }

    fn of_chosen(found: &Structured) -> Self {
        Self {
            name: found.fit.structure.to_string(),
            relative: found.fit.relative_error,
            cross_test: found.validation.as_ref().map(|prediction| prediction.relative_error),
            rms: found.fit.residual_rms,
            remark: remark(true, false),
        }
    }
}

/// The errors of the chosen structure, then of the others from the best to the worst.
pub fn errors(
    found: &Identification,
    structured: Option<&Structured>,
    validation: Option<&Recording>,
) -> Table {
    let mut columns = vec!["model".to_owned(), "relative error [%]".to_owned()];
    if validation.is_some() {
        columns.push("cross-test [%]".to_owned());
    }
    columns.push(format!("residual rms [{}]", found.settings.axis.force_unit()));
    columns.push("remark".to_owned());
    let plain = [Some(&found.symmetric), found.asymmetric.as_ref()].into_iter().flatten();
    let mut all: Vec<Error> = plain.map(Error::of_plain).collect();
    let size = |error: &Error| error.cross_test.unwrap_or(error.relative);
    all.sort_by(|a, b| size(a).total_cmp(&size(b)));
    let all = structured.map(Error::of_chosen).into_iter().chain(all);
    let rows = all.map(|Error { name, relative, cross_test, rms, remark }| {
        let cross_test = cross_test.map(|error| format!("{error:.3}"));
        let numbers = std::iter::once(format!("{relative:.3}")).chain(cross_test);
        [name].into_iter().chain(numbers).chain([format!("{rms:.4}"), remark]).collect()
    });
    Table {
        title: "How well the models fit".to_owned(),
        caption: "100 |measured - predicted| / |measured|, over all fitted samples.".to_owned(),
        columns,
        rows: rows.collect(),
        highlight: None,
    }
}
