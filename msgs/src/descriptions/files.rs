//! The files of this crate.

use super::library::Library;
use crate::message::part;

/// Package, name and text of a file.
type File = (&'static str, &'static str, &'static str);

macro_rules! file {
    ($package:literal, $name:literal, $path:literal) => {
        ($package, $name, include_str!(concat!("../../", $path)))
    };
}

const MESSAGES: [File; 46] = [
    file!("friction_msgs", "ControllerState", "friction_msgs/msg/ControllerState.msg"),
    file!("friction_msgs", "EstimatedParameter", "friction_msgs/msg/EstimatedParameter.msg"),
    file!("friction_msgs", "ExperimentDescription", "friction_msgs/msg/ExperimentDescription.msg"),
    file!("friction_msgs", "ExperimentParameter", "friction_msgs/msg/ExperimentParameter.msg"),
    file!("friction_msgs", "ExperimentStatus", "friction_msgs/msg/ExperimentStatus.msg"),
    file!("friction_msgs", "Figure", "friction_msgs/msg/Figure.msg"),
    file!("friction_msgs", "FrictionEstimate", "friction_msgs/msg/FrictionEstimate.msg"),
    file!("friction_msgs", "ModelFit", "friction_msgs/msg/ModelFit.msg"),
    file!("friction_msgs", "MotorVoltage", "friction_msgs/msg/MotorVoltage.msg"),
    file!("friction_msgs", "Reference", "friction_msgs/msg/Reference.msg"),
    file!("friction_msgs", "RigMeasurement", "friction_msgs/msg/RigMeasurement.msg"),
    file!("friction_msgs", "Setting", "friction_msgs/msg/Setting.msg"),
    file!("action_msgs", "GoalInfo", "standard/action_msgs/GoalInfo.msg"),
    file!("action_msgs", "GoalStatus", "standard/action_msgs/GoalStatus.msg"),
    file!("action_msgs", "GoalStatusArray", "standard/action_msgs/GoalStatusArray.msg"),
    file!("builtin_interfaces", "Time", "standard/builtin_interfaces/Time.msg"),
    file!("diagnostic_msgs", "DiagnosticArray", "standard/diagnostic_msgs/DiagnosticArray.msg"),
    file!("diagnostic_msgs", "DiagnosticStatus", "standard/diagnostic_msgs/DiagnosticStatus.msg"),
    file!("diagnostic_msgs", "KeyValue", "standard/diagnostic_msgs/KeyValue.msg"),
    file!("lifecycle_msgs", "State", "standard/lifecycle_msgs/State.msg"),
    file!("lifecycle_msgs", "Transition", "standard/lifecycle_msgs/Transition.msg"),
    file!(
        "lifecycle_msgs",
        "TransitionDescription",
        "standard/lifecycle_msgs/TransitionDescription.msg"
    ),
    file!("lifecycle_msgs", "TransitionEvent", "standard/lifecycle_msgs/TransitionEvent.msg"),
    file!("rcl_interfaces", "FloatingPointRange", "standard/rcl_interfaces/FloatingPointRange.msg"),
    file!("rcl_interfaces", "IntegerRange", "standard/rcl_interfaces/IntegerRange.msg"),
    file!(
        "rcl_interfaces",
        "ListParametersResult",
        "standard/rcl_interfaces/ListParametersResult.msg"
    ),
    file!("rcl_interfaces", "Log", "standard/rcl_interfaces/Log.msg"),
    file!("rcl_interfaces", "Parameter", "standard/rcl_interfaces/Parameter.msg"),
    file!(
        "rcl_interfaces",
        "ParameterDescriptor",
        "standard/rcl_interfaces/ParameterDescriptor.msg"
    ),
    file!("rcl_interfaces", "ParameterEvent", "standard/rcl_interfaces/ParameterEvent.msg"),
    file!("rcl_interfaces", "ParameterValue", "standard/rcl_interfaces/ParameterValue.msg"),
    file!(
        "rcl_interfaces",
        "SetParametersResult",
        "standard/rcl_interfaces/SetParametersResult.msg"
    ),
    file!("rmw_dds_common", "Gid", "standard/rmw_dds_common/Gid.msg"),
    file!("rmw_dds_common", "NodeEntitiesInfo", "standard/rmw_dds_common/NodeEntitiesInfo.msg"),
    file!(
        "rmw_dds_common",
        "ParticipantEntitiesInfo",
        "standard/rmw_dds_common/ParticipantEntitiesInfo.msg"
    ),
    file!("rosgraph_msgs", "Clock", "standard/rosgraph_msgs/Clock.msg"),
    file!("sensor_msgs", "JointState", "standard/sensor_msgs/JointState.msg"),
    file!("service_msgs", "ServiceEventInfo", "standard/service_msgs/ServiceEventInfo.msg"),
    file!("std_msgs", "Header", "standard/std_msgs/Header.msg"),
    file!("type_description_interfaces", "Field", "standard/type_description_interfaces/Field.msg"),
    file!(
        "type_description_interfaces",
        "FieldType",
        "standard/type_description_interfaces/FieldType.msg"
    ),
    file!(
        "type_description_interfaces",
        "IndividualTypeDescription",
        "standard/type_description_interfaces/IndividualTypeDescription.msg"
    ),
    file!(
        "type_description_interfaces",
        "KeyValue",
        "standard/type_description_interfaces/KeyValue.msg"
    ),
    file!(
        "type_description_interfaces",
        "TypeDescription",
        "standard/type_description_interfaces/TypeDescription.msg"
    ),
    file!(
        "type_description_interfaces",
        "TypeSource",
        "standard/type_description_interfaces/TypeSource.msg"
    ),
    file!("unique_identifier_msgs", "UUID", "standard/unique_identifier_msgs/UUID.msg"),
];

const SERVICES: [File; 16] = [
    file!("friction_msgs", "Identify", "friction_msgs/srv/Identify.srv"),
    file!("friction_msgs", "ListExperiments", "friction_msgs/srv/ListExperiments.srv"),
    file!("friction_msgs", "StartExperiment", "friction_msgs/srv/StartExperiment.srv"),
    file!("action_msgs", "CancelGoal", "standard/action_msgs/CancelGoal.srv"),
    file!("lifecycle_msgs", "ChangeState", "standard/lifecycle_msgs/ChangeState.srv"),
    file!("lifecycle_msgs", "GetAvailableStates", "standard/lifecycle_msgs/GetAvailableStates.srv"),
    file!(
        "lifecycle_msgs",
        "GetAvailableTransitions",
        "standard/lifecycle_msgs/GetAvailableTransitions.srv"
    ),
    file!("lifecycle_msgs", "GetState", "standard/lifecycle_msgs/GetState.srv"),
    file!("rcl_interfaces", "DescribeParameters", "standard/rcl_interfaces/DescribeParameters.srv"),
    file!("rcl_interfaces", "GetParameterTypes", "standard/rcl_interfaces/GetParameterTypes.srv"),
    file!("rcl_interfaces", "GetParameters", "standard/rcl_interfaces/GetParameters.srv"),
    file!("rcl_interfaces", "ListParameters", "standard/rcl_interfaces/ListParameters.srv"),
    file!("rcl_interfaces", "SetParameters", "standard/rcl_interfaces/SetParameters.srv"),
    file!(
        "rcl_interfaces",
        "SetParametersAtomically",
        "standard/rcl_interfaces/SetParametersAtomically.srv"
    ),
    file!("std_srvs", "Trigger", "standard/std_srvs/Trigger.srv"),
    file!(
        "type_description_interfaces",
        "GetTypeDescription",
        "standard/type_description_interfaces/GetTypeDescription.srv"
    ),
];

const ACTIONS: [File; 1] =
    [file!("friction_msgs", "RunExperiment", "friction_msgs/action/RunExperiment.action")];

/// All of them.
pub(super) fn library() -> Library {
    let mut library = Library::default();
    // A test reads each of them.
    for (package, name, text) in MESSAGES {
        let _ = library.add_message(package, name, text);
    }
    for (package, name, text) in SERVICES {
        let _ = library.add_service(package, name, [part(text, 0), part(text, 1)]);
    }
    for (package, name, text) in ACTIONS {
        let _ = library.add_action(package, name, [0, 1, 2].map(|number| part(text, number)));
    }
    library
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_read_and_refers_to_others_that_are() {
        let library = library();
        let (messages, services) = (MESSAGES.map(|f| (f, "msg")), SERVICES.map(|f| (f, "srv")));
        let actions = ACTIONS.map(|file| (file, "action"));
        for ((package, name, text), folder) in messages.into_iter().chain(services).chain(actions) {
            let described = library.describe(&format!("{package}/{folder}/{name}"));
            let described = described.unwrap_or_else(|error| panic!("{package}/{name}: {error}"));
            assert_eq!(described.sources[0].raw_file_contents, text.trim_end());
        }
    }

    #[test]
    fn no_file_is_left_out() {
        let listed = |package: &str, name: &str| {
            let same = |file: &&File| (file.0, file.1) == (package, name);
            [&MESSAGES[..], &SERVICES, &ACTIONS].into_iter().flatten().any(|file| same(&file))
        };
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let folder = |path: &std::path::Path| -> Vec<_> {
            let entries = path.read_dir().expect("a folder").map(|entry| entry.expect("an entry"));
            entries.map(|entry| entry.path()).collect()
        };
        let own = ["msg", "srv", "action"].map(|of| root.join("friction_msgs").join(of));
        let own =
            own.iter().flat_map(|path| folder(path)).map(|path| ("friction_msgs".to_owned(), path));
        let standard = folder(&root.join("standard")).into_iter().flat_map(|package| {
            let name = package.file_name().expect("a name").to_string_lossy().into_owned();
            folder(&package).into_iter().map(move |path| (name.clone(), path))
        });
        for (package, path) in own.chain(standard) {
            let name = path.file_stem().expect("a name").to_string_lossy();
            assert!(listed(&package, &name), "{package}/{name}");
        }
    }
}
