//! `features`: what tells friction models apart.

use std::num::NonZero;

use friction_model::ModelName;
use pyo3::prelude::*;
use report::{linked, render_page};
use studies::features::{FeaturesOptions, compute, page, summary};
use work::model_name::model_name;
use work::{BadInput, Interrupted};

use crate::calls::{call, silent, workers};

/// The features of these models, of all where there are none: JSON, page and text.
#[pyfunction]
pub fn features(
    py: Python<'_>,
    models: Vec<String>,
    jobs: Option<NonZero<u16>>,
) -> PyResult<(String, String, String)> {
    call(py, move |cancel| {
        let named: Result<Vec<_>, _> = models.iter().map(|name| model_name(name)).collect();
        let named = named.map_err(|error| BadInput(error.to_string()))?;
        let chosen = |name: &ModelName| named.is_empty() || named.contains(name);
        let models = ModelName::ALL.into_iter().filter(chosen).collect();
        let workers = workers(jobs);
        let results = compute(&FeaturesOptions { models, workers }, &silent(), cancel)?;
        let results = results.ok_or_else(|| Interrupted("stopped before the end".to_owned()))?;
        let html = render_page(&linked(page(&results), ["features.json"]));
        Ok((serde_json::to_string(&results)?, html, summary(&results)))
    })
}
