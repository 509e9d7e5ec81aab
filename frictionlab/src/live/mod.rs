//! The loop in real time, on ROS 2: the nodes `rig_driver`, `friction_observer`, `controller` and
//! `experiment_runner` in one process, recorded.
//!
//! The nodes are those of the executables, with their parameters, services and states. What is
//! different is the way between them: observer and controller answer on the rig's control thread
//! ([`answering`]), which runs at absolute deadlines and does nothing else: no lock, no allocation,
//! no message. Its cycles leave through bounded queues, to the threads that publish and to the one
//! that records ([`recording`]). A full queue costs a cycle, which is counted and told, never a
//! wait. The command's options become the nodes' parameters ([`settings`]).

mod answering;
mod diagnostics;
mod error;
pub mod of_files;
mod period_errors;
mod publishing;
mod recording;
mod reference;
mod report;
mod settings;
mod shape;

use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use controller::ControlMode;
use controller::node::ManagedController;
use friction_model::{AnyModel, ModelName};
use friction_observer::node::FrictionObserver;
use rig_driver::node::RigDriver;
use rig_driver::safety::{Fault, Supervised};
use rig_driver::{Calibration, RigError};
use ros_node::{Discovery, Lost, Participant, Stop, Watch};
use serde::Serialize;

pub use error::LiveError;
pub use report::LiveReport;
pub use ros_node::timing::{Percentiles, Timing};

use of_files::OfFiles;

use answering::{Ending, InProcess, Memory};
use period_errors::PeriodErrors;
use publishing::{Nodes, RunnerSide};
use recording::Recorded;
use reference::ReferenceNode;
use shape::Course;

use crate::viewing::{Heard, NodesView, Shelf, Shown};

use ::recording::bag::{BagOptions, BagWriter};
use experiment_runner::compensation::Means;
use experiment_runner::errand::Errands;
use experiment_runner::messages::CycleTopics;
use experiment_runner::run::{Compensators, Origins, render_parameter_file};
use experiment_runner::test_bed::TestBed;
use experiment_runner::waveform::Waveform;
use files::OutputFile;
use rig_setup::{Opened, RigChoice, RigDescription, RigLimits, RigSetup, require_device};
use view::ViewOptions;

/// Cycles that wait for the recorder: eight seconds at 1 kHz, since a disk can be busy for that
/// long.
const RECORDER_QUEUE: usize = 8192;
/// How often faults and the end are looked for.
const WATCH: Duration = Duration::from_millis(20);

/// Experiments for whoever asks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Serving {
    /// Folder for their results.
    pub runs: PathBuf,
    /// Rigs that they may use.
    pub allow_rigs: Vec<RigChoice>,
    /// What is offered beside experiments.
    #[serde(skip)]
    pub offers: Errands,
}

/// What a live run does.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LiveOptions {
    /// Folder for the results; the bag goes to `bag` in it.
    pub out: PathBuf,
    /// Which rig.
    pub rig: RigChoice,
    /// What corrects a real rig's readings.
    pub calibration: Option<Calibration>,
    /// What was set for the rig beside the usual limits.
    pub limits: RigLimits,
    /// What the real rig said of itself when its profile was written: another one is refused.
    pub description: Option<RigDescription>,
    /// The bench: the simulated rig and its friction, and what estimator and controller are made
    /// of.
    pub test_bed: TestBed,
    /// What the controller regulates.
    pub mode: ControlMode,
    /// Where the axis should be; none if `/reference` says it.
    pub reference: Option<Waveform>,
    /// Model of the observer.
    pub observer: ModelName,
    /// Every model with the parameters that the observer knows of it.
    pub models: Compensators,
    /// What else parameter files say of the nodes.
    pub of_files: OfFiles,
    /// Where the parameters come from that are no defaults.
    pub origins: Origins,
    /// By what means the estimate enters the command; none for not at all.
    pub means: Option<Means>,
    /// The bench's period was asked for by name: a device with another one is refused.
    pub rate_given: bool,
    /// Seed of the sensors' noise.
    pub seed: u64,
    /// Length of the run \[s\]; `None` until it is stopped.
    pub duration: Option<f64>,
    /// What others may ask for meanwhile; none for taking no requests.
    pub serve: Option<Serving>,
    /// Arguments of ROS for the nodes: names, namespaces, parameters, log levels. They count above
    /// the other options.
    pub ros_arguments: Vec<String>,
    /// A page in the browser; none for none.
    #[serde(skip)]
    pub view: Option<ViewOptions>,
    /// The folder whose reports and bags it lists.
    #[serde(skip)]
    pub view_runs: PathBuf,
    /// File for the exact percentiles of the periods' errors.
    #[serde(skip)]
    pub timing: Option<OutputFile>,
}

/// Runs the loop in real time until the duration is over or `stop` is set.
///
/// `started` is called once everything runs, with a line about the control thread's priority and
/// one that tells where the view is.
///
/// # Errors
/// [`LiveError`] names the environment variable, folder or option at fault. What was recorded
/// before a failure stays readable.
pub fn run(
    options: &LiveOptions,
    stop: &Arc<AtomicBool>,
    started: impl FnOnce(&str),
) -> Result<LiveReport, LiveError> {
    let discovery = Discovery::from_environment()?;
    // Put together once for nothing, so that a wrong option leaves neither a folder nor a node
    // behind.
    options.check()?;
    let real = options.open_rig()?;
    let period =
        real.as_ref().map_or(options.test_bed.simulation.period, |opened| opened.rig.period());
    let about_line = real.as_ref().and_then(|opened| opened.about.clone());
    let arguments = settings::arguments(options, period)?;

    let participant = Participant::join_with(&discovery, arguments.clone().or_enclave("/live"))?;
    let (runner, to_reference) = RunnerSide::new(
        &participant,
        options.reference.is_some(),
        options.serve.as_ref().map(|serving| serving.offers),
    )?;
    let (observer, estimating) = FrictionObserver::new(&participant)?;
    let (controller, controlling) = ManagedController::new(&participant)?;
    if options.reference.is_none() {
        controller.follow(controlling.references)?;
    }
    let view = options
        .view
        .as_ref()
        .map(|view| {
            let arguments = arguments.clone();
            let join =
                move || Participant::join_with(&discovery, arguments.clone().or_enclave("/live"));
            let shown = Shown {
                heard: Heard::Inside,
                experiments: options.serve.is_some(),
                reference: options.reference.is_some() && participant.enclave().is_none(),
            };
            let shelf = Shelf::new(&options.view_runs);
            NodesView::open(view, &participant, (shown, shelf), Box::new(join))
        })
        .transpose()?;
    let bag = options.bag()?;

    let begun = options.reference.as_ref().map(reference::shape);
    // The permissions of a secured network name no such node.
    let changed = begun.filter(|_| participant.enclave().is_none());
    let changed = changed
        .map(|begun| ReferenceNode::new(&participant, begun, options.limits.velocity))
        .transpose()?;
    let (reference_node, shapes) = changed.unzip();

    let (to_recorder, for_recorder) = rtrb::RingBuffer::new(RECORDER_QUEUE);
    let ending = Arc::new(Ending::default());
    let in_process = InProcess {
        estimation: estimating.estimation,
        control: controlling.control,
        course: begun.map(Course::new),
        shapes,
        cycles: options.duration.map(|duration| (duration / period).round() as u64),
        to_observer: estimating.out,
        to_controller: controlling.out,
        to_reference,
        to_recorder,
        ending: Arc::clone(&ending),
        memory: Memory::default(),
    };
    let opened = real.map(|Opened { rig, limits, .. }| Supervised::new(rig, limits)).transpose();
    let rig =
        RigDriver::new(&participant, Some(Box::new(in_process)), opened.map_err(LiveError::Rig)?)?;
    let mut nodes = Nodes { rig, observer, controller, runner };

    let recorded = Arc::new(Recorded::new());
    let recorder = {
        let (stop, recorded) = (Arc::clone(stop), Arc::clone(&recorded));
        let errors = options.timing.is_some().then(|| PeriodErrors::new(period));
        let (bag, topics) = bag;
        let record =
            move || recording::record(bag, topics, for_recorder, (&recorded, errors), &stop);
        let spawned = thread::Builder::new().name("recorder".into()).spawn(record);
        spawned.map_err(|source| LiveError::Thread { source })?
    };

    let middleware =
        Watch::start(&Stop::default()).map_err(|source| LiveError::Thread { source })?;
    nodes.observer.start();
    nodes.controller.start();
    let begun = nodes.rig.start();
    let mut elder = None;
    let priority = nodes.rig.priority();
    if begun.is_ok() {
        let view = view.as_ref().map(NodesView::words);
        let lines: Vec<_> = about_line.into_iter().chain([priority.clone()]).chain(view).collect();
        started(&lines.join("\n"));
        let over = || ending.over.load(Ordering::Acquire) || ending.gone.load(Ordering::Acquire);
        while elder.is_none()
            && !over()
            && !stop.load(Ordering::Relaxed)
            && !middleware.stop().is_set()
        {
            nodes.tend(&recorded, ending.not_recorded.load(Ordering::Relaxed));
            elder = nodes.rig.elder();
            thread::sleep(WATCH);
        }
    }
    let (over, lost) = (ending.over.load(Ordering::Acquire), ending.gone.load(Ordering::Acquire));
    // The motor is at zero volts before anything else ends.
    nodes.rig.halt();
    let deaf = middleware.end();
    let overruns = nodes.rig.overruns();
    let published = nodes.leave();
    drop(view);
    drop(reference_node);
    // Its queue ended with the rig's node.
    let kept = recorder.join().map_err(|_| LiveError::Panicked { thread: "recorder" });
    if matches!(deaf, Some(Lost::Stuck(_))) {
        // Leaving would wait for the stuck thread; the process ends without that.
        std::mem::forget(participant);
    } else {
        drop(participant);
    }
    let (published, (bag, errors)) = (published?, kept??);
    if let Err(reason) = begun {
        // A rig that fails before it is active ends the cycle; its own words say why. One that answered
        // when nobody waited for it any more has left none.
        let wordless = |error: &RigError| matches!(error, RigError::Safety(report) if report.fault == Fault::BackEnd);
        let own = ending.error().filter(|error| !wordless(error));
        let why = own.map_or_else(|| reason.to_string(), |error| error.to_string());
        return Err(LiveError::Start(why));
    }
    if let Some(elder) = elder {
        return Err(LiveError::Elder(elder));
    }
    if let Some(error) = ending.error() {
        return Err(LiveError::Rig(error));
    }
    if lost && !over {
        return Err(LiveError::Panicked { thread: "control" });
    }
    if let Some(lost) = deaf {
        return Err(LiveError::Deaf(lost));
    }
    if let (Some(file), Some(errors)) = (&options.timing, errors) {
        let summary = errors.summary(priority.clone());
        let text = serde_json::to_string(&summary).unwrap_or_else(|error| error.to_string());
        file.write((text + "\n").as_bytes())?;
    }
    let not_recorded = ending.not_recorded.load(Ordering::Relaxed);
    let report = LiveReport::new(recorded.timing(overruns), priority, published, bag, not_recorded);
    Ok(LiveReport { interrupted: options.duration.is_some() && !over, ..report })
}

impl LiveOptions {
    /// The observer's model with its parameters.
    fn observer(&self) -> AnyModel {
        self.models.get(self.observer)
    }

    /// Puts the loop together once.
    fn check(&self) -> Result<(), LiveError> {
        if let Some(duration) =
            self.duration.filter(|duration| !(*duration > 0.0 && *duration <= 1e7))
        {
            return Err(LiveError::Duration(duration));
        }
        let Self { test_bed, mode, means, seed, .. } = self;
        let reference = self.reference.unwrap_or(Waveform::ConstantVelocity { velocity: 0.0 });
        test_bed.control_loop(*mode, reference, &self.observer(), *means, *seed, 0)?;
        Ok(())
    }

    /// The bag with what belongs to it, and its topics.
    fn bag(&self) -> Result<(BagWriter, CycleTopics), LiveError> {
        let mut bag = BagWriter::create(&self.out.join("bag"), BagOptions::default())?;
        bag.metadata("frictionlab", self.metadata())?;
        let given = (&self.test_bed, &self.models, self.observer);
        let name = format!("`live` in {}", self.out.display());
        let parameters = render_parameter_file(given, &self.origins, None, &name)
            .map_err(|error| LiveError::ParameterFile(Box::new(error)))?;
        bag.attach("parameters.yaml", "application/yaml", parameters.text.as_bytes())?;
        let topics = CycleTopics::open(&mut bag)?;
        Ok((bag, topics))
    }

    /// The real rig, if one was chosen, its motor at zero volts.
    fn open_rig(&self) -> Result<Option<Opened>, LiveError> {
        if self.rig == RigChoice::Simulated {
            return Ok(None);
        }
        let setup = RigSetup {
            calibration: self.calibration,
            limits: self.limits,
            friction: self.test_bed.friction,
            ..RigSetup::default()
        };
        let opened = self.rig.open(&setup)?;
        if let Some(expected) = &self.description {
            require_device(expected, &self.rig, opened.description.as_ref())?;
        }
        let (period, asked) = (opened.rig.period(), 1.0 / self.test_bed.simulation.period);
        if self.rate_given && (period * asked - 1.0).abs() > 1e-6 {
            return Err(LiveError::Rate { period, asked });
        }
        Ok(Some(opened))
    }

    /// What the bag says about the run.
    fn metadata(&self) -> BTreeMap<String, String> {
        let options = serde_json::to_string(self).unwrap_or_else(|error| error.to_string());
        BTreeMap::from([
            ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("command".to_owned(), "live".to_owned()),
            ("seed".to_owned(), self.seed.to_string()),
            ("options".to_owned(), options),
        ])
    }
}
