//! Sensitivity: how much breakaway and frictional lag change when a parameter is halved or doubled
//! (thesis section 3.5.3).
//!
//! The measure is the elasticity `d ln y / d ln p`, taken between half and twice the value: 1 means
//! that the answer grows in proportion to the parameter, 0 that it does not depend on it. One
//! number for a model is the root mean square of its elasticities.
//!
//! The shares of elements (`alpha` of GMS, `lambda` of Xiong) sum to one in a valid model, so they
//! cannot be scaled by themselves. Scaling them all by `k` would do the same as scaling `f_s` and
//! `f_c` by `k`, since they only ever multiply the sliding level: that is done instead.

use friction_model::{AnyModel, ModelError};
use serde::{Deserialize, Serialize};

use crate::{
    BreakawaySettings, Contact, FrictionalLagSettings, TimeScales, breakaway, frictional_lag,
};

/// What is varied and measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SensitivitySettings {
    /// Factors on each parameter, below and above 1.
    pub factors: [f64; 2],
    /// How breakaway is measured; the first of its rates counts. The end of its ramp is raised, if
    /// need be, by `reach`.
    pub breakaway: BreakawaySettings,
    /// The ramp reaches at least this multiple of the sliding level, so that contacts with a higher
    /// static one break away too.
    pub reach: f64,
    /// How the lag is measured; the first of its frequencies counts.
    pub lag: FrictionalLagSettings,
}

impl Default for SensitivitySettings {
    /// Half and twice; breakaway at 0.1 N/s, at least to four times the static level; lag at 0.02
    /// (1 - 0.95 cos 2t) m/s.
    fn default() -> Self {
        Self {
            factors: [0.5, 2.0],
            breakaway: BreakawaySettings { rates: vec![0.1], ..BreakawaySettings::default() },
            reach: 4.0,
            lag: FrictionalLagSettings::chapter_3(),
        }
    }
}

/// What is measured of one variant of a model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Response {
    /// Largest friction at breakaway \[N or N m\].
    pub breakaway_force: f64,
    /// Displacement at breakaway \[m or rad\], see [`crate::Breakaway::displacement`].
    pub breakaway_displacement: Option<f64>,
    /// Area of the loop of frictional lag \[W\].
    pub lag_area: f64,
}

/// Elasticities with respect to one parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Elasticities {
    /// Of the breakaway force; always there.
    pub breakaway_force: Option<f64>,
    /// Of the breakaway displacement; `None` if the model has none, or none that is above zero.
    pub breakaway_displacement: Option<f64>,
    /// Of the area of the loop of frictional lag; `None` if the model has no lag, or if the loop
    /// changes its sense in between.
    pub lag_area: Option<f64>,
}

/// What one parameter does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterSensitivity {
    /// Name of the parameter.
    pub parameter: String,
    /// With the parameter at its lower and its higher value; `None` where that is no valid model,
    /// for instance with `f_s` below `f_c`.
    pub responses: [Option<Response>; 2],
    /// Elasticities, where both values are valid.
    pub elasticities: Option<Elasticities>,
    /// Whether the loop of frictional lag changes its sense between the two values.
    pub lag_reverses: bool,
    /// Whether the parameter counts in the model's root mean square, see
    /// [`Sensitivity::rms_elasticity`].
    pub counts: bool,
}

/// Sensitivity of one model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// The model as it is.
    pub nominal: Response,
    /// Each parameter that is not zero; but no seed of random numbers, of which there is no half.
    pub parameters: Vec<ParameterSensitivity>,
    /// Root mean square of the elasticities that exist with respect to the parameters that count:
    /// all but the levels `f_s` and `f_c`, the exponent `delta` and the viscous `f_v`, which most
    /// models share. `None` if there is none.
    pub rms_elasticity: Option<f64>,
}

/// Parameters that do not count in the root mean square.
const SHARED: [&str; 4] = ["f_s", "f_c", "delta", "f_v"];

/// Varies each parameter of `model`.
#[must_use]
pub fn sensitivity(model: &AnyModel, settings: &SensitivitySettings) -> Sensitivity {
    let parameters: Vec<ParameterSensitivity> = model
        .parameters()
        .table()
        .iter()
        .filter(|row| {
            let mut acts = false;
            model.parameters().each(row.name, &mut |value| acts |= value != 0.0);
            acts && row.name != "seed"
        })
        .map(|row| of_parameter(model, row.name, settings))
        .collect();
    let counting: Vec<f64> = parameters
        .iter()
        .filter(|p| p.counts)
        .filter_map(|p| p.elasticities)
        .flat_map(|e| [e.breakaway_force, e.breakaway_displacement, e.lag_area])
        .flatten()
        .collect();
    let squares: f64 = counting.iter().map(|e| e * e).sum();
    let rms_elasticity = (!counting.is_empty()).then(|| (squares / counting.len() as f64).sqrt());
    Sensitivity { nominal: respond(model, settings), parameters, rms_elasticity }
}

fn of_parameter(
    model: &AnyModel,
    name: &str,
    settings: &SensitivitySettings,
) -> ParameterSensitivity {
    let responses = settings
        .factors
        .map(|factor| varied(model, name, factor).ok().map(|variant| respond(&variant, settings)));
    let [low, high] = responses;
    let span = (settings.factors[1] / settings.factors[0]).ln();
    let elasticity = |low: f64, high: f64| {
        (low * high > 0.0).then(|| (high / low).ln() / span).filter(|e| e.is_finite())
    };
    let elasticities = low.zip(high).map(|(low, high)| Elasticities {
        breakaway_force: elasticity(low.breakaway_force, high.breakaway_force),
        breakaway_displacement: low
            .breakaway_displacement
            .zip(high.breakaway_displacement)
            .and_then(|(low, high)| elasticity(low, high)),
        lag_area: elasticity(low.lag_area, high.lag_area),
    });
    let lag_reverses = low.zip(high).is_some_and(|(low, high)| low.lag_area * high.lag_area < 0.0);
    ParameterSensitivity {
        parameter: name.to_owned(),
        responses,
        elasticities,
        lag_reverses,
        counts: !SHARED.contains(&name),
    }
}

/// The model with the parameter `name` multiplied by `factor`; shares are scaled through the
/// levels.
fn varied(model: &AnyModel, name: &str, factor: f64) -> Result<AnyModel, ModelError> {
    if matches!(name, "alpha" | "lambda") {
        let mut parameters = model.parameters();
        parameters.scale("f_s", factor);
        parameters.scale("f_c", factor);
        parameters.try_into()
    } else {
        model.scaled(name, factor)
    }
}

fn respond(model: &AnyModel, settings: &SensitivitySettings) -> Response {
    let contact = Contact::new(model);
    let level = TimeScales::of(&contact).highest_level;
    let limit = settings.breakaway.limit.max(settings.reach * level);
    let broken = breakaway(&contact, &BreakawaySettings { limit, ..settings.breakaway.clone() });
    let lag = frictional_lag(&contact, &settings.lag);
    Response {
        breakaway_force: broken.first().map_or(f64::NAN, |b| b.friction_max),
        breakaway_displacement: broken.first().and_then(|b| b.displacement),
        lag_area: lag.first().map_or(f64::NAN, |l| l.area),
    }
}
