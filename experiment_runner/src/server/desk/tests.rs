//! One experiment at a time, and what everybody is told of it.

use std::sync::mpsc;

use super::*;
use crate::run::Status;
use crate::server::outcome;
use recording::bag::BagReader;

/// Sends the end on.
struct Wait(mpsc::Sender<Ended>, mpsc::Sender<RunExperimentFeedback>);

impl Watcher for Wait {
    fn progress(&self, feedback: RunExperimentFeedback) {
        let _ = self.1.send(feedback);
    }

    fn ended(self: Box<Self>, ended: &Ended) {
        let came = ended.came.clone();
        let _ = self.0.send(Ended { started: ended.started.clone(), came });
    }
}

struct Bench {
    root: tempfile::TempDir,
    desk: Desk,
    told: Arc<Mutex<Vec<ExperimentStatus>>>,
}

fn bench() -> Bench {
    let root = tempfile::tempdir().unwrap();
    let told: Arc<Mutex<Vec<ExperimentStatus>>> = Arc::default();
    let hear = Arc::clone(&told);
    let announce = Box::new(move |status| hear.lock().unwrap().push(status));
    let permissions =
        Permissions::new("/", vec![RigChoice::Simulated], root.path().join("runs"), None);
    let desk = Desk::new(permissions, UsualRig::default(), announce);
    Bench { root, desk, told }
}

fn request(experiment: &str, folder: Option<&str>, preempt: bool) -> ExperimentRequest {
    let quick = msgs::friction_msgs::Setting { name: "quick".into(), value: String::new() };
    ExperimentRequest {
        experiment: experiment.into(),
        models: vec!["lugre".into()],
        repetitions: 1,
        overrides: vec![quick],
        folder: folder.map(str::to_owned),
        preempt,
    }
}

#[test]
fn an_experiment_runs_to_its_end_and_everybody_is_told() {
    let Bench { root, desk, told } = bench();
    let (end, ended) = mpsc::channel();
    let (feed, fed) = mpsc::channel();
    let asked = request("velocity-tracking", None, false);
    let started = desk.start(&asked, Arc::default(), Wait(end, feed)).unwrap();
    assert_eq!(started.run_id, "velocity-tracking-1");
    assert_eq!(
        started.folder,
        fs::canonicalize(root.path()).unwrap().join("runs/velocity-tracking-1")
    );
    let ended = ended.recv_timeout(Duration::from_secs(120)).unwrap();
    let result = outcome::result(&ended);
    assert!(result.success, "{}", result.message);
    assert!(Path::new(&result.report).is_file() && Path::new(&result.parameters_file).is_file());
    BagReader::open(Path::new(&result.bag_path)).unwrap();
    let mse = |row: &str| {
        result
            .figures
            .iter()
            .find(|figure| figure.row == row && figure.name == "mse")
            .unwrap()
            .value
    };
    assert!(mse("lugre") < 0.5 * mse("none"), "{:?}", result.figures);
    assert!(fed.try_iter().count() > 0);
    let told = told.lock().unwrap();
    assert_eq!(told[0].stage, "idle");
    assert!(told.iter().any(|status| status.experiment == "velocity-tracking"));
    let last = told.last().unwrap();
    assert_eq!((last.experiment.as_str(), last.progress), ("", 1.0));
    assert!(last.message.contains("velocity-tracking-1 is complete"), "{}", last.message);
}

#[test]
fn a_second_experiment_is_refused_with_the_first_ones_name_and_preemption_ends_the_first() {
    let Bench { root: _root, desk, .. } = bench();
    let (end, ended) = mpsc::channel();
    let (feed, _fed) = mpsc::channel();
    let long = ExperimentRequest { repetitions: 1000, ..request("position-tracking", None, false) };
    desk.start(&long, Arc::default(), Wait(end, feed)).unwrap();
    let second = request("velocity-tracking", None, false);
    let refusal = desk.start(&second, Arc::default(), ()).unwrap_err();
    assert!(matches!(&refusal, Refusal::Busy { run_id, .. } if run_id == "position-tracking-1"));
    assert_eq!(outcome::refused(&refusal).outcome, msgs::friction_msgs::RunExperimentResult::BUSY);
    let started =
        desk.start(&request("velocity-tracking", None, true), Arc::default(), ()).unwrap();
    assert_eq!(started.run_id, "velocity-tracking-1");
    let first = ended.recv_timeout(Duration::from_secs(60)).unwrap();
    assert_eq!(first.results().unwrap().status, Status::Interrupted);
    let result = outcome::result(&first);
    assert_eq!(result.outcome, msgs::friction_msgs::RunExperimentResult::CANCELED);
    BagReader::open(Path::new(&result.bag_path)).unwrap();
    assert!(desk.close(Refusal::Inactive, Duration::from_secs(60)));
    assert_eq!(desk.start(&second, Arc::default(), ()).unwrap_err(), Refusal::Inactive);
    desk.open();
    assert!(desk.start(&second, Arc::default(), ()).is_ok());
    assert!(desk.close(Refusal::Leaving, Duration::from_secs(60)));
}

#[test]
fn a_bad_request_leaves_nothing_behind() {
    let Bench { root, desk, .. } = bench();
    let refused =
        |asked: ExperimentRequest| desk.start(&asked, Arc::default(), ()).unwrap_err().to_string();
    assert!(refused(request("jump", None, false)).contains("jump"));
    let full = root.path().join("runs/full");
    fs::create_dir_all(&full).unwrap();
    fs::write(full.join("precious.txt"), "mine").unwrap();
    assert!(refused(request("all", Some("full"), false)).contains("not empty"));
    assert!(refused(request("all", Some("full/precious.txt/run"), false)).contains("precious.txt"));
    let mut wild = request("all", None, false);
    wild.overrides
        .push(msgs::friction_msgs::Setting { name: "voltage-limit".into(), value: "50".into() });
    assert!(refused(wild).contains("voltage_limit"));
    assert_eq!(fs::read_dir(root.path().join("runs")).unwrap().count(), 1);
    assert_eq!(desk.abort(), None);
}
