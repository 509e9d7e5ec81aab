//! What a fit of the drive leaves.

use crate::estimate::Estimates;

/// The fit in volts.
pub(super) struct Fitted {
    pub estimates: Estimates,
    pub time: Vec<f64>,
    pub measured: Vec<f64>,
    pub predicted: Vec<f64>,
    pub share: f64,
}
