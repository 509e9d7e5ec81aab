//! Models: which there are, what their parameters mean, and their friction.

use std::num::NonZero;

use clap::ValueEnum;
use experiment_runner::models::{Preset, file, sheet};
use friction_model::{AnyModel, AnyStepper, MAX_SPEED, Scheme, TimeStep};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use studies::sweep::{SweepError, sets, sweep};
use work::model_name::model_name;
use work::{BadInput, Interrupted};

use crate::arrays::{array, values};
use crate::calls::{at_once, call, workers};

/// All models, or one, with their parameters, units, ranges and values, as JSON.
#[pyfunction]
pub fn catalogue(py: Python<'_>, name: Option<&str>, preset: &str) -> PyResult<String> {
    at_once(py, || {
        let names = match name {
            Some(name) => vec![model_name(name).map_err(|error| BadInput(error.to_string()))?],
            None => friction_model::ModelName::ALL.to_vec(),
        };
        Ok(sheet::document(&names, set(preset)?).to_string())
    })
}

fn set(name: &str) -> anyhow::Result<Preset> {
    Preset::from_str(name, true).map_err(|_| {
        let known = Preset::value_variants().iter().filter_map(ValueEnum::to_possible_value);
        let known: Vec<_> = known.map(|value| value.get_name().to_owned()).collect();
        BadInput(format!("expected one of the sets {}, but got `{name}`", known.join(", "))).into()
    })
}

/// A friction model with its parameters.
#[pyclass(frozen, module = "frictionlab._native")]
pub struct Model(pub AnyModel);

#[pymethods]
impl Model {
    /// The model of that name with the parameters of a set.
    #[staticmethod]
    fn preset(py: Python<'_>, name: &str, preset: &str) -> PyResult<Self> {
        at_once(py, || {
            let name = model_name(name).map_err(|error| BadInput(error.to_string()))?;
            Ok(Self(AnyModel::try_from(set(preset)?.parameters(name))?))
        })
    }

    /// The model of a parameter file's text, in every form that is in use.
    #[staticmethod]
    fn read(py: Python<'_>, text: &str, name: Option<&str>) -> PyResult<Self> {
        at_once(py, || {
            let name = name.map(model_name).transpose();
            let name = name.map_err(|error| BadInput(error.to_string()))?;
            Ok(Self(file::read(text, name)?))
        })
    }

    /// As files name it.
    #[getter]
    fn name(&self) -> &'static str {
        self.0.name().as_str()
    }

    /// As headings name it.
    #[getter]
    fn title(&self) -> &'static str {
        self.0.name().title()
    }

    /// Its parameters under its name, as JSON.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        at_once(py, || Ok(serde_json::to_string(&self.0)?))
    }

    /// The friction at each velocity once everything has settled.
    fn steady_state<'py>(
        &self,
        py: Python<'py>,
        velocity: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (model, velocity) = (self.0, values(&velocity));
        let forces = call(py, move |_| {
            velocity.iter().map(|v| Ok(model.steady_state(checked(*v)?))).collect()
        })?;
        Ok(array(py, forces))
    }

    /// The friction along velocities that are `dt` apart, from rest.
    fn force<'py>(
        &self,
        py: Python<'py>,
        velocity: PyReadonlyArray1<'py, f64>,
        dt: f64,
        scheme: &str,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let velocity = values(&velocity);
        let mut contact = self.contact(py, dt, scheme)?.0;
        let forces =
            call(py, move |_| velocity.iter().map(|v| Ok(contact.step(checked(*v)?))).collect())?;
        Ok(array(py, forces))
    }

    /// The friction of many parameter sets along velocities that are `dt` apart, a row a set; those
    /// of this model but for what varies.
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        varied: Vec<(String, PyReadonlyArray1<'py, f64>)>,
        velocity: PyReadonlyArray1<'py, f64>,
        dt: f64,
        scheme: &str,
        jobs: Option<NonZero<u16>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let varied: Vec<_> =
            varied.iter().map(|(name, array)| (name.clone(), values(array))).collect();
        let how = at_once(py, || how(dt, scheme))?;
        let (model, velocity) = (self.0, values(&velocity));
        let shape = [varied.first().map_or(0, |(_, values)| values.len()), velocity.len()];
        let workers = workers(jobs);
        let forces = call(py, move |cancel| {
            let bad = |error: SweepError| BadInput(error.to_string());
            let models = sets(&model, &varied).map_err(bad)?;
            let forces = sweep(&models, &velocity, how, workers, cancel).map_err(bad)?;
            forces.ok_or_else(|| Interrupted("stopped before the end".to_owned()).into())
        })?;
        array(py, forces).reshape(shape)
    }

    /// The model at rest, to be stepped once every `dt`.
    fn contact(&self, py: Python<'_>, dt: f64, scheme: &str) -> PyResult<Contact> {
        at_once(py, || {
            let (dt, scheme) = how(dt, scheme)?;
            Ok(Contact(self.0.start_by(scheme, dt)))
        })
    }
}

/// Period and scheme of fixed steps.
fn how(dt: f64, scheme: &str) -> anyhow::Result<(TimeStep, Scheme)> {
    let dt = TimeStep::new(dt).map_err(|error| BadInput(error.to_string()))?;
    let expected = |_| BadInput(format!("the scheme must be `mean` or `held`, but is `{scheme}`"));
    Ok((dt, scheme.parse().map_err(expected)?))
}

/// A velocity that a model may be asked for.
fn checked(velocity: f64) -> anyhow::Result<f64> {
    if velocity.abs() <= MAX_SPEED {
        return Ok(velocity);
    }
    let why = format!(
        "a velocity must be a finite number of at most {MAX_SPEED:e} either way, but is {velocity}"
    );
    Err(BadInput(why).into())
}

/// A model with its state, stepped once a period.
#[pyclass(module = "frictionlab._native")]
pub struct Contact(AnyStepper);

#[pymethods]
impl Contact {
    /// The friction now at `velocity`.
    fn step(&mut self, py: Python<'_>, velocity: f64) -> PyResult<f64> {
        at_once(py, || Ok(self.0.step(checked(velocity)?)))
    }

    /// Back to rest.
    fn reset(&mut self) {
        self.0.reset();
    }
}
