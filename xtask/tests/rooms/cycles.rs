//! Rings of arrows.

use std::collections::BTreeSet;

use crate::arrows::Graph;

/// Groups of rooms that reach each other.
pub fn rings(graph: &Graph) -> Vec<Vec<String>> {
    let mut told = BTreeSet::new();
    let mut rings = Vec::new();
    for room in graph.keys().filter(|room| reach(graph, room).contains(*room)) {
        if told.contains(room) {
            continue;
        }
        let far = reach(graph, room);
        let ring: Vec<String> =
            far.into_iter().filter(|other| reach(graph, other).contains(room)).collect();
        told.extend(ring.iter().cloned());
        rings.push(ring);
    }
    rings
}

/// Every room that arrows lead to from one, over any number of steps.
fn reach(graph: &Graph, from: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut ahead = vec![from.to_owned()];
    while let Some(room) = ahead.pop() {
        for next in graph.get(&room).into_iter().flat_map(|arrows| arrows.keys()) {
            if found.insert(next.clone()) {
                ahead.push(next.clone());
            }
        }
    }
    found
}

/// The arrows of a ring, each with a file that draws it.
pub fn told(ring: &[String], graph: &Graph) -> String {
    let mut lines = vec![ring.join(" <-> ")];
    for room in ring {
        for (to, why) in graph.get(room).into_iter().flatten().filter(|(to, _)| ring.contains(to)) {
            lines.push(format!("  {room} -> {to}: {why}"));
        }
    }
    lines.join("\n")
}
