//! A friction model with what acts beside it.

use friction_model::AnyModel;

use super::along::predict;
use crate::position_load::PositionLoad;
use crate::steady_point::SteadyPoint;
use crate::stretch::Stretch;

/// A friction model with what acts beside it: what is predicted of a measured force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predictor {
    /// Friction.
    pub model: AnyModel,
    /// What acts beside it.
    pub load: PositionLoad,
}

impl From<AnyModel> for Predictor {
    /// Friction alone.
    fn from(model: AnyModel) -> Self {
        Self { model, load: PositionLoad::default() }
    }
}

impl Predictor {
    /// The measured force at each sample of a stretch.
    #[must_use]
    pub fn along(&self, stretch: &Stretch) -> Vec<f64> {
        if self.load.is_none() {
            return predict(&self.model, stretch);
        }
        // What a model without pre-sliding holds at rest is what is applied beside the load.
        let mut predicted = predict(&self.model, &self.load.taken_from(stretch));
        predicted.iter_mut().zip(self.load.along(stretch)).for_each(|(all, load)| *all += load);
        predicted
    }

    /// The measured force of a steady point.
    #[must_use]
    pub fn steady(&self, point: &SteadyPoint) -> f64 {
        self.model.steady_state(point.velocity) + self.load.at(point.place)
    }
}
