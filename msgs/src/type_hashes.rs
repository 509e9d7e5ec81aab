//! Hashes of the types that the laboratory's endpoints carry, by their names: what ROS announces
//! beside each reader and writer.
//!
//! The types of this crate know their own. The client library has the others: those of parameters,
//! logs and the graph, and what an action makes of its goal, result and feedback.

use std::{collections::BTreeMap, sync::LazyLock};

use crate::{
    RosMessage,
    diagnostic_msgs::DiagnosticArray,
    friction_msgs::*,
    lifecycle_msgs::{
        ChangeStateRequest, ChangeStateResponse, GetAvailableStatesRequest,
        GetAvailableStatesResponse, GetAvailableTransitionsRequest,
        GetAvailableTransitionsResponse, GetStateRequest, GetStateResponse, TransitionEvent,
    },
    rcl_interfaces::Log,
    rosgraph_msgs::Clock,
    sensor_msgs::JointState,
    std_srvs::{TriggerRequest, TriggerResponse},
};

/// Those that have no type in this crate.
const OTHERS: [(&str, &str); 22] = [
    (
        "action_msgs/msg/GoalStatusArray",
        "RIHS01_6c1684b00f177d37438febe6e709fc4e2b0d4248dca4854946f9ed8b30cda83e",
    ),
    (
        "action_msgs/srv/CancelGoal_Request",
        "RIHS01_3d3c84653c1f96918086887e1dcb236faec88b81a5b14fd4cf4840065bcdf8af",
    ),
    (
        "action_msgs/srv/CancelGoal_Response",
        "RIHS01_35e682cf3f510e83c70a82a4aac888496dedee56773bf9d8e5e0aa81f9e1c960",
    ),
    (
        "friction_msgs/action/RunExperiment_FeedbackMessage",
        "RIHS01_88103e2458dd15fab61a5a640c1170695cca34b63fb35f0a76b350dc471b5a9d",
    ),
    (
        "friction_msgs/action/RunExperiment_GetResult_Request",
        "RIHS01_8c8b20d6bafd660bf91d05eab594e386e375ef8fe972063a52d1d01b15791437",
    ),
    (
        "friction_msgs/action/RunExperiment_GetResult_Response",
        "RIHS01_a647623ced3285699fc781d5668ae30647f989c349ef807debef7ad3b59640d7",
    ),
    (
        "friction_msgs/action/RunExperiment_SendGoal_Request",
        "RIHS01_7ea665145d26e490c93ea6a2c875201867354036c64c75c3b2241c5ec5cf7c2d",
    ),
    (
        "friction_msgs/action/RunExperiment_SendGoal_Response",
        "RIHS01_729ba4bfbaf73a9a1f18396381ac2e0d831bc1e458c7a64d4b7c817cc367925e",
    ),
    (
        "rcl_interfaces/msg/ParameterEvent",
        "RIHS01_043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204",
    ),
    (
        "rcl_interfaces/srv/DescribeParameters_Request",
        "RIHS01_05dd1c2bc87dec2627105c8070d6f9725c781a4f2ab852975bf105462b82b644",
    ),
    (
        "rcl_interfaces/srv/DescribeParameters_Response",
        "RIHS01_ad6747319613c6131589e062e095b469a46cc764f7d0f12a001a49e6cd893995",
    ),
    (
        "rcl_interfaces/srv/GetParameterTypes_Request",
        "RIHS01_87d7ec5ef545d4daa289d500025d31fb2437bc8b8365ca367161c4dac4be33fd",
    ),
    (
        "rcl_interfaces/srv/GetParameterTypes_Response",
        "RIHS01_ac1335dce67c478e669434f6ac2fbff34fcd529580f272d3006785ba8b54e47f",
    ),
    (
        "rcl_interfaces/srv/GetParameters_Request",
        "RIHS01_135a9e1c3d7cebef792f6687d7ddf99949b21a0bd9a320d863a9110a3f5cf4d6",
    ),
    (
        "rcl_interfaces/srv/GetParameters_Response",
        "RIHS01_9fa773b46e39cc5d02db6224d8fd520bb9caeeffc2b27c96c1e59431baba9f2a",
    ),
    (
        "rcl_interfaces/srv/ListParameters_Request",
        "RIHS01_a1b0b5d6b967a5b8ac5bc8563c3ea678f349e312a6a4967227c5a96bc5ce38df",
    ),
    (
        "rcl_interfaces/srv/ListParameters_Response",
        "RIHS01_31b937b82de3612426be79f231e386259f97e8dc843e3f2845288b4bfa296bdd",
    ),
    (
        "rcl_interfaces/srv/SetParametersAtomically_Request",
        "RIHS01_db0bd950ed5ed867a0e90b225e44dea382d762c0762ff3e0ee842190042a59e5",
    ),
    (
        "rcl_interfaces/srv/SetParametersAtomically_Response",
        "RIHS01_31b1a38c5b0b9d893ee24da45f69638f4561c78461d82d52750f429b534502b8",
    ),
    (
        "rcl_interfaces/srv/SetParameters_Request",
        "RIHS01_130d46386b7e84ea9ecf60608a4d83cbe5e5cb7c6cc5b712b7a4e3a6c254e932",
    ),
    (
        "rcl_interfaces/srv/SetParameters_Response",
        "RIHS01_7a0e8140a0b8d98308fa81a5403a766e610af29a239caf54b7553227906fc266",
    ),
    (
        "rmw_dds_common/msg/ParticipantEntitiesInfo",
        "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e",
    ),
];

static ALL: LazyLock<BTreeMap<String, &'static str>> = LazyLock::new(|| {
    fn own<M: RosMessage>() -> (String, &'static str) {
        (M::type_name(), M::TYPE_HASH)
    }
    let own = [
        own::<JointState>(),
        own::<DiagnosticArray>(),
        own::<Log>(),
        own::<Clock>(),
        own::<TransitionEvent>(),
        own::<ChangeStateRequest>(),
        own::<ChangeStateResponse>(),
        own::<GetStateRequest>(),
        own::<GetStateResponse>(),
        own::<GetAvailableStatesRequest>(),
        own::<GetAvailableStatesResponse>(),
        own::<GetAvailableTransitionsRequest>(),
        own::<GetAvailableTransitionsResponse>(),
        own::<RigMeasurement>(),
        own::<Reference>(),
        own::<MotorVoltage>(),
        own::<FrictionEstimate>(),
        own::<ControllerState>(),
        own::<ExperimentStatus>(),
        own::<StartExperimentRequest>(),
        own::<StartExperimentResponse>(),
        own::<ListExperimentsRequest>(),
        own::<ListExperimentsResponse>(),
        own::<IdentifyRequest>(),
        own::<IdentifyResponse>(),
        own::<TriggerRequest>(),
        own::<TriggerResponse>(),
    ];
    own.into_iter().chain(OTHERS.map(|(name, hash)| (name.to_owned(), hash))).collect()
});

/// Names, as in `std_srvs/srv/Trigger_Request`, with the hashes of the types (`RIHS01_...`).
#[must_use]
pub fn all() -> &'static BTreeMap<String, &'static str> {
    &ALL
}

/// The hash of a type that DDS calls so, as in `std_srvs::srv::dds_::Trigger_Request_`; `None` if
/// it is none of the laboratory's.
#[must_use]
pub fn of_dds(type_name: &str) -> Option<&'static str> {
    let (folder, name) = type_name.strip_suffix('_')?.split_once("::dds_::")?;
    ALL.get(&format!("{}/{name}", folder.replace("::", "/"))).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_is_found_by_the_name_that_dds_has() {
        assert_eq!(
            of_dds("std_srvs::srv::dds_::Trigger_Request_"),
            Some(TriggerRequest::TYPE_HASH)
        );
        assert_eq!(of_dds("friction_msgs::msg::dds_::Reference_"), Some(Reference::TYPE_HASH));
        let goal = OTHERS
            .iter()
            .find(|(name, _)| name.ends_with("SendGoal_Request"))
            .map(|(_, hash)| *hash);
        assert_eq!(of_dds("friction_msgs::action::dds_::RunExperiment_SendGoal_Request_"), goal);
        for unknown in
            ["", "_", "std_srvs/srv/Trigger_Request", "std_msgs::msg::dds_::Empty_", "::dds_::_"]
        {
            assert_eq!(of_dds(unknown), None, "{unknown}");
        }
    }
}
