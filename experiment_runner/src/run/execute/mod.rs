//! The run itself, stage by stage.

mod folder;
mod write;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use recording::bag;
use work::progress::Progress;
use work::sequencer::Completion;

use self::folder::{put_aside, require_empty};
use self::write::{Ending, write_results};
use super::bench::{self, Bench};
use super::experiment::{Found, Running};
use super::journal::Journal;
use super::recorder::{Recorder, Timeline};
use super::results::{RunResults, Status};
use super::{Appended, Compensators, RunError, RunOptions};
use crate::control_loop::EPOCH_NS;

/// Where the results of a run are.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was found.
    pub results: RunResults,
    /// The output folder.
    pub folder: PathBuf,
}

/// Folder of the bag in the run's folder.
const BAG: &str = "bag";

/// Runs the experiments and writes `bag/`, `parameters.yaml`, `report.html` and `run.json` into
/// `folder`.
///
/// Once `cancel` is set the run ends after the jobs at hand, at the pace of the clock within a
/// cycle; what is there by then is written, and the status says so.
///
/// # Errors
/// [`RunError`]. Parameters are checked before anything is written.
pub fn execute(
    options: &RunOptions,
    folder: &Path,
    progress: &Progress,
    cancel: &Arc<AtomicBool>,
) -> Result<Outcome, RunError> {
    execute_in(options, folder, Beginning::Anew { force: false, words: None }, progress, cancel)
}

/// How a run begins.
#[derive(Debug)]
pub enum Beginning {
    /// With its first job.
    Anew {
        /// Whether its folder may hold something already: files of the same names are replaced, and
        /// so is a bag.
        force: bool,
        /// What stood behind `run` on the command line: with it a run that is stopped can go on.
        words: Option<Vec<String>>,
    },
    /// With the first job that was not done when it was stopped. Its bag is moved to
    /// `bag_before_resume_N` first.
    Resumed(Box<Journal>),
}

/// The same, where the beginning says how. What the jobs gave is kept in a journal until the run is
/// complete.
///
/// # Errors
/// As for [`execute`].
pub fn execute_in(
    options: &RunOptions,
    folder: &Path,
    beginning: Beginning,
    progress: &Progress,
    cancel: &Arc<AtomicBool>,
) -> Result<Outcome, RunError> {
    let started = Instant::now();
    // Put together for nothing first, so that a wrong option neither opens a rig nor writes
    // anything.
    check_options(options)?;
    match &beginning {
        Beginning::Anew { force: true, .. } => bag::remove(&folder.join(BAG))?,
        Beginning::Anew { force: false, .. } => require_empty(folder)?,
        Beginning::Resumed(journal) => journal.require_asked(options)?,
    }
    let asked = options;
    let (rig, options) = bench::open(options, progress, cancel)?;
    let mut bench = Bench::new(&options, rig, progress, cancel);
    Bench::check(&options)?;
    let recorder = begin(&mut bench, asked, folder, beginning)?;
    carry_out(bench, recorder, folder, started).map_err(RunError::underway)
}

/// What comes after the beginning: every experiment, then the results.
fn carry_out(
    bench: Bench<'_>,
    mut recorder: Recorder,
    folder: &Path,
    started: Instant,
) -> Result<Outcome, RunError> {
    let (options, progress) = (bench.options, bench.progress);
    let measured = measure(&bench, &mut recorder)?;
    // The rig is let go before the report is written.
    let reconnections = bench.reconnections();
    let journal = bench.journal();
    let sessions = journal.as_ref().map(|journal| journal.sessions(BAG)).unwrap_or_default();
    let ended = bench.end();
    // To go on would bring no other curve.
    let over = (measured.status == Status::Complete || measured.unfit.is_some()) && ended.is_none();
    let ending = Ending { ended, reconnections, sessions, started };
    let results = write_results(folder, options, progress, recorder, measured, ending)?;
    if let Some(journal) = journal.filter(|_| over) {
        journal.complete()?;
    }
    progress.finish();
    Ok(Outcome { results, folder: folder.to_owned() })
}

/// Where the bag and the journal of a run begin, or go on.
fn begin(
    bench: &mut Bench<'_>,
    asked: &RunOptions,
    folder: &Path,
    beginning: Beginning,
) -> Result<Recorder, RunError> {
    let (options, real_time) = (bench.options, bench.is_real_time());
    let beginning = match beginning {
        Beginning::Resumed(mut journal) => {
            journal.require_opened(options)?;
            journal.go_on(real_time, put_aside(folder, bench.progress)?)?;
            Beginning::Resumed(journal)
        }
        anew @ Beginning::Anew { .. } => anew,
    };
    let recorder = Recorder::create(&folder.join(BAG), options, real_time)?;
    bench.record_to(recorder.stream(), recorder.marks());
    match beginning {
        Beginning::Anew { words: Some(words), .. } => {
            bench.keep_in(Journal::begin(folder, words, (asked, options), real_time)?);
        }
        Beginning::Anew { words: None, .. } => Journal::remove(folder)?,
        Beginning::Resumed(journal) => bench.keep_in(*journal),
    }
    Ok(recorder)
}

/// What all experiments of a run gave.
struct Measured {
    status: Status,
    /// Time on the rig \[s\].
    rig_seconds: f64,
    models: Compensators,
    found: Found,
    tables: Option<Appended>,
    /// Why the experiments ended early: hours of measuring are not thrown away because no curve
    /// fits.
    unfit: Option<String>,
}

/// Carries the experiments out, and computes what stands behind them.
fn measure(bench: &Bench<'_>, recorder: &mut Recorder) -> Result<Measured, RunError> {
    let options = bench.options;
    let mut timeline = Timeline::from(bench.now_or(EPOCH_NS));
    let mut measured = Measured {
        status: Status::Complete,
        rig_seconds: 0.0,
        models: options.compensators.clone(),
        found: Found::default(),
        tables: None,
        unfit: None,
    };
    let mut going = true;
    for experiment in options.experiment.parts() {
        if !going {
            break;
        }
        let progressed = experiment.carry_out(&mut Running {
            bench,
            recorder,
            timeline: &mut timeline,
            models: &mut measured.models,
            found: &mut measured.found,
        })?;
        measured.rig_seconds += progressed.rig_seconds;
        if progressed.completion != Completion::All {
            measured.status = Status::Interrupted;
        }
        measured.unfit = progressed.ended;
        going = progressed.completion == Completion::All && measured.unfit.is_none();
    }
    if let Some(appendix) = options.appendix.filter(|_| going) {
        let compute = appendix.compute;
        let computed = compute(options.seed, options.workers, bench.progress, bench.cancel)?;
        measured.rig_seconds += (appendix.rig_seconds)();
        if !computed.complete {
            measured.status = Status::Interrupted;
        }
        measured.tables = Some(computed);
    }
    Ok(measured)
}

/// Whether a run with these options into that folder could start: every loop is put together once,
/// nothing is written.
///
/// # Errors
/// [`RunError`], as [`execute`] would return it before it begins.
pub fn check(options: &RunOptions, folder: &Path) -> Result<(), RunError> {
    check_options(options)?;
    require_empty(folder)
}

/// Whether a run with these options could start: every loop is put together once.
///
/// # Errors
/// [`RunError`], as [`execute`] would return it before it begins.
pub fn check_options(options: &RunOptions) -> Result<(), RunError> {
    Bench::check(options)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::sync::atomic::Ordering;

    use files::OutputError;

    use super::*;
    use crate::run::options::tests::options;
    use recording::bag::BagReader;

    fn run(options: &RunOptions, folder: &Path) -> Result<Outcome, RunError> {
        execute(options, folder, &Progress::new(options.rig_seconds(), true), &Arc::default())
    }

    #[test]
    fn the_whole_job_compensates_better_than_none_and_is_reproducible() {
        let root = tempfile::tempdir().unwrap();
        let first = run(&options(), &root.path().join("a")).unwrap();
        assert_eq!(first.results.status, Status::Complete);
        for name in ["bag/metadata.yaml", "parameters.yaml", "report.html", "run.json"] {
            assert!(first.folder.join(name).is_file(), "{name}");
        }
        for task in [&first.results.velocity_tracking, &first.results.position_tracking] {
            let rows = &task.as_ref().unwrap().rows;
            assert_eq!(rows.len(), 3);
            assert!(rows[1..].iter().all(|row| row.mse < rows[0].mse), "{rows:?}");
        }
        // Another number of workers, the same bytes.
        let second = run(&RunOptions { workers: 1, ..options() }, &root.path().join("b")).unwrap();
        assert_eq!(
            serde_json::to_string(&first.results.constant_velocity).unwrap(),
            serde_json::to_string(&second.results.constant_velocity).unwrap()
        );
        let messages = |folder: &Path| {
            let bag = BagReader::open(&folder.join("bag")).unwrap();
            bag.messages::<msgs::sensor_msgs::JointState>("/joint_states").unwrap()
        };
        assert_eq!(messages(&first.folder), messages(&second.folder));
    }

    #[test]
    fn a_cancelled_run_leaves_a_whole_bag() {
        let root = tempfile::tempdir().unwrap();
        let cancel = Arc::new(AtomicBool::new(true));
        let folder = root.path().join("cancelled");
        let outcome = execute(&options(), &folder, &Progress::new(1.0, true), &cancel).unwrap();
        assert!(cancel.load(Ordering::Relaxed));
        assert_eq!(outcome.results.status, Status::Interrupted);
        assert!(outcome.results.identification.is_none());
        BagReader::open(&folder.join("bag")).unwrap();
    }

    #[test]
    fn a_folder_in_use_is_left_alone() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("precious.txt"), "mine").unwrap();
        assert!(matches!(
            run(&options(), root.path()),
            Err(RunError::Output(OutputError::NotEmpty(_)))
        ));
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_parameter_out_of_range_writes_nothing() {
        let root = tempfile::tempdir().unwrap();
        let mut wrong = options();
        wrong.test_bed.simulation.voltage_limit = 50.0;
        let message = run(&wrong, &root.path().join("out")).unwrap_err().to_string();
        assert!(message.contains("voltage_limit"), "{message}");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
    }
}
