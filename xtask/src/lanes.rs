//! The tests in three lanes at once, in each of which one program runs after the other. What runs in
//! real time mostly waits: over a network in one lane, over a line in another. All else computes, and
//! takes the processor time that is left over.

use std::ffi::OsString;
use std::io::{self, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::{Sender, channel};
use std::{env, thread};

use anyhow::{Context, ensure};
use serde_json::Value;

use crate::tally::Tally;

/// Test programs that speak DDS or serve a page, each in real time.
const OVER_A_NETWORK: [&str; 23] = [
    "answers",
    "apart",
    "bench_live",
    "blocked_stderr",
    "colcon",
    "cyclone",
    "doctor",
    "examples",
    "experiment_over_nodes",
    "foreign_host",
    "hostile_traffic",
    "killed_processes",
    "matrix",
    "paused",
    "rclpy",
    "ros2_verbs",
    "security",
    "server",
    "signals",
    "stopping",
    "view",
    "view_work",
    "viewers",
];

/// Test programs that drive a device in real time over a line of its own, or time what others do.
const OVER_A_LINE: [&str; 15] = [
    "broken_lines",
    "coasting",
    "commission_serial",
    "exit_codes",
    "fleet_cluster",
    "killed_drivers",
    "live_serial",
    "python_package",
    "quanser",
    "resume",
    "rig",
    "rig_setup",
    "round_trip",
    "run_serial",
    "strangers",
];

/// Programs by lane: over a network, over a line, and those that compute.
const LANES: usize = 3;
const COMPUTING: usize = LANES - 1;

/// The options of `cargo test` that name the programs of each lane: all programs of the workspace,
/// each once.
///
/// # Errors
/// cargo does not tell which there are, or one that is listed here is none.
fn programs(root: &Path) -> anyhow::Result<[Vec<String>; LANES]> {
    let output = cargo()
        .args(["metadata", "--no-deps", "--format-version", "1", "--locked"])
        .current_dir(root)
        .stderr(Stdio::inherit())
        .output()
        .context("cargo does not start")?;
    ensure!(output.status.success(), "cargo metadata failed");
    let told: Value = serde_json::from_slice(&output.stdout)?;
    let lanes = sorted(&told);
    for (lane, name) in in_real_time() {
        ensure!(lanes[lane].iter().any(|known| known == name), "there is no test program `{name}`");
    }
    Ok(lanes)
}

/// Programs that run in real time, with their lane.
fn in_real_time() -> impl Iterator<Item = (usize, &'static str)> {
    let of = |(lane, names): (usize, &'static [&str])| names.iter().map(move |&name| (lane, name));
    [&OVER_A_NETWORK[..], &OVER_A_LINE].into_iter().enumerate().flat_map(of)
}

/// See [`programs`].
fn sorted(told: &Value) -> [Vec<String>; LANES] {
    let mut lanes = [Vec::new(), Vec::new(), vec!["--lib".to_owned(), "--bins".to_owned()]];
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
            let of = in_real_time().find(|(_, known)| *known == name);
            let lane = &mut lanes[of.map_or(COMPUTING, |(lane, _)| lane)];
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
    let lanes = programs(root)?;
    let documents = [vec!["--doc".to_owned()]];
    let (results, counted): (Vec<_>, Vec<_>) = thread::scope(|scope| {
        let mut quiet = Vec::new();
        for (lane, programs) in lanes.iter().enumerate().skip(1) {
            let (says, said) = channel();
            let then = if lane == COMPUTING { &documents[..] } else { &[] };
            let work = move || {
                let (mut counted, mut says) = (Tally::default(), Said(says));
                let mut result = Ok(());
                for programs in std::iter::once(programs).chain(then) {
                    let command = if lane == COMPUTING { last_in_turn() } else { cargo() };
                    let of = [arguments, &words(programs)].concat();
                    result =
                        result.and(hear(command, root, &of, environment, &mut counted, &mut says));
                }
                (result, counted)
            };
            quiet.push((said, scope.spawn(work)));
        }
        let of = [arguments, &words(&lanes[0])].concat();
        let mut counted = Tally::default();
        let first = hear(cargo(), root, &of, environment, &mut counted, &mut io::stdout());
        // What the other lanes have said so far, and what they still say, one after the other.
        let heard = quiet.into_iter().map(|(said, lane)| {
            for bytes in said {
                let _ = io::stdout().write_all(&bytes);
            }
            lane.join().expect("it does not panic")
        });
        std::iter::once((first, counted)).chain(heard).unzip()
    });
    counted.into_iter().for_each(|counted| tally.add(counted));
    results.into_iter().collect()
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
                target("quanser", "test", &[]),
                target("firmware", "example", &[]),
                target("controller", "bin", &[]),
                json!({ "name": "slow", "kind": ["bench"], "test": false }),
            ]),
        ] });
        let [network, line, computing] = sorted(&told);
        assert_eq!(network, ["--test", "rclpy", "--test", "examples"]);
        assert_eq!(line, ["--test", "quanser"]);
        let rest = ["--lib", "--bins", "--test", "safety", "--example", "firmware"];
        assert_eq!(computing, rest);
    }

    #[test]
    fn the_programs_in_real_time_are_there() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let lanes = programs(root).unwrap();
        let listed = OVER_A_NETWORK.len() + OVER_A_LINE.len();
        assert!(lanes[0].len() + lanes[1].len() >= 2 * listed, "{lanes:?}");
        assert!(lanes[COMPUTING].len() > 2, "{lanes:?}");
    }
}
