//! What experiments and identification find: parameters with their uncertainty, figures, fits.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

/// One parameter that was identified, with its uncertainty.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct EstimatedParameter {
    /// The model it belongs to, as in parameter files: stribeck, lugre, proposed, ...
    pub model: String,
    /// Name of the parameter: f_s, f_c, sigma0, ...
    pub name: String,
    /// Its unit, as text: N m, rad/s, ...; empty for a number without one.
    pub unit: String,
    /// Value [unit].
    pub value: f64,
    /// Standard error [unit]; not a number where the data does not determine it.
    pub standard_error: f64,
    /// Lower end of the 95 % interval [unit]; not a number where it is open.
    pub low: f64,
    /// Upper end of the 95 % interval [unit]; not a number where it is open.
    pub high: f64,
    /// The data determines the parameter.
    pub identified: bool,
    /// If it does not: why, and what to measure instead. Else empty.
    pub explanation: String,
}

/// One figure of the table an experiment ends with.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure {
    /// What was driven: velocity tracking, position tracking, pre-sliding, ...
    pub task: String,
    /// The row of the table: what compensated, or which excitation.
    pub row: String,
    /// What the figure is: mse, max_error, effort, ...
    pub name: String,
    /// Its unit, as text; empty for a number without one.
    pub unit: String,
    /// Value [unit].
    pub value: f64,
    /// Standard deviation over the repetitions, or of the mean where the task gives one [unit]; not
    /// a number where there is none.
    pub deviation: f64,
}

/// How well one model fits, as identification found it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ModelFit {
    /// The model, as in parameter files.
    pub model: String,
    /// Root mean square of predicted minus measured friction on the recordings it was fitted to [N
    /// m, or N for a linear axis].
    pub fit_error: f64,
    /// The same on recordings it has not seen; not a number where none were given.
    pub validation_error: f64,
    /// Parameters that were fitted.
    pub parameters: u32,
    /// It cannot be told from the best one.
    pub tie: bool,
}

ros_message!(
    EstimatedParameter,
    "friction_msgs",
    "../../friction_msgs/msg/EstimatedParameter.msg",
    "RIHS01_cd64c8ea0fd55e652227d5c7749c5389e5f98b440c0b037faa71a4caabd0f45f",
    []
);
ros_message!(
    Figure,
    "friction_msgs",
    "../../friction_msgs/msg/Figure.msg",
    "RIHS01_3d0c32f56f31ba04fe4bfa853eaa2ce55fa93de617e27dab2185b8ded0860655",
    []
);
ros_message!(
    ModelFit,
    "friction_msgs",
    "../../friction_msgs/msg/ModelFit.msg",
    "RIHS01_66367b9398c44a11e50b9cc9d180b2e16821f12bcdd2f3e7879d458a736cee31",
    []
);
