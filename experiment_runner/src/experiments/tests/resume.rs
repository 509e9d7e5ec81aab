//! A run that was stopped, wherever, and went on finds what a run in one piece finds, bit for bit.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use serde_json::Value;

use super::provenance::short;
use crate::experiments;
use crate::protocol::{ConstantVelocityProtocol, ProtocolFile};
use crate::run::bench::stop_after;
use crate::run::experiment::Selection;
use crate::run::{Beginning, Journal, Outcome, RunError, RunOptions, Status, execute_in};
use recording::bag::BagReader;
use work::progress::Progress;

fn begun() -> Beginning {
    Beginning::Anew { force: false, words: Some(vec!["as".to_owned(), "given".to_owned()]) }
}

/// Runs until `after` jobs of it are delivered, or to the end.
fn run(options: &RunOptions, folder: &Path, beginning: Beginning, after: Option<usize>) -> Outcome {
    let cancel = Arc::new(AtomicBool::new(after == Some(0)));
    stop_after::set(after.filter(|&jobs| jobs > 0));
    let outcome =
        execute_in(options, folder, beginning, &Progress::new(1.0, true), &cancel).unwrap();
    stop_after::set(None);
    outcome
}

fn resumed(options: &RunOptions, folder: &Path, after: Option<usize>) -> Outcome {
    let journal = Journal::open(folder).unwrap();
    assert_eq!(journal.words(), ["as", "given"]);
    run(options, folder, Beginning::Resumed(Box::new(journal)), after)
}

/// The data of a report's figures.
fn drawn(report: &str) -> impl Iterator<Item = &str> {
    let data = report.split("<script type=\"application/json\" id=\"data-").skip(1);
    data.filter_map(|rest| rest.split("</script>").next())
}

/// Everything that was found: run.json without what tells of the sittings, and the other files but
/// the report.
fn found(folder: &Path) -> (Value, Vec<(String, String)>) {
    let mut json: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("run.json")).unwrap()).unwrap();
    for differs in ["timing", "sessions", "bag"] {
        json.as_object_mut().unwrap().remove(differs);
    }
    let mut files: Vec<(String, String)> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.path().is_file())
        .map(|entry| {
            (entry.file_name().into_string().unwrap(), fs::read_to_string(entry.path()).unwrap())
        })
        .filter(|(name, _)| !["run.json", "report.html"].contains(&name.as_str()))
        .map(|(name, text)| (name, text.replace(&folder.display().to_string(), "FOLDER")))
        .collect();
    // Of the report what is drawn.
    let report = fs::read_to_string(folder.join("report.html")).unwrap();
    files.extend(drawn(&report).map(|figure| ("figure".to_owned(), figure.to_owned())));
    files.sort();
    (json, files)
}

/// What a run says that cannot go on.
fn refusal(folder: &Path) -> String {
    Journal::open(folder).unwrap_err().to_string()
}

fn goes_on_from_everywhere(experiment: &Selection) {
    let root = tempfile::tempdir().unwrap();
    let options = short(experiment.clone());
    let whole = root.path().join("whole");
    let all = 1_000_000;
    run(&options, &whole, begun(), None);
    let wanted = found(&whole);
    assert_eq!(wanted.0["status"], "complete");
    // Counted with a stop that never comes.
    let counted = root.path().join("counted");
    stop_after::set(Some(all));
    execute_in(&options, &counted, begun(), &Progress::new(1.0, true), &Arc::default()).unwrap();
    let jobs = all - stop_after::left().unwrap();
    stop_after::set(None);

    let steady = (options.constant_velocity.velocities.len()
        * options.constant_velocity.sets as usize)
        * usize::from(experiment.includes(ConstantVelocityProtocol::NAME));
    let mut stops: Vec<usize> = (0..jobs).step_by(jobs.div_ceil(5)).collect();
    stops.extend(
        [1, steady, steady + 1, jobs.saturating_sub(1)].into_iter().filter(|&stop| stop < jobs),
    );
    stops.sort_unstable();
    stops.dedup();
    for after in stops {
        let folder = root.path().join(format!("after-{after}"));
        let stopped =
            run(&RunOptions { workers: 1, ..options.clone() }, &folder, begun(), Some(after));
        if stopped.results.status == Status::Complete {
            // What is under way at the stop is delivered too: here it was the rest.
            assert!(after + 10 > jobs, "{experiment:?} after {after} of {jobs}");
            continue;
        }
        let outcome = resumed(&options, &folder, None);
        assert_eq!(outcome.results.status, Status::Complete);
        assert_eq!(found(&folder), wanted, "{experiment:?} after {after}");
        let sessions = &outcome.results.sessions;
        assert_eq!(sessions.len(), 2, "{sessions:?}");
        assert_eq!(sessions[1].first_job, sessions[0].jobs);
        assert_eq!(sessions.iter().map(|session| session.jobs).sum::<u64>(), jobs as u64);
        for session in sessions {
            BagReader::open(&folder.join(session.bag.as_ref().unwrap())).unwrap();
        }
        assert!(
            fs::read_to_string(folder.join("report.html"))
                .unwrap()
                .contains("was stopped and went on")
        );
        assert!(refusal(&folder).contains("complete"), "{}", refusal(&folder));
    }
}

#[test]
fn every_experiment_goes_on_from_wherever_it_was_stopped() {
    for experiment in experiments::selections() {
        goes_on_from_everywhere(&experiment);
    }
}

#[test]
fn a_run_goes_on_as_often_as_it_is_stopped_and_what_was_measured_is_not_measured_again() {
    let root = tempfile::tempdir().unwrap();
    let options = RunOptions { workers: 1, ..short(experiments::whole_job()) };
    run(&options, &root.path().join("whole"), begun(), None);
    let report = fs::read_to_string(root.path().join("whole/report.html")).unwrap();
    assert!(drawn(&report).count() >= 2, "{} figures", drawn(&report).count());
    let folder = root.path().join("run");
    run(&options, &folder, begun(), Some(3));
    resumed(&options, &folder, Some(4));
    // Stopped before its first run.
    resumed(&options, &folder, Some(0));
    let last = resumed(&options, &folder, None).results;
    assert_eq!(found(&folder), found(&root.path().join("whole")));
    let bags: Vec<&str> = last.sessions.iter().map(|s| s.bag.as_deref().unwrap()).collect();
    assert_eq!(bags, ["bag_before_resume_1", "bag_before_resume_2", "bag_before_resume_3", "bag"]);
    let jobs: Vec<u64> = last.sessions.iter().map(|s| s.jobs).collect();
    // What is under way at a stop is delivered too.
    assert!((3..=13).contains(&jobs[0]) && (4..=14).contains(&jobs[1]) && jobs[2] == 0, "{jobs:?}");
    let firsts: Vec<u64> = last.sessions.iter().map(|s| s.first_job).collect();
    assert_eq!(firsts, [0, jobs[0], jobs[0] + jobs[1], jobs[0] + jobs[1]]);
    let second = format!("runs {} to {}", jobs[0] + 1, jobs[0] + jobs[1]);
    assert!(last.resumed().unwrap().contains(&second), "{:?}", last.resumed());
}

#[test]
fn what_a_kill_cut_off_is_measured_again() {
    let root = tempfile::tempdir().unwrap();
    let options = RunOptions { workers: 1, ..short(experiments::whole_job()) };
    let whole = root.path().join("whole");
    run(&options, &whole, begun(), None);
    let stop = |name: &str| {
        let folder = root.path().join(name);
        run(&options, &folder, begun(), Some(5));
        for file in ["run.json", "parameters.yaml", "report.html", "bag/metadata.yaml"] {
            fs::remove_file(folder.join(file)).unwrap();
        }
        folder
    };
    // A cut last line, with a bag that lost its end.
    let cut = stop("cut");
    let journal = cut.join("journal.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    let done = text.matches("{\"done\"").count() as u64;
    fs::write(&journal, &text[..text.len() - 20]).unwrap();
    let bag = cut.join("bag/bag_0.mcap");
    let bytes = fs::read(&bag).unwrap();
    fs::write(&bag, &bytes[..bytes.len() - 700]).unwrap();
    let outcome = resumed(&options, &cut, None);
    assert_eq!(found(&cut), found(&whole));
    assert_eq!(outcome.results.sessions[1].first_job, done - 1);
    BagReader::open(&cut.join("bag_before_resume_1")).unwrap();

    // A result that cannot be read, in the middle, and a sitting after it.
    let spoilt = stop("spoilt");
    resumed(&options, &spoilt, Some(2));
    let journal = spoilt.join("journal.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let third = lines.iter_mut().filter(|line| line.contains("\"done\"")).nth(2).unwrap();
    *third = third.replace("\"torque\":", "\"torque\":null,\"was\":");
    fs::write(&journal, lines.join("\n") + "\n").unwrap();
    let stopped = resumed(&options, &spoilt, Some(3)).results;
    let sittings = |sessions: &[crate::run::Session]| {
        sessions.iter().map(|s| (s.first_job, s.jobs)).collect::<Vec<_>>()
    };
    let stopped = sittings(&stopped.sessions);
    assert_eq!(stopped[..2], [(0, 2), (2, 0)]);
    assert!(stopped[2].0 == 2 && stopped[2].1 >= 3, "{stopped:?}");
    let last = resumed(&options, &spoilt, None).results;
    assert_eq!(sittings(&last.sessions)[..3], stopped);
    assert_eq!(found(&spoilt), found(&whole));

    // Not even the first line.
    let empty = stop("empty");
    fs::write(empty.join("journal.jsonl"), "{\"header\":{\"form").unwrap();
    assert!(refusal(&empty).contains("begin the run anew"), "{}", refusal(&empty));
}

#[test]
fn a_run_that_would_not_be_the_same_does_not_go_on() {
    let root = tempfile::tempdir().unwrap();
    let options = RunOptions {
        workers: 1,
        ..short(Selection::alone(Arc::new(experiments::ConstantVelocity)))
    };
    let folder = root.path().join("run");
    run(&options, &folder, begun(), Some(3));
    let before = fs::read(folder.join("journal.jsonl")).unwrap();
    let mut changed = RunOptions { seed: 7, ..options.clone() };
    changed.constant_velocity.duration += 1.0;
    let journal = Journal::open(&folder).unwrap();
    // While it goes on nobody else may.
    assert!(refusal(&folder).contains("still going on"), "{}", refusal(&folder));
    let beginning = Beginning::Resumed(Box::new(journal));
    let error =
        execute_in(&changed, &folder, beginning, &Progress::new(1.0, true), &Arc::default());
    let Err(error @ RunError::Resume { .. }) = error else { panic!("{error:?}") };
    let error = error.to_string();
    assert!(
        error.contains("seed was 1, is 7") && error.contains("constant_velocity.duration was"),
        "{error}"
    );
    assert_eq!(fs::read(folder.join("journal.jsonl")).unwrap(), before);
    assert!(folder.join("bag").is_dir() && !folder.join("bag_before_resume_1").exists());
    // The number of workers may differ.
    assert_eq!(
        resumed(&RunOptions { workers: 2, ..options }, &folder, None).results.status,
        Status::Complete
    );
    assert!(!folder.join("journal.jsonl").exists());

    let strange = root.path().join("strange");
    fs::create_dir(&strange).unwrap();
    assert!(refusal(&strange).contains("holds no journal.jsonl"), "{}", refusal(&strange));
    assert_eq!(fs::read_dir(&strange).unwrap().count(), 0);
}
