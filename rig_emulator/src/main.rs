//! `rig_emulator`: the simulated rig behind the serial protocol, on a pseudo-terminal, in real
//! time, with faults on demand.
//!
//! It is what a microcontroller with a motor is to the driver: the same device state machine
//! (`rig_protocol::Device`), the simulated test bed in the motor's place, and its own books
//! ([`books`]) on what voltage the motor had when.

mod books;
mod control;
mod emulator;
mod line;
mod options;
mod terminal;

use std::{
    io::Write,
    process::ExitCode,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use anyhow::Context;
use clap::Parser;

use emulator::Emulator;
use options::Options;
use rig_driver::emulated::{self, Announcement};

fn main() -> anyhow::Result<ExitCode> {
    let options = Options::parse();
    let stop = Arc::new(AtomicBool::new(false));
    let told = Arc::clone(&stop);
    ctrlc::set_handler(move || told.store(true, Ordering::Relaxed))
        .context("cannot watch for ctrl-C")?;
    let mut emulator = Emulator::new(&options)?;
    let orders = control::listen();
    // A rig that cannot be announced runs all the same; it is only not listed.
    let _announced = emulated::folder().and_then(|folder| {
        let announced = Announcement::new(&folder, emulator.path());
        announced
            .inspect_err(|error| {
                eprintln!(
                    "`frictionlab rig list` will not show this rig: {}: {error}",
                    folder.display()
                )
            })
            .ok()
    });
    say(&format!("ready {}", emulator.path().display()));
    emulator.run(&orders, &stop)?;
    let summary = serde_json::to_string_pretty(&emulator.summary()).context("the summary")?;
    let Some(file) = &options.summary else {
        say(&summary);
        return Ok(ExitCode::SUCCESS);
    };
    Ok(match std::fs::write(file, format!("{summary}\n")) {
        Ok(()) => ExitCode::SUCCESS,
        // The folder may be gone by now; what is in the summary is not.
        Err(error) => {
            eprintln!(
                "error: {} cannot be written: {error}; the summary goes to standard output",
                file.display()
            );
            say(&summary);
            ExitCode::FAILURE
        }
    })
}

/// A line on standard output. Nobody listening is no reason to stop the motor's simulation.
fn say(line: &str) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{line}").and_then(|()| out.flush());
}
