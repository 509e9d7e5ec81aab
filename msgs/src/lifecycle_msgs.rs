//! Types of the ROS package `lifecycle_msgs`: managed nodes.

use serde::{Deserialize, Serialize};

use crate::message::{RosService, ros_message, ros_part};

/// State of a managed node.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct State {
    /// One of the constants.
    pub id: u8,
    /// Its name.
    pub label: String,
}

impl State {
    /// Unknown.
    pub const PRIMARY_STATE_UNKNOWN: u8 = 0;
    /// Unconfigured.
    pub const PRIMARY_STATE_UNCONFIGURED: u8 = 1;
    /// Inactive.
    pub const PRIMARY_STATE_INACTIVE: u8 = 2;
    /// Active.
    pub const PRIMARY_STATE_ACTIVE: u8 = 3;
    /// Finalized.
    pub const PRIMARY_STATE_FINALIZED: u8 = 4;
    /// Configuring.
    pub const TRANSITION_STATE_CONFIGURING: u8 = 10;
    /// Cleaningup.
    pub const TRANSITION_STATE_CLEANINGUP: u8 = 11;
    /// Shuttingdown.
    pub const TRANSITION_STATE_SHUTTINGDOWN: u8 = 12;
    /// Activating.
    pub const TRANSITION_STATE_ACTIVATING: u8 = 13;
    /// Deactivating.
    pub const TRANSITION_STATE_DEACTIVATING: u8 = 14;
    /// Errorprocessing.
    pub const TRANSITION_STATE_ERRORPROCESSING: u8 = 15;
}

/// Transition of a managed node from one state to another.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Transition {
    /// One of the constants; 0 to go by the label.
    pub id: u8,
    /// Its name.
    pub label: String,
}

impl Transition {
    /// Create.
    pub const TRANSITION_CREATE: u8 = 0;
    /// Configure.
    pub const TRANSITION_CONFIGURE: u8 = 1;
    /// Cleanup.
    pub const TRANSITION_CLEANUP: u8 = 2;
    /// Activate.
    pub const TRANSITION_ACTIVATE: u8 = 3;
    /// Deactivate.
    pub const TRANSITION_DEACTIVATE: u8 = 4;
    /// Unconfigured shutdown.
    pub const TRANSITION_UNCONFIGURED_SHUTDOWN: u8 = 5;
    /// Inactive shutdown.
    pub const TRANSITION_INACTIVE_SHUTDOWN: u8 = 6;
    /// Active shutdown.
    pub const TRANSITION_ACTIVE_SHUTDOWN: u8 = 7;
    /// Destroy.
    pub const TRANSITION_DESTROY: u8 = 8;
    /// Configure success.
    pub const TRANSITION_ON_CONFIGURE_SUCCESS: u8 = 10;
    /// Configure failure.
    pub const TRANSITION_ON_CONFIGURE_FAILURE: u8 = 11;
    /// Configure error.
    pub const TRANSITION_ON_CONFIGURE_ERROR: u8 = 12;
    /// Cleanup success.
    pub const TRANSITION_ON_CLEANUP_SUCCESS: u8 = 20;
    /// Cleanup failure.
    pub const TRANSITION_ON_CLEANUP_FAILURE: u8 = 21;
    /// Cleanup error.
    pub const TRANSITION_ON_CLEANUP_ERROR: u8 = 22;
    /// Activate success.
    pub const TRANSITION_ON_ACTIVATE_SUCCESS: u8 = 30;
    /// Activate failure.
    pub const TRANSITION_ON_ACTIVATE_FAILURE: u8 = 31;
    /// Activate error.
    pub const TRANSITION_ON_ACTIVATE_ERROR: u8 = 32;
    /// Deactivate success.
    pub const TRANSITION_ON_DEACTIVATE_SUCCESS: u8 = 40;
    /// Deactivate failure.
    pub const TRANSITION_ON_DEACTIVATE_FAILURE: u8 = 41;
    /// Deactivate error.
    pub const TRANSITION_ON_DEACTIVATE_ERROR: u8 = 42;
    /// Shutdown success.
    pub const TRANSITION_ON_SHUTDOWN_SUCCESS: u8 = 50;
    /// Shutdown failure.
    pub const TRANSITION_ON_SHUTDOWN_FAILURE: u8 = 51;
    /// Shutdown error.
    pub const TRANSITION_ON_SHUTDOWN_ERROR: u8 = 52;
    /// Error success.
    pub const TRANSITION_ON_ERROR_SUCCESS: u8 = 60;
    /// Error failure.
    pub const TRANSITION_ON_ERROR_FAILURE: u8 = 61;
    /// Error error.
    pub const TRANSITION_ON_ERROR_ERROR: u8 = 62;
    /// Callback success.
    pub const TRANSITION_CALLBACK_SUCCESS: u8 = 97;
    /// Callback failure.
    pub const TRANSITION_CALLBACK_FAILURE: u8 = 98;
    /// Callback error.
    pub const TRANSITION_CALLBACK_ERROR: u8 = 99;
}

/// A transition with its ends.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct TransitionDescription {
    /// The transition.
    pub transition: Transition,
    /// State before.
    pub start_state: State,
    /// State after.
    pub goal_state: State,
}

/// A transition that happened.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct TransitionEvent {
    /// When \[ns\].
    pub timestamp: u64,
    /// The transition.
    pub transition: Transition,
    /// State before.
    pub start_state: State,
    /// State after.
    pub goal_state: State,
}

ros_message!(
    State,
    "lifecycle_msgs",
    "../standard/lifecycle_msgs/State.msg",
    "RIHS01_dd2d02b82f3ebc858e53c431b1e6e91f3ffc71436fc81d0715214ac6ee2107a0",
    []
);
ros_message!(
    Transition,
    "lifecycle_msgs",
    "../standard/lifecycle_msgs/Transition.msg",
    "RIHS01_c65d7b31ea134cba4f54fc867b817979be799f7452035cd35fac9b7421fb3424",
    []
);
ros_message!(
    TransitionDescription,
    "lifecycle_msgs",
    "../standard/lifecycle_msgs/TransitionDescription.msg",
    "RIHS01_c5f1cd4bb1ad2ba0e3329d4ac7015c52a674a72c1faf7974c37a33f4f6048b28",
    [Transition, State]
);
ros_message!(
    TransitionEvent,
    "lifecycle_msgs",
    "../standard/lifecycle_msgs/TransitionEvent.msg",
    "RIHS01_d5f8873a2f0146498f812d7885c7327ce27e463d36811d8792f35ee38c0d6c38",
    [Transition, State]
);

/// Asks a managed node for a transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChangeState;

/// Request of [`ChangeState`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ChangeStateRequest {
    /// By its number, or by its label where the number is 0.
    pub transition: Transition,
}

/// Response of [`ChangeState`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ChangeStateResponse {
    /// It was done.
    pub success: bool,
}

impl RosService for ChangeState {
    const PACKAGE: &'static str = "lifecycle_msgs";
    const NAME: &'static str = "ChangeState";
    type Request = ChangeStateRequest;
    type Response = ChangeStateResponse;
}

ros_part!(
    ChangeStateRequest,
    "lifecycle_msgs",
    "srv",
    "ChangeState_Request",
    "../standard/lifecycle_msgs/ChangeState.srv",
    0,
    "RIHS01_d74c6f524e14cade7b67e7297190360ed749264af300524fc1456f27cc2a553a",
    [Transition]
);

ros_part!(
    ChangeStateResponse,
    "lifecycle_msgs",
    "srv",
    "ChangeState_Response",
    "../standard/lifecycle_msgs/ChangeState.srv",
    1,
    "RIHS01_e1ddfed0271fefe63767aa71561926e4d9eac0f1ddf9e71a8873eb46b36deac2",
    []
);

/// Asks a managed node for its state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GetState;

/// Request of [`GetState`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct GetStateRequest {
    /// The byte that ROS sends for a type without fields.
    pub structure_needs_at_least_one_member: u8,
}

/// Response of [`GetState`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct GetStateResponse {
    /// The state.
    pub current_state: State,
}

impl RosService for GetState {
    const PACKAGE: &'static str = "lifecycle_msgs";
    const NAME: &'static str = "GetState";
    type Request = GetStateRequest;
    type Response = GetStateResponse;
}

ros_part!(
    GetStateRequest,
    "lifecycle_msgs",
    "srv",
    "GetState_Request",
    "../standard/lifecycle_msgs/GetState.srv",
    0,
    "RIHS01_77a9c844e7975f15bc2221e8bbebafc4d118afb78c7f7071eef91f83f940f2f6",
    []
);

ros_part!(
    GetStateResponse,
    "lifecycle_msgs",
    "srv",
    "GetState_Response",
    "../standard/lifecycle_msgs/GetState.srv",
    1,
    "RIHS01_fe249babab472e42cb5653b5d6a6b0c42a003b0fdfb84851aea3fde08760b4f5",
    [State]
);

/// Asks a managed node for every state there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GetAvailableStates;

/// Request of [`GetAvailableStates`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct GetAvailableStatesRequest {
    /// The byte that ROS sends for a type without fields.
    pub structure_needs_at_least_one_member: u8,
}

/// Response of [`GetAvailableStates`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct GetAvailableStatesResponse {
    /// All of them.
    pub available_states: Vec<State>,
}

impl RosService for GetAvailableStates {
    const PACKAGE: &'static str = "lifecycle_msgs";
    const NAME: &'static str = "GetAvailableStates";
    type Request = GetAvailableStatesRequest;
    type Response = GetAvailableStatesResponse;
}

ros_part!(
    GetAvailableStatesRequest,
    "lifecycle_msgs",
    "srv",
    "GetAvailableStates_Request",
    "../standard/lifecycle_msgs/GetAvailableStates.srv",
    0,
    "RIHS01_c2c0c12de6023822f284929577d4ca2862e0501150010966e8a90b632e4424de",
    []
);

ros_part!(
    GetAvailableStatesResponse,
    "lifecycle_msgs",
    "srv",
    "GetAvailableStates_Response",
    "../standard/lifecycle_msgs/GetAvailableStates.srv",
    1,
    "RIHS01_223e0dd5bb8a847ebb9532adaf8b5e2a97e6e68e79faeaabd81a45fb32925bd1",
    [State]
);

/// Asks a managed node for transitions: those that can be asked for now, or all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GetAvailableTransitions;

/// Request of [`GetAvailableTransitions`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct GetAvailableTransitionsRequest {
    /// The byte that ROS sends for a type without fields.
    pub structure_needs_at_least_one_member: u8,
}

/// Response of [`GetAvailableTransitions`].
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct GetAvailableTransitionsResponse {
    /// The transitions.
    pub available_transitions: Vec<TransitionDescription>,
}

impl RosService for GetAvailableTransitions {
    const PACKAGE: &'static str = "lifecycle_msgs";
    const NAME: &'static str = "GetAvailableTransitions";
    type Request = GetAvailableTransitionsRequest;
    type Response = GetAvailableTransitionsResponse;
}

ros_part!(
    GetAvailableTransitionsRequest,
    "lifecycle_msgs",
    "srv",
    "GetAvailableTransitions_Request",
    "../standard/lifecycle_msgs/GetAvailableTransitions.srv",
    0,
    "RIHS01_52a73c0b5d7489bee0df6ddb0aec45c41289d223ff225b58fe11d859ac8109a6",
    []
);

ros_part!(
    GetAvailableTransitionsResponse,
    "lifecycle_msgs",
    "srv",
    "GetAvailableTransitions_Response",
    "../standard/lifecycle_msgs/GetAvailableTransitions.srv",
    1,
    "RIHS01_4711339461aadf02bcfff797a198de911f885074bd3f2fe9f7b677ef87f0741c",
    [TransitionDescription, Transition, State]
);
