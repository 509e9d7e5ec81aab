//! `frictionlab identify-servo`, as a person uses it: short logs, damaged logs, and a change of
//! mind.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};

/// A log of 1.5 s: the pendulum follows a sine with a lag that shrinks with the gain.
fn log(gain: f64) -> Value {
    let entries: Vec<Value> = (0..300)
        .map(|k| {
            let t = 0.0052 * f64::from(k);
            let lag = 10.0 / gain;
            json!({
                "timestamp": t,
                "goal_position": 0.5 * (4.0 * t).sin(),
                "position": 0.4 * (4.0 * (t - lag)).sin(),
                "speed": 1.6 * (4.0 * (t - lag)).cos(),
                "torque_enable": true,
            })
        })
        .collect();
    json!({ "mass": 0.3, "length": 0.1, "kp": gain, "vin": 7.5, "motor": "XL330", "trajectory": "sine", "entries": entries })
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for gain in [100.0, 400.0] {
        std::fs::write(folder.path().join(format!("kp{gain}.json")), log(gain).to_string())
            .unwrap();
    }
    folder
}

fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frictionlab"));
    command.current_dir(folder).arg("identify-servo").args(args);
    command
}

fn document(folder: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("servo.json")).unwrap()).unwrap()
}

#[test]
fn what_was_fitted_and_what_was_held_out_is_written_and_does_not_depend_on_the_threads() {
    let folder = folder();
    let run = |jobs: &str, out: &str| -> Output {
        let args =
            ["kp100.json", "kp400.json", "--hold-out", "kp=400", "--level", "m1", "--seeds", "2"];
        command(folder.path(), &args)
            .args(["--evaluations", "200", "--jobs", jobs, "--out", out])
            .output()
            .unwrap()
    };
    let output = run("1", "one");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("servo xl330, level m1") && shown.contains("held out"), "{shown}");
    let found = document(&folder.path().join("one"));
    assert_eq!(found["level"], "m1");
    assert_eq!(found["stopped"], false);
    assert_eq!(found["seeds"].as_array().unwrap().len(), 2);
    let roles: Vec<(&Value, &Value)> = found["logs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|log| (&log["gain"], &log["held_out"]))
        .collect();
    assert_eq!(roles, [(&json!(100.0), &json!(false)), (&json!(400.0), &json!(true))]);
    // The held-out error is that of the best seed on the one log held out.
    let best = found["seeds"]
        .as_array()
        .unwrap()
        .iter()
        .min_by(|a, b| {
            a["train_mrad"].as_f64().unwrap().total_cmp(&b["train_mrad"].as_f64().unwrap())
        })
        .unwrap();
    let (alone, of_seed) =
        (found["logs"][1]["error_mrad"].as_f64().unwrap(), best["held_out_mrad"].as_f64().unwrap());
    assert!((alone / of_seed - 1.0).abs() < 1e-9, "{alone} {of_seed}");
    assert!(folder.path().join("one/report.html").is_file());

    assert!(run("2", "two").status.success());
    let again = document(&folder.path().join("two"));
    for part in ["seeds", "parameters", "train", "held_out", "logs"] {
        assert_eq!(found[part], again[part], "{part}");
    }
}

#[test]
fn logs_that_cannot_be_used_are_refused_in_a_sentence_and_nothing_is_written() {
    let folder = folder();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    let whole = log(200.0).to_string();
    write("cut.json", whole[..whole.len() / 2].to_owned());
    write("nan.json", whole.replacen("\"speed\":1.", "\"speed\":NaN,\"was\":1.", 1));
    let without = |field: &str| {
        let mut log = log(200.0);
        log["entries"][7].as_object_mut().unwrap().remove(field);
        log.to_string()
    };
    write("no_goal.json", without("goal_position"));
    let mut empty = log(200.0);
    empty["entries"] = json!([]);
    write("empty.json", empty.to_string());
    let mut massless = log(200.0);
    massless["mass"] = json!(0.0);
    write("massless.json", massless.to_string());

    let mut still = log(200.0);
    for entry in still["entries"].as_array_mut().unwrap() {
        entry["position"] = json!(0.1);
        entry["speed"] = json!(0.0);
    }
    write("still.json", still.to_string());
    let mut worded = log(200.0);
    worded["entries"][16]["position"] = json!("abc");
    write("worded.json", worded.to_string());

    let mut nameless = log(200.0);
    nameless.as_object_mut().unwrap().remove("motor");
    write("nameless.json", nameless.to_string());
    let mut other = log(200.0);
    other["motor"] = json!("sts3215");
    write("other.json", other.to_string());

    for (args, said) in [
        (&["cut.json"][..], &["cut.json", "line 1"][..]),
        (&["nan.json"], &["nan.json", "line 1"]),
        (&["no_goal.json"], &["no_goal.json", "missing field `goal_position`"]),
        (&["empty.json"], &["empty.json", "`entries` is empty", "record it again"]),
        (&["still.json"], &["still.json", "turns by 0 mrad", "the goal moves by"]),
        (&["worded.json"], &["worded.json", "entry 17", "`position`", "\"abc\""]),
        (&["massless.json"], &["massless.json", "mass"]),
        (&["nowhere.json"], &["nowhere.json"]),
        (&["kp100.json", "empty.json"], &["empty.json"]),
        (&["kp400.json", "--hold-out", "kp=400"], &["every log is held out"]),
        (&["kp100.json", "--hold-out", "trajectory"], &["'trajectory=sine'", "the logs have sine"]),
        (&["kp100.json", "--hold-out", "kp=400"], &["kp=400", "the logs have 100"]),
        (
            &["kp100.json", "--hold-out", "colour=red"],
            &["no log's header has the field", "trajectory"],
        ),
        (&["kp100.json", "--servo", "xl331"], &["no servo `xl331`", "did you mean", "per_unit"]),
        (&["kp100.json", "--servo", "nowhere.yaml"], &["nowhere.yaml"]),
        (&["kp100.json", "--delay", "7"], &["fit, none, or seconds"]),
        (&["nameless.json"], &["nameless.json", "--servo NAME", "--list-servos"]),
        (&["kp100.json", "other.json"], &["several servos", "XL330, sts3215"]),
        (&["kp100.json", "--evaluate", "p.json", "--level", "m1"], &["--evaluate", "--level"]),
        (&["kp100.json", "--evaluate", "kp100.json"], &["kp100.json", "no parameter"]),
        (&["kp100.json", "--hold-out", "hard"], &["--hold-out", "kp=400"]),
        (&["kp100.json", "--level", "m9"], &["m6"]),
    ] {
        let output = command(folder.path(), args).args(["--out", "made"]).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert!(message.starts_with("error: "), "{args:?}: {message}");
        for part in said {
            assert!(message.contains(part), "{args:?}: {message}");
        }
        assert!(!message.contains("panicked"), "{message}");
        assert!(!folder.path().join("made").exists(), "{args:?}");
    }
}

/// A pendulum that swings while it is asked to rest: no servo does this.
#[test]
fn a_fit_that_does_not_follow_its_logs_is_called_a_failure_before_anything_else() {
    let folder = tempfile::tempdir().unwrap();
    let mut swinging = log(200.0);
    for entry in swinging["entries"].as_array_mut().unwrap() {
        entry["goal_position"] = json!(0.0);
        entry["position"] = json!(2.0 * entry["position"].as_f64().unwrap());
    }
    std::fs::write(folder.path().join("swing.json"), swinging.to_string()).unwrap();
    let args = ["swing.json", "--level", "m1", "--seeds", "2", "--evaluations", "300"];
    let output = command(folder.path(), &args).args(["--out", "made"]).output().unwrap();
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(shown.starts_with("FAILED: "), "{shown}");
    assert!(!shown.contains(" identified\n") && !shown.contains("k_t"), "{shown}");
    let found = document(&folder.path().join("made"));
    assert!(found["failure"].as_str().unwrap().contains("mrad"));
    for parameter in found["parameters"].as_array().unwrap() {
        assert_eq!(parameter["verdict"], "not_identifiable", "{parameter}");
    }
}

#[test]
fn given_parameters_are_scored_log_by_log_without_a_fit() {
    let folder = folder();
    let peer = json!({ "kt": 0.37, "R": 3.7, "armature": 0.0018, "friction_base": 0.01,
        "friction_viscous": 0.008, "model": "m1", "actuator": "xl330" });
    std::fs::write(folder.path().join("m1.json"), peer.to_string()).unwrap();
    let args = ["kp100.json", "kp400.json", "--evaluate", "m1.json", "--out", "made"];
    let output = command(folder.path(), &args).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("sine, kp 100") && shown.contains("sine, kp 400"), "{shown}");
    let text = std::fs::read_to_string(folder.path().join("made/evaluation.json")).unwrap();
    let scored: Value = serde_json::from_str(&text).unwrap();
    let logs = scored["logs"].as_array().unwrap();
    let errors: Vec<f64> = logs.iter().map(|log| log["error_mrad"].as_f64().unwrap()).collect();
    // The logs are equally long: the whole is their mean.
    let mean = errors.iter().sum::<f64>() / 2.0;
    assert!((scored["error_mrad"].as_f64().unwrap() / mean - 1.0).abs() < 1e-6, "{scored}");
}

#[test]
fn a_first_look_at_a_log_says_what_it_holds_and_which_command_reads_it() {
    let folder = folder();
    let run = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_frictionlab"));
        command.current_dir(folder.path()).args(args).output().unwrap()
    };
    let output = run(&["look", "kp100.json", "--out", "seen"]);
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for part in ["XL330", "300, 1.555 s at 192 Hz", "frictionlab identify-servo kp100.json"] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    let text = std::fs::read_to_string(folder.path().join("seen/look.json")).unwrap();
    let seen: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&seen["form"], &seen["entries"]), (&json!("servo_log"), &json!(300)));
    // The command for tables names the one for logs.
    let output = run(&["identify", "kp100.json"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && said.contains("identify-servo"), "{said}");
}

#[test]
fn the_servos_that_are_described_are_listed_with_an_example() {
    let output = command(Path::new("."), &["--list-servos"]).output().unwrap();
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success());
    for part in ["xl330", "sts3215", "erob80_100", "current mode", "per_unit"] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
}

/// Ctrl-C, as early as the program hears it.
#[test]
#[cfg(target_os = "linux")]
fn a_change_of_mind_leaves_the_best_so_far() {
    use std::process::Stdio;

    let folder = folder();
    let args =
        ["kp100.json", "kp400.json", "--hold-out", "kp=400", "--level", "m1", "--seeds", "3"];
    let mut child = command(folder.path(), &args)
        .args(["--jobs", "1", "--evaluations", "4000000000", "--out", "made"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !hears_interrupts(child.id()) {
        assert!(child.try_wait().unwrap().is_none(), "ended before the signal");
        std::thread::yield_now();
    }
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("stopped before the end") && said.contains("made"), "{said}");
    let found = document(&folder.path().join("made"));
    assert_eq!(found["stopped"], true);
    // One search was under way, the others had not begun.
    assert_eq!(found["seeds"].as_array().unwrap().len(), 1);
    assert!(found["seeds"][0]["train_mrad"].as_f64().unwrap() > 0.0);
    let page = std::fs::read_to_string(folder.path().join("made/report.html")).unwrap();
    assert!(page.contains("Stopped before the end"));
}

/// Whether the process has a handler for SIGINT: bit 1 of the signals caught (proc(5)).
#[cfg(target_os = "linux")]
fn hears_interrupts(process: u32) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    caught
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask & 0b10 != 0)
}
