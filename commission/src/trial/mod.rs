//! A trial: machines that nobody here has seen, commissioned one after the other in lock-step, on
//! all processors, and what came of it in one table.

mod case;
mod finish;
mod joined;
mod table;
mod told;
mod truth;
mod user;

use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use experiment_runner::protocol::ConstantVelocityProtocol;
use files::write_all;
use machine_rig::{Machine, random};
use rig_setup::RigSetupError;
use work::progress::Progress;

pub use case::{Case, Commissioned, Held, Protocol, case};
pub use finish::Finish;
pub use joined::{TrialPart, join};
pub use table::{Table, table};
pub use told::{Part, PartTable, Told, Verdict};

use crate::friction::wanted::Wanted;
use crate::{CommissionError, Stage};

/// What is tried.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Number of machines.
    pub machines: u32,
    /// Seed of the first; each further one has the next.
    pub seed: u64,
    /// How well the friction is to be known.
    pub wanted: Wanted,
    /// Rig time that each may take \[s\].
    pub allowed: f64,
    /// The fixed protocol that is driven beside it, where one is.
    pub protocol: Option<ConstantVelocityProtocol>,
    /// Threads; the figures do not depend on it.
    pub workers: usize,
}

/// Tries some of them, by their place from 0 on. Each machine's file and results are in `folder`.
///
/// # Errors
/// [`CommissionError`] if something cannot be written, or the user stops it.
pub fn trial(
    trial: &Trial,
    machines: Range<u32>,
    folder: &Path,
    stop: &Arc<AtomicBool>,
    progress: &Progress,
) -> Result<Vec<Case>, CommissionError> {
    let next = AtomicU32::new(machines.start);
    let done: Mutex<Vec<(u32, Result<Case, CommissionError>)>> = Mutex::default();
    std::thread::scope(|scope| {
        for _ in 0..trial.workers.max(1) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= machines.end || stop.load(Ordering::Relaxed) {
                        return;
                    }
                    let machine = random::machine(trial.seed + u64::from(index));
                    let result = one(trial, &machine, folder, stop);
                    progress.advance(1.0);
                    done.lock().unwrap_or_else(PoisonError::into_inner).push((index, result));
                }
            });
        }
    });
    if stop.load(Ordering::Relaxed) {
        return Err(RigSetupError::Stopped.into());
    }
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, case)| case).collect()
}

/// One machine; a panic is what a user would call a crash, and counted as one.
fn one(
    trial: &Trial,
    machine: &Machine,
    folder: &Path,
    stop: &Arc<AtomicBool>,
) -> Result<Case, CommissionError> {
    let name = machine.name.replace(' ', "-");
    let text = machine.text().map_err(|error| CommissionError::Asked(error.to_string()))?;
    write_all(folder, &[(&format!("{name}.json"), text)])?;
    let (file, results) = (folder.join(format!("{name}.json")), folder.join(&name));
    let file = std::path::absolute(&file).unwrap_or(file);
    std::fs::create_dir_all(&results).map_err(|source| {
        CommissionError::Output(files::OutputError::Write { path: results.clone(), source })
    })?;
    let work = || {
        let asked = (&trial.wanted, trial.allowed, trial.protocol.as_ref());
        case(machine, &file, &results, asked, stop)
    };
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        Ok(Case {
            name: machine.name.clone(),
            friction: machine.friction.name().to_string(),
            commissioned: None,
            refused: Some((Stage::Meet, "the program panicked".to_owned())),
            cannot: false,
            rightly: false,
            peaks: machine_rig::peaks(&file.display().to_string()).unwrap_or_default(),
            limits: (0.0, 0.0),
            creeping: 0.0,
        })
    })
}
