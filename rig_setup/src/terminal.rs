//! What a person sees while a rig is set up.

use std::fmt::Write as _;
use std::io::{self, IsTerminal, Write};

use rig_driver::Measurement;

use super::Findings;

/// All channels in one line that is written over ten times a second; a line every half second where
/// the output is no terminal.
#[derive(Debug)]
pub struct Display {
    every: f64,
    next: f64,
    terminal: bool,
    shown: bool,
}

impl Default for Display {
    fn default() -> Self {
        let terminal = io::stderr().is_terminal();
        // The first cycle shows what was before.
        let every = if terminal { 0.1 } else { 0.5 };
        Self { every, next: every, terminal, shown: false }
    }
}

impl Display {
    /// Shows the readings, if it is time.
    pub fn show(&mut self, seen: &Measurement) {
        if seen.time < self.next {
            return;
        }
        self.next = seen.time + self.every;
        self.shown = true;
        let (begin, end) = if self.terminal { ("\r", "\x1b[K") } else { ("", "\n") };
        // A terminal that went away stops nothing.
        let _ = write!(io::stderr().lock(), "{begin}{}{end}", channels(seen));
    }

    /// Ends the line.
    pub fn end(&mut self) {
        if self.shown && self.terminal {
            let _ = writeln!(io::stderr().lock());
        }
        self.shown = false;
    }
}

/// Every channel in a line.
fn channels(seen: &Measurement) -> String {
    let mut text = format!(
        "{:8.2} s  {:+6.2} V  encoder {:+8} = {:+8.3} rad  tachometer {:+7.3} rad/s  potentiometer {:+7.3} rad  torque {:+7.4} N m",
        seen.time,
        seen.voltage_applied,
        seen.encoder_counts,
        seen.encoder_position,
        seen.tachometer_velocity,
        seen.potentiometer_position,
        seen.torque
    );
    if let Some(current) = seen.motor_current {
        // Writing to a string cannot fail.
        let _ = write!(text, "  current {current:+6.3} A");
    }
    for (flag, name) in
        [(seen.saturated, "cut"), (seen.watchdog_expired, "watchdog"), (seen.fault, "FAULT")]
    {
        if flag {
            text += "  ";
            text += name;
        }
    }
    text
}

/// The judgement as a table.
#[must_use]
pub fn findings_table(found: &Findings) -> String {
    let mut text =
        String::from("  voltage [V]  encoder [rad/s]  tachometer [rad/s]  torque [N m]\n");
    for level in &found.levels {
        let _ = writeln!(
            text,
            "  {:+11.2}  {:+15.3}  {:+18.3}  {:+12.4}",
            level.volts, level.velocity, level.tachometer, level.torque
        );
    }
    text.push('\n');
    for verdict in found.verdicts() {
        let said =
            verdict.wrong.as_deref().map_or("ok".to_owned(), |wrong| format!("WRONG: {wrong}"));
        let _ = writeln!(text, "  {:<19} {:<24} {said}", verdict.what, verdict.found);
    }
    text
}
