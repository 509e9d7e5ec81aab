//! `frictionlab live` and `serve` that were stopped and continued: the middleware's threads do not
//! survive it.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use tests::network::namespaced;

/// Longest wait for a line or an end.
const PATIENCE: Duration = Duration::from_secs(60);
/// Waits of the thread that looks after the middleware until it knows all of the middleware's
/// threads: several times those of its first looks.
const SETTLED: u64 = 30;

/// `frictionlab` in a namespace of its own, and the lines that it prints.
fn start(arguments: &[&str], folder: &Path) -> (Child, Receiver<String>) {
    let mut child = namespaced()
        .arg(tests::frictionlab().get_program())
        .args(arguments)
        .current_dir(folder)
        .env("ROS_DOMAIN_ID", "76")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("unshare starts");
    let (tell, lines) = channel();
    let output = BufReader::new(child.stdout.take().expect("its output is ours"));
    thread::spawn(move || {
        output.lines().map_while(Result::ok).try_for_each(|line| tell.send(line))
    });
    (child, lines)
}

fn wait_for(lines: &Receiver<String>, part: &str) {
    loop {
        let line = lines.recv_timeout(PATIENCE).unwrap_or_else(|_| panic!("nothing said `{part}`"));
        if line.contains(part) {
            return;
        }
    }
}

fn signal(child: &Child, name: &str) {
    let status =
        Command::new("kill").args([name, &child.id().to_string()]).status().expect("kill starts");
    assert!(status.success());
}

/// Waits until the condition holds.
fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let began = Instant::now();
    while !holds() {
        assert!(began.elapsed() < PATIENCE, "{what}");
        thread::sleep(Duration::from_millis(10));
    }
}

/// How often the thread that looks after the middleware has waited; none if there is no such
/// thread.
fn looks(child: &Child) -> Option<u64> {
    let tasks = fs::read_dir(format!("/proc/{}/task", child.id())).ok()?;
    let watcher = tasks.flatten().map(|task| task.path()).find(|task| {
        fs::read_to_string(task.join("comm")).is_ok_and(|name| name.trim() == "middleware")
    })?;
    let status = fs::read_to_string(watcher.join("status")).ok()?;
    let waits = status.lines().find_map(|line| line.strip_prefix("voluntary_ctxt_switches:"))?;
    waits.trim().parse().ok()
}

fn is_stopped(child: &Child) -> bool {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    status.lines().any(|line| line.starts_with("State:") && line.contains('T'))
}

fn pause(child: &Child) {
    until("the program looks after its middleware", || looks(child) > Some(SETTLED));
    signal(child, "-STOP");
    until("it stops", || is_stopped(child));
    signal(child, "-CONT");
}

#[tests::needs(namespace)]
#[test]
fn live_ends_with_the_motor_at_rest_and_its_bag_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["live", "--duration", "300", "--out", "run"];
    let (mut child, lines) = start(&arguments, folder.path());
    wait_for(&lines, "live at");
    pause(&child);
    let mut said = String::new();
    child.stderr.take().expect("its errors are ours").read_to_string(&mut said).expect("text");
    assert_eq!(child.wait().expect("it ends").code(), Some(1), "{said}");
    assert!(said.contains("middleware") && said.contains("zero volts"), "{said}");
    let bag = folder.path().join("run/bag");
    assert!(bag.join("metadata.yaml").is_file());
    let info =
        tests::frictionlab().args(["bag", "info"]).arg(&bag).output().expect("frictionlab starts");
    assert!(info.status.success(), "{}", String::from_utf8_lossy(&info.stderr));
}

#[tests::needs(namespace)]
#[test]
fn serve_begins_anew() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut child, lines) = start(&["serve"], folder.path());
    wait_for(&lines, "experiment_runner is ready");
    pause(&child);
    wait_for(&lines, "starts anew");
    wait_for(&lines, "experiment_runner is ready");
    signal(&child, "-INT");
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
}
