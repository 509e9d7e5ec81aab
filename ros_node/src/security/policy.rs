//! Who may do what in the laboratory's graph, as a policy of SROS 2, made from the table of
//! interfaces.
//!
//! Enclaves: one for each node, `/live` for all of them in one process, `/operator` who leads them,
//! and `/viewer` who looks and may stop.

use std::fmt::Write as _;

use msgs::interfaces::{self, ACTIONS, EVERY_NODE, NODES, SERVICES};

/// Services that change nothing.
const LOOKS: [&str; 8] = [
    "get_state",
    "get_available_states",
    "get_available_transitions",
    "get_transition_graph",
    "list_parameters",
    "get_parameters",
    "get_parameter_types",
    "describe_parameters",
];
/// Whoever is in the domain may stop the motor.
const STOP: &str = "rig_driver/emergency_stop";
/// Two topics that every node writes.
const SAID_BY_ALL: [&str; 2] = ["/rosout", "/parameter_events"];

/// What one node does, by SROS 2's words; names are relative to the namespace unless they begin
/// with a slash.
#[derive(Default)]
struct Profile {
    node: &'static str,
    publish: Vec<String>,
    subscribe: Vec<String>,
    reply: Vec<String>,
    request: Vec<String>,
    execute: Vec<String>,
    call: Vec<String>,
}

/// The policy for the laboratory's nodes in a namespace, as in `/` or `/axis_1`.
#[must_use]
pub fn policy(namespace: &str) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <!-- Who may do what in the laboratory's graph: made from the table of interfaces. -->\n\
         <policy version=\"0.2.0\">\n  <enclaves>\n",
    );
    let live: Vec<Profile> = NODES.iter().map(|node| of_node(node)).collect();
    for node in NODES {
        enclave(&mut text, node, namespace, &[of_node(node)]);
    }
    enclave(&mut text, "live", namespace, &live);
    enclave(&mut text, "operator", namespace, &[operator()]);
    enclave(&mut text, "viewer", namespace, &[viewer()]);
    text + "  </enclaves>\n</policy>\n"
}

fn relative(topic: &str) -> String {
    let stays = topic == msgs::topics::DIAGNOSTICS.name;
    if stays { topic.to_owned() } else { topic.trim_start_matches('/').to_owned() }
}

fn topics_where(keep: impl Fn(&interfaces::TopicInterface) -> bool) -> Vec<String> {
    interfaces::topics()
        .iter()
        .filter(|topic| keep(topic))
        .map(|topic| relative(topic.name))
        .collect()
}

fn of_node(node: &'static str) -> Profile {
    let own = SERVICES.iter().filter(|of| of.node == node).map(|of| of.name);
    let every = EVERY_NODE.iter().map(|(name, ..)| *name);
    let mut profile = Profile {
        node,
        publish: topics_where(|topic| topic.publishers.contains(&node)),
        subscribe: topics_where(|topic| topic.subscribers.contains(&node)),
        reply: own.chain(every).map(|name| format!("~/{name}")).collect(),
        execute: ACTIONS
            .iter()
            .filter(|of| of.node == node)
            .map(|of| format!("~/{}", of.name))
            .collect(),
        ..Profile::default()
    };
    if node == "experiment_runner" {
        // It leads the others through experiments: it answers measurements with references, or with
        // voltages, and changes states and parameters.
        profile.publish.extend(["reference".to_owned(), "motor_voltage".to_owned()]);
        profile.subscribe = topics_where(|_| true);
        profile.subscribe.push("rig_driver/transition_event".to_owned());
        profile.request = services_of(|of| of != node, |_| true);
    }
    profile.publish.push("~/transition_event".to_owned());
    profile.publish.extend(SAID_BY_ALL.map(str::to_owned));
    profile.subscribe.extend(["/parameter_events".to_owned(), "/clock".to_owned()]);
    profile
}

/// Requests to the nodes that `node` names, of the services that `service` names.
fn services_of(node: impl Fn(&str) -> bool, service: impl Fn(&str) -> bool) -> Vec<String> {
    let own = SERVICES.iter().map(|of| (of.node, of.name));
    let every =
        NODES.iter().flat_map(|node| EVERY_NODE.iter().map(move |(name, ..)| (*node, *name)));
    own.chain(every)
        .filter(|(of, name)| node(of) && service(name))
        .map(|(of, name)| format!("{of}/{name}"))
        .collect()
}

fn looker(node: &'static str) -> Profile {
    let mut subscribe = topics_where(|_| true);
    subscribe.extend(["/rosout", "/parameter_events", "/clock"].map(str::to_owned));
    subscribe.extend(NODES.map(|node| format!("{node}/transition_event")));
    for action in ACTIONS {
        for what in ["feedback", "status"] {
            subscribe.push(format!("{}/{}/_action/{what}", action.node, action.name));
        }
    }
    Profile {
        node,
        publish: SAID_BY_ALL.map(str::to_owned).to_vec(),
        subscribe,
        // Nodes of other makers answer for their own parameters and types.
        reply: EVERY_NODE
            .iter()
            .filter(|(name, ..)| name.contains("parameter") || *name == "get_type_description")
            .map(|(name, ..)| format!("~/{name}"))
            .collect(),
        ..Profile::default()
    }
}

/// Leads the nodes and sets where the axis should be; the voltage stays the controller's.
fn operator() -> Profile {
    let mut profile = looker("operator");
    profile.publish.push("reference".to_owned());
    profile.request = services_of(|_| true, |_| true);
    profile.call = ACTIONS.iter().map(|of| format!("{}/{}", of.node, of.name)).collect();
    profile
}

fn viewer() -> Profile {
    let mut profile = looker("viewer");
    profile.request =
        services_of(|_| true, |name| LOOKS.contains(&name) || name == "list_experiments");
    profile.request.push(STOP.to_owned());
    profile
}

fn enclave(text: &mut String, name: &str, namespace: &str, profiles: &[Profile]) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "    <enclave path=\"/{name}\">\n      <profiles>");
    for profile in profiles {
        let _ = writeln!(text, "        <profile ns=\"{namespace}\" node=\"{}\">", profile.node);
        for (list, item, what, names) in [
            ("topics", "topic", "publish", &profile.publish),
            ("topics", "topic", "subscribe", &profile.subscribe),
            ("services", "service", "reply", &profile.reply),
            ("services", "service", "request", &profile.request),
            ("actions", "action", "execute", &profile.execute),
            ("actions", "action", "call", &profile.call),
        ] {
            if names.is_empty() {
                continue;
            }
            let _ = writeln!(text, "          <{list} {what}=\"ALLOW\">");
            for name in names {
                let _ = writeln!(text, "            <{item}>{name}</{item}>");
            }
            let _ = writeln!(text, "          </{list}>");
        }
        text.push_str("        </profile>\n");
    }
    text.push_str("      </profiles>\n    </enclave>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The repository shows the policy as a file, for `ros2 security` and for reading;
    /// `UPDATE_DOCS=1` writes it anew.
    #[test]
    fn the_file_shows_this_policy() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("policy.xml");
        if std::env::var_os("UPDATE_DOCS").is_some() {
            std::fs::write(&path, policy("/")).expect("the policy can be written");
        }
        let shown = std::fs::read_to_string(&path).expect("the policy is part of the project");
        assert_eq!(shown, policy("/"), "run the test with UPDATE_DOCS=1");
    }

    fn of(enclave: &str) -> String {
        let text = policy("/");
        let from = text.find(&format!("<enclave path=\"/{enclave}\">")).expect("it is there");
        text[from..].split("</enclave>").next().unwrap_or_default().to_owned()
    }

    fn allowed(enclave: &str, what: &str) -> Vec<String> {
        let (text, begin) = (of(enclave), format!(" {what}=\"ALLOW\">"));
        let mut names = Vec::new();
        let mut inside = false;
        for line in text.lines().map(str::trim) {
            if line.ends_with(&begin) {
                inside = true;
            } else if line.starts_with("</") {
                inside = false;
            } else if inside {
                names.extend(line.split(['<', '>']).nth(2).map(str::to_owned));
            }
        }
        names
    }

    /// The sentence of the issue, as a table: who moves the motor, and everybody who may stop it.
    #[test]
    fn only_controller_and_runner_command_and_everybody_who_asks_may_stop() {
        let publishes =
            |enclave: &str, topic: &str| allowed(enclave, "publish").iter().any(|of| of == topic);
        let requests = |enclave: &str, of: &str| {
            allowed(enclave, "request").iter().any(|service| service == of)
        };
        for enclave in ["rig_driver", "friction_observer", "operator", "viewer"] {
            assert!(!publishes(enclave, "motor_voltage"), "{enclave}");
        }
        for enclave in ["controller", "experiment_runner", "live"] {
            assert!(publishes(enclave, "motor_voltage"), "{enclave}");
        }
        for enclave in ["experiment_runner", "operator", "viewer"] {
            assert!(requests(enclave, STOP), "{enclave}");
        }
        for changing in [
            "rig_driver/clear_fault",
            "rig_driver/change_state",
            "controller/set_parameters",
            "experiment_runner/abort",
        ] {
            assert!(requests("operator", changing), "{changing}");
            assert!(!requests("viewer", changing), "{changing}");
        }
        assert!(!publishes("viewer", "reference") && publishes("operator", "reference"));
        assert_eq!(allowed("operator", "call"), ["experiment_runner/run_experiment"]);
        assert!(allowed("viewer", "call").is_empty());
        assert!(allowed("viewer", "subscribe").iter().any(|topic| topic == "joint_states"));
    }

    #[test]
    fn a_namespace_is_that_of_every_profile() {
        let text = policy("/axis_1");
        assert!(text.contains("ns=\"/axis_1\"") && !text.contains("ns=\"/\""));
    }
}
