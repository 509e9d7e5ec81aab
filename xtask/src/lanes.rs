//! The tests in two lanes at once. What runs in real time or speaks DDS mostly waits: one program
//! after the other, as ever. All else computes, and takes the processor time that is left over.

use std::ffi::OsString;
use std::io::{self, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::{Sender, channel};
use std::{env, thread};

use anyhow::{Context, ensure};
use serde_json::Value;

use crate::tally::Tally;

/// Test programs that drive a device in real time, speak DDS or time what others do.
const IN_REAL_TIME: [&str; 38] = [
    "answers",
    "apart",
    "bench_live",
    "blocked_stderr",
    "broken_lines",
    "coasting",
    "colcon",
    "commission_serial",
    "cyclone",
    "doctor",
    "examples",
    "exit_codes",
    "experiment_over_nodes",
    "fleet_cluster",
    "foreign_host",
    "hostile_traffic",
    "killed_drivers",
    "killed_processes",
    "live_serial",
    "matrix",
    "paused",
    "quanser",
    "rclpy",
    "resume",
    "rig",
    "rig_setup",
    "ros2_verbs",
    "round_trip",
    "run_serial",
    "security",
    "server",
    "signals",
    "stopping",
    "strangers",
    "view",
    "view_work",
    "viewers",
    "python_package",
];

/// The options of `cargo test` that name the programs of each lane: all programs of the workspace,
/// each once.
///
/// # Errors
/// cargo does not tell which there are, or one that is listed here is none.
fn programs(root: &Path) -> anyhow::Result<[Vec<String>; 2]> {
    let output = cargo()
        .args(["metadata", "--no-deps", "--format-version", "1", "--locked"])
        .current_dir(root)
        .stderr(Stdio::inherit())
        .output()
        .context("cargo does not start")?;
    ensure!(output.status.success(), "cargo metadata failed");
    let told: Value = serde_json::from_slice(&output.stdout)?;
    let lanes = sorted(&told);
    for name in IN_REAL_TIME {
        ensure!(lanes[0].iter().any(|known| known == name), "there is no test program `{name}`");
    }
    Ok(lanes)
}

/// See [`programs`].
fn sorted(told: &Value) -> [Vec<String>; 2] {
    let mut lanes = [Vec::new(), vec!["--lib".to_owned(), "--bins".to_owned()]];
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    for package in list(&told["packages"]) {
        let usual = list(&package["features"]["default"]);
        for target in list(&package["targets"]) {
            let has = list(&target["required-features"]).iter().all(|one| usual.contains(one));
            let kind = target["kind"][0].as_str().unwrap_or_default();
            if !has || target["test"] != true || !["test", "example"].contains(&kind) {
                continue;
            }
            let name = target["name"].as_str().unwrap_or_default();
            let lane = &mut lanes[usize::from(!IN_REAL_TIME.contains(&name))];
            if !lane.iter().any(|known| known == name) {
                lane.extend([format!("--{kind}"), name.to_owned()]);
            }
        }
    }
    lanes
}

/// Runs all test programs, then the examples in the documentation, and counts what came of them.
///
/// # Errors
/// A test fails, or cargo cannot be asked.
pub fn run(
    root: &Path,
    environment: &[(&str, &str)],
    arguments: &[&str],
    tally: &mut Tally,
) -> anyhow::Result<()> {
    let [waiting, computing] = programs(root)?;
    let (says, said) = channel();
    let (first, (second, counted)) = thread::scope(|scope| {
        let second = scope.spawn(|| {
            let mut counted = Tally::default();
            let mut says = Said(says);
            let of = [arguments, &words(&computing)].concat();
            let programs = hear(last_in_turn(), root, &of, environment, &mut counted, &mut says);
            let of = [arguments, &["--doc"]].concat();
            let documents = hear(last_in_turn(), root, &of, environment, &mut counted, &mut says);
            (programs.and(documents), counted)
        });
        let of = [arguments, &words(&waiting)].concat();
        let first = hear(cargo(), root, &of, environment, tally, &mut io::stdout());
        // What the other lane has said so far, and what it still says.
        for bytes in said {
            let _ = io::stdout().write_all(&bytes);
        }
        (first, second.join().expect("it does not panic"))
    });
    tally.add(counted);
    first.and(second)
}

/// Runs cargo, passes on what it and the tests say, and counts.
fn hear(
    mut cargo: Command,
    root: &Path,
    arguments: &[&str],
    environment: &[(&str, &str)],
    tally: &mut Tally,
    on: &mut impl Write,
) -> anyhow::Result<()> {
    writeln!(on, "cargo {}", arguments.join(" "))?;
    let (said, says) = io::pipe()?;
    cargo.args(arguments).current_dir(root).envs(environment.iter().copied());
    cargo.stdout(says.try_clone()?).stderr(says);
    let mut running = cargo.spawn().context("cargo does not start")?;
    // Its ends of the pipe are the command's: they close with it.
    drop(cargo);
    tally.hear(BufReader::new(said), on)?;
    let status = running.wait()?;
    ensure!(status.success(), "cargo {} failed: {tally}", arguments.join(" "));
    Ok(())
}

/// Keeps what is said for whoever listens later.
struct Said(Sender<Vec<u8>>);

impl Write for Said {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let _ = self.0.send(bytes.to_vec());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn words(list: &[String]) -> Vec<&str> {
    list.iter().map(String::as_str).collect()
}

fn cargo() -> Command {
    Command::new(program())
}

fn program() -> OsString {
    env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// cargo and all that it starts, when nobody else wants the processor.
fn last_in_turn() -> Command {
    if cfg!(unix) {
        let mut command = Command::new("nice");
        command.args(["-n", "15"]).arg(program());
        return command;
    }
    cargo()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn each_test_program_is_in_one_lane_and_what_cannot_be_built_in_none() {
        let target = |name: &str, kind: &str, needs: &[&str]| json!({ "name": name, "kind": [kind], "test": true, "required-features": needs });
        let package =
            |targets: &[Value]| json!({ "features": { "default": ["ros"] }, "targets": targets });
        let told = json!({ "packages": [
            package(&[target("rclpy", "test", &[]), target("examples", "test", &[])]),
            package(&[
                target("examples", "test", &[]),
                target("safety", "test", &["ros"]),
                target("security_peers", "test", &["security"]),
                target("firmware", "example", &[]),
                target("controller", "bin", &[]),
                json!({ "name": "slow", "kind": ["bench"], "test": false }),
            ]),
        ] });
        let [waiting, computing] = sorted(&told);
        assert_eq!(waiting, ["--test", "rclpy", "--test", "examples"]);
        let rest = ["--lib", "--bins", "--test", "safety", "--example", "firmware"];
        assert_eq!(computing, rest);
    }

    #[test]
    fn the_programs_in_real_time_are_there() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let [waiting, computing] = programs(root).unwrap();
        assert!(waiting.len() >= 2 * IN_REAL_TIME.len() && computing.len() > 2, "{computing:?}");
    }
}
