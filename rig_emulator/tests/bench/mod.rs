//! A running emulator, and what its books say.

// Every test file is a program of its own and uses a part of this.
#![allow(dead_code, reason = "shared by several test programs")]

use std::{
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    time::Duration,
};

use rig_driver::{
    Measurement, Rig, RigError,
    serial::{Cause, SerialError, SerialOptions, SerialRig},
};
use serde_json::Value;

/// The emulator as a process of its own, on a pseudo-terminal.
pub struct Bench {
    process: Child,
    orders: ChildStdin,
    answers: BufReader<ChildStdout>,
    _folder: tempfile::TempDir,
    path: PathBuf,
    options: SerialOptions,
}

impl Bench {
    /// Starts the emulator with `arguments`, and has it wait for its host for so long that no busy
    /// machine makes it give up.
    pub fn start_patient(arguments: &[&str]) -> Self {
        let patience = ["--validity-limit", "1000000", "--host-timeout", "5000000"];
        let bench = Self::start(&[&patience, arguments].concat());
        Self { options: SerialOptions { validity: 1.0, ..patient() }, ..bench }
    }

    /// Starts the emulator with `arguments`.
    pub fn start(arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("port");
        let mut process = Command::new(env!("CARGO_BIN_EXE_rig_emulator"))
            .args(["--until-eof", "--link"])
            .arg(&path)
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the emulator starts");
        let orders = process.stdin.take().expect("its input");
        let mut answers = BufReader::new(process.stdout.take().expect("its output"));
        let mut ready = String::new();
        answers.read_line(&mut ready).expect("its first line");
        assert_eq!(ready.trim(), format!("ready {}", path.display()));
        Self { process, orders, answers, _folder: folder, path, options: patient() }
    }

    /// The port.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Opens the port and says hello. Where another test starts a program at this moment, its copy
    /// of this process holds a port that was just closed until it has become that program.
    pub fn open(&self) -> SerialRig {
        for _ in 0..100 {
            match SerialRig::open(&self.path, self.options) {
                Err(SerialError::Busy { .. }) => std::thread::sleep(Duration::from_millis(20)),
                other => return other.expect("the emulator answers"),
            }
        }
        panic!("the port stays busy")
    }

    /// Gives an order.
    pub fn order(&mut self, order: &str) {
        writeln!(self.orders, "{order}")
            .and_then(|()| self.orders.flush())
            .expect("the emulator listens");
    }

    /// The books so far.
    pub fn status(&mut self) -> Value {
        self.order("status");
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("an answer");
        serde_json::from_str(&line).expect("JSON")
    }

    /// Waits until the device has gone through `cycles` more cycles, on its own clock. Returns the
    /// books then.
    pub fn pass(&mut self, cycles: u64) -> Value {
        let end = self.status()["books"]["cycles"].as_u64().expect("a number") + cycles;
        loop {
            let status = self.status();
            if status["books"]["cycles"].as_u64().expect("a number") >= end {
                return status;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Ends the emulator. Returns the books, in which the motor has never had a voltage that it
    /// should not have had.
    pub fn finish(mut self) -> Value {
        let status = self.status();
        drop(self.orders);
        assert!(self.process.wait().expect("it ends").success());
        assert_safe(&status);
        status
    }
}

/// The promise: no voltage without permission, none beyond the validity.
pub fn assert_safe(status: &Value) {
    let books = &status["books"];
    assert_eq!(books["driven_without_permission"], 0, "{books}");
    let limit = status["validity_limit_cycles"].as_u64();
    assert!(limit.is_some());
    // A voltage may stand in the cycle in which its validity ends; in the next it is zero.
    assert!(books["longest_drive_after_a_measurement"].as_u64() <= limit, "{books}");
    assert!(books["longest_drive_after_a_command"].as_u64() <= limit, "{books}");
}

/// Options for a machine that may be busy with other tests: nothing hangs on how long it takes.
pub fn patient() -> SerialOptions {
    SerialOptions { answer: 20.0, silence: 5.0, ..SerialOptions::default() }
}

/// One cycle with `volts`. A host that a busy machine held up is silent for too long: the device is
/// then activated again, as often as it takes.
pub fn cycle(rig: &mut SerialRig, volts: f64) -> Result<Measurement, RigError> {
    for _ in 0..1000 {
        rig.wait()?;
        let seen = rig.measure();
        match rig.apply(volts) {
            Ok(_) => return Ok(seen),
            Err(RigError::Serial(SerialError::NotActive { cause: Cause::HostLost, .. })) => {
                rig.activate()?;
            }
            Err(other) => return Err(other),
        }
    }
    panic!("the machine is too busy for 1000 cycles in turn");
}

/// Cycles with `volts` until something goes wrong; what did.
pub fn drive_until_trouble(rig: &mut SerialRig, volts: f64) -> SerialError {
    for _ in 0..100_000 {
        match cycle(rig, volts) {
            Ok(_) => {}
            Err(RigError::Serial(error)) => return error,
            Err(other) => panic!("{other}"),
        }
    }
    panic!("nothing went wrong in 100000 cycles");
}

/// Cycles until one succeeds: the line is back.
pub fn wait_for_line(rig: &mut SerialRig) -> Measurement {
    for _ in 0..100 {
        if rig.wait().is_ok() {
            return rig.measure();
        }
    }
    panic!("the line does not come back");
}
