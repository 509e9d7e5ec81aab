//! Whatever ends a run, and whenever: its files claim no identification that did not take place.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::experiments;
use crate::protocol::{ConstantVelocityProtocol, ProtocolFile, SequenceProtocol};
use crate::run::bench::stop_after;
use crate::run::experiment::Selection;
use crate::run::options::tests::options;
use crate::run::{Origin, Outcome, RunOptions, Status, execute, read_parameter_file};
use recording::bag::BagReader;
use work::progress::Progress;

/// As short as the curve allows: every experiment in all its stages, in a second or so.
pub(super) fn short(experiment: Selection) -> RunOptions {
    let mut options = RunOptions { experiment, ..options() };
    let steady = &mut options.constant_velocity;
    steady.repetitions = 1;
    options.varying_velocity.repetitions = 1;
    options.pre_sliding.repetitions = 1;
    options.breakaway_rate.repetitions = 1;
    for tracking in [&mut options.velocity_tracking, &mut options.position_tracking] {
        (tracking.duration, tracking.repetitions) = (2.0, 1);
    }
    options.sequence = sequence();
    options
}

fn sequence() -> Option<SequenceProtocol> {
    SequenceProtocol::shipped().ok()
}

fn stopped(options: &RunOptions, folder: &Path, after: Option<usize>) -> Outcome {
    let cancel = Arc::new(AtomicBool::new(after == Some(0)));
    stop_after::set(after.filter(|&jobs| jobs > 0));
    execute(options, folder, &Progress::new(1.0, true), &cancel).unwrap()
}

/// What holds of every run.
fn honest(outcome: &Outcome, options: &RunOptions) {
    let read = |name: &str| fs::read_to_string(outcome.folder.join(name)).unwrap();
    let (yaml, report, json) = (read("parameters.yaml"), read("report.html"), read("run.json"));
    let results = &outcome.results;
    let done = results.identification.is_some();
    // The files are whole and can be read back.
    let models = read_parameter_file(&yaml).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    BagReader::open(&outcome.folder.join("bag")).unwrap();

    assert_eq!(yaml.contains("identified by this run"), done, "{yaml}");
    assert_eq!(yaml.contains("were identified by it"), done);
    assert_eq!(json["origin"].to_string().contains("identified"), done);
    assert!(!report.contains("identified above") || done);
    assert_eq!(report.contains("friction - f_v v"), done);
    for (path, origin) in results.origin.iter() {
        let name = path.rsplit('.').next().unwrap();
        let found = results.identification.as_ref();
        let parameter = found.and_then(|found| found.parameters.iter().find(|p| p.name == name));
        if *origin == Origin::Identified {
            // It is the number that was identified, and the one in the file.
            let model = path.split('.').nth(1).unwrap().parse().unwrap();
            assert_eq!(
                models.get(model).parameter(name),
                Some(parameter.unwrap().estimate.value),
                "{path}"
            );
        }
    }
    if !done {
        assert_eq!(models, options.compensators, "the numbers are those that were given");
        assert!(!crate::run::terminal::summary(outcome).contains("Stribeck"));
    }
}

#[test]
fn no_run_claims_an_identification_that_did_not_take_place() {
    let root = tempfile::tempdir().unwrap();
    for experiment in experiments::selections() {
        let options = short(experiment.clone());
        let steady = (options.constant_velocity.velocities.len()
            * options.constant_velocity.sets as usize)
            * usize::from(experiment.includes(ConstantVelocityProtocol::NAME));
        // Before the first run, after it, in the middle of the characteristic, with its last run,
        // and in what comes after it.
        let mut stops = vec![0, 1, steady / 2, steady, steady + 1, steady + 2];
        stops.sort_unstable();
        stops.dedup();
        for after in stops {
            let folder = root.path().join(format!("{}-{after}", experiment.as_str()));
            let outcome = stopped(&options, &folder, Some(after));
            let reached = after == 0 || stop_after::left() == Some(0);
            if reached && after < steady {
                assert_eq!(
                    outcome.results.status,
                    Status::Interrupted,
                    "{experiment:?} after {after}"
                );
                assert!(outcome.results.identification.is_none(), "{experiment:?} after {after}");
            }
            honest(&outcome, &options);
            fs::remove_dir_all(&folder).unwrap();
        }
    }
    stop_after::set(None);
}

#[test]
fn a_whole_run_says_which_of_its_numbers_it_identified() {
    let root = tempfile::tempdir().unwrap();
    let mut options = short(Selection::alone(Arc::new(experiments::ConstantVelocity)));
    options.origins.set("friction_observer.lugre", Origin::File { file: "mine.yaml".to_owned() });
    let outcome = stopped(&options, &root.path().join("run"), None);
    assert_eq!(outcome.results.status, Status::Complete);
    honest(&outcome, &options);
    let origin = |path: &str| outcome.results.origin.of(path).to_string();
    assert_eq!(origin("friction_observer.lugre.f_c"), "identified by this run");
    assert_eq!(origin("friction_observer.lugre.sigma0"), "from mine.yaml");
    assert_eq!(origin("controller.pid.k_p"), "default");
    let yaml = fs::read_to_string(outcome.folder.join("parameters.yaml")).unwrap();
    assert!(yaml.contains("# from mine.yaml") && yaml.contains("# default"), "{yaml}");
}
