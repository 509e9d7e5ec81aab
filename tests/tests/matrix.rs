//! Which distribution of ROS 2, over which middleware, on which network: the page
//! `docs/reference/ros2-matrix.md`, made of what is seen.

use std::fmt::Write as _;

use serde_json::Value;
use tests::network::{ORDINARY_MTU, Place, report, session_at, turn};
use tests::python::{self, Distribution};

/// What is tried, as the page heads its columns.
const CALLS: [&str; 5] = ["topic", "service", "parameter", "lifecycle", "action"];

const NETWORKS: [(&str, Place); 2] = [
    ("one machine, loopback", Place::Loopback),
    ("two machines, MTU 1500", Place::TwoPcs(ORDINARY_MTU)),
];

const HEAD: &str = "\
# Distributions and middlewares

Made by the test `matrix` from what it saw; do not change it by hand. `UPDATE_DOCS=1 FRICTION_FULL=1
cargo test --workspace --test matrix` makes it anew.

The laboratory's nodes are called by what is named in the first two columns. A yes means: joint
states heard and a reference followed; a request answered; parameters listed, set, read back and
refused; the observer deactivated and activated; a goal accepted, with feedback and its result.

";

const FEET: &str = "
* **Lyrical**: its rclpy was not at hand. PyPI had no wheels of it on 26 November 2026
  (`ros-lyrical-rclpy`, `ros-lyrical-rmw-fastrtps-cpp`); those of Kilted are `ros-kilted-rclpy`
  9.1.2. `ros2-client` 0.12.1 has a feature `lyrical`, which changes only the name that it compares
  with `$ROS_DISTRO` (`src/distributions.rs`): over DDS it sends what it sends for Kilted.
* **Cyclone DDS** is `cyclonedds` 11.0.1 of PyPI with what `rmw_cyclonedds` puts on it, the same for
  every distribution. `rmw_cyclonedds_cpp` itself was not at hand.
* **Zenoh**: the nodes speak DDS only. [What was tried, and what is in the
  way](../explanation/ros2.md#zenoh).
";

fn frictionlab() -> String {
    tests::frictionlab().get_program().to_str().expect("a path of text").to_owned()
}

/// What rclpy of a distribution sees, over its own middleware.
fn over_fast_dds(distribution: Distribution, place: Place) -> Value {
    session_at(place, distribution, "matrix_session.py", &[&frictionlab(), "fast_dds"])
}

/// What a participant of Cyclone DDS sees.
fn over_cyclone(place: Place) -> Value {
    let _turn = turn();
    let mut command = place.command();
    command.arg(python::cyclone()).arg(python::script("matrix_session.py"));
    command.arg(tests::node_programs()).arg(frictionlab()).arg("cyclone");
    command.env("ROS_DOMAIN_ID", "74");
    let card = if place == Place::Loopback { "lo" } else { "wire" };
    let uri = format!(
        "<General><Interfaces><NetworkInterface name=\"{card}\" multicast=\"true\"/></Interfaces></General>"
    );
    command.env("CYCLONEDDS_URI", uri);
    report(command).0
}

/// A row of the page.
fn row(page: &mut String, head: [&str; 3], seen: Result<&Value, &str>) {
    let cell = |call: &str| match seen {
        Ok(seen) => match &seen[call] {
            Value::Bool(true) => "yes".to_owned(),
            Value::String(why) => format!("no: {}", why.replace('|', "/")),
            other => format!("no: {other}"),
        },
        Err(why) => why.to_owned(),
    };
    let cells = CALLS.map(cell).join(" | ");
    writeln!(page, "| {} | {cells} |", head.join(" | ")).expect("text");
}

#[tests::needs(rclpy, jazzy, cyclone, namespace, machines, long_tier)]
#[test]
fn the_page_says_what_is_seen() {
    let mut page = HEAD.to_owned();
    writeln!(page, "| distribution | middleware | network | {} |", CALLS.join(" | "))
        .expect("text");
    writeln!(page, "|{}", "---|".repeat(3 + CALLS.len())).expect("text");
    let cyclone = NETWORKS.map(|(_, place)| over_cyclone(place));
    for distribution in ["Kilted", "Jazzy", "Lyrical"] {
        let known = match distribution {
            "Kilted" => Some(Distribution::Kilted),
            "Jazzy" => Some(Distribution::Jazzy),
            _ => None,
        };
        for (network, place) in NETWORKS {
            let seen = known.map(|known| over_fast_dds(known, place));
            let seen = seen.as_ref().ok_or("not tried");
            row(&mut page, [distribution, "Fast DDS", network], seen);
        }
        for ((network, _), seen) in NETWORKS.iter().zip(&cyclone) {
            row(
                &mut page,
                [distribution, "Cyclone DDS", network],
                known.map(|_| seen).ok_or("not tried"),
            );
        }
        for (network, _) in NETWORKS {
            row(&mut page, [distribution, "Zenoh", network], Err("no"));
        }
    }
    page += FEET;
    let file = tests::checkout().join("docs/reference/ros2-matrix.md");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&file, &page).expect("it is ours");
    }
    let committed = std::fs::read_to_string(&file).unwrap_or_default();
    assert_eq!(page, committed, "the page differs from what was seen");
}
