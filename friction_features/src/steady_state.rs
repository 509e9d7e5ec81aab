//! Steady sliding: whether a model settles at the force that it promises for constant velocity, in
//! both of its forms.
//!
//! For models with a Stribeck curve that is `F = sgn(v) g(v) + f_v v`. The derivative form and the
//! fixed-step form must reach the same force; a difference would be a bias in every observer that
//! uses the model.

use friction_model::TimeStep;
use serde::{Deserialize, Serialize};

use crate::{Contact, TimeScales};

/// The motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SteadyStateSettings {
    /// Speeds \[m/s or rad/s\]; each is held in both directions, from rest.
    pub speeds: Vec<f64>,
    /// Each is held over this displacement \[m or rad\], over which bristles settle,
    pub distance: f64,
    /// and for this time besides \[s\], in which sliding levels settle.
    pub time: f64,
    /// Period of the fixed-step form \[s\], above 0 and at most 10 ms.
    pub period: f64,
}

impl Default for SteadyStateSettings {
    /// From 1 mm/s to 0.5 m/s over 0.1 m and 3 s, period 1 ms. With the thesis's chapter 3 set the
    /// softest element of GMS begins to slide after 14 mm, and Leuven's bristles have settled to
    /// 1e-9 after 80 mm.
    fn default() -> Self {
        let speeds = vec![0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.5];
        Self { speeds, distance: 0.1, time: 3.0, period: 1e-3 }
    }
}

/// Steady sliding of one model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SteadyState {
    /// Velocities, the speeds in both directions \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// The force that the model promises there \[N or N m\].
    pub promised: Vec<f64>,
    /// The force that the derivative form has reached \[N or N m\].
    pub derivative_form: Vec<f64>,
    /// The force that the fixed-step form has reached \[N or N m\].
    pub fixed_step_form: Vec<f64>,
    /// Largest distance of the derivative form from the promise \[N or N m\].
    pub error: f64,
    /// Largest distance of the fixed-step form from the promise \[N or N m\].
    pub fixed_step_error: f64,
    /// The curve of promised forces, for drawing.
    pub curve: SteadyStateCurve,
}

/// Force against velocity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SteadyStateCurve {
    /// Velocity \[m/s or rad/s\], from minus to plus the largest speed.
    pub velocity: Vec<f64>,
    /// Friction \[N or N m\].
    pub friction: Vec<f64>,
}

/// Holds each speed and compares the force with the promise.
#[must_use]
pub fn steady_state(contact: &Contact, settings: &SteadyStateSettings) -> SteadyState {
    let scales = TimeScales::of(contact);
    let velocity: Vec<f64> = settings.speeds.iter().flat_map(|&v| [v, -v]).collect();
    let promised: Vec<f64> = velocity.iter().map(|&v| contact.steady_state(v)).collect();
    let derivative_form: Vec<f64> = velocity
        .iter()
        .map(|&v| {
            let duration = settings.time + settings.distance / v.abs();
            let steps = (duration / scales.prescribed(v.abs()).min(1e-3)).ceil() as usize;
            let dt = duration / steps as f64;
            let mut motion = contact.prescribed();
            (0..steps).fold(0.0, |_, _| motion.step([v; 3], dt))
        })
        .collect();
    let fixed_step_form: Vec<f64> = velocity
        .iter()
        .map(|&v| {
            let Ok(dt) = TimeStep::new(settings.period) else { return f64::NAN };
            let mut stepper = contact.fixed_step(dt);
            let duration = settings.time + settings.distance / v.abs();
            let steps = (duration / settings.period).ceil() as usize;
            (0..steps).fold(0.0, |_, _| stepper.step(v))
        })
        .collect();
    let largest = |reached: &[f64]| {
        reached.iter().zip(&promised).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let fastest = settings.speeds.iter().copied().fold(0.0, f64::max);
    let drawn: Vec<f64> = (-300..=300).map(|k| fastest * f64::from(k) / 300.0).collect();
    SteadyState {
        error: largest(&derivative_form),
        fixed_step_error: largest(&fixed_step_form),
        curve: SteadyStateCurve {
            friction: drawn.iter().map(|&v| contact.steady_state(v)).collect(),
            velocity: drawn,
        },
        velocity,
        promised,
        derivative_form,
        fixed_step_form,
    }
}
