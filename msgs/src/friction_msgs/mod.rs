//! Types of the laboratory's own ROS package `friction_msgs`, whose definitions stand in
//! `msgs/friction_msgs/`.
//!
//! Here are the signals of the control cycle and the status of an experiment; [`RunExperiment`] and
//! the services have files of their own.

mod experiments;
mod identify;
mod results;

use serde::{Deserialize, Serialize};

pub use experiments::{
    ExperimentDescription, ExperimentParameter, ListExperiments, ListExperimentsRequest,
    ListExperimentsResponse, RunExperiment, RunExperimentFeedback, RunExperimentGoal,
    RunExperimentResult, Setting, StartExperiment, StartExperimentRequest, StartExperimentResponse,
};
pub use identify::{Identify, IdentifyRequest, IdentifyResponse};
pub use results::{EstimatedParameter, Figure, ModelFit};

use crate::{builtin_interfaces::Time, message::ros_message, std_msgs::Header};

/// Every channel of the rig, once a control cycle. SI units, load side of the gear.
/// Positive friction torque opposes positive velocity.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RigMeasurement {
    /// Time of the measurement.
    pub header: Header,
    /// Number of the control cycle, from 0.
    pub cycle: u64,
    /// Time since the rig started \[s\].
    pub rig_time: f64,
    /// Encoder count, unwrapped.
    pub encoder_counts: i64,
    /// Position from the encoder \[rad\].
    pub encoder_position: f64,
    /// Velocity from the tachometer \[rad/s\].
    pub tachometer_velocity: f64,
    /// Position from the potentiometer \[rad\].
    pub potentiometer_position: f64,
    /// Friction torque from the torque sensor \[N m\].
    pub torque: f64,
    /// Voltage the controller asked for in the cycle before \[V\].
    pub voltage_asked: f64,
    /// Voltage that was applied in the cycle before \[V\].
    pub voltage_applied: f64,
    /// The voltage asked for was beyond a limit and was cut.
    pub saturated: bool,
    /// The command watchdog has expired.
    pub watchdog_expired: bool,
    /// A fault holds the output at zero volts.
    pub fault: bool,
}

/// Where the axis should be, load side of the gear.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Reference {
    /// Time the reference is for.
    pub header: Header,
    /// Position \[rad\].
    pub position: f64,
    /// Velocity \[rad/s\].
    pub velocity: f64,
    /// Acceleration \[rad/s^2\].
    pub acceleration: f64,
}

/// The motor voltage a controller asks for.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct MotorVoltage {
    /// Time of the measurement the voltage answers to.
    pub header: Header,
    /// Voltage \[V\].
    pub voltage: f64,
}

/// What the friction observer says once a control cycle.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct FrictionEstimate {
    /// Time of the measurement the estimate was made with.
    pub header: Header,
    /// Name of the model behind the estimate, as in parameter files: coulomb, lugre, proposed, ...
    pub model: String,
    /// Friction torque \[N m\]; positive opposes positive velocity.
    pub torque: f64,
    /// Bristle deflection z \[rad\]; zero for models without bristles.
    pub deflection: f64,
    /// Stribeck state gamma [N m]: the present sliding level.
    pub gamma: f64,
    /// [`STICK`](Self::STICK) or [`SLIP`](Self::SLIP).
    pub regime: u8,
    /// Velocity the estimate was made with \[rad/s\].
    pub velocity: f64,
    /// Measured torque minus estimated torque \[N m\]; not a number where the rig has no torque
    /// sensor.
    pub residual: f64,
}

impl FrictionEstimate {
    /// The bristles hold: presliding.
    pub const STICK: u8 = 0;
    /// The surfaces slide.
    pub const SLIP: u8 = 1;
}

/// What the controller saw and decided in one control cycle.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ControllerState {
    /// Time of the measurement the command answers to.
    pub header: Header,
    /// [`VELOCITY`](Self::VELOCITY) or [`POSITION`](Self::POSITION).
    pub mode: u8,
    /// Value the feedback is compared with \[rad or rad/s, by mode\].
    pub reference: f64,
    /// Measured value \[rad or rad/s, by mode\].
    pub feedback: f64,
    /// Reference minus feedback \[rad or rad/s, by mode\].
    pub error: f64,
    /// Part of the linear controller \[V\].
    pub linear: f64,
    /// Part of the plant inverse \[V\].
    pub inverse: f64,
    /// Part of the friction compensation \[V\].
    pub friction: f64,
    /// Part of the dither \[V\].
    pub dither: f64,
    /// Voltage sent to the rig, after the limit \[V\].
    pub total: f64,
    /// The sum of the parts was beyond the limit.
    pub saturated: bool,
}

impl ControllerState {
    /// The feedback is a velocity \[rad/s\].
    pub const VELOCITY: u8 = 0;
    /// The feedback is a position \[rad\].
    pub const POSITION: u8 = 1;
}

/// How far an experiment has come. Published transient local, so that whoever comes late sees the
/// last one.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ExperimentStatus {
    /// Time of the status.
    pub header: Header,
    /// Name of the experiment; empty when none runs.
    pub experiment: String,
    /// What is being done.
    pub stage: String,
    /// Repetition of the stage, from 1; 0 where it has none.
    pub repetition: u32,
    /// Done so far, 0 to 1.
    pub progress: f64,
    /// Expected time to the end \[s\]; not a number while unknown.
    pub remaining: f64,
    /// Folder of the bag that is being written; empty when none is.
    pub bag_path: String,
    /// For people: what happened, or why it stopped.
    pub message: String,
}

ros_message!(
    RigMeasurement,
    "friction_msgs",
    "../../friction_msgs/msg/RigMeasurement.msg",
    "RIHS01_7da0dc2defaa8a98d64a3556489dcadd870867c298a25984c9b3a694d86083ec",
    [Header, Time]
);
ros_message!(
    Reference,
    "friction_msgs",
    "../../friction_msgs/msg/Reference.msg",
    "RIHS01_e01316e06571dd817281ccb0181b873f1e00affc3312d9c17c9abd4925d0fc00",
    [Header, Time]
);
ros_message!(
    MotorVoltage,
    "friction_msgs",
    "../../friction_msgs/msg/MotorVoltage.msg",
    "RIHS01_df6769a80fde48a776a0ee6f4105f3c6762e8db06ed1a9afd6f15cc656a19597",
    [Header, Time]
);
ros_message!(
    FrictionEstimate,
    "friction_msgs",
    "../../friction_msgs/msg/FrictionEstimate.msg",
    "RIHS01_a9d34e3b3088be9deaff306de4e26e2e3dc305a4a67e3b5ecc7bdd7a43236c13",
    [Header, Time]
);
ros_message!(
    ControllerState,
    "friction_msgs",
    "../../friction_msgs/msg/ControllerState.msg",
    "RIHS01_0af08586f0dfe4b1ab2748bbb7044670f3a989ecd7fe965fd6d6784b61fc07e0",
    [Header, Time]
);
ros_message!(
    ExperimentStatus,
    "friction_msgs",
    "../../friction_msgs/msg/ExperimentStatus.msg",
    "RIHS01_483b7be573199df44572ecedaca71370e3b19354c7820c6f460feec2d9c447fb",
    [Header, Time]
);
