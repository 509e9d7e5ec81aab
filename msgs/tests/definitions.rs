//! The `.msg`, `.srv` and `.action` files and the Rust structs say the same: fields, order, types,
//! constants, dependencies, hashes.

mod trace;

use std::{collections::BTreeSet, fs, path::Path};

use msgs::{
    Definition, RosAction, RosMessage, RosService,
    builtin_interfaces::Time,
    descriptions,
    diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
    friction_msgs::{
        ControllerState, EstimatedParameter, ExperimentDescription, ExperimentParameter,
        ExperimentStatus, Figure, FrictionEstimate, Identify, IdentifyRequest, IdentifyResponse,
        ListExperiments, ListExperimentsRequest, ListExperimentsResponse, ModelFit, MotorVoltage,
        Reference, RigMeasurement, RunExperiment, RunExperimentFeedback, RunExperimentGoal,
        RunExperimentResult, Setting, StartExperiment, StartExperimentRequest,
        StartExperimentResponse,
    },
    lifecycle_msgs::{
        ChangeStateRequest, ChangeStateResponse, GetAvailableStatesRequest,
        GetAvailableStatesResponse, GetAvailableTransitionsRequest,
        GetAvailableTransitionsResponse, GetStateRequest, GetStateResponse, State, Transition,
        TransitionDescription, TransitionEvent,
    },
    rcl_interfaces::Log,
    rosgraph_msgs::Clock,
    sensor_msgs::JointState,
    std_msgs::Header,
    std_srvs::{Trigger, TriggerRequest, TriggerResponse},
    type_description_interfaces::{self, GetTypeDescription},
};
use trace::Leaf;

/// Calls a generic function for each message type.
macro_rules! for_each_message {
    ($check:ident) => {
        $check::<Time>();
        $check::<Header>();
        $check::<JointState>();
        $check::<KeyValue>();
        $check::<DiagnosticStatus>();
        $check::<DiagnosticArray>();
        $check::<Log>();
        $check::<Clock>();
        $check::<State>();
        $check::<Transition>();
        $check::<TransitionDescription>();
        $check::<TransitionEvent>();
        $check::<ChangeStateRequest>();
        $check::<ChangeStateResponse>();
        $check::<GetStateRequest>();
        $check::<GetStateResponse>();
        $check::<GetAvailableStatesRequest>();
        $check::<GetAvailableStatesResponse>();
        $check::<GetAvailableTransitionsRequest>();
        $check::<GetAvailableTransitionsResponse>();
        $check::<RigMeasurement>();
        $check::<Reference>();
        $check::<MotorVoltage>();
        $check::<FrictionEstimate>();
        $check::<ControllerState>();
        $check::<ExperimentStatus>();
        $check::<EstimatedParameter>();
        $check::<Figure>();
        $check::<ModelFit>();
        $check::<Setting>();
        $check::<ExperimentParameter>();
        $check::<ExperimentDescription>();
        $check::<RunExperimentGoal>();
        $check::<RunExperimentResult>();
        $check::<RunExperimentFeedback>();
        $check::<StartExperimentRequest>();
        $check::<StartExperimentResponse>();
        $check::<ListExperimentsRequest>();
        $check::<ListExperimentsResponse>();
        $check::<IdentifyRequest>();
        $check::<IdentifyResponse>();
        $check::<TriggerRequest>();
        $check::<TriggerResponse>();
        $check::<type_description_interfaces::FieldType>();
        $check::<type_description_interfaces::Field>();
        $check::<type_description_interfaces::IndividualTypeDescription>();
        $check::<type_description_interfaces::TypeDescription>();
        $check::<type_description_interfaces::TypeSource>();
        $check::<type_description_interfaces::KeyValue>();
        $check::<type_description_interfaces::GetTypeDescriptionRequest>();
        $check::<type_description_interfaces::GetTypeDescriptionResponse>();
    };
}

/// A line of a `.msg` file that declares a field.
struct Field<'a> {
    name: &'a str,
    base: &'a str,
    sequence: bool,
}

fn statements(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .map(|line| line.split('#').next().unwrap_or_default().trim())
        .filter(|line| !line.is_empty())
}

/// The fields; a definition without any has the one that ROS gives it.
fn fields(text: &str) -> Vec<Field<'_>> {
    let mut fields: Vec<_> = statements(text)
        .filter(|line| !line.replace("<=", "").contains('='))
        .map(|line| {
            let mut words = line.split_whitespace();
            let [kind, name] = [(); 2].map(|()| words.next().expect("a type and a name"));
            let base = kind.strip_suffix("[]").unwrap_or(kind);
            // A bound changes nothing on the wire.
            let plain = base.split("<=").next().unwrap_or(base);
            Field { name, base: plain, sequence: base.len() != kind.len() }
        })
        .collect();
    if fields.is_empty() {
        fields.push(Field {
            name: "structure_needs_at_least_one_member",
            base: "uint8",
            sequence: false,
        });
    }
    fields
}

fn constants(text: &str) -> Vec<(String, String)> {
    statements(text)
        .filter_map(|line| line.split_once('='))
        .map(|(left, value)| {
            (
                left.split_whitespace().last().expect("a constant has a name").to_owned(),
                value.trim().to_owned(),
            )
        })
        .collect()
}

/// The definition a nested type refers to.
fn definition<M: RosMessage>(reference: &str) -> Definition {
    *M::DEPENDENCIES
        .iter()
        .find(|definition| format!("{}/{}", definition.package, definition.name) == reference)
        .unwrap_or_else(|| {
            panic!("{} contains {reference}, which is not among its dependencies", M::type_name())
        })
}

fn expected_leaves<M: RosMessage>(
    text: &str,
    path: &str,
    in_sequence: bool,
    leaves: &mut Vec<Leaf>,
) {
    for field in fields(text) {
        let path =
            if path.is_empty() { field.name.to_owned() } else { format!("{path}.{}", field.name) };
        let sequence = in_sequence || field.sequence;
        if field.base.contains('/') {
            expected_leaves::<M>(definition::<M>(field.base).text, &path, sequence, leaves);
        } else {
            let base = if field.base == "byte" { "uint8" } else { field.base };
            leaves.push(Leaf { path, kind: format!("{base}{}", if sequence { "[]" } else { "" }) });
        }
    }
}

#[test]
fn structs_have_the_fields_of_their_definitions_in_order() {
    fn check<M: RosMessage>() {
        let mut expected = Vec::new();
        expected_leaves::<M>(M::DEFINITION.text, "", false, &mut expected);
        assert_eq!(trace::leaves::<M>(), expected, "{}", M::type_name());
    }
    for_each_message!(check);
}

#[test]
fn constants_are_those_of_the_definitions() {
    fn check<M: RosMessage>(expected: &[(&str, u8)]) {
        let expected: Vec<_> =
            expected.iter().map(|(name, value)| ((*name).to_owned(), value.to_string())).collect();
        assert_eq!(constants(M::DEFINITION.text), expected, "{}", M::type_name());
    }
    check::<FrictionEstimate>(&[
        ("STICK", FrictionEstimate::STICK),
        ("SLIP", FrictionEstimate::SLIP),
    ]);
    check::<ControllerState>(&[
        ("VELOCITY", ControllerState::VELOCITY),
        ("POSITION", ControllerState::POSITION),
    ]);
    check::<RunExperimentResult>(&[
        ("SUCCEEDED", RunExperimentResult::SUCCEEDED),
        ("CANCELED", RunExperimentResult::CANCELED),
        ("BUSY", RunExperimentResult::BUSY),
        ("BAD_REQUEST", RunExperimentResult::BAD_REQUEST),
        ("FAILED", RunExperimentResult::FAILED),
    ]);
    check::<DiagnosticStatus>(&[
        ("OK", DiagnosticStatus::OK),
        ("WARN", DiagnosticStatus::WARN),
        ("ERROR", DiagnosticStatus::ERROR),
        ("STALE", DiagnosticStatus::STALE),
    ]);
}

/// Collects the names of every type below `text`.
fn collect<M: RosMessage>(text: &str, found: &mut BTreeSet<String>) {
    for field in fields(text).iter().filter(|field| field.base.contains('/')) {
        if found.insert(field.base.to_owned()) {
            collect::<M>(definition::<M>(field.base).text, found);
        }
    }
}

#[test]
fn dependencies_are_complete_and_each_once() {
    fn check<M: RosMessage>() {
        let mut needed = BTreeSet::new();
        collect::<M>(M::DEFINITION.text, &mut needed);
        let mut named: Vec<_> =
            M::DEPENDENCIES.iter().map(|d| format!("{}/{}", d.package, d.name)).collect();
        named.sort();
        assert_eq!(named, needed.into_iter().collect::<Vec<_>>(), "{}", M::type_name());
    }
    for_each_message!(check);
}

#[test]
fn hashes_are_those_of_the_definitions() {
    fn check<M: RosMessage>() {
        let name = M::type_name();
        assert_eq!(M::TYPE_HASH, descriptions::all()[&name].hash, "{name}");
        let described = descriptions::message::<M>().expect("it is read");
        assert_eq!(described, descriptions::all()[&name]);
    }
    for_each_message!(check);
}

#[test]
fn every_definition_of_the_package_is_built_and_known_in_rust() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("friction_msgs");
    let cmake = fs::read_to_string(package.join("CMakeLists.txt"))
        .expect("the package has a CMakeLists.txt");
    let known = [
        ControllerState::DEFINITION.name,
        EstimatedParameter::DEFINITION.name,
        ExperimentDescription::DEFINITION.name,
        ExperimentParameter::DEFINITION.name,
        ExperimentStatus::DEFINITION.name,
        Figure::DEFINITION.name,
        FrictionEstimate::DEFINITION.name,
        ModelFit::DEFINITION.name,
        MotorVoltage::DEFINITION.name,
        Reference::DEFINITION.name,
        RigMeasurement::DEFINITION.name,
        Setting::DEFINITION.name,
    ];
    let services = [Identify::NAME, ListExperiments::NAME, StartExperiment::NAME];
    for (folder, known) in
        [("msg", &known[..]), ("srv", &services), ("action", &[RunExperiment::NAME])]
    {
        let mut files: Vec<String> = fs::read_dir(package.join(folder))
            .expect("the package has the folder")
            .map(|entry| {
                entry
                    .expect("the folder can be read")
                    .file_name()
                    .into_string()
                    .expect("plain names")
            })
            .collect();
        files.sort();
        let expected: Vec<String> = known.iter().map(|name| format!("{name}.{folder}")).collect();
        assert_eq!(files, expected);
        for file in files {
            assert!(
                cmake.contains(&format!("\"{folder}/{file}\"")),
                "CMakeLists.txt does not build {file}"
            );
        }
    }
}

#[test]
fn the_parts_of_services_and_actions_are_named_as_ros_names_them() {
    fn service<S: RosService>() {
        let name = |part| format!("{}/srv/{}_{part}", S::PACKAGE, S::NAME);
        assert_eq!(<S::Request as RosMessage>::type_name(), name("Request"));
        assert_eq!(<S::Response as RosMessage>::type_name(), name("Response"));
    }
    service::<StartExperiment>();
    service::<ListExperiments>();
    service::<Identify>();
    service::<Trigger>();
    service::<GetTypeDescription>();
    let name = |part| format!("{}/action/{}_{part}", RunExperiment::PACKAGE, RunExperiment::NAME);
    assert_eq!(<RunExperiment as RosAction>::Goal::type_name(), name("Goal"));
    assert_eq!(<RunExperiment as RosAction>::Result::type_name(), name("Result"));
    assert_eq!(<RunExperiment as RosAction>::Feedback::type_name(), name("Feedback"));
}
