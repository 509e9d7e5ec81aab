//! Identification of a position-controlled servo from logs: what `frictionlab identify-servo` does
//! between reading and printing.
//!
//! A [`description`] says what is known of the servo, [`logs`] brings its logs to a grid.
//! [`identify`] searches from several seeds, in parallel, then on disjoint halves of the logs, and
//! compares the results; [`evaluate`](mod@evaluate) scores [`given`] parameters. [`document`] is the
//! JSON, [`page`] the HTML, [`terminal`] the text.

pub mod description;
pub mod document;
pub mod evaluate;
pub mod given;
pub mod logs;
pub mod page;
pub mod terminal;

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use friction_ident::servo::{
    Drive, Effort, FitQuality, Found, Free, FrictionLevel, Lanes, Physics, ServoLog,
    ServoParameter, estimates, half_samples, search, search_from,
};
use friction_ident::statistics::Quartiles;
use friction_ident::{Estimates, IdentError};

use logs::NamedServoLog;
use work::progress::Progress;
use work::sequencer::run_in_order;

/// Trials a second of the program that the friction levels come from, on one core with twelve logs.
pub const PEER_RATE: f64 = 10.0;

/// What to do.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// What the servo is called.
    pub servo: String,
    /// Its position loop.
    pub drive: Drive,
    /// Friction.
    pub level: FrictionLevel,
    /// What is searched, and where.
    pub free: Vec<Free>,
    /// A delay that is given and not searched \[s\].
    pub delay: Option<f64>,
    /// What was taken otherwise than the logs' headers say, and what cannot be told apart.
    pub notes: Vec<String>,
    /// Splits of the logs into disjoint halves.
    pub splits: usize,
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
    /// The fits of disjoint halves, a pair a split.
    pub halves: Vec<[Found; 2]>,
    /// The error of the best beside the motion of the logs fitted.
    pub quality: FitQuality,
    /// The same of the logs held out.
    pub held_out_quality: Option<FitQuality>,
}

impl ServoIdentification {
    /// Why the fit is a failure: on the logs fitted, else on those held out.
    pub fn failure(&self) -> Option<String> {
        let held_out = || {
            let doubt = self.held_out_quality.and_then(|quality| quality.doubt())?;
            Some(format!("on the logs held out {doubt}"))
        };
        self.quality.doubt().map(|doubt| doubt.to_string()).or_else(held_out)
    }
}

/// The coefficients of found values.
fn physics_of(settings: &Settings, values: &[f64]) -> Physics {
    let parameters: Vec<ServoParameter> = settings.free.iter().map(|free| free.parameter).collect();
    Physics::new(&parameters, values)
}

fn lanes_of(drive: &Drive, logs: &[&NamedServoLog]) -> Lanes {
    Lanes::new(&logs.iter().map(|named| &named.log).collect::<Vec<&ServoLog>>(), drive)
}

/// A mean error beside the motion of the logs it is of.
pub(crate) fn quality_of(logs: &[NamedServoLog], error: f64) -> FitQuality {
    FitQuality::of(logs.iter().map(|named| (named.log.position(), named.log.goal())), error)
}

/// The logs in an order in which neighbours are alike: by gain, mass, length, then motion.
fn alike(logs: &[NamedServoLog]) -> Vec<&NamedServoLog> {
    let mut sorted: Vec<&NamedServoLog> = logs.iter().collect();
    let numbers = |named: &NamedServoLog| [named.file.gain, named.file.mass, named.file.length];
    sorted.sort_by(|a, b| {
        let pairs = numbers(a).into_iter().zip(numbers(b));
        let by_number = pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
        by_number.unwrap_or_else(|| a.title().cmp(&b.title()).then(a.file.path.cmp(&b.file.path)))
    });
    sorted
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
        let mut lanes = lanes_of(&settings.drive, &logs.iter().collect::<Vec<_>>());
        lanes.set_goal_delay(settings.delay);
        lanes
    };
    let (fitted, other) = (lanes(train), lanes(held_out));
    let free = &settings.free;
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
        let found = search(&fitted, free, seed, &settings.effort, &mut |evaluations, error| {
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
        let physics = physics_of(settings, &found.values);
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
    let Some(best) = best.filter(|&best| all[best].error.is_finite()) else {
        return Err(nothing());
    };
    let halves =
        if stopped { Vec::new() } else { of_halves(train, settings, &all[best], cancel, progress) };
    let stopped = stopped || cancel.load(Ordering::Relaxed);
    let quality = quality_of(train, all[best].error);
    let estimates = estimates(free, &all, &halves, &quality).ok_or_else(nothing)?;
    let errors: Vec<f64> = all.iter().map(|found| found.error).collect();
    let held: Vec<f64> = seeds.iter().filter_map(|result| result.held_out).collect();
    let physics = physics_of(settings, &all[best].values);
    let evaluations: usize = all.iter().map(|found| found.evaluations).sum();
    let held_out_quality =
        (other.logs() > 0).then(|| quality_of(held_out, other.error(&physics, f64::INFINITY)));
    Ok(ServoIdentification {
        settings: settings.clone(),
        halves,
        quality,
        held_out_quality,
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

/// Fits both halves of every split, each with half the evaluations of a search, beginning at what
/// all logs together gave. Empty where the user stops.
fn of_halves(
    train: &[NamedServoLog],
    settings: &Settings,
    all: &Found,
    cancel: &AtomicBool,
    progress: &Progress,
) -> Vec<[Found; 2]> {
    let sorted = alike(train);
    let splits = half_samples(sorted.len(), settings.splits);
    let jobs: Vec<&Vec<usize>> = splits.iter().flatten().collect();
    let effort = Effort { evaluations: settings.effort.evaluations / 2, ..settings.effort };
    let work = |half: &&Vec<usize>| {
        let logs: Vec<&NamedServoLog> =
            half.iter().filter_map(|&index| sorted.get(index).copied()).collect();
        let mut lanes = lanes_of(&settings.drive, &logs);
        lanes.set_goal_delay(settings.delay);
        let mut counted = 0;
        let first = Some(&all.values[..]);
        let seed = settings.first_seed;
        let found = search_from(&lanes, &settings.free, first, seed, &effort, &mut |done, _| {
            progress.advance((done - counted) as f64);
            counted = done;
            if cancel.load(Ordering::Relaxed) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        Ok::<_, IdentError>(found)
    };
    let mut found = Vec::new();
    let done = run_in_order(&jobs, settings.workers, cancel, work, |_, half| {
        found.push(half);
        Ok(())
    });
    if done.is_err() || cancel.load(Ordering::Relaxed) || found.len() != jobs.len() {
        return Vec::new();
    }
    found.chunks_exact(2).map(|pair| [pair[0].clone(), pair[1].clone()]).collect()
}

/// Simulations a second that go to their end, side by side as those of a search: the best of
/// several short runs, because other programs may hold the processor.
fn whole_rate(lanes: &Lanes, physics: &Physics) -> f64 {
    const RUNS: usize = 10;
    let many = [*physics; 24];
    (0..RUNS)
        .map(|_| {
            let started = Instant::now();
            std::hint::black_box(lanes.errors_of(std::hint::black_box(&many), f64::INFINITY));
            many.len() as f64 / started.elapsed().as_secs_f64().max(1e-9)
        })
        .fold(0.0, f64::max)
}
