//! Experiments: what there are, one started and left alone, one run to its end.

use serde::{Deserialize, Serialize};

use super::{EstimatedParameter, Figure};
use crate::message::{RosAction, RosService, ros_message, ros_part};

/// One option of an experiment or an identification, by its name on the command line.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Setting {
    /// Name of the option without dashes: quick, seed, plant, voltage-limit, ...
    pub name: String,
    /// Its value as text, as on the command line: 3, lugre, 4.5. For an option that is a switch:
    /// true, false or empty for true.
    pub value: String,
}

/// One option that an experiment can be given.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ExperimentParameter {
    /// Its name, as in Setting.
    pub name: String,
    /// What it does, with units.
    pub description: String,
    /// The value it has if nothing is said; empty where it has none.
    pub default_value: String,
    /// The values it may have, where they can be counted.
    pub choices: Vec<String>,
}

/// One experiment that can be run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ExperimentDescription {
    /// Its name.
    pub name: String,
    /// What it does.
    pub description: String,
    /// Time it takes in real time, with the default options \[s\].
    pub duration: f64,
    /// Time it takes in real time with the option `quick` \[s\].
    pub quick_duration: f64,
    /// What else it can be told.
    pub parameters: Vec<ExperimentParameter>,
}

ros_message!(
    Setting,
    "friction_msgs",
    "../../friction_msgs/msg/Setting.msg",
    "RIHS01_b538049a857f0252a7dda5a09aa85e9f7571edd5fca1a2ee4edd444d47a39b70",
    []
);
ros_message!(
    ExperimentParameter,
    "friction_msgs",
    "../../friction_msgs/msg/ExperimentParameter.msg",
    "RIHS01_b0bc795d3ad6e4324ef9f91414465c534441f94418b8dad44666527f8dcc116d",
    []
);
ros_message!(
    ExperimentDescription,
    "friction_msgs",
    "../../friction_msgs/msg/ExperimentDescription.msg",
    "RIHS01_b4694cccbc296236e279ccf573e6d978ba04afaf52e2117eaffc4a0a30f0c8b3",
    [ExperimentParameter]
);

/// Runs one experiment to its end. Cancelling it stops the rig; what was measured until then is
/// kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunExperiment;

/// Goal of [`RunExperiment`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunExperimentGoal {
    /// Name of the experiment, as `list_experiments` tells it: all, characterise,
    /// position-tracking, ...
    pub experiment: String,
    /// Models that compensate friction, each compared with none at all; empty for the experiment's
    /// own choice.
    pub models: Vec<String>,
    /// Repetitions of everything; 0 for the experiment's own number.
    pub repetitions: u32,
    /// Options by name, as `list_experiments` tells them.
    pub overrides: Vec<Setting>,
    /// Folder for the results, new or empty; if empty, the node makes one of its own.
    pub output_folder: String,
    /// If another experiment runs: end it and run this one, in place of being refused.
    pub preempt: bool,
}

/// Result of [`RunExperiment`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunExperimentResult {
    /// The experiment came to its end.
    pub success: bool,
    /// [`SUCCEEDED`](Self::SUCCEEDED), [`CANCELED`](Self::CANCELED), [`BUSY`](Self::BUSY),
    /// [`BAD_REQUEST`](Self::BAD_REQUEST) or [`FAILED`](Self::FAILED).
    pub outcome: u8,
    /// For people: what happened; if it was refused, why and how to mend it.
    pub message: String,
    /// Name of the run: the last part of its folder.
    pub run_id: String,
    /// Folder of the results; empty if nothing was written.
    pub folder: String,
    /// Folder of the bag; empty if there is none.
    pub bag_path: String,
    /// The report, a page for a browser; empty if there is none.
    pub report: String,
    /// Parameter file for friction_observer and controller; empty if there is none.
    pub parameters_file: String,
    /// What was identified.
    pub parameters: Vec<EstimatedParameter>,
    /// The table of figures.
    pub figures: Vec<Figure>,
}

impl RunExperimentResult {
    /// It came to its end.
    pub const SUCCEEDED: u8 = 0;
    /// It was cancelled or preempted.
    pub const CANCELED: u8 = 1;
    /// Another experiment runs; nothing was done.
    pub const BUSY: u8 = 2;
    /// The request cannot be carried out as it stands; nothing was done.
    pub const BAD_REQUEST: u8 = 3;
    /// The rig, the disk or the computation failed.
    pub const FAILED: u8 = 4;
}

/// Feedback of [`RunExperiment`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunExperimentFeedback {
    /// What is being done.
    pub stage: String,
    /// Repetition of the stage, from 1; 0 where it has none.
    pub repetition: u32,
    /// Done so far, 0 to 1.
    pub progress: f64,
    /// Expected time to the end \[s\]; not a number while unknown.
    pub remaining: f64,
    /// Time the rig has been driven \[s\]; more than the time on the clock where the rig is
    /// simulated as fast as possible.
    pub rig_seconds: f64,
}

impl RosAction for RunExperiment {
    const PACKAGE: &'static str = "friction_msgs";
    const NAME: &'static str = "RunExperiment";
    type Goal = RunExperimentGoal;
    type Result = RunExperimentResult;
    type Feedback = RunExperimentFeedback;
}

ros_part!(
    RunExperimentGoal,
    "friction_msgs",
    "action",
    "RunExperiment_Goal",
    "../../friction_msgs/action/RunExperiment.action",
    0,
    "RIHS01_1c83175bc81c40a63c96129d1934b7e78cb45ed5f5ebfdb675406d10a79b2914",
    [Setting]
);
ros_part!(
    RunExperimentResult,
    "friction_msgs",
    "action",
    "RunExperiment_Result",
    "../../friction_msgs/action/RunExperiment.action",
    1,
    "RIHS01_04c642b5fa17a85aae161b71287eea303fc72ffb9ddde41d831ed4bb3ae5f813",
    [EstimatedParameter, Figure]
);
ros_part!(
    RunExperimentFeedback,
    "friction_msgs",
    "action",
    "RunExperiment_Feedback",
    "../../friction_msgs/action/RunExperiment.action",
    2,
    "RIHS01_7f6d066486cf1ffce6e36c4607791dec0429478ac8ef55d6acf31a1cf7c1f6d8",
    []
);

/// Starts an experiment and returns at once. `/experiment_status` tells how it goes, the service
/// abort ends it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StartExperiment;

/// Request of [`StartExperiment`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct StartExperimentRequest {
    /// Name of the experiment, as `list_experiments` tells it.
    pub experiment: String,
    /// Models that compensate friction; empty for the experiment's own choice.
    pub models: Vec<String>,
    /// Repetitions of everything; 0 for the experiment's own number.
    pub repetitions: u32,
    /// Options by name, as `list_experiments` tells them.
    pub overrides: Vec<Setting>,
    /// Folder for the results, new or empty; if empty, the node makes one of its own.
    pub output_folder: String,
    /// If another experiment runs: end it and run this one, in place of being refused.
    pub preempt: bool,
}

/// Response of [`StartExperiment`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct StartExperimentResponse {
    /// The experiment was started.
    pub success: bool,
    /// For people: what was started; if it was refused, why and how to mend it.
    pub message: String,
    /// Name of the run: the last part of its folder.
    pub run_id: String,
    /// Folder that the results go to.
    pub folder: String,
}

impl RosService for StartExperiment {
    const PACKAGE: &'static str = "friction_msgs";
    const NAME: &'static str = "StartExperiment";
    type Request = StartExperimentRequest;
    type Response = StartExperimentResponse;
}

ros_part!(
    StartExperimentRequest,
    "friction_msgs",
    "srv",
    "StartExperiment_Request",
    "../../friction_msgs/srv/StartExperiment.srv",
    0,
    "RIHS01_45177bcb09bc3c2a7e44540bc9f7092583099f59ec954c854d39f7fb496322eb",
    [Setting]
);
ros_part!(
    StartExperimentResponse,
    "friction_msgs",
    "srv",
    "StartExperiment_Response",
    "../../friction_msgs/srv/StartExperiment.srv",
    1,
    "RIHS01_eaeba9b1b122e9a77ebcc61fdc1d4c6a947045b429e0b44c8aed4f9154626657",
    []
);

/// Tells which experiments there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ListExperiments;

/// Request of [`ListExperiments`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ListExperimentsRequest {
    /// The byte that ROS sends for a type without fields.
    pub structure_needs_at_least_one_member: u8,
}

/// Response of [`ListExperiments`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ListExperimentsResponse {
    /// The experiments.
    pub experiments: Vec<ExperimentDescription>,
}

impl RosService for ListExperiments {
    const PACKAGE: &'static str = "friction_msgs";
    const NAME: &'static str = "ListExperiments";
    type Request = ListExperimentsRequest;
    type Response = ListExperimentsResponse;
}

ros_part!(
    ListExperimentsRequest,
    "friction_msgs",
    "srv",
    "ListExperiments_Request",
    "../../friction_msgs/srv/ListExperiments.srv",
    0,
    "RIHS01_3ebc320164692935f3b6c5ed92f9bd9ca0b2774490f7d32576b579fb6068ee2c",
    []
);
ros_part!(
    ListExperimentsResponse,
    "friction_msgs",
    "srv",
    "ListExperiments_Response",
    "../../friction_msgs/srv/ListExperiments.srv",
    1,
    "RIHS01_f806e77b0aeddd627c17aa25281d648f6bc6fee63f7966e6a7a3ec684c331afb",
    [ExperimentDescription, ExperimentParameter]
);
