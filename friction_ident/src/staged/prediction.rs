//! What an identified model predicts on recordings, kind by kind, and which of two predicts better.

use friction_model::AnyModel;

use super::FrictionData;
use crate::information::{Difference, paired_difference, stratified};
use crate::output_error::{Measured, Predictor, prediction_rms};
use crate::residual_whiteness::effective_share;
use crate::rest::{at_rest, holds};
use crate::stretch::{Stretch, StretchKind};

/// Predicted minus measured friction over all points and samples, kind by kind in the order of
/// [`StretchKind::ALL`].
pub fn residuals(by: &Predictor, data: &FrictionData) -> Vec<f64> {
    StretchKind::ALL.iter().flat_map(|&kind| residuals_of_kind(by, data, kind)).collect()
}

/// Predicted minus measured friction of one kind of recording.
pub fn residuals_of_kind(by: &Predictor, data: &FrictionData, kind: StretchKind) -> Vec<f64> {
    if kind == StretchKind::Steady {
        return data.points.iter().map(|point| by.steady(point) - point.torque).collect();
    }
    let off = |stretch: &Stretch| -> Vec<f64> {
        by.along(stretch).iter().zip(&stretch.friction).map(|(p, f)| p - f).collect()
    };
    data.stretches(kind).iter().flat_map(off).collect()
}

/// Predicted minus measured friction over all points and samples that the model predicts a value
/// for.
pub(super) fn residuals_that_count(by: &Predictor, data: &FrictionData) -> Vec<f64> {
    let of = |&kind: &StretchKind| {
        let counts = all_predict(&[by.model], data, kind);
        let residuals = residuals_of_kind(by, data, kind).into_iter().zip(counts);
        residuals.filter(|(_, counts)| *counts).map(|(residual, _)| residual).collect::<Vec<_>>()
    };
    StretchKind::ALL.iter().flat_map(of).collect()
}

/// Which points and samples of one kind of recording all of `models` predict a value for: all of
/// them, but without those at rest where one of the models predicts a range there.
pub fn all_predict(models: &[AnyModel], data: &FrictionData, kind: StretchKind) -> Vec<bool> {
    if kind == StretchKind::Steady {
        return vec![true; data.points.len()];
    }
    let ranges = models.iter().any(holds);
    let moving = |stretch: &Stretch| -> Vec<bool> {
        if !ranges {
            return vec![true; stretch.len()];
        }
        at_rest(stretch).into_iter().map(|rest| !rest).collect()
    };
    data.stretches(kind).iter().flat_map(moving).collect()
}

/// By how much `first` predicts worse than `second` in mean square, paired over blocks within each
/// kind of recording.
pub fn difference(first: &Predictor, second: &Predictor, data: &FrictionData) -> Difference {
    let kinds: Vec<_> = StretchKind::ALL
        .iter()
        .map(|&kind| {
            let [first, second] = [first, second].map(|by| residuals_of_kind(by, data, kind));
            let samples = first.len();
            // Blocks of ten correlation times of what differs, at least five of them.
            let apart: Vec<f64> = first.iter().zip(&second).map(|(a, b)| a * a - b * b).collect();
            let mean = apart.iter().sum::<f64>() / samples.max(1) as f64;
            let centred: Vec<f64> = apart.iter().map(|d| d - mean).collect();
            let blocks = (samples as f64 * effective_share(&centred) / 10.0) as usize;
            (paired_difference(&first, &second, blocks.clamp(5, 50)), samples)
        })
        .filter(|(_, samples)| *samples > 0)
        .collect();
    stratified(&kinds)
}

/// Root mean square of predicted minus measured friction, of one kind of recording; none where
/// there is none.
pub fn rms_of_kind(by: &Predictor, data: &FrictionData, kind: StretchKind) -> Option<f64> {
    let measured = match kind {
        StretchKind::Steady => Measured { points: &data.points, ..Measured::default() },
        _ => Measured { stretches: data.stretches(kind), ..Measured::default() },
    };
    (!measured.is_empty()).then(|| prediction_rms(by, &measured))
}
