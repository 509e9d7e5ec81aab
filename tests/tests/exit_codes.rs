//! The exit codes of `frictionlab` (docs/reference/exit-codes.md), one test a class: the built
//! program, as a person runs it.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tests::emulated_rig::{EmulatedRig, SHORT_PROTOCOL, said};

/// Runs `frictionlab` in `folder`.
fn frictionlab(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = tests::frictionlab();
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).output().expect("it runs")
}

/// The same where no file grows beyond `kibibytes`, as on a disk that is full.
fn with_little_room(folder: &Path, kibibytes: u32, arguments: &[&str]) -> Output {
    let limited = format!("ulimit -f {kibibytes}; trap '' XFSZ; exec \"$@\"");
    Command::new("bash")
        .args(["-c", &limited, "--"])
        .arg(tests::frictionlab().get_program())
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .expect("bash runs")
}

/// Names of everything in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let name = |entry: fs::DirEntry| entry.file_name().into_string().expect("text");
    let mut names: Vec<_> = entries.map(|entry| name(entry.expect("an entry"))).collect();
    names.sort();
    names
}

/// A recording of an axis with friction, one second at 1 kHz, and its motion alone.
fn recording(folder: &Path) {
    let mut text = String::from("t_s,position_m,force_N\n");
    let mut motion = String::from("t_s,velocity_rad_s\n");
    for n in 0..1000 {
        let t = f64::from(n) * 1e-3;
        let (sine, cosine) = (6.0 * t).sin_cos();
        let force = 0.3 * cosine.signum() + 0.8 * cosine - 6.0 * sine;
        text += &format!("{t:.3},{:.9},{force:.9}\n", sine / 6.0);
        motion += &format!("{t:.3},{cosine:.9}\n");
    }
    fs::write(folder.join("motion.csv"), motion).expect("a motion");
    fs::write(folder.join("axis.csv"), text).expect("a recording");
}

#[test]
fn what_is_done_ends_with_0() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = frictionlab(folder.path(), &["models"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
}

/// An option, a file, a folder, a rig, a value: each in a command that would write or move.
#[test]
fn wrong_input_ends_with_2_and_nothing_is_written() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = root.path();
    recording(folder);
    fs::write(folder.join("no-recording.csv"), "t_s\n").expect("a file");
    fs::write(folder.join("protocol.yaml"), "experiment: dance\n").expect("a file");
    fs::create_dir(folder.join("taken")).expect("a folder");
    fs::write(folder.join("taken/mine"), "").expect("a file");
    let before = names(folder);
    for (arguments, sentence) in [
        (&["run", "--no-such-option"][..], "--no-such-option"),
        (&["run", "--out", "taken"], "is not empty"),
        (&["run", "--out", "axis.csv/below"], "cannot be written"),
        (&["run", "--parameters", "no-such.yaml"], "no-such.yaml"),
        (&["run", "--protocol", "protocol.yaml"], "dance"),
        (&["run", "--rig", "serial:/no/such/port"], "cannot open the serial port"),
        (&["run", "--rig", "serial:axis.csv"], "is no serial port"),
        (&["run", "--voltage-limit", "50"], "--voltage-limit"),
        (&["run", "--resume", "taken"], "cannot be resumed"),
        (&["rig", "jog", "--rig", "serial:/no/such/port", "--volts", "1"], "cannot open"),
        (&["rig", "jog", "--volts", "100"], "--volts must be"),
        (&["identify", "no-such.csv"], "no-such.csv cannot be read"),
        (&["identify", "no-recording.csv"], "has no column"),
        (&["identify", "axis.csv", "--out", "taken"], "is not empty"),
        (&["bag", "info", "no-such-bag"], "no-such-bag"),
        (&["bag", "info", "axis.csv"], "is not an MCAP file"),
        (&["bag", "to-csv", "taken"], "holds no bag"),
    ] {
        let output = frictionlab(folder, arguments);
        let text = said(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains(sentence), "{arguments:?}: {text}");
        assert_eq!(names(folder), before, "{arguments:?} left something");
    }
    assert_eq!(names(&folder.join("taken")), ["mine"]);
}

#[test]
fn a_full_disk_ends_with_1() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = root.path();
    recording(folder);
    fs::write(folder.join("protocol.yaml"), SHORT_PROTOCOL).expect("a protocol");
    for (arguments, room) in [
        // The bag, while it is written.
        (&["run", "--protocol", "protocol.yaml", "--out", "run"][..], 8),
        // A report, once everything is known.
        (&["identify", "axis.csv", "--out", "identified"], 2),
        // The one file of a command.
        (&["simulate", "--model", "lugre", "--velocity", "motion.csv", "--out", "friction.csv"], 2),
    ] {
        let output = with_little_room(folder, room, arguments);
        let text = said(&output);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {text}");
        assert!(text.contains("written"), "{arguments:?}: {text}");
    }
}

/// Whatever the system says then: the run had begun, and no other input would mend it.
#[test]
fn a_run_whose_results_cannot_be_written_ends_with_1() {
    let root = tempfile::tempdir().expect("a folder");
    let out = root.path().join("out");
    fs::write(root.path().join("protocol.yaml"), SHORT_PROTOCOL).expect("a protocol");
    let child = tests::frictionlab()
        .args(["run", "--protocol", "protocol.yaml", "--real-time", "--out", "out"])
        .current_dir(root.path())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    while !out.join("journal.jsonl").is_file() {
        std::thread::yield_now();
    }
    // In the way of a file.
    fs::create_dir(out.join("report.html")).expect("a folder");
    let output = child.wait_with_output().expect("it ends");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("report.html cannot be written"), "{text}");
}

/// A jog of the emulated rig, disturbed once it moves.
fn disturbed(disturb: impl Fn(&mut EmulatedRig, u32)) -> Output {
    let mut last = None;
    // A machine that is busy elsewhere may starve the line, which ends the jog before its time.
    for _ in 0..10 {
        let mut rig = EmulatedRig::start(&[]);
        let mut child = tests::frictionlab()
            .args(["rig", "jog", "--rig", &rig.name(), "--volts", "0.5", "--seconds", "60"])
            .current_dir(rig.folder())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        let driven = rig.driven_by(&mut child, 100);
        if driven {
            disturb(&mut rig, child.id());
        }
        let output = child.wait_with_output().expect("it ends");
        // Where the line is gone, the device's own watch puts the motor at zero volts.
        rig.pass(1000);
        assert_eq!(rig.finish()["voltage"], 0);
        let starved = said(&output).contains("no measurement came from");
        if driven && !starved {
            return output;
        }
        last = Some(output);
    }
    panic!("no jog of ten came as far as the disturbance: {last:?}");
}

#[test]
fn a_rig_that_is_lost_or_faulted_ends_with_1() {
    for (order, sentence) in
        [("unplug 100000", "is gone"), ("fault", "a fault of the motor's driver stage")]
    {
        let output = disturbed(|rig, _| rig.order(order));
        let text = said(&output);
        assert_eq!(output.status.code(), Some(1), "{order}: {text}");
        assert!(text.contains(sentence), "{order}: {text}");
    }
}

#[test]
fn each_signal_ends_with_its_code() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let output = disturbed(|_, process| {
            let killed = Command::new("kill")
                .args([format!("-{signal}"), process.to_string()])
                .status()
                .expect("kill");
            assert!(killed.success(), "no SIG{signal}");
        });
        assert_eq!(output.status.code(), Some(code), "SIG{signal}: {}", said(&output));
    }
}

#[test]
fn the_page_has_every_code() {
    let page = tests::checkout().join("docs/reference/exit-codes.md");
    let page = fs::read_to_string(page).expect("the page");
    for code in [0, 1, 2, 129, 130, 143] {
        assert!(page.lines().any(|line| line.starts_with(&format!("| {code} |"))), "{code}");
    }
}
