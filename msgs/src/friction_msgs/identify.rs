//! Identification of friction models from a bag.

use serde::{Deserialize, Serialize};

use super::{EstimatedParameter, ModelFit, Setting};
use crate::message::{RosService, ros_part};

/// Identifies friction models from a bag. It may take minutes: give the client time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Identify;

/// Request of [`Identify`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct IdentifyRequest {
    /// The bag: a folder or an .mcap file.
    pub bag_path: String,
    /// Models to identify; empty for the usual ones.
    pub models: Vec<String>,
    /// Bags that the models are tried on and not fitted to.
    pub validation_bags: Vec<String>,
    /// Options by name, as on the command line of `frictionlab identify`.
    pub overrides: Vec<Setting>,
    /// Folder for the results; if empty, a folder beside the bag.
    pub output_folder: String,
}

/// Response of [`Identify`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct IdentifyResponse {
    /// Something was identified.
    pub success: bool,
    /// For people: what was found; if nothing was, why and how to mend it.
    pub message: String,
    /// The model to use: the simplest one that cannot be told from the best.
    pub model: String,
    /// Parameters of every model, with their uncertainty.
    pub parameters: Vec<EstimatedParameter>,
    /// The models, best first.
    pub fits: Vec<ModelFit>,
    /// Parameter file for friction_observer.
    pub parameters_file: String,
    /// The report, a page for a browser.
    pub report: String,
}

impl RosService for Identify {
    const PACKAGE: &'static str = "friction_msgs";
    const NAME: &'static str = "Identify";
    type Request = IdentifyRequest;
    type Response = IdentifyResponse;
}

ros_part!(
    IdentifyRequest,
    "friction_msgs",
    "srv",
    "Identify_Request",
    "../../friction_msgs/srv/Identify.srv",
    0,
    "RIHS01_0f5ddf71182053a5d0412ad83a147606d671080dab7597e9f949e804375562fa",
    [Setting]
);
ros_part!(
    IdentifyResponse,
    "friction_msgs",
    "srv",
    "Identify_Response",
    "../../friction_msgs/srv/Identify.srv",
    1,
    "RIHS01_6b425e932475a812bc15b05d2e2fb6d40bb19a1f739b635e89b76d558fb0f652",
    [EstimatedParameter, ModelFit]
);
