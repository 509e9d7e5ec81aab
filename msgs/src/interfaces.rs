//! What the laboratory's nodes offer: topics, services and actions with types, quality of service
//! and direction, once for the documentation and for the tests that hold it against running nodes.

use std::fmt::Write as _;

use crate::{
    RosMessage,
    topics::{self, Qos, Topic},
};

/// Names of the nodes.
pub const NODES: [&str; 4] = ["rig_driver", "friction_observer", "controller", "experiment_runner"];

/// A topic, and who has to do with it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TopicInterface {
    /// Absolute name.
    pub name: &'static str,
    /// Type, as in `sensor_msgs/msg/JointState`.
    pub kind: String,
    /// Quality of service it is offered with.
    pub qos: Qos,
    /// Nodes that publish it.
    pub publishers: &'static [&'static str],
    /// Nodes that listen to it.
    pub subscribers: &'static [&'static str],
    /// What it carries, with units.
    pub content: &'static str,
}

/// A service or an action of one node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Served {
    /// The node.
    pub node: &'static str,
    /// Name behind the node's.
    pub name: &'static str,
    /// Type, as in `std_srvs/srv/Trigger`.
    pub kind: &'static str,
    /// What it does.
    pub what: &'static str,
}

fn topic<M: RosMessage>(
    topic: &Topic<M>,
    publishers: &'static [&'static str],
    subscribers: &'static [&'static str],
    content: &'static str,
) -> TopicInterface {
    TopicInterface {
        name: topic.name,
        kind: M::type_name(),
        qos: topic.qos,
        publishers,
        subscribers,
        content,
    }
}

/// The laboratory's topics. Those of every node, such as `/rosout`, are not among them.
#[must_use]
pub fn topics() -> Vec<TopicInterface> {
    vec![
        topic(
            &topics::JOINT_STATES,
            &["rig_driver"],
            &["friction_observer", "controller"],
            "joint `load_shaft`: position [rad], velocity [rad/s], effort: friction torque [N m]",
        ),
        topic(
            &topics::RIG_MEASUREMENT,
            &["rig_driver"],
            &[],
            "every channel: counts, position [rad], velocity [rad/s], torque [N m], voltage [V], flags",
        ),
        topic(
            &topics::REFERENCE,
            &[],
            &["friction_observer", "controller"],
            "from people or a runner: position [rad], velocity [rad/s], acceleration [rad/s^2]",
        ),
        topic(
            &topics::MOTOR_VOLTAGE,
            &["controller"],
            &["rig_driver", "friction_observer"],
            "voltage of the motor [V], with the stamp of the measurement it answers to",
        ),
        topic(
            &topics::FRICTION_ESTIMATE,
            &["friction_observer"],
            &["controller"],
            "model, friction torque [N m], its states, velocity believed [rad/s], residual [N m]",
        ),
        topic(
            &topics::CONTROLLER_STATE,
            &["controller"],
            &[],
            "reference, feedback, error [rad/s or rad, by mode], parts of the command [V]",
        ),
        topic(
            &topics::EXPERIMENT_STATUS,
            &["experiment_runner"],
            &[],
            "experiment, stage, progress 0 to 1, seconds left [s], bag, message",
        ),
        topic(
            &topics::DIAGNOSTICS,
            &["rig_driver", "friction_observer", "controller"],
            &[],
            "once a second: lifecycle state, period and command age [us], losses, faults",
        ),
    ]
}

const TRIGGER: &str = "std_srvs/srv/Trigger";

/// Services that a node has for itself.
pub const SERVICES: [Served; 9] = [
    Served {
        node: "rig_driver",
        name: "emergency_stop",
        kind: TRIGGER,
        what: "zero volts within a cycle, in any state, until cleared; no emergency stop in the sense of ISO 13850 and IEC 60204-1, which needs hardware",
    },
    Served {
        node: "rig_driver",
        name: "clear_fault",
        kind: TRIGGER,
        what: "a fault: back to inactive; an emergency stop: back to unconfigured",
    },
    Served {
        node: "rig_driver",
        name: "zero_sensors",
        kind: TRIGGER,
        what: "in inactive: the mean of 200 cycles counts as zero from then on",
    },
    Served {
        node: "friction_observer",
        name: "reset",
        kind: TRIGGER,
        what: "the estimator at rest",
    },
    Served {
        node: "controller",
        name: "reset",
        kind: TRIGGER,
        what: "the controller at rest, its fault cleared",
    },
    Served {
        node: "experiment_runner",
        name: "start_experiment",
        kind: "friction_msgs/srv/StartExperiment",
        what: "begins an experiment and returns at once, with its name and folder",
    },
    Served {
        node: "experiment_runner",
        name: "list_experiments",
        kind: "friction_msgs/srv/ListExperiments",
        what: "every experiment with what it does, its options and its length [s]",
    },
    Served {
        node: "experiment_runner",
        name: "identify",
        kind: "friction_msgs/srv/Identify",
        what: "identifies models from a bag: parameters, standard errors, errors on other bags, the file written",
    },
    Served {
        node: "experiment_runner",
        name: "abort",
        kind: TRIGGER,
        what: "ends the running experiment; its bag is kept",
    },
];

/// Services that every node has, behind its name.
pub const EVERY_NODE: [(&str, &str, &str); 12] = [
    (
        "change_state",
        "lifecycle_msgs/srv/ChangeState",
        "configure, activate, deactivate, clean up, shut down",
    ),
    ("get_state", "lifecycle_msgs/srv/GetState", "unconfigured, inactive, active or finalized"),
    ("get_available_states", "lifecycle_msgs/srv/GetAvailableStates", "all states"),
    ("get_available_transitions", "lifecycle_msgs/srv/GetAvailableTransitions", "those from here"),
    ("get_transition_graph", "lifecycle_msgs/srv/GetAvailableTransitions", "all of them"),
    ("list_parameters", "rcl_interfaces/srv/ListParameters", "names"),
    ("get_parameters", "rcl_interfaces/srv/GetParameters", "values"),
    ("get_parameter_types", "rcl_interfaces/srv/GetParameterTypes", "types"),
    (
        "describe_parameters",
        "rcl_interfaces/srv/DescribeParameters",
        "descriptions with units, ranges",
    ),
    (
        "set_parameters",
        "rcl_interfaces/srv/SetParameters",
        "one by one, each refusal with a reason",
    ),
    (
        "set_parameters_atomically",
        "rcl_interfaces/srv/SetParametersAtomically",
        "all or none, for values that only fit together",
    ),
    (
        "get_type_description",
        "type_description_interfaces/srv/GetTypeDescription",
        "fields, hash and source of a type that the node uses, by its hash",
    ),
];

/// Actions.
pub const ACTIONS: [Served; 1] = [Served {
    node: "experiment_runner",
    name: "run_experiment",
    kind: "friction_msgs/action/RunExperiment",
    what: "goal: experiment, models, repetitions, options, folder; feedback: stage, progress 0 to 1, seconds left [s]; result: outcome, message, bag, \
           parameters, figures; cancelling stops the rig and keeps the bag",
}];

fn qos_text(qos: Qos) -> String {
    let local = if qos.transient_local { ", transient local" } else { "" };
    format!("reliable, last {}{local}", qos.depth)
}

/// The topics as Markdown.
#[must_use]
pub fn topic_table() -> String {
    let names = |nodes: &[&str], nobody: &str| {
        if nodes.is_empty() { nobody.to_owned() } else { nodes.join(", ") }
    };
    let mut text = String::from(
        "| topic | type | quality of service | from | to | content |\n|---|---|---|---|---|---|\n",
    );
    for topic in topics() {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| `{}` | `{}` | {} | {} | {} | {} |",
            topic.name,
            topic.kind,
            qos_text(topic.qos),
            names(topic.publishers, "people, runner"),
            names(topic.subscribers, "people, recorders"),
            topic.content
        );
    }
    text
}

/// The services as Markdown.
#[must_use]
pub fn service_table() -> String {
    let mut text = String::from("| service | type | what |\n|---|---|---|\n");
    let own = SERVICES.iter().map(|of| (format!("/{}/{}", of.node, of.name), of.kind, of.what));
    let every = EVERY_NODE.iter().map(|(name, kind, what)| (format!("NODE/{name}"), *kind, *what));
    for (name, kind, what) in own.chain(every) {
        let _ = writeln!(text, "| `{name}` | `{kind}` | {what} |");
    }
    text
}

/// The actions as Markdown.
#[must_use]
pub fn action_table() -> String {
    ACTIONS.iter().fold(String::from("| action | type | what |\n|---|---|---|\n"), |text, of| {
        text + &format!("| `/{}/{}` | `{}` | {} |\n", of.node, of.name, of.kind, of.what)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RosAction, RosService, friction_msgs, std_srvs};

    #[test]
    fn types_are_those_of_the_code() {
        fn name<S: RosService>() -> String {
            format!("{}/srv/{}", S::PACKAGE, S::NAME)
        }
        let kind =
            |name: &str| SERVICES.iter().find(|of| of.name == name).expect("it is listed").kind;
        assert_eq!(kind("abort"), name::<std_srvs::Trigger>());
        assert_eq!(kind("identify"), name::<friction_msgs::Identify>());
        assert_eq!(kind("start_experiment"), name::<friction_msgs::StartExperiment>());
        assert_eq!(kind("list_experiments"), name::<friction_msgs::ListExperiments>());
        type Run = friction_msgs::RunExperiment;
        assert_eq!(ACTIONS[0].kind, format!("{}/action/{}", Run::PACKAGE, Run::NAME));
        for topic in topics() {
            assert_eq!(topic.qos, crate::topics::qos_of(topic.name), "{}", topic.name);
        }
    }
}
