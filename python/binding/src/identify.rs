//! `identify`: what `frictionlab identify` does, without files.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use identification::asked::friction::{Asked, FILES, contents};
use identification::asked::{IdentifyArgs, axis, check};
use identification::friction::{self, FrictionIdentification};
use numpy::PyArray1;
use pyo3::prelude::*;
use recording::grid::Arrays;
use work::destination::ToFolder;
use work::{BadInput, line};

use crate::arrays::{Table, array, table};
use crate::calls::{at_once, call, silent};
use crate::errors::exception;
use crate::models::Model;

/// Identifies as the command does with these options; `files` names files and `tables`.
#[pyfunction]
pub fn identify(
    py: Python<'_>,
    options: Vec<String>,
    files: Vec<String>,
    tables: Vec<Table<'_>>,
) -> PyResult<Found> {
    let arrays: anyhow::Result<Vec<_>> = tables.iter().map(table).collect();
    call(py, move |cancel| found(&parsed(options, files, arrays?)?, cancel))
}

/// Identifies each of the joints that `joint` among these options means, one after the other: their
/// names, with what was found or the exception that says why nothing was. A recording that names no
/// joints is one, without a name; where `forgiving`, one whose joints cannot be read is so too, and
/// its identification says why.
///
/// All is one piece of work on one thread: small recordings, thousands of them, take no longer for
/// being handed from thread to thread.
#[pyfunction]
pub fn identify_each<'py>(
    py: Python<'py>,
    options: Vec<String>,
    joint: Vec<String>,
    files: Vec<String>,
    tables: Vec<Table<'py>>,
    forgiving: bool,
) -> PyResult<Vec<(Option<String>, Bound<'py, PyAny>)>> {
    let arrays: anyhow::Result<Vec<_>> = tables.iter().map(table).collect();
    let each = call(py, move |cancel| {
        let arrays = arrays?;
        let asked = [&options[..], &joint].concat();
        let named = match parsed(asked, files.clone(), arrays.clone())?.joints() {
            Ok(named) => named,
            Err(_) if forgiving => Vec::new(),
            Err(error) => return Err(error),
        };
        let names =
            if named.is_empty() { vec![None] } else { named.into_iter().map(Some).collect() };
        let mut each = Vec::with_capacity(names.len());
        for name in names {
            if cancel.load(Ordering::Relaxed) {
                break;
            }
            let one = name.iter().map(|name| format!("--joint={name}"));
            let options = options.iter().cloned().chain(one).collect();
            let args = parsed(options, files.clone(), arrays.clone());
            each.push((name, args.and_then(|args| found(&args, cancel))));
        }
        Ok(each)
    })?;
    let told = |(name, outcome): (_, anyhow::Result<Found>)| {
        let outcome = match outcome {
            Ok(found) => Bound::new(py, found)?.into_any(),
            Err(error) => exception(py, &error).into_value(py).into_bound(py).into_any(),
        };
        Ok((name, outcome))
    };
    each.into_iter().map(told).collect()
}

fn found(args: &IdentifyArgs, cancel: &AtomicBool) -> anyhow::Result<Found> {
    check(args)?;
    let progress = silent();
    let found = if args.is_friction() {
        let found = Asked::read(args)?.identify(&progress, cancel)?;
        What::Friction(Box::new(found))
    } else {
        let mut found = axis::Asked::read(args)?.identify()?;
        if let Some(wanted) = &args.structure {
            found.compare(wanted, &progress, cancel)?;
        }
        What::Axis(Box::new(found))
    };
    Ok(Found { found, contents: OnceLock::new() })
}

/// The joints that `--joint` among these options means: all of them, or those of a list.
#[pyfunction]
pub fn joints(
    py: Python<'_>,
    options: Vec<String>,
    files: Vec<String>,
    tables: Vec<Table<'_>>,
) -> PyResult<Vec<String>> {
    let arrays: anyhow::Result<Vec<_>> = tables.iter().map(table).collect();
    call(py, move |_| parsed(options, files, arrays?)?.joints())
}

fn parsed(
    mut options: Vec<String>,
    files: Vec<String>,
    arrays: Vec<Arrays>,
) -> anyhow::Result<IdentifyArgs> {
    options.extend(["--quiet".to_owned(), "--".to_owned()]);
    options.extend(files);
    let mut args: IdentifyArgs = line::parse(&options)?;
    args.arrays = arrays;
    Ok(args)
}

/// What was identified.
#[pyclass(frozen, module = "frictionlab._native")]
pub struct Found {
    found: What,
    contents: OnceLock<[String; 3]>,
}

enum What {
    Friction(Box<FrictionIdentification>),
    Axis(Box<axis::Found>),
}

impl Found {
    /// Document, page and parameters, written when they are first asked for.
    fn contents(&self, py: Python<'_>) -> PyResult<&[String; 3]> {
        if let Some(contents) = self.contents.get() {
            return Ok(contents);
        }
        let contents = at_once(py, || match &self.found {
            What::Friction(found) => contents(found, Vec::new()),
            What::Axis(found) => found.contents(),
        })?;
        Ok(self.contents.get_or_init(|| contents))
    }
}

#[pymethods]
impl Found {
    /// `friction` or `axis`.
    #[getter]
    const fn kind(&self) -> &'static str {
        match self.found {
            What::Friction(_) => "friction",
            What::Axis(_) => "axis",
        }
    }

    /// `identification.json`.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        at_once(py, || match &self.found {
            What::Friction(found) => Ok(friction::document::render(found)),
            What::Axis(found) => found.document(),
        })
    }

    /// `report.html`.
    fn html(&self, py: Python<'_>) -> PyResult<&str> {
        let [_, page, _] = self.contents(py)?;
        Ok(page)
    }

    /// `parameters.yaml`.
    fn yaml(&self, py: Python<'_>) -> PyResult<&str> {
        let [_, _, parameters] = self.contents(py)?;
        Ok(parameters)
    }

    /// What the command prints.
    fn text(&self, py: Python<'_>) -> PyResult<String> {
        at_once(py, || match &self.found {
            What::Friction(found) => Ok(friction::terminal::render(found)),
            What::Axis(found) => Ok(found.terminal()),
        })
    }

    /// Writes the three files into a folder, as the command does, and tells which.
    fn save(&self, py: Python<'_>, folder: String, force: bool) -> PyResult<String> {
        let contents = self.contents(py)?;
        at_once(py, || {
            let to = ToFolder { out: Some(folder.into()), force, runs: None };
            let folder = to.reserve("identify")?;
            let files: Vec<_> = FILES.into_iter().zip(contents.iter().cloned()).collect();
            folder.write(&files)?;
            Ok(folder.path().display().to_string())
        })
    }

    /// A model that was identified, with what was found for its parameters.
    fn model(&self, py: Python<'_>, name: &str) -> PyResult<Model> {
        at_once(py, || {
            let What::Friction(found) = &self.found else {
                let none = "this identification is of an axis, and holds no friction model";
                return Err(BadInput(none.to_owned()).into());
            };
            let of = found.models.iter().find(|model| model.found.name.as_str() == name);
            let of = of.ok_or_else(|| BadInput(format!("`{name}` was not identified")))?;
            Ok(Model(of.found.model))
        })
    }

    /// The steady points: velocities and the friction at them; empty for an axis.
    fn points<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray1<f64>>; 2] {
        let points = match &self.found {
            What::Friction(found) => found.data.points.as_slice(),
            What::Axis(_) => &[],
        };
        [
            array(py, points.iter().map(|point| point.velocity).collect()),
            array(py, points.iter().map(|point| point.torque).collect()),
        ]
    }

    /// The force of an axis as it was measured, and as its symmetric model has it; empty for
    /// friction models.
    fn predicted<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray1<f64>>; 2] {
        match &self.found {
            What::Friction(_) => [array(py, Vec::new()), array(py, Vec::new())],
            What::Axis(found) => {
                let there = &found.found.symmetric.estimation;
                [array(py, there.measured.clone()), array(py, there.predicted.clone())]
            }
        }
    }
}
