//! `frictionlab live` against the emulated rig on a pseudo-terminal.

use std::{
    io::{BufRead, BufReader, Write},
    path::PathBuf,
    process::{Child, ChildStdin, Command, Output, Stdio},
};

use serde_json::Value;
use tempfile::TempDir;

/// The emulator, its port, and the folder of both.
struct Rig {
    process: Child,
    orders: Option<ChildStdin>,
    folder: TempDir,
}

impl Rig {
    fn start(arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let mut process = tests::rig_emulator()
            .args(["--until-eof", "--link"])
            .arg(folder.path().join("port"))
            .arg("--summary")
            .arg(folder.path().join("summary.json"))
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the emulator starts");
        let mut ready = String::new();
        let mut out = BufReader::new(process.stdout.take().expect("its output"));
        out.read_line(&mut ready).expect("its first line");
        assert!(ready.starts_with("ready "), "{ready}");
        let orders = process.stdin.take();
        Self { process, orders, folder }
    }

    fn bag(&self) -> PathBuf {
        self.folder.path().join("live/bag")
    }

    /// `frictionlab live` on the port.
    fn live(&self, arguments: &[&str]) -> Command {
        let mut command = tests::frictionlab();
        command
            .arg("live")
            .arg(format!("--rig=serial:{}", self.folder.path().join("port").display()))
            .arg("--out")
            .arg(self.folder.path().join("live"))
            .args(arguments)
            // Beside other tests of this machine.
            .env("ROS_DOMAIN_ID", "87")
            .stdin(Stdio::null());
        command
    }

    /// Ends the emulator. Returns its books, in which nothing was driven that should not have been.
    fn finish(mut self) -> Value {
        drop(self.orders.take());
        assert!(self.process.wait().expect("it ends").success());
        let text = std::fs::read_to_string(self.folder.path().join("summary.json")).expect("a summary");
        let summary: Value = serde_json::from_str(&text).expect("JSON");
        let books = &summary["books"];
        assert_eq!(books["driven_without_permission"], 0, "{summary}");
        let limit = summary["validity_limit_cycles"].as_u64().expect("a limit");
        assert!(books["longest_drive_after_a_command"].as_u64().expect("a number") <= limit, "{summary}");
        summary
    }
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

#[test]
fn a_live_run_drives_the_device_on_the_port_records_it_and_leaves_it_at_zero_volts() {
    let rig = Rig::start(&[]);
    let output =
        rig.live(&["--duration", "3", "--mode", "position", "--frequency", "2"]).output().expect("it runs");
    let text = said(&output);
    assert!(output.status.success(), "{text}");
    assert!(text.contains("rig_emulator (firmware 0.1.0), 1000 us a cycle, at most 6.00 V"), "{text}");
    assert!(rig.bag().join("metadata.yaml").is_file(), "{text}");
    let summary = rig.finish();
    assert!(summary["books"]["commands"].as_u64().expect("a number") > 1500, "{summary}\n{text}");
    assert!(summary["books"]["driven"].as_u64().expect("a number") > 1000, "{summary}\n{text}");
    assert_eq!((&summary["state"], &summary["voltage"]), (&"inactive".into(), &0.into()));
}

#[test]
fn a_cable_pulled_during_a_live_run_ends_it_with_a_sentence_and_a_whole_bag() {
    let mut rig = Rig::start(&[]);
    let mut run = rig
        .live(&["--duration", "60", "--mode", "position", "--frequency", "2"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut lines = BufReader::new(run.stdout.take().expect("its output")).lines();
    while !lines.next().expect("it says that it is live").expect("text").contains("live at") {}
    std::thread::sleep(std::time::Duration::from_millis(500));
    writeln!(rig.orders.as_mut().expect("its input"), "unplug 100000").expect("the emulator listens");
    let output = run.wait_with_output().expect("it ends");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("is gone") || text.contains("no measurement came"), "{text}");
    assert!(rig.bag().join("metadata.yaml").is_file(), "{text}");
    let summary = rig.finish();
    assert_eq!(summary["voltage"], 0);
}

#[test]
fn rigs_that_cannot_be_driven_end_with_exit_code_2_and_leave_nothing_behind() {
    let rig = Rig::start(&[]);
    let refused = |mut command: Command, sentence: &str| {
        let output = command.output().expect("it runs");
        let text = said(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(sentence), "{text}");
    };
    refused(rig.live(&["--rate", "500", "--duration", "1"]), "leave --rate out");
    assert!(!rig.bag().exists());
    for (choice, sentence) in [
        ("serial:/dev/no-such-port", "cannot open the serial port /dev/no-such-port"),
        ("serial:", "wants a port"),
        ("serial:/dev/ttyACM0@fast", "no baud rate"),
        ("imagined", "`simulated` or `serial:PORT`"),
    ] {
        let mut command = tests::frictionlab();
        command.args(["live", "--duration", "1", "--rig", choice]).stdin(Stdio::null());
        refused(command, sentence);
    }
    rig.finish();
    let foreign = Rig::start(&["--speak-version", "3"]);
    refused(foreign.live(&["--duration", "1"]), "speaks version 3 of the protocol");
    foreign.finish();
}
