//! `cargo xtask test`: every test of the project, with what they need made ready first.

use std::io::{self, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::{env, fs, thread, time::Instant};

use anyhow::{Context, ensure};

use machine::Need;

use crate::distribution::Distribution;
use crate::lanes;
use crate::python_env;
use crate::room;
use crate::tally::Tally;

/// Random cases a property test runs through: in the short tier, and in the full one.
const CASES: [(&str, &str); 2] = [("short", "2000"), ("full", "50000")];

/// Examples that a test starts as programs (`ros_node/tests/examples.rs`). The others are not linked
/// here: whether they compile, Clippy says.
const RUN_EXAMPLES: [&str; 3] = ["talker_listener", "service", "managed"];

/// Arguments of `cargo xtask test`.
#[derive(Debug, clap::Args)]
pub struct Test {
    /// Long tiers whole: 25 times the random cases, 2000 repetitions of the identifications, the
    /// whole protocol of `frictionlab run`, ten seeds of servo identification, 1000 draws of
    /// compensation with wrong parameters, 200 rounds of killed drivers, 50 rounds of killed nodes,
    /// up to ten frozen and unplugged readers beside each way to run the loop, millions of damaged
    /// inputs, the loader under valgrind, the unit tests of the mended middleware, DDS Security
    /// with a peer on Fast DDS, the nodes built by colcon in release, an experiment from outside,
    /// the largest answers to the rclpy of Kilted and Jazzy on every kind of network
    #[arg(long)]
    full: bool,
}

impl Test {
    /// Runs the tests.
    ///
    /// # Errors
    /// Whatever does not build or does not pass.
    pub fn run(&self) -> anyhow::Result<()> {
        let started = Instant::now();
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask stands in the workspace")?;
        let target = env::var_os("CARGO_TARGET_DIR")
            .map_or_else(|| root.join("target"), |dir| root.join(dir));
        let (tier, cases) = CASES[usize::from(self.full)];
        let long: &[(&str, &str)] = if self.full { &[("FRICTION_FULL", "1")] } else { &[] };
        // Fetching the Python half leaves the processors to the compiler. Programs and tests are
        // built together, with the same features, so that nothing is built twice. The tests know
        // what the machine has: they are built for what it will have. Where something could not be
        // had, they are built again before the first one runs: a program that one lane replaces is
        // gone for the tests of the other.
        fs::create_dir_all(&target)?;
        let built = target.join("debug/deps").is_dir();
        room::said(&target, built).iter().for_each(|line| println!("{line}"));
        let mut expected = machine::look(&target);
        expected.extend(python_env::PARTS.map(|(need, _)| need));
        expected.extend(self.full.then_some(Need::Jazzy));
        machine::write_down(&target, &expected)?;
        let examples = RUN_EXAMPLES.map(|name| ["--example", name]).concat();
        // Libraries too: the extension module of Python is one that no program asks for.
        let all = ["build", "--workspace", "--lib", "--bins", "--tests", "--locked"];
        let build = || cargo(root, &[&all[..], &examples].concat(), long);
        thread::scope(|scope| {
            scope.spawn(|| prepare_python(self.full));
            build()
        })?;
        let found = machine::look(&target);
        machine::write_down(&target, &found)?;
        if found != expected {
            let other: Vec<String> =
                found.symmetric_difference(&expected).map(ToString::to_string).collect();
            println!(
                "The tests are built again: they were built for another machine ({} differs).",
                other.join(", ")
            );
            build()?;
        }
        let built = |name: &str| {
            let program = target.join("debug").join(format!("{name}{}", env::consts::EXE_SUFFIX));
            program
                .into_os_string()
                .into_string()
                .ok()
                .context("the target folder's path must be text")
        };
        let (program, emulator) = (built("frictionlab")?, built("rig_emulator")?);
        let xtask = built("xtask")?;
        let (before, after) = (env::consts::DLL_PREFIX, env::consts::DLL_SUFFIX);
        let module = target.join(format!("debug/{before}frictionlab_native{after}"));
        let module = module.to_str().context("the target folder's path must be text")?;
        let nodes = target.join("debug").into_os_string().into_string().ok();
        let nodes = nodes.context("the target folder's path must be text")?;
        let state = target.join("state").into_os_string().into_string().ok();
        let state = state.context("the target folder's path must be text")?;
        let left_out = target.join("left_out.txt");
        let _ = fs::remove_file(&left_out);
        let left_out_by_name =
            left_out.to_str().context("the target folder's path must be text")?;
        let mut environment = vec![
            ("FRICTION_LEFT_OUT", left_out_by_name),
            ("FRICTION_NODES", nodes.as_str()),
            ("FRICTIONLAB_BIN", program.as_str()),
            ("FRICTIONLAB_PYTHON_MODULE", module),
            ("RIG_EMULATOR_BIN", emulator.as_str()),
            ("XTASK_BIN", xtask.as_str()),
            ("PROPTEST_CASES", cases),
            // Temperatures of emulated motors are of no use after the test.
            ("XDG_STATE_HOME", state.as_str()),
        ];
        if self.full {
            environment.push(("FRICTION_FULL", "1"));
            environment.push(("FRICTION_COVERAGE", "2000"));
        }
        let mut tally = Tally::default();
        let all = ["test", "--workspace", "--locked", "--no-fail-fast"];
        let all_passed = lanes::run(root, &environment, &all, &mut tally);
        if all_passed.is_err() {
            room::said(&target, true).iter().for_each(|line| println!("{line}"));
        }
        all_passed?;
        if self.full {
            let seeds = [
                "run",
                "--release",
                "--locked",
                "--package",
                "friction_ident",
                "--example",
                "servo_seeds",
            ];
            cargo(root, &seeds, &environment)?;
            let bars = [
                "run",
                "--release",
                "--locked",
                "--package",
                "studies",
                "--example",
                "monte_carlo_bars",
            ];
            cargo(root, &bars, &environment)?;
            loader_under_valgrind(root, &environment, &mut tally)?;
            middleware(root, &environment, &mut tally)?;
            secured(root, &environment, &mut tally)?;
        }
        println!(
            "All tests passed, {tier} tier, in {:.0} s: {tally}",
            started.elapsed().as_secs_f64()
        );
        if let Ok(parts) = fs::read_to_string(&left_out) {
            println!("Parts of tests were left out:\n{parts}");
        }
        Ok(())
    }
}

/// DDS Security, with a peer of another vendor; in the long tier only, because the middleware is
/// compiled once more for it.
fn secured(root: &Path, environment: &[(&str, &str)], tally: &mut Tally) -> anyhow::Result<()> {
    if !Path::new("/usr/include/openssl/ssl.h").exists() {
        tally.leave_out(
            "DDS Security: OpenSSL's headers are missing (Debian: apt-get install libssl-dev)",
        );
        return Ok(());
    }
    let features = ["--features", "ros_node/security,rig_driver/security"];
    let of_nodes = [
        "test",
        "--locked",
        "-p",
        "ros_node",
        "-p",
        "rig_driver",
        "--lib",
        "--test",
        "security_peers",
    ];
    counted(root, &[&of_nodes[..], &features].concat(), environment, tally)?;
    // Keystores from the command line.
    let of_command =
        ["test", "--locked", "-p", "frictionlab", "--features", "security", "--lib", "security"];
    counted(root, &of_command, environment, tally)
}

/// The unit tests of the mended middleware, which is no member of the workspace.
fn middleware(root: &Path, environment: &[(&str, &str)], tally: &mut Tally) -> anyhow::Result<()> {
    let library =
        ["test", "--locked", "--manifest-path", "third_party/rustdds/Cargo.toml", "--lib"];
    let features = ["--no-default-features", "--features", "mio_1"];
    let target = root.join("target/rustdds");
    let apart = [environment, &[("CARGO_TARGET_DIR", target.to_str().context("a folder's name")?)]]
        .concat();
    counted(root, &[&library[..], &features].concat(), &apart, tally)
}

/// The tests of the loader of foreign code, each access to memory checked. Those that kill
/// themselves are left out: what they check is the card's watchdog.
fn loader_under_valgrind(
    root: &Path,
    environment: &[(&str, &str)],
    tally: &mut Tally,
) -> anyhow::Result<()> {
    if !Command::new("valgrind").arg("--version").output().is_ok_and(|said| said.status.success()) {
        tally.leave_out(
            "the loader's memory: valgrind is not installed (Debian: apt-get install valgrind)",
        );
        return Ok(());
    }
    let runner =
        "target.'cfg(unix)'.runner=['valgrind','-q','--error-exitcode=99','--trace-children=no']";
    let mut arguments = vec![
        "--config",
        runner,
        "test",
        "--locked",
        "--package",
        "rig_driver",
        "--test",
        "quanser",
        "--",
    ];
    for left_out in ["driver_to_be_killed", "killed_with", "a_driver_that_was_stopped"] {
        arguments.extend(["--skip", left_out]);
    }
    cargo(root, &arguments, environment)
}

/// Without the environment the tests that need it say that they are skipped. The other
/// distribution's is for the long tier.
fn prepare_python(full: bool) {
    println!("Python environment for the tests (first time: about two minutes) ...");
    match python_env::prepare() {
        Ok(environment) => {
            environment.missing().for_each(|(what, error)| println!("no {what}: {error:#}"));
        }
        Err(error) => println!("no Python environment: {error:#}"),
    }
    if full && let Err(error) = python_env::rclpy(Distribution::Jazzy) {
        println!("no rclpy of Jazzy: {error:#}");
    }
}

fn cargo(root: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> anyhow::Result<()> {
    let status = command(root, arguments, environment).status().context("cargo does not start")?;
    ensure!(status.success(), "cargo {} failed", arguments.join(" "));
    Ok(())
}

/// Runs tests, and counts what came of them.
fn counted(
    root: &Path,
    arguments: &[&str],
    environment: &[(&str, &str)],
    tally: &mut Tally,
) -> anyhow::Result<()> {
    let mut tests = command(root, arguments, environment)
        .stdout(Stdio::piped())
        .spawn()
        .context("cargo does not start")?;
    let said = tests.stdout.take().context("its output is ours")?;
    tally.hear(BufReader::new(said), &mut io::stdout())?;
    let status = tests.wait()?;
    ensure!(status.success(), "cargo {} failed: {tally}", arguments.join(" "));
    Ok(())
}

fn command(root: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> Command {
    println!("cargo {}", arguments.join(" "));
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root).envs(environment.iter().copied());
    command
}
