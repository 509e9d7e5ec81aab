//! Identification of a position-controlled servo from logs: what `frictionlab identify-servo` does
//! between reading and printing.
//!
//! [`identify`] searches from several seeds, in parallel, and compares the results; [`document`] is
//! the JSON, [`page`] the HTML, [`terminal`] the text.

pub mod document;
pub mod page;
pub mod terminal;

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use friction_ident::servo::{
    Effort, Found, FrictionLevel, Lanes, Physics, ServoLog, estimates, search,
};
use friction_ident::statistics::Quartiles;
use friction_ident::{Estimates, IdentError};

use recording::servo_log::NamedServoLog;
use work::progress::Progress;
use work::sequencer::run_in_order;

/// Trials a second of the program that the friction levels come from, on one core with twelve logs.
pub const PEER_RATE: f64 = 10.0;

/// What to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Friction.
    pub level: FrictionLevel,
    /// Searches, each from its own seed.
    pub seeds: usize,
    /// The first seed; the others follow it.
    pub first_seed: u64,
    /// Effort of each search.
    pub effort: Effort,
    /// Threads.
    pub workers: usize,
}

/// The result of one seed.
#[derive(Debug, Clone, PartialEq)]
pub struct SeedResult {
    /// The seed.
    pub seed: u64,
    /// What the search found.
    pub found: Found,
    /// Mean position error on the logs held out \[rad\]; none where nothing is held out.
    pub held_out: Option<f64>,
}

/// Everything that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoIdentification {
    /// How it was done.
    pub settings: Settings,
    /// In the order of the seeds.
    pub seeds: Vec<SeedResult>,
    /// Which of them has the least error on the logs fitted.
    pub best: usize,
    /// Its parameters, with the spread over the seeds that fit equally well.
    pub estimates: Estimates,
    /// Quartiles over the seeds of the error on the logs fitted \[rad\].
    pub train: Quartiles,
    /// The same on the logs held out \[rad\].
    pub held_out: Option<Quartiles>,
    /// Mean position error of the best on each log fitted \[rad\].
    pub train_logs: Vec<f64>,
    /// The same on the logs held out.
    pub held_out_logs: Vec<f64>,
    /// Its simulated positions on the logs fitted \[rad\].
    pub train_positions: Vec<Vec<f64>>,
    /// The same on the logs held out.
    pub held_out_positions: Vec<Vec<f64>>,
    /// Simulations of all logs a second and thread, as they were done in the search.
    pub rate: f64,
    /// The same where every simulation goes to its end.
    pub whole_rate: f64,
    /// Whether the user stopped it before all seeds were done.
    pub stopped: bool,
}

/// Searches for the parameters. `cancel` stops it with the best so far.
///
/// # Errors
/// [`IdentError`] where no log is left to fit or no search got anywhere.
pub fn identify(
    train: &[NamedServoLog],
    held_out: &[NamedServoLog],
    settings: &Settings,
    cancel: &AtomicBool,
    progress: &Progress,
) -> Result<ServoIdentification, IdentError> {
    if train.is_empty() {
        return Err(IdentError::NoLogs);
    }
    let lanes = |logs: &[NamedServoLog]| {
        Lanes::new(&logs.iter().map(|named| &named.log).collect::<Vec<&ServoLog>>())
    };
    let (fitted, other) = (lanes(train), lanes(held_out));
    let parameters = settings.level.parameters();
    let jobs: Vec<u64> =
        (0..settings.seeds.max(1) as u64).map(|k| settings.first_seed.wrapping_add(k)).collect();
    let least = Mutex::new(f64::INFINITY);
    let mut seeds = Vec::new();
    let mut seconds = 0.0;
    // Set by a search that has looked at `cancel` with something in its hands, so that however
    // early the user stops there is a best so far.
    let stop = AtomicBool::new(false);
    let work = |&seed: &u64| {
        let started = Instant::now();
        let mut counted = 0;
        let found =
            search(&fitted, parameters, seed, &settings.effort, &mut |evaluations, error| {
                progress.advance((evaluations - counted) as f64);
                counted = evaluations;
                if let Ok(mut least) = least.lock()
                    && error < *least
                {
                    *least = error;
                    progress.stage(format!("{}: {:.2} mrad", settings.level.name(), 1e3 * error));
                }
                if cancel.load(Ordering::Relaxed) {
                    stop.store(true, Ordering::Relaxed);
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(())
            });
        Ok::<_, IdentError>((found, started.elapsed().as_secs_f64()))
    };
    run_in_order(&jobs, settings.workers, &stop, work, |&seed, (found, took)| {
        let physics = Physics::new(parameters, &found.values);
        let held_out = (other.logs() > 0).then(|| other.error(&physics, f64::INFINITY));
        seconds += took;
        seeds.push(SeedResult { seed, found, held_out });
        Ok(())
    })?;
    let stopped = stop.load(Ordering::Relaxed);
    let all: Vec<Found> = seeds.iter().map(|result| result.found.clone()).collect();
    let best = (0..all.len()).min_by(|&a, &b| all[a].error.total_cmp(&all[b].error));
    let nothing =
        || IdentError::NoConvergence("no search found parameters that can be simulated".to_owned());
    let (Some(best), Some(estimates)) = (best, estimates(parameters, &all)) else {
        return Err(nothing());
    };
    let errors: Vec<f64> = all.iter().map(|found| found.error).collect();
    let held: Vec<f64> = seeds.iter().filter_map(|result| result.held_out).collect();
    let physics = Physics::new(parameters, &all[best].values);
    let evaluations: usize = all.iter().map(|found| found.evaluations).sum();
    Ok(ServoIdentification {
        settings: *settings,
        best,
        estimates,
        train: Quartiles::of(&errors).ok_or_else(nothing)?,
        held_out: Quartiles::of(&held),
        train_logs: fitted.errors(&physics),
        held_out_logs: other.errors(&physics),
        train_positions: fitted.positions(&physics),
        held_out_positions: other.positions(&physics),
        rate: evaluations as f64 / seconds.max(1e-9),
        whole_rate: whole_rate(&fitted, &physics),
        seeds,
        stopped,
    })
}

/// Simulations a second that go to their end: the best of several short runs, because other
/// programs may hold the processor.
fn whole_rate(lanes: &Lanes, physics: &Physics) -> f64 {
    const RUNS: usize = 10;
    const SIMULATIONS: usize = 20;
    (0..RUNS)
        .map(|_| {
            let started = Instant::now();
            for _ in 0..SIMULATIONS {
                std::hint::black_box(lanes.error(std::hint::black_box(physics), f64::INFINITY));
            }
            SIMULATIONS as f64 / started.elapsed().as_secs_f64().max(1e-9)
        })
        .fold(0.0, f64::max)
}
