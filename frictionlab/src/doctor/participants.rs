//! Which other nodes are there, and how the laboratory's are.

use std::collections::BTreeMap;

use msgs::diagnostic_msgs::DiagnosticStatus;

use super::Finding;
use super::heard::{Heard, is_ours};

/// Findings about the graph of a domain.
pub(super) fn check(heard: &Heard) -> Vec<Finding> {
    let mut counted: BTreeMap<&str, u32> = BTreeMap::new();
    for node in &heard.nodes {
        *counted.entry(&node.name).or_default() += 1;
    }
    let mut processes: Vec<_> = heard.nodes.iter().map(|node| node.participant).collect();
    processes.sort_unstable();
    processes.dedup();
    let found = if counted.is_empty() {
        "no other node is on this domain".to_owned()
    } else {
        counted.keys().copied().collect::<Vec<_>>().join(", ")
    };
    let mut findings =
        vec![Finding::fine("other nodes", found).with("nodes", heard.nodes.len() as f64, "").with(
            "participants with nodes",
            processes.len() as f64,
            "",
        )];
    for (name, times) in counted.iter().filter(|(_, times)| **times > 1) {
        findings.push(twice(name, *times));
    }
    findings.extend(counted.keys().filter(|name| is_ours(name)).map(|name| state(name, heard)));
    findings
}

fn twice(name: &str, times: u32) -> Finding {
    let found = format!("{times} nodes have this name");
    let mend = format!(
        "end all but one of them (`pgrep -af {}`), or put each axis into a namespace: `frictionlab launch namespace:=axis_1`",
        name.rsplit('/').next().unwrap_or(name)
    );
    let finding = if is_ours(name) {
        Finding::broken(name, format!("{found}: two would drive one axis"), mend)
    } else {
        Finding::look(name, format!("{found}: services and parameters go to either"), mend)
    };
    finding.with("nodes of this name", f64::from(times), "")
}

/// What a node of the laboratory says of itself.
fn state(name: &str, heard: &Heard) -> Finding {
    let Some(status) = heard.said_by(name) else {
        return match heard.states.get(name) {
            Some(state) => Finding::fine(name, format!("lifecycle state {state}")),
            None => Finding::look(
                name,
                "it says nothing on /diagnostics and does not answer get_state: it hangs, has just ended, or is no managed node",
                "look at its log; end its program if it hangs",
            ),
        };
    };
    let label = value(status, "node");
    let lifecycle =
        label.map_or_else(|| "runs".to_owned(), |state| format!("lifecycle state {state}"));
    let found = format!("{lifecycle}; it says: {}", status.message);
    match status.level {
        DiagnosticStatus::OK => Finding::fine(name, found),
        DiagnosticStatus::WARN => Finding::look(
            name,
            found,
            format!("`ros2 topic echo /diagnostics` and the log of {name} say more"),
        ),
        _ => Finding::look(
            name,
            found,
            format!(
                "mend what it names, then call {name}/clear_fault or {name}/reset, and activate the node; docs/reference/faults.md has every fault"
            ),
        ),
    }
}

/// A value of a report.
pub(super) fn value<'a>(status: &'a DiagnosticStatus, key: &str) -> Option<&'a str> {
    status.values.iter().find(|entry| entry.key == key).map(|entry| entry.value.as_str())
}

#[cfg(test)]
mod tests {
    use msgs::diagnostic_msgs::KeyValue;
    use ros_node::SeenNode;

    use super::*;
    use crate::doctor::Verdict;

    fn seen(names: &[&str]) -> Vec<SeenNode> {
        (1..)
            .zip(names)
            .map(|(number, name)| SeenNode { name: (*name).into(), participant: [number; 16] })
            .collect()
    }

    #[test]
    fn two_nodes_of_one_name_are_found_and_two_of_ours_are_broken() {
        let heard = Heard {
            nodes: seen(&["/a", "/a", "/axis_1/controller", "/axis_2/controller"]),
            ..Heard::default()
        };
        let states =
            ["/axis_1/controller", "/axis_2/controller"].map(|name| (name.to_owned(), "active"));
        let heard = Heard { states: states.into(), ..heard };
        let findings = check(&heard);
        assert_eq!(findings[0].figures[0].value, 4.0);
        let of = |name: &str| findings.iter().find(|f| f.subject == name).map(|f| f.verdict);
        assert_eq!(of("/a"), Some(Verdict::LookAtThis));
        assert_eq!(of("/axis_1/controller"), Some(Verdict::Fine), "{findings:?}");
        let heard = Heard { nodes: seen(&["/controller", "/controller"]), ..Heard::default() };
        assert!(check(&heard).iter().any(|finding| finding.verdict == Verdict::Broken));
    }

    #[test]
    fn the_lifecycle_state_of_a_node_comes_from_its_own_report() {
        let status = |name: &str, level| DiagnosticStatus {
            level,
            name: name.into(),
            message: "emergency stop".into(),
            hardware_id: String::new(),
            values: vec![KeyValue { key: "node".into(), value: "inactive".into() }],
        };
        let mut heard =
            Heard { nodes: seen(&["/axis_1/rig_driver", "/rig_driver"]), ..Heard::default() };
        for name in ["axis_1/rig_driver: control loop", "rig_driver: control loop"] {
            let level = if name.starts_with("axis") {
                DiagnosticStatus::ERROR
            } else {
                DiagnosticStatus::OK
            };
            heard.health.insert(name.into(), vec![status(name, level)]);
        }
        let findings = check(&heard);
        let of = |name: &str| findings.iter().find(|f| f.subject == name).expect("a finding");
        assert_eq!(of("/axis_1/rig_driver").verdict, Verdict::LookAtThis);
        assert_eq!(of("/rig_driver").verdict, Verdict::Fine);
        assert!(of("/rig_driver").found.contains("inactive"));
    }
}
