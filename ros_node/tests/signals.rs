//! A signal ends a program whatever is stuck, and what is to be done before is done.

use std::{
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    thread,
    time::{Duration, Instant},
};

use rustix::process::{Pid, Signal, kill_process};

const PATIENCE: Duration = Duration::from_secs(60);
/// Variables of the environment: the file that the last act makes, and the time in which the
/// program says it ends \[s\].
const FILE: &str = "ACTED";
const WITHIN: &str = "WITHIN";

/// A program that never ends by itself, with an act that hangs beside the one that makes the file.
#[test]
#[ignore = "never ends: run by the tests below"]
fn stuck() {
    let file = PathBuf::from(std::env::var_os(FILE).unwrap());
    ros_node::ends_within(Duration::from_secs(std::env::var(WITHIN).unwrap().parse().unwrap()));
    let stop = ros_node::Stop::on_signals().unwrap();
    ros_node::before_forced_exit(|| thread::sleep(Duration::from_secs(3600)));
    ros_node::before_forced_exit(move || std::fs::write(&file, "acted").unwrap());
    println!("\nready");
    while !stop.wait(Duration::from_secs(3600)) {}
    println!("\nwished");
    loop {
        thread::sleep(Duration::from_secs(3600));
    }
}

struct Stuck {
    child: Child,
    folder: PathBuf,
}

impl Stuck {
    fn start(name: &str, within: &str) -> Self {
        let folder =
            std::env::temp_dir().join(format!("frictionlab-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--ignored", "--exact", "stuck", "--nocapture"])
            .env(FILE, folder.join("acted"))
            .env(WITHIN, within)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.as_mut().unwrap()).lines();
        assert!(lines.any(|line| line.unwrap() == "ready"));
        Self { child, folder }
    }

    fn signal(&self) {
        kill_process(Pid::from_child(&self.child), Signal::INT).unwrap();
    }

    fn end(&mut self) -> ExitStatus {
        let began = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(began.elapsed() < PATIENCE, "it does not end");
            thread::sleep(Duration::from_millis(5));
        }
    }

    fn acted(&self) -> bool {
        Path::new(&self.folder).join("acted").exists()
    }
}

impl Drop for Stuck {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

#[test]
fn one_signal_ends_a_stuck_program_when_its_time_is_over() {
    let mut stuck = Stuck::start("deadline", "1");
    let began = Instant::now();
    stuck.signal();
    assert_eq!(stuck.end().code(), Some(i32::from(ros_node::FORCED)));
    assert!(began.elapsed() >= Duration::from_secs(1), "it had its time");
    assert!(stuck.acted());
}

#[test]
fn a_second_signal_ends_a_stuck_program_at_once() {
    let mut stuck = Stuck::start("second", "3600");
    // However long the machine takes for the first: one of the next is the second.
    let mut told = 0;
    let began = Instant::now();
    while stuck.child.try_wait().unwrap().is_none() {
        stuck.signal();
        told += 1;
        assert!(began.elapsed() < PATIENCE, "{told} signals and no end");
        thread::sleep(Duration::from_millis(300));
    }
    assert_eq!(stuck.end().code(), Some(i32::from(ros_node::FORCED)));
    assert!(told >= 2 && stuck.acted());
}
