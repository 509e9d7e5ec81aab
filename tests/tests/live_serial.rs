//! `frictionlab live` against the emulated rig on a pseudo-terminal.

use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};

use tests::emulated_rig::{EmulatedRig as Rig, said};
use tests::unstarved;

/// A domain for each test: of two nodes of one name in one domain the later does not work.
const DRIVEN: &str = "86";
const UNPLUGGED: &str = "87";
const REFUSED: &str = "88";
const SILENT: &str = "91";

/// `frictionlab live` on the port.
fn live(rig: &Rig, domain: &str, arguments: &[&str]) -> Command {
    let mut command = tests::frictionlab();
    command
        .arg("live")
        .arg(rig.choice())
        .arg("--out")
        .arg(rig.folder().join("live"))
        .args(arguments)
        .env("ROS_DOMAIN_ID", domain)
        .stdin(Stdio::null());
    command
}

#[test]
fn a_live_run_drives_the_device_on_the_port_records_it_and_leaves_it_at_zero_volts() {
    let driven = || {
        let rig = Rig::start(&[]);
        let arguments = ["--duration", "3", "--mode", "position", "--frequency", "2"];
        let output = live(&rig, DRIVEN, &arguments).output().expect("it runs");
        // A machine that is busy elsewhere may starve the line, which ends the run before its time.
        let starved = said(&output).contains("no measurement came from");
        (!starved).then_some((rig, output))
    };
    let Some((rig, output)) = unstarved(driven) else { return };
    let text = said(&output);
    assert!(output.status.success(), "{text}");
    assert!(
        text.contains("rig_emulator (firmware 0.2.0), 1000 us a cycle, at most 6.00 V"),
        "{text}"
    );
    assert!(rig.folder().join("live/bag").join("metadata.yaml").is_file(), "{text}");
    let summary = rig.finish();
    assert!(summary["books"]["commands"].as_u64().expect("a number") > 1500, "{summary}\n{text}");
    assert!(summary["books"]["driven"].as_u64().expect("a number") > 1000, "{summary}\n{text}");
    assert_eq!((&summary["state"], &summary["voltage"]), (&"inactive".into(), &0.into()));
}

#[test]
fn a_cable_pulled_during_a_live_run_ends_it_with_a_sentence_and_a_whole_bag() {
    let underway = || {
        let mut rig = Rig::start(&[]);
        let mut run =
            live(&rig, UNPLUGGED, &["--duration", "60", "--mode", "position", "--frequency", "2"])
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
                .expect("it starts");
        let mut lines = BufReader::new(run.stdout.take().expect("its output")).lines();
        let live = lines.any(|line| line.expect("text").contains("live at"));
        if live && rig.driven_by(&mut run, 300) {
            return Some((rig, run));
        }
        let text = said(&run.wait_with_output().expect("it ends"));
        // As above: a busy machine may starve the line before it is pulled.
        assert!(text.contains("no measurement came from"), "{text}");
        None
    };
    let Some((mut rig, run)) = unstarved(underway) else { return };
    rig.order("unplug 100000");
    let output = run.wait_with_output().expect("it ends");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("is gone") || text.contains("no measurement came"), "{text}");
    assert!(rig.folder().join("live/bag").join("metadata.yaml").is_file(), "{text}");
    let summary = rig.finish();
    assert_eq!(summary["voltage"], 0);
}

/// What ended the cycle before the activation was said in the words of the thread that it ended: "clean
/// the node up", of which a user of `live` has none.
#[test]
fn a_device_that_falls_silent_before_it_is_active_is_named() {
    let mut rig = Rig::start(&[]);
    let mut run = live(&rig, SILENT, &["--duration", "60"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut words = BufReader::new(run.stderr.take().expect("its words"));
    let mut text = String::new();
    while !text.contains("control thread:") && words.read_line(&mut text).expect("text") > 0 {}
    rig.order("hang 100000");
    words.read_to_string(&mut text).expect("text");
    let error = text.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
    // Told by the control thread, or by who waits for it where the device stopped answering while it
    // was being activated.
    let named = ["no measurement came from", "the rig hangs; take its power away"];
    assert!(named.iter().any(|words| error.contains(words)), "{text}");
    assert!(error.contains("zero volts"), "{text}");
    assert_eq!(run.wait().expect("it ends").code(), Some(1), "{text}");
    assert_eq!(rig.finish()["voltage"], 0);
}

/// The later of two runs as one axis would wait for ever for an activation that is not given.
#[test]
fn a_second_run_in_the_same_domain_ends_with_a_sentence_about_the_first() {
    let mut first = tests::frictionlab();
    let folder = tempfile::tempdir().expect("a folder");
    let simulated = |command: &mut Command, seconds: &str, out: &str| {
        command.args(["live", "--duration", seconds, "--out"]).arg(folder.path().join(out));
        command.env("ROS_DOMAIN_ID", "89").stdin(Stdio::null());
    };
    // On a busy machine the others take long to begin.
    simulated(&mut first, "600", "first");
    let mut first = first.stdout(Stdio::piped()).spawn().expect("it starts");
    let mut lines = BufReader::new(first.stdout.take().expect("its output")).lines();
    while !lines.next().expect("it says that it is live").expect("text").contains("live at") {}
    // Of two that begin within a second both may give way: a run elsewhere takes longer.
    let mut elsewhere = tests::frictionlab();
    elsewhere.args(["live", "--duration", "1.5", "--out"]).arg(folder.path().join("elsewhere"));
    let output =
        elsewhere.env("ROS_DOMAIN_ID", "90").stdin(Stdio::null()).output().expect("it runs");
    assert!(output.status.success(), "{}", said(&output));
    let mut second = tests::frictionlab();
    simulated(&mut second, "60", "second");
    let output = second.output().expect("it runs");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("another node /rig_driver was there before"), "{text}");
    assert!(first.try_wait().expect("it can be asked").is_none(), "the first goes on");
    first.kill().expect("it is there");
    first.wait().expect("it ends");
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
    refused(live(&rig, REFUSED, &["--rate", "500", "--duration", "1"]), "leave --rate out");
    assert!(!rig.folder().join("live/bag").exists());
    for (choice, sentence) in [
        ("serial:/dev/no-such-port", "cannot open the serial port /dev/no-such-port"),
        ("serial:", "PORT[@BAUD] is missing"),
        ("serial:/dev/ttyACM0@fast", "no baud rate"),
        ("imagined", "serial:PORT[@BAUD] as in"),
    ] {
        let mut command = tests::frictionlab();
        command.args(["live", "--duration", "1", "--rig", choice]).stdin(Stdio::null());
        refused(command, sentence);
    }
    rig.finish();
    let foreign = Rig::start(&["--speak-version", "3"]);
    refused(live(&foreign, REFUSED, &["--duration", "1"]), "speaks version 3 of the protocol");
    foreign.finish();
}
