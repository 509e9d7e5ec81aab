//! The emulated rig on a pseudo-terminal, for tests that drive it.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Output, Stdio};
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;

/// Experiment 1 in a quarter of a minute: eight points, each driven for 1700 cycles at 1 kHz.
pub const SHORT_PROTOCOL: &str = "experiment: constant-velocity
velocities:
  - {from: 0.3 rad/s, to: 3 rad/s, points: 8}
duration: 1.7 s
drop_first: 1 s
drop_last: 0.1 s
repetitions: 1
sets: 1
";

/// The emulator, its port, and a folder for the results.
pub struct EmulatedRig {
    process: Child,
    orders: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    folder: TempDir,
}

impl EmulatedRig {
    /// Starts the emulator with `arguments` and waits for its port.
    ///
    /// # Panics
    /// If it does not start.
    #[must_use]
    pub fn start(arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let mut process = crate::rig_emulator()
            .args(["--until-eof", "--link"])
            .arg(folder.path().join("port"))
            .arg("--summary")
            .arg(folder.path().join("summary.json"))
            .args(arguments)
            // It is announced there, and not among the rigs of whoever runs the tests.
            .env("XDG_RUNTIME_DIR", folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the emulator starts");
        let mut ready = String::new();
        let mut answers = BufReader::new(process.stdout.take().expect("its output"));
        answers.read_line(&mut ready).expect("its first line");
        assert!(ready.starts_with("ready "), "{ready}");
        let orders = process.stdin.take();
        Self { process, orders, answers, folder }
    }

    /// A folder that lives as long as the emulator.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The option that chooses this rig.
    #[must_use]
    pub fn choice(&self) -> String {
        format!("--rig={}", self.name())
    }

    /// What names this rig, as in `serial:/dev/ttyACM0`.
    #[must_use]
    pub fn name(&self) -> String {
        format!("serial:{}", self.folder.path().join("port").display())
    }

    /// Gives the emulator an order.
    ///
    /// # Panics
    /// If it does not listen any more.
    pub fn order(&mut self, order: &str) {
        writeln!(self.orders.as_mut().expect("its input"), "{order}")
            .expect("the emulator listens");
    }

    /// Waits until one of the device's books says at least `least`: `cycles` it has gone through,
    /// `driven` of them with volts.
    ///
    /// # Panics
    /// If the emulator does not answer.
    pub fn wait_for(&mut self, book: &str, least: u64) {
        while self.book(book) < least {
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Waits until the motor had volts in `least` cycles; false if `driver` has ended before.
    ///
    /// # Panics
    /// If the emulator does not answer.
    pub fn driven_by(&mut self, driver: &mut Child, least: u64) -> bool {
        while self.book("driven") < least {
            if driver.try_wait().expect("its end").is_some() {
                return false;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        true
    }

    /// Everything that the device tells of itself.
    ///
    /// # Panics
    /// If the emulator does not answer.
    pub fn status(&mut self) -> Value {
        self.order("status");
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("an answer");
        serde_json::from_str(&line).expect("JSON")
    }

    /// One of the device's books.
    ///
    /// # Panics
    /// If the emulator does not answer, or has no such book.
    pub fn book(&mut self, book: &str) -> u64 {
        self.status()["books"][book].as_u64().expect("a number")
    }

    /// Waits until the device has gone through `cycles` more cycles of its own clock. Returns what
    /// it tells then.
    ///
    /// # Panics
    /// If the emulator does not answer.
    pub fn pass(&mut self, cycles: u64) -> Value {
        let end = self.book("cycles") + cycles;
        self.wait_for("cycles", end);
        self.status()
    }

    /// Ends the emulator. Returns its books, in which nothing was driven that should not have been.
    ///
    /// # Panics
    /// If something was.
    pub fn finish(mut self) -> Value {
        // The driver's last words are on the line; the device reads them in its next cycle.
        self.pass(5);
        drop(self.orders.take());
        assert!(self.process.wait().expect("it ends").success());
        let text =
            std::fs::read_to_string(self.folder.path().join("summary.json")).expect("a summary");
        let summary: Value = serde_json::from_str(&text).expect("JSON");
        let books = &summary["books"];
        assert_eq!(books["driven_without_permission"], 0, "{summary}");
        let limit = summary["validity_limit_cycles"].as_u64().expect("a limit");
        assert!(
            books["longest_drive_after_a_command"].as_u64().expect("a number") <= limit,
            "{summary}"
        );
        summary
    }
}

/// Everything a program printed.
#[must_use]
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}
