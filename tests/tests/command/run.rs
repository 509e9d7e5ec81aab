//! `frictionlab run` as a person uses it: the whole job, wrong input, and a change of mind.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use msgs::friction_msgs::ExperimentStatus;
use msgs::sensor_msgs::JointState;
use recording::bag::BagReader;
use serde_json::Value;
use tempfile::TempDir;
use tests::frictionlab;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn run(arguments: &[&str], out: &Path) -> Output {
    frictionlab()
        .arg("run")
        .args(arguments)
        .arg("--out")
        .arg(out)
        .output()
        .expect("frictionlab starts")
}

fn results(out: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(out.join("run.json")).expect("run.json"))
        .expect("valid JSON")
}

/// The rows `none`, `lugre`, `proposed` of a comparison, and what holds for all of them.
fn assert_compensated(results: &Value, task: &str, factor: f64) {
    let rows = results[task]["rows"].as_array().expect("rows");
    let mse: Vec<f64> = rows.iter().map(|row| row["mse"].as_f64().expect("mse")).collect();
    assert_eq!(mse.len(), 3, "{task}");
    for compensated in &mse[1..] {
        assert!(*compensated < mse[0] / factor, "{task}: {mse:?}");
    }
    for row in &rows[1..] {
        let improvement = 100.0 * (1.0 - row["mse"].as_f64().unwrap() / mse[0]);
        assert!((row["mse_improvement"].as_f64().unwrap() - improvement).abs() < 1e-9);
    }
}

#[test]
fn one_command_does_the_whole_job() {
    let folder = folder();
    let out = folder.path().join("all");
    let output = run(&["--quick"], &out);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("as fast as real time") && said.contains("report.html"), "{said}");

    let found = results(&out);
    assert_eq!(found["status"], "complete");
    assert_compensated(&found, "velocity_tracking", 2.0);
    assert_compensated(&found, "position_tracking", 2.0);
    // The plant's own values, within what forty points of 3.5 s tell.
    for (parameter, tolerance) in found["identification"]["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .zip([0.02, 0.01, 0.3, 0.01])
    {
        let (value, truth) =
            (parameter["value"].as_f64().unwrap(), parameter["truth"].as_f64().unwrap());
        assert!((value / truth - 1.0).abs() < tolerance, "{parameter}");
        let error = parameter["standard_error"].as_f64().unwrap();
        assert!((value - truth).abs() < 5.0 * error, "{parameter}");
    }

    let bag = BagReader::open(&out.join("bag")).expect("a readable bag");
    let joints = bag.messages::<JointState>("/joint_states").expect("joint states");
    // Six messages a cycle, and the status of the experiment.
    let statuses = bag.messages::<ExperimentStatus>("/experiment_status").expect("statuses");
    assert_eq!(found["bag"]["messages"], 6 * joints.len() + statuses.len());
    assert!(statuses.iter().any(|(_, status)| status.stage == "compensation proposed"));

    // What was identified is where the next run starts.
    let parameters = out.join("parameters.yaml");
    let again = folder.path().join("again");
    let output = run(
        &["position-tracking", "--quick", "--quiet", "--parameters", parameters.to_str().unwrap()],
        &again,
    );
    assert!(
        output.status.success() && output.stdout.is_empty() && output.stderr.is_empty(),
        "{output:?}"
    );
    let next = results(&again);
    assert_eq!(
        next["position_tracking"]["rows"][2]["mse"],
        found["position_tracking"]["rows"][2]["mse"]
    );
    assert!(next["identification"].is_null());
}

#[test]
fn the_same_seed_gives_the_same_figures_and_another_seed_others() {
    let folder = folder();
    let figures = |seed: &str, jobs: &str, name: &str| {
        let out = folder.path().join(name);
        let output =
            run(&["velocity-tracking", "--quick", "--quiet", "--seed", seed, "--jobs", jobs], &out);
        assert!(output.status.success(), "{output:?}");
        results(&out)["velocity_tracking"].clone()
    };
    let first = figures("7", "1", "a");
    assert_eq!(first, figures("7", "2", "b"));
    assert_ne!(first, figures("8", "2", "c"));
}

/// Exit code 2, one paragraph that names the mistake, nothing written.
#[test]
fn wrong_input_is_told_and_nothing_is_written() {
    let folder = folder();
    let missing = folder.path().join("nowhere.yaml");
    let broken = folder.path().join("broken.yaml");
    fs::write(&broken, "/friction_observer:\n  ros__parameters:\n    lugre: {f_s: 0.1, f_c: 0.2, v_s: 0.1, sigma0: 1.0, sigma1: 0.1, f_v: 0.0}\n").unwrap();
    let cases: [(&[&str], &[&str]); 7] = [
        (&["--voltage-limit", "50"], &["--voltage-limit", "10 V", "50"]),
        (&["--voltage-limit", "NaN"], &["--voltage-limit", "NaN"]),
        (&["--model", "lugri"], &["lugri", "xiong, proposed"]),
        (&["--plant", "butter"], &["butter", "coulomb"]),
        (&["--parameters", missing.to_str().unwrap()], &["nowhere.yaml", "No such file"]),
        (&["--parameters", broken.to_str().unwrap()], &["broken.yaml", "lugre.f_c", "at most f_s"]),
        (&["--repetitions", "0"], &["repetitions", "0"]),
    ];
    for (arguments, named) in cases {
        let out = folder.path().join("out");
        let output = run(arguments, &out);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        for name in named {
            assert!(said.contains(name), "{arguments:?} should name {name}: {said}");
        }
        assert!(!said.contains("panicked"), "{said}");
        assert!(!out.exists(), "{arguments:?} wrote something");
    }
}

#[test]
fn an_output_folder_that_cannot_be_used_is_told() {
    let folder = folder();
    fs::write(folder.path().join("mine.txt"), "precious").unwrap();
    let file = folder.path().join("mine.txt");
    for (out, named) in [
        (folder.path().to_owned(), "not empty"),
        (file.join("below"), "mine.txt"),
        (Path::new("/proc/no/such/place").to_owned(), "/proc/no"),
    ] {
        let output = run(&["--quick"], &out);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(named) && said.contains("--out"), "{said}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(fs::read_to_string(file).unwrap(), "precious");
}

/// Ctrl-C in the middle of the run: the bag is whole as far as it goes, and the program says so.
#[test]
#[cfg(unix)]
fn a_change_of_mind_leaves_a_readable_bag() {
    let folder = folder();
    let out = folder.path().join("all");
    let child = frictionlab()
        .args(["run", "--repetitions", "1000", "--out"])
        .arg(&out)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("frictionlab starts");
    // The bag is made after the signal handler: from then on ctrl-C is heard.
    let bag = out.join("bag").join("bag_0.mcap");
    while !bag.is_file() {
        std::thread::yield_now();
    }
    let killed =
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(killed.success());
    let output = child.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("stopped before the end") && said.contains("bag"), "{said}");
    assert_eq!(results(&out)["status"], "interrupted");
    assert!(out.join("report.html").is_file());
    BagReader::open(&out.join("bag"))
        .expect("a readable bag")
        .messages::<JointState>("/joint_states")
        .expect("joint states");
}

/// The protocol at full length, in the full tier only.
#[tests::needs(long_tier)]
#[test]
fn the_full_protocol_fits_its_bag() {
    let folder = folder();
    let out = folder.path().join("all");
    let output = run(&["--quiet"], &out);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = results(&out);
    assert_eq!(found["constant_velocity"].as_array().unwrap().len(), 1600);
    assert!(found["bag"]["bytes"].as_u64().unwrap() < 300_000_000);
    assert!((found["timing"]["rig_seconds"].as_f64().unwrap() - 25_180.5).abs() < 1e-6);
    assert_compensated(&found, "velocity_tracking", 3.0);
    assert_compensated(&found, "position_tracking", 3.0);
    for (parameter, tolerance) in found["identification"]["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .zip([0.002, 0.002, 0.02, 0.002])
    {
        let (value, truth) =
            (parameter["value"].as_f64().unwrap(), parameter["truth"].as_f64().unwrap());
        assert!((value / truth - 1.0).abs() < tolerance, "{parameter}");
    }
}
