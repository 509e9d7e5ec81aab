//! The run itself, stage by stage.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use friction_model::ModelName;
use recording::bag;
use report::{linked, render_page};
use work::progress::Progress;
use work::sequencer::Completion;

use super::bench::{self, Bench};
use super::experiment::{Found, Running};
use super::journal::Journal;
use super::recorder::{Recorder, Timeline};
use super::results::{BagFigures, RunResults, Status, Timing};
use super::{CHARACTERISE, RunError, RunOptions, page, parameter_file};
use crate::constant_velocity::SteadyRun;
use crate::control_loop::EPOCH_NS;
use files::{OutputError, is_empty_or_missing, write_all};

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
    let options = &options;
    let mut bench = Bench::new(options, rig, progress, cancel);
    Bench::check(options)?;
    let real_time = bench.is_real_time();
    let beginning = match beginning {
        Beginning::Resumed(mut journal) => {
            journal.require_opened(options)?;
            journal.go_on(real_time, put_aside(folder, progress)?)?;
            Beginning::Resumed(journal)
        }
        anew @ Beginning::Anew { .. } => anew,
    };
    let mut recorder = Recorder::create(&folder.join(BAG), options, real_time)?;
    bench.record_to(recorder.stream(), recorder.marks());
    match beginning {
        Beginning::Anew { words: Some(words), .. } => {
            bench.keep_in(Journal::begin(folder, words, (asked, options), real_time)?);
        }
        Beginning::Anew { words: None, .. } => Journal::remove(folder)?,
        Beginning::Resumed(journal) => bench.keep_in(*journal),
    }
    let mut timeline = Timeline::from(bench.now_or(EPOCH_NS));
    let mut status = Status::Complete;
    let mut rig_seconds = 0.0;
    let mut models = options.compensators.clone();
    let mut found = Found::default();
    let mut going = true;
    // Hours of measuring are not thrown away because no curve fits.
    let mut unfit = None;
    for experiment in options.experiment.parts() {
        if !going {
            break;
        }
        let progressed = experiment.carry_out(&mut Running {
            bench: &bench,
            recorder: &mut recorder,
            timeline: &mut timeline,
            models: &mut models,
            found: &mut found,
        })?;
        rig_seconds += progressed.rig_seconds;
        if progressed.completion != Completion::All {
            status = Status::Interrupted;
        }
        unfit = progressed.ended;
        going = progressed.completion == Completion::All && unfit.is_none();
    }

    let mut tables = None;
    if let Some(appendix) = options.appendix.filter(|_| going) {
        let computed = (appendix.compute)(options.seed, options.workers, progress, cancel)?;
        rig_seconds += (appendix.rig_seconds)();
        if !computed.complete {
            status = Status::Interrupted;
        }
        tables = Some(computed);
    }

    // The rig is let go before the report is written.
    let reconnections = bench.reconnections();
    let journal = bench.journal();
    let sessions = journal.as_ref().map(|journal| journal.sessions(BAG)).unwrap_or_default();
    // To go on would bring no other curve.
    let over = status == Status::Complete || unfit.is_some();
    let ended = bench.end();
    let over = over && ended.is_none();
    let ended = ended.or(unfit);
    let unrecorded = recorder.drain()?;
    if unrecorded > 0 {
        progress.line(&format!("{unrecorded} cycles are not in the bag: the disk did not keep up"));
    }
    progress.stage("report");
    let chosen = options.models.last().copied().unwrap_or(ModelName::Proposed);
    let name = format!("`run {}` in {}", options.experiment.as_str(), folder.display());
    let parameters =
        parameter_file::render(options, &models, chosen, found.identification.as_ref(), &name)?;
    let (parameters, origin) = (parameters.text, parameters.origins);
    recorder.attach("parameters.yaml", "application/yaml", &parameters)?;
    let bag = recorder.finish()?;
    let wall_seconds = started.elapsed().as_secs_f64();
    let Found { steady, identification, characterisation, tracked, own, blocks, tables: of_own } =
        found;
    let results = RunResults {
        program_version: env!("CARGO_PKG_VERSION"),
        status: if ended.is_some() { Status::Interrupted } else { status },
        ended,
        reconnections,
        sessions: if sessions.len() > 1 { sessions } else { Vec::new() },
        options: options.clone(),
        origin,
        constant_velocity: steady,
        identification,
        characterisation,
        velocity_tracking: tracked.velocity,
        position_tracking: tracked.position,
        compensation: tracked.tasks,
        thesis_tables: tables,
        own,
        bag: BagFigures {
            folder: BAG,
            messages: bag.messages,
            bytes: bag.bytes,
            recorded: options.record.describe(),
        },
        timing: Timing { wall_seconds, rig_seconds, times_real_time: rig_seconds / wall_seconds },
    };
    let json = serde_json::to_string_pretty(&results)
        .map_err(|e| RunError::Describe { what: "JSON", detail: e.to_string() })?;
    let mut files = vec![("parameters.yaml", parameters), ("run.json", json)];
    let tables = &results.characterisation.records;
    files.extend(tables.iter().map(|(name, record)| (name.as_str(), record.csv())));
    files.extend(of_own.iter().map(|(name, table)| (name.as_str(), table.clone())));
    if options.experiment.as_str() == CHARACTERISE && !results.constant_velocity.is_empty() {
        files.push(("steady_points.csv", steady_points(&results.constant_velocity)));
    }
    let page = page::build(&results, &models, &tracked.traces, blocks);
    let report =
        render_page(&linked(page, std::iter::once(BAG).chain(files.iter().map(|file| file.0))));
    files.push(("report.html", report));
    write_all(folder, &files)?;
    if let Some(journal) = journal.filter(|_| over) {
        journal.complete()?;
    }
    progress.finish();
    Ok(Outcome { results, folder: folder.to_owned() })
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

/// The steady points as comma-separated values.
fn steady_points(runs: &[SteadyRun]) -> String {
    let with_current = runs.iter().all(|run| run.current.is_some());
    let head = if with_current { ",current_A" } else { "" };
    let mut text =
        format!("set,repetition,velocity_rad_s,voltage_V{head},torque_Nm,torque_deviation_Nm\n");
    for run in runs {
        let SteadyRun { set, repetition, velocity, voltage, torque, torque_deviation, .. } = run;
        let current =
            run.current.filter(|_| with_current).map_or(String::new(), |i| format!(",{i:.7}"));
        text += &format!("{},{},{velocity:.8},{voltage:.7}{current}", set + 1, repetition + 1);
        text += &format!(",{torque:.8},{torque_deviation:.6}\n");
    }
    text
}

/// Puts the bag of a run that was stopped aside, whole as far as it goes; the name of the folder
/// that it is in then.
fn put_aside(folder: &Path, progress: &Progress) -> Result<Option<String>, RunError> {
    let old = folder.join(BAG);
    if is_empty_or_missing(&old)
        .map_err(|source| OutputError::Write { path: old.clone(), source })?
    {
        return Ok(None);
    }
    if bag::is_cut(&old)
        && let Err(error) = bag::recover(&old)
    {
        progress.line(&format!(
            "the bag of the run before cannot be saved and is kept as it is: {error}"
        ));
    }
    let free = (1u32..)
        .map(|n| format!("{BAG}_before_resume_{n}"))
        .find(|name| !folder.join(name).exists());
    let Some(name) = free else { return Ok(None) };
    fs::rename(&old, folder.join(&name))
        .map_err(|source| OutputError::Write { path: old, source })?;
    Ok(Some(name))
}

/// Refuses a folder that holds something; one that does not exist is made later.
fn require_empty(folder: &Path) -> Result<(), RunError> {
    match is_empty_or_missing(folder) {
        Ok(true) => Ok(()),
        Ok(false) => Err(OutputError::NotEmpty(folder.to_owned()).into()),
        Err(source) => Err(OutputError::Write { path: folder.to_owned(), source }.into()),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::Ordering;

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
