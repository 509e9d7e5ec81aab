//! The files of this crate.

use super::library::Library;
use crate::message::part;

/// Package, name and text of a file.
type File = (&'static str, &'static str, &'static str);

/// A file of the packages of ROS.
macro_rules! standard {
    ($package:literal, $name:literal, $kind:literal) => {
        (
            $package,
            $name,
            include_str!(concat!("../../standard/", $package, "/", $name, ".", $kind)),
        )
    };
}

/// A file of this laboratory's own package.
macro_rules! own {
    ($name:literal, $kind:literal) => {
        (
            "friction_msgs",
            $name,
            include_str!(concat!("../../friction_msgs/", $kind, "/", $name, ".", $kind)),
        )
    };
}

const MESSAGES: [File; 46] = [
    own!("ControllerState", "msg"),
    own!("EstimatedParameter", "msg"),
    own!("ExperimentDescription", "msg"),
    own!("ExperimentParameter", "msg"),
    own!("ExperimentStatus", "msg"),
    own!("Figure", "msg"),
    own!("FrictionEstimate", "msg"),
    own!("ModelFit", "msg"),
    own!("MotorVoltage", "msg"),
    own!("Reference", "msg"),
    own!("RigMeasurement", "msg"),
    own!("Setting", "msg"),
    standard!("action_msgs", "GoalInfo", "msg"),
    standard!("action_msgs", "GoalStatus", "msg"),
    standard!("action_msgs", "GoalStatusArray", "msg"),
    standard!("builtin_interfaces", "Time", "msg"),
    standard!("diagnostic_msgs", "DiagnosticArray", "msg"),
    standard!("diagnostic_msgs", "DiagnosticStatus", "msg"),
    standard!("diagnostic_msgs", "KeyValue", "msg"),
    standard!("lifecycle_msgs", "State", "msg"),
    standard!("lifecycle_msgs", "Transition", "msg"),
    standard!("lifecycle_msgs", "TransitionDescription", "msg"),
    standard!("lifecycle_msgs", "TransitionEvent", "msg"),
    standard!("rcl_interfaces", "FloatingPointRange", "msg"),
    standard!("rcl_interfaces", "IntegerRange", "msg"),
    standard!("rcl_interfaces", "ListParametersResult", "msg"),
    standard!("rcl_interfaces", "Log", "msg"),
    standard!("rcl_interfaces", "Parameter", "msg"),
    standard!("rcl_interfaces", "ParameterDescriptor", "msg"),
    standard!("rcl_interfaces", "ParameterEvent", "msg"),
    standard!("rcl_interfaces", "ParameterValue", "msg"),
    standard!("rcl_interfaces", "SetParametersResult", "msg"),
    standard!("rmw_dds_common", "Gid", "msg"),
    standard!("rmw_dds_common", "NodeEntitiesInfo", "msg"),
    standard!("rmw_dds_common", "ParticipantEntitiesInfo", "msg"),
    standard!("rosgraph_msgs", "Clock", "msg"),
    standard!("sensor_msgs", "JointState", "msg"),
    standard!("service_msgs", "ServiceEventInfo", "msg"),
    standard!("std_msgs", "Header", "msg"),
    standard!("type_description_interfaces", "Field", "msg"),
    standard!("type_description_interfaces", "FieldType", "msg"),
    standard!("type_description_interfaces", "IndividualTypeDescription", "msg"),
    standard!("type_description_interfaces", "KeyValue", "msg"),
    standard!("type_description_interfaces", "TypeDescription", "msg"),
    standard!("type_description_interfaces", "TypeSource", "msg"),
    standard!("unique_identifier_msgs", "UUID", "msg"),
];

const SERVICES: [File; 16] = [
    own!("Identify", "srv"),
    own!("ListExperiments", "srv"),
    own!("StartExperiment", "srv"),
    standard!("action_msgs", "CancelGoal", "srv"),
    standard!("lifecycle_msgs", "ChangeState", "srv"),
    standard!("lifecycle_msgs", "GetAvailableStates", "srv"),
    standard!("lifecycle_msgs", "GetAvailableTransitions", "srv"),
    standard!("lifecycle_msgs", "GetState", "srv"),
    standard!("rcl_interfaces", "DescribeParameters", "srv"),
    standard!("rcl_interfaces", "GetParameterTypes", "srv"),
    standard!("rcl_interfaces", "GetParameters", "srv"),
    standard!("rcl_interfaces", "ListParameters", "srv"),
    standard!("rcl_interfaces", "SetParameters", "srv"),
    standard!("rcl_interfaces", "SetParametersAtomically", "srv"),
    standard!("std_srvs", "Trigger", "srv"),
    standard!("type_description_interfaces", "GetTypeDescription", "srv"),
];

const ACTIONS: [File; 1] = [own!("RunExperiment", "action")];

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
