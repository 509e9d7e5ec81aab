//! What the laboratory records, it also identifies: late and missing cycles, repeated stamps,
//! thinned bags and the tables of its experiments.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use friction_model::{AnyModel, ModelName};
use msgs::friction_msgs::RigMeasurement;
use msgs::sensor_msgs::JointState;
use msgs::std_msgs::Header;
use recording::bag::{BagOptions, BagWriter};
use rig_driver::SimulationOptions;
use serde_json::Value;
use tempfile::TempDir;

/// One control cycle.
struct Cycle {
    /// When the machine ran it [s].
    time: f64,
    /// When it was by the rig's own clock [s].
    rig_time: f64,
    velocity: f64,
    /// Voltage of the cycle before [V].
    voltage: f64,
    torque: f64,
}

/// Volts at a time: a chirp and steps.
fn excitation(t: f64) -> f64 {
    if t < 8.0 {
        return 4.0 * (std::f64::consts::TAU * (0.5 * t + 7.5 / 16.0 * t * t)).sin();
    }
    let levels = [2.0, -2.0, 4.0, -4.0, 3.0, -1.5, 5.0, -3.0, 1.5, -5.0, 2.5, 0.0];
    levels[((t - 8.0) / 0.5) as usize % levels.len()]
}

/// Sixteen seconds of a simulated rig.
fn cycles() -> Vec<Cycle> {
    let mut rig = SimulationOptions::default().build(AnyModel::test_bed(ModelName::LuGre)).unwrap();
    let one = |k: u32| {
        let time = f64::from(k) * 1e-3;
        let seen = rig.measure();
        rig.apply(excitation(time)).unwrap();
        Cycle {
            time,
            rig_time: time,
            velocity: seen.tachometer_velocity,
            voltage: seen.voltage_applied,
            torque: seen.torque,
        }
    };
    (0..16_000).map(one).collect()
}

/// What a busy machine makes of it: a late cycle, one and two lost ones, a stamp that comes twice,
/// and three longer gaps.
fn of_a_busy_machine(mut cycles: Vec<Cycle>) -> Vec<Cycle> {
    cycles[9_000].time += 6e-4;
    (cycles[9_500].time, cycles[9_501].time) = (9.501_9, 9.501_95);
    for (from, lost) in [(14_000, 5), (11_000, 4), (10_000, 2), (6_000, 1), (3_000, 3)] {
        cycles.drain(from..from + lost);
    }
    let Cycle { time, rig_time, velocity, voltage, torque } = cycles[200];
    cycles.insert(200, Cycle { time, rig_time, velocity, voltage, torque });
    cycles
}

/// A bag with the stamps of the machine alone, or with the time of the rig too.
fn bag(folder: &Path, cycles: &[Cycle], by_rig: bool) -> PathBuf {
    let dir = folder.join("bag");
    let mut bag = BagWriter::create(&dir, BagOptions::default()).unwrap();
    for cycle in cycles {
        let stamp = 1_700_000_000_000_000_000 + (cycle.time * 1e9).round() as u64;
        let state = JointState {
            header: Header::at(stamp),
            name: vec!["load_shaft".into()],
            position: vec![0.0],
            velocity: vec![cycle.velocity],
            effort: vec![cycle.torque],
        };
        bag.write("/joint_states", stamp, &state).unwrap();
        let rig = RigMeasurement {
            header: Header::at(stamp),
            tachometer_velocity: cycle.velocity,
            voltage_applied: cycle.voltage,
            torque: cycle.torque,
            rig_time: if by_rig { cycle.rig_time } else { 0.0 },
            ..RigMeasurement::default()
        };
        bag.write("/rig_measurement", stamp, &rig).unwrap();
    }
    bag.finish().unwrap();
    dir
}

fn table(folder: &Path, cycles: &[Cycle]) -> PathBuf {
    let mut text = "t_s,voltage_V,velocity_rad_s,friction_Nm\n".to_owned();
    // The voltage of a cycle stands in the next one.
    for pair in cycles.windows(2) {
        let (now, next) = (&pair[0], &pair[1]);
        text += &format!("{:.7},{},{},{}\n", now.time, next.voltage, now.velocity, now.torque);
    }
    let file = folder.join("drive.csv");
    fs::write(&file, text).unwrap();
    file
}

fn frictionlab(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frictionlab"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// Runs it, expects success and returns what it printed.
fn ok(folder: &Path, arguments: &[&str]) -> String {
    let output = frictionlab(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

const SAID: &str = "3 gaps, 12 samples missing; split into 4 stretches";

#[test]
fn a_drive_is_identified_from_a_bag_with_late_and_missing_cycles_as_from_a_whole_one() {
    let folder = folder();
    let here = folder.path();
    bag(here, &of_a_busy_machine(cycles()), false);
    let said = ok(here, &["identify-drive", "bag", "--gear-ratio", "70", "--out", "found"]);
    assert!(said.contains(SAID), "{said}");
    assert!(said.contains("1 repeated sample dropped"), "{said}");
    let document = json(&here.join("found/identification-drive.json"));
    assert_eq!(document["recordings"][0]["timing"]["missing"], 12);
    assert_eq!(document["recordings"][0]["timing"]["filled"], 3);
    let page = fs::read_to_string(here.join("found/report.html")).unwrap();
    assert!(page.contains(SAID));
    for (name, truth) in [("gain", 1.862_54), ("time_constant", 0.023_88), ("inertia", 2.647_57e-3)]
    {
        let estimate =
            document["estimates"].as_array().unwrap().iter().find(|e| e["name"] == name).unwrap();
        let value = estimate["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.01, "{name}: {value}");
    }
}

/// Every cycle of a busy machine is late by something; the rig knows better.
#[test]
fn late_stamps_cost_nothing_where_the_rig_tells_its_time() {
    let folder = folder();
    let here = folder.path();
    let mut cycles = of_a_busy_machine(cycles());
    for cycle in &mut cycles {
        let late = (cycle.rig_time * 1e3).round() as u32 * 7919 % 997;
        cycle.time = cycle.rig_time + f64::from(late) * 3e-7;
    }
    bag(here, &cycles, true);
    let said = ok(here, &["identify-drive", "bag", "--gear-ratio", "70", "--out", "found"]);
    assert!(said.contains(SAID) && !said.contains("came late"), "{said}");
    let axis = ok(here, &["identify", "bag", "--torque-from-voltage", "--out", "axis"]);
    assert!(axis.contains(SAID) && !axis.contains("came late"), "{axis}");
    let friction =
        ok(here, &["identify", "bag", "--model", "stribeck", "--no-joint", "--out", "friction"]);
    assert!(friction.contains(SAID) && !friction.contains("came late"), "{friction}");
}

#[test]
fn a_drive_is_identified_from_a_table_with_late_and_missing_cycles() {
    let folder = folder();
    let here = folder.path();
    table(here, &of_a_busy_machine(cycles()));
    let said = ok(here, &["identify-drive", "drive.csv", "--gear-ratio", "70", "--out", "found"]);
    assert!(said.contains("gaps") && said.contains("split into 4 stretches"), "{said}");
    let wrong = frictionlab(here, &["identify-drive", "drive.csv", "--time-tolerance", "0.7"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("from 0 to 0.5"));
}

#[test]
fn friction_and_inertia_are_identified_from_a_bag_with_late_and_missing_cycles() {
    let folder = folder();
    let here = folder.path();
    bag(here, &of_a_busy_machine(cycles()), false);
    let said = ok(here, &["identify", "bag", "--torque-from-voltage", "--out", "axis"]);
    assert!(said.contains(SAID), "{said}");
    let document = json(&here.join("axis/identification.json"));
    assert_eq!(document["recording"]["timing"]["gaps"], 3);
    let inertia = document["symmetric"]["parameters"]["inertia"]["value"].as_f64().unwrap();
    assert!((inertia / 2.647_57e-3 - 1.0).abs() < 0.02, "{inertia}");
    let friction = ok(
        here,
        &["identify", "bag", "--model", "coulomb_viscous", "--no-joint", "--out", "friction"],
    );
    assert!(friction.contains(SAID), "{friction}");
    let document = json(&here.join("friction/identification.json"));
    assert_eq!(document["files"][0]["timing"]["missing"], 12);
    // With a structure that remembers, too.
    let structure = ["--structure", "symmetric+delay,asymmetric+stribeck", "--out", "structure"];
    ok(here, &[&["identify", "bag", "--torque-from-voltage"][..], &structure].concat());
}

/// Its bag has constant velocities at 50 Hz, tracking at 1000 Hz and at 100 Hz, with pauses between
/// the runs.
#[test]
fn the_thinned_bag_of_a_run_is_identified() {
    let folder = folder();
    let here = folder.path();
    ok(here, &["run", "--quick", "--quiet", "--out", "run"]);
    let said = ok(here, &["identify-drive", "run/bag", "--gear-ratio", "70", "--out", "drive"]);
    assert!(said.contains("at another rate than most samples have"), "{said}");
    assert!(!said.contains("one control cycle in"), "{said}");
    ok(here, &["run", "constant-velocity", "--quick", "--quiet", "--out", "steady"]);
    let said =
        ok(here, &["identify-drive", "steady/bag", "--gear-ratio", "70", "--out", "steady-drive"]);
    assert!(said.contains("one control cycle in 20 was recorded"), "{said}");
    ok(here, &["identify", "run/bag", "--torque-from-voltage", "--out", "axis"]);
    ok(here, &["identify", "run/bag", "--model", "stribeck", "--no-joint", "--out", "friction"]);
}

#[test]
fn the_tables_of_an_experiment_are_identified() {
    let folder = folder();
    let here = folder.path();
    ok(here, &["run", "varying-velocity", "--quick", "--quiet", "--out", "run"]);
    let tables: Vec<PathBuf> = fs::read_dir(here.join("run"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "csv"))
        .collect();
    assert!(!tables.is_empty());
    let files: Vec<&str> = tables.iter().map(|path| path.to_str().unwrap()).collect();
    let model = ["--model", "coulomb_viscous", "--no-joint", "--out", "friction"];
    ok(here, &[&["identify"][..], &files, &model].concat());
    ok(here, &["identify-drive", "run/lag_chirp.csv", "--gear-ratio", "70", "--out", "drive"]);
}

#[test]
fn what_was_designed_and_what_was_identified_go_into_one_run() {
    let folder = folder();
    let here = folder.path();
    ok(here, &["run", "constant-velocity", "--quick", "--quiet", "--out", "run"]);
    ok(
        here,
        &[
            "design",
            "velocity",
            "--steady-state-error",
            "0.01",
            "--crossover",
            "110",
            "--out",
            "design",
        ],
    );
    let points = "velocity_rad_s,torque_Nm\n0.05,0.1\n0.1,0.098\n0.3,0.1\n0.5,0.109\n1.0,0.13\n2.0,0.17\n3.0,0.21\n4.0,0.25\n-0.05,-0.1\n-0.3,-0.1\n-1.0,-0.13\n-3.0,-0.21\n";
    fs::write(here.join("points.csv"), points).unwrap();
    ok(here, &["identify", "points.csv", "--model", "coulomb_viscous", "--out", "identified"]);
    let run = "run/parameters.yaml";
    let design = "design/controller.yaml";
    let identified = "identified/parameters.yaml";
    let mut out = 0;
    for (first, second) in [
        (run, design),
        (design, run),
        (run, identified),
        (identified, run),
        (design, identified),
        (identified, design),
    ] {
        out += 1;
        let name = format!("both-{out}");
        let both = ["--parameters", first, "--parameters", second, "--model", "coulomb_viscous"];
        let rest = ["--quick", "--quiet", "--repetitions", "1", "--out", &name];
        ok(here, &[&["run", "velocity-tracking"][..], &both, &rest].concat());
        let document = json(&here.join(&name).join("run.json"));
        let origin = |path: &str| document["origin"][path]["file"].as_str().map(str::to_owned);
        let of = |file: &str| [first, second].contains(&file);
        let later = |a: &str, b: &str| {
            if of(a) && (second == a || !of(b)) { Some(a.to_owned()) } else { None }
        };
        let lag = later(design, run).or(later(run, design));
        assert_eq!(origin("controller.lag.k_p"), lag, "{first}, {second}");
        let level = later(identified, run).or(later(run, identified));
        assert_eq!(origin("friction_observer.coulomb_viscous.f_c"), level, "{first}, {second}");
        assert_eq!(document["origin"]["rig_driver.period"]["from"], "default");
        let yaml = fs::read_to_string(here.join(&name).join("parameters.yaml")).unwrap();
        assert!(yaml.contains(&format!("# from {second}")), "{yaml}");
        assert!(!yaml.contains("identified by this run"));
    }
    // A wrong file is named.
    let wrong =
        frictionlab(here, &["run", "--quick", "--parameters", run, "--parameters", "points.csv"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("points.csv"));
}
