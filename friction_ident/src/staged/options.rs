//! What is asked of the staged identification.

use crate::micro_damping::THESIS_ZETA;
use crate::output_error::OutputErrorOptions;
use crate::position_load::LoadShape;
use crate::uncertain::Uncertain;

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StagedOptions {
    /// Separate parameters for each direction.
    pub asymmetric: bool,
    /// Refine all parameters together over all recordings at the end.
    pub joint: bool,
    /// Elements of models that have any.
    pub elements: usize,
    /// Inertia that moves on the bristles \[kg or kg m^2\]; without it the micro-damping is left to
    /// the recordings.
    pub inertia: Option<Uncertain>,
    /// Damping ratio of that motion.
    pub damping_ratio: f64,
    /// What is estimated beside friction; [`choose_position_load`](crate::choose_position_load)
    /// says which of it the recordings show.
    pub beside: LoadShape,
    /// How the output-error fits are done.
    pub output_error: OutputErrorOptions,
}

impl Default for StagedOptions {
    /// Symmetric, nothing beside friction, with the joint stage, four elements, no inertia, the thesis's damping ratio of
    /// 0.7.
    fn default() -> Self {
        Self {
            asymmetric: false,
            joint: true,
            elements: 4,
            inertia: None,
            damping_ratio: THESIS_ZETA,
            beside: LoadShape::NONE,
            output_error: OutputErrorOptions::default(),
        }
    }
}
