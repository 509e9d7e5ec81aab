//! The table of the bench: each figure of the laboratory beside rclpy's.

use std::fmt::Write as _;

use serde_json::Value;

/// Nodes of `launch`.
const NODES: [&str; 4] = ["rig_driver", "friction_observer", "controller", "experiment_runner"];

/// A figure's name, where it is in a publisher's report, what it is multiplied by, and its
/// decimals.
type Figure<'a> = (&'a str, &'a str, f64, usize);

/// The table as Markdown; what could not be measured is left out of it.
pub(super) fn markdown(report: &Value, minutes: f64, clients: u32) -> String {
    let mut out = String::from(
        "| what | rclpy | live | to rclpy | launch | to rclpy |\n|---|---|---|---|---|---|\n",
    );
    let figures: [Figure; 13] = [
        ("rate, 1 reader [Hz]", "/one/rate_hz", 1.0, 1),
        ("lost, 1 reader [%]", "/one/lost", 100.0, 3),
        ("from stamp to callback, median [us]", "/one/p50_us", 1.0, 0),
        ("from stamp to callback, 99th percentile [us]", "/one/p99_us", 1.0, 0),
        ("rate, 10 readers [Hz]", "/ten/rate_hz", 1.0, 1),
        ("lost, 10 readers [%]", "/ten/lost", 100.0, 3),
        ("the same for 10 readers, median [us]", "/ten/p50_us", 1.0, 0),
        ("the same for 10 readers, 99th percentile [us]", "/ten/p99_us", 1.0, 0),
        ("first message of a newcomer [ms]", "/seconds/first_message", 1e3, 0),
        ("first call of a newcomer [ms]", "/seconds/first_call", 1e3, 1),
        ("later calls [ms]", "/seconds/later_call", 1e3, 2),
        ("first goal to its result [ms]", "/seconds/first_goal", 1e3, 1),
        ("later goals to their results [ms]", "/seconds/later_goal", 1e3, 2),
    ];
    for (name, at, factor, decimals) in figures {
        let of = |who: &str| {
            report[who].pointer(at).and_then(Value::as_f64).map(|number| factor * number)
        };
        row(&mut out, name, of("rclpy"), of("live"), of("launch"), decimals);
    }
    let memory = format!("memory after {minutes} minutes [MB]");
    let visits = format!("memory left behind by each of {clients} clients [kB]");
    let of_processes: [Figure; 3] = [
        ("processor time, 1 reader [%]", "/one/processor_percent", 1.0, 1),
        (&memory, "/memory_late_kb", 1e-3, 1),
        (&visits, "/kb_a_client", 1.0, 1),
    ];
    for (name, at, factor, decimals) in of_processes {
        let of = |who: &str, process: &str| {
            let found = report[who].pointer(at)?;
            found[process].as_f64().map(|number| factor * number)
        };
        let rclpy = of("rclpy", "rclpy");
        row(&mut out, name, rclpy, of("live", "live"), None, decimals);
        for node in NODES {
            row(
                &mut out,
                &format!("the same of {node}"),
                rclpy,
                None,
                of("launch", node),
                decimals,
            );
        }
    }
    out
}

fn row(
    out: &mut String,
    name: &str,
    rclpy: Option<f64>,
    live: Option<f64>,
    launch: Option<f64>,
    decimals: usize,
) {
    let number = |number: Option<f64>| {
        number.map_or_else(String::new, |number| format!("{number:.decimals$}"))
    };
    let ratio = |number: Option<f64>| match (number, rclpy) {
        (Some(number), Some(rclpy)) if rclpy.abs() > 1e-9 => format!("{:.2}", number / rclpy),
        _ => String::new(),
    };
    let cells = [number(rclpy), number(live), ratio(live), number(launch), ratio(launch)];
    // Writing into a string cannot fail.
    let _ = writeln!(out, "| {name} | {} |", cells.join(" | "));
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn each_figure_stands_beside_that_of_rclpy() {
        let of = |p99: f64, process: &str| json!({"one": {"p99_us": p99, "lost": 0.0, "processor_percent": {process: 10.0 + p99}}});
        let report = json!({
            "rclpy": of(2000.0, "rclpy"), "live": of(1000.0, "live"), "launch": of(500.0, "controller"),
        });
        let table = markdown(&report, 2.0, 100);
        assert!(
            table.contains("99th percentile [us] | 2000 | 1000 | 0.50 | 500 | 0.25 |"),
            "{table}"
        );
        assert!(table.contains("| lost, 1 reader [%] | 0.000 | 0.000 |  | 0.000 |  |"), "{table}");
        assert!(
            table.contains("| the same of controller | 2010.0 |  |  | 510.0 | 0.25 |"),
            "{table}"
        );
    }
}
