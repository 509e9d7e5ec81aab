//! What is asked of a run: the options of `frictionlab run`, which a request to the node may give
//! too, and what they stand for.

#![expect(
    rustdoc::broken_intra_doc_links,
    reason = "options are read in a terminal, where units are not escaped"
)]

pub mod rig;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args as _, FromArgMatches as _};
use controller::ControllerOptions;
use friction_ident::TorqueSource;
use friction_model::{AnyModel, ModelName, Motor};
use friction_observer::EstimatorOptions;
use identification::asked::advice as drive_advice;
use identification::drive::parameters::read_motor;
use rig_driver::{
    Calibration, FrictionCoupling, HIGHEST_VOLTAGE, Sensors, SimulationOptions, VOLTAGE_RANGE,
};
use rig_setup::{RigChoice, RigFileError, read_calibration};
use work::destination::ToFolder;
use work::model_name::model_name;
use work::saying::Saying;
use work::{BadInput, drive_errors};

use self::rig::{Chosen, RigParser, choose};
use crate::characterise::TorqueReading;
use crate::compensation::Means;
use crate::experiments;
use crate::models::file;
use crate::protocol::{
    BreakawayRateProtocol, CompensationProtocol, ConstantVelocityProtocol, DriveExcitationProtocol,
    PreSlidingProtocol, ProtocolFile, TrackingProtocol, VaryingVelocityProtocol,
};
use crate::run::experiment::{Experiment, Put, Selection};
use crate::run::{Appendix, Beside, Given, Origin, Pace, ProfileUsed, RecordPolicy, RunOptions};
use crate::test_bed::{TestBed, nominal_drive};

/// Run experiments on the simulated test bed or a real rig
///
/// `frictionlab run` alone does the whole job: it drives the rig at 80 constant velocities (10
/// repetitions, two sets), identifies the Stribeck curve, compensates with what it found and
/// compares none, LuGre and the proposed model in velocity and position tracking. The output folder
/// gets the bag, parameters.yaml, report.html and run.json.
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    /// Go on with the run in this folder that was stopped, whatever stopped it. Its own options
    /// count; what is measured is not measured again. A real rig is opened as for a run that begins
    #[arg(long, value_name = "FOLDER", conflicts_with_all = NOT_RESUMED)]
    pub resume: Option<PathBuf>,
    /// What to run [default: all, or the experiment of the protocol given]
    #[arg(value_parser = selections())]
    pub experiment: Option<Selection>,
    /// The rig
    #[arg(long, value_name = "RIG", value_parser = RigParser, hide_possible_values = true, help = format!(
        "The rig: {}, with their observer and controller. A real rig and the nodes run in real time, one run after the other, and ctrl-C puts the motor at \
         zero volts at once [default: the rig of --rig-file, else simulated]",
        RigChoice::grammar()
    ))]
    pub rig: Option<RigChoice>,
    /// Rig profile: address, calibration, limits and drive in one file
    /// [default: rig.yaml of this folder, where --rig names the rig that it is of]
    #[arg(long, value_name = "FILE")]
    pub rig_file: Option<PathBuf>,
    /// Correct a real rig's readings by the calibration.yaml of `frictionlab rig calibrate`
    #[arg(long, value_name = "FILE")]
    pub calibration: Option<PathBuf>,
    /// The drive's constants: a drive.yaml of `frictionlab identify-drive` [default: the SRV-02's]
    #[arg(long, value_name = "FILE", conflicts_with = "time_constant")]
    pub drive: Option<PathBuf>,
    /// Protocol of an experiment, as `frictionlab protocols` prints them; may be given several
    /// times
    #[arg(long, value_name = "FILE")]
    pub protocol: Vec<PathBuf>,
    /// Where the friction torque of experiments 1 to 4 is from: a rig without a torque sensor has
    /// its voltage or current [default: sensor, or what the rig profile says that there is]
    #[arg(long, value_enum, value_name = "SOURCE")]
    pub torque_source: Option<TorqueSourceArg>,
    /// Standard errors of the drive's constants in percent: torque constant, armature resistance,
    /// inertia; they make the uncertainty of a torque from voltage or current
    #[arg(long, value_name = "K,R,J", value_delimiter = ',', default_value = "1,2,2")]
    pub drive_errors: Vec<f64>,
    /// Where the results go.
    #[command(flatten)]
    pub to: ToFolder,
    /// Seed of the sensors' noise; the same seed gives the same run
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Models that compensate, each compared with none at all
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "lugre,proposed", value_parser = model_name)]
    pub model: Vec<ModelName>,
    /// By what means they compensate; `feedback` is the observer on the measured velocity
    #[arg(
        long,
        value_enum,
        value_name = "MEANS",
        value_delimiter = ',',
        default_value = "feedback"
    )]
    pub means: Vec<Means>,
    /// The simulated plant's own friction model
    #[arg(long, value_name = "NAME", default_value = "proposed", value_parser = model_name)]
    pub plant: ModelName,
    /// Parameters of the plant's friction: a file as `frictionlab models NAME --yaml` prints it.
    /// With tau = 0.0111 the proposed model shows the lag of the thesis's figures, ten times that
    /// of the test bed's set
    #[arg(long, value_name = "FILE")]
    pub plant_parameters: Option<PathBuf>,
    /// Parameters of the compensating models and of the controller: a parameters.yaml of `run` or
    /// `identify`, a controller.yaml of `design`. May be given several times; of a value that
    /// several files have the last counts [default: the thesis's test bed]
    #[arg(long, value_name = "FILE")]
    pub parameters: Vec<PathBuf>,
    /// A short protocol to try things out: 20 velocities of 6 s, 2 repetitions
    #[arg(long)]
    pub quick: bool,
    /// Repetitions of every experiment [default: 10 at constant velocity, 5 in tracking]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repetitions: Option<u32>,
    /// How much goes into the bag [default: thinned, and full on a real rig]
    #[arg(long, value_enum)]
    pub record: Option<RecordPolicy>,
    /// Time constant of the drive: the thesis's chapter 6 and its data sheet disagree
    /// [default: thesis]
    #[arg(long, value_enum)]
    pub time_constant: Option<TimeConstantArg>,
    /// Friction as a torque, or taken off the volts as in the thesis's own simulations
    #[arg(long, value_enum, default_value_t)]
    pub friction: FrictionArg,
    /// With `run compensation`: also Tables 5.1, 5.2 and 6.2 to 6.7 of the thesis, its figures
    /// beside ours, and every model as plant under every model as observer
    #[arg(long)]
    pub thesis_tables: bool,
    /// The older name of `--friction as-volts`
    #[arg(long, conflicts_with = "friction", hide = true)]
    pub thesis_units: bool,
    /// Sensors without noise and steps, for studies of the models alone
    #[arg(long)]
    pub ideal_sensors: bool,
    /// Motor voltage limit [V], at most the rig's own voltage range; 10 V for the simulated one
    /// [default: that of the rig profile, else 6]
    #[arg(long, value_name = "VOLTS")]
    pub voltage_limit: Option<f64>,
    /// Drive the simulated rig at the pace of the clock, one run after the other; ctrl-C then stops
    /// it within a cycle
    #[arg(long)]
    pub real_time: bool,
    /// Threads [default: all cores]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
    /// What is told besides.
    #[command(flatten)]
    pub saying: Saying,
}

/// Reads the name of a selection; help and completion show every one with what it does.
fn selections() -> impl TypedValueParser<Value = Selection> {
    let names = experiments::selections()
        .into_iter()
        .map(|one| PossibleValue::new(one.as_str()).help(one.about()));
    PossibleValuesParser::new(names)
        .try_map(|name| experiments::selection(&name).ok_or("there is no such experiment"))
}

/// Options that a run that goes on has already.
pub const NOT_RESUMED: [&str; 26] = [
    "experiment",
    "rig",
    "rig_file",
    "calibration",
    "drive",
    "protocol",
    "torque_source",
    "drive_errors",
    "out",
    "force",
    "seed",
    "model",
    "means",
    "plant",
    "plant_parameters",
    "parameters",
    "quick",
    "repetitions",
    "record",
    "time_constant",
    "friction",
    "thesis_tables",
    "thesis_units",
    "ideal_sensors",
    "voltage_limit",
    "real_time",
];

/// [`TorqueSource`] on the command line.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum TorqueSourceArg {
    /// The torque sensor
    #[default]
    Sensor,
    /// (A Km/Ra) (u - A Km w) - J w'
    Voltage,
    /// A Km i - J w'
    Current,
}

/// Which of the thesis's two time constants of the SRV-02 is meant: its chapter 6 and its appendix
/// A disagree.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum TimeConstantArg {
    /// T = 0.02388 s
    #[default]
    Thesis,
    /// T = 0.01734 s
    Datasheet,
}

/// [`FrictionCoupling`] on the command line.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum FrictionArg {
    /// As a torque: 4.84 V per N m
    #[default]
    Physical,
    /// 1 V per N m: the thesis's units
    AsVolts,
}

/// What the arguments ask for; nothing is driven or written.
///
/// # Errors
/// [`BadInput`] names the option at fault.
pub fn options(args: &RunArgs, beside: &Beside) -> anyhow::Result<RunOptions> {
    let coupling = match (args.friction, args.thesis_units) {
        (FrictionArg::Physical, false) => FrictionCoupling::Physical,
        (FrictionArg::AsVolts, _) | (_, true) => FrictionCoupling::NewtonMetreAsVolt,
    };
    let chosen = choose(args.rig.as_ref(), args.rig_file.as_deref())?;
    let rig = chosen.rig.clone();
    let drive = drive(args, &chosen)?;
    let calibration = calibration(&chosen, args.calibration.as_deref())?;
    let limits = chosen.limits(args.voltage_limit);
    let voltage_limit = limits.voltage.unwrap_or(SimulationOptions::default().voltage_limit);
    let sensors = if args.ideal_sensors { Sensors::ideal() } else { Sensors::default() };
    let simulation = SimulationOptions {
        drive,
        friction_coupling: coupling,
        sensors,
        voltage_limit,
        // A real rig tells its own when it is opened, and nothing moves before.
        voltage_range: if rig == RigChoice::Simulated { VOLTAGE_RANGE } else { HIGHEST_VOLTAGE },
        ..Default::default()
    };
    let given = given(&args.parameters)?;
    let mut controller = given
        .controller(&ControllerOptions::default())
        .map_err(|error| BadInput(error.to_string()))?;
    let Given { compensators, mut origins, .. } = given;
    let option = |name: &str| Origin::Option { option: name.to_owned() };
    match (&args.drive, args.time_constant) {
        (Some(file), _) => {
            origins.set("rig_driver.drive", Origin::File { file: file.display().to_string() });
        }
        (None, Some(TimeConstantArg::Datasheet)) => {
            origins.set("rig_driver.drive", option("--time-constant"));
        }
        (None, Some(TimeConstantArg::Thesis)) => {}
        (None, None) => chosen.drive_origin(&mut origins),
    }
    match args.voltage_limit {
        Some(volts) if volts != SimulationOptions::default().voltage_limit => {
            origins.set("rig_driver.voltage_limit", option("--voltage-limit"));
        }
        Some(_) => {}
        None => chosen.limit_origin(&mut origins),
    }
    controller.compensation.volts_per_newton_metre = coupling.volts_per_newton_metre(&drive);
    let estimator =
        EstimatorOptions { drive: nominal_drive(&drive, coupling), ..Default::default() };
    let models = once_each(&args.model);
    let means = once_each(&args.means);
    let protocols = protocols(&args.protocol)?;
    let experiment = experiment(args, &protocols)?;
    let errors = drive_errors::fractions(&args.drive_errors)?;
    let source = match args.torque_source {
        Some(TorqueSourceArg::Sensor) => TorqueSource::Sensor,
        Some(TorqueSourceArg::Voltage) => TorqueSource::Voltage,
        Some(TorqueSourceArg::Current) => TorqueSource::Current,
        None => chosen.torque_source().unwrap_or(TorqueSource::Sensor),
    };
    if source != TorqueSource::Sensor && coupling != FrictionCoupling::Physical {
        let why = "--torque-source voltage and current need friction that acts as a torque: leave --friction as-volts out";
        return Err(BadInput(why.to_owned()).into());
    }
    let mut options = RunOptions {
        experiment,
        rig: rig.clone(),
        rig_profile: chosen.profile.as_ref().map(|(file, profile)| ProfileUsed {
            file: file.clone(),
            description: profile.description.clone().filter(|_| chosen.of_real().is_some()),
        }),
        calibration,
        limits,
        test_bed: TestBed { simulation, friction: plant(args)?, controller, estimator },
        models,
        means,
        compensators,
        origins,
        seed: args.seed,
        pace: if args.real_time { Pace::RealTime } else { Pace::Offline },
        record: args.record.unwrap_or(match rig {
            RigChoice::Simulated => RecordPolicy::Thinned,
            _ => RecordPolicy::Full,
        }),
        constant_velocity: ConstantVelocityProtocol::default(),
        varying_velocity: VaryingVelocityProtocol::shipped()?,
        pre_sliding: PreSlidingProtocol::shipped()?,
        breakaway_rate: BreakawayRateProtocol::shipped()?,
        drive_excitation: DriveExcitationProtocol::shipped()?,
        sequence: None,
        compensation: CompensationProtocol::shipped()?,
        appendix: appendix(args, beside)?,
        torque: TorqueReading::new(source, &drive, &sensors, errors),
        velocity_tracking: TrackingProtocol::velocity(),
        position_tracking: TrackingProtocol::position(),
        workers: if args.real_time {
            1
        } else {
            args.jobs
                .map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from)
        },
    };
    for experiment in experiments::all() {
        if args.quick {
            experiment.shorten(&mut options);
        }
        if let Some(repetitions) = args.repetitions {
            experiment.repeat(&mut options, repetitions);
        }
    }
    // A file says everything itself: neither --quick nor --repetitions changes it.
    protocols.into_iter().for_each(|(_, put)| put(&mut options));
    Ok(options)
}

/// What `frictionlab run` asks for where no option says otherwise, of that selection: the simulated
/// test bed, with the protocols that are part of the program.
///
/// # Errors
/// None that a user could cause: the defaults of the options are good ones, which a test holds.
pub fn usual(selection: Selection) -> anyhow::Result<RunOptions> {
    let command = RunArgs::augment_args(clap::Command::new("run").no_binary_name(true));
    let args = RunArgs::from_arg_matches(&command.try_get_matches_from([""; 0])?)?;
    Ok(RunOptions { experiment: selection, ..options(&args, &Beside::default())? })
}

/// The drive, as the file says or as the SRV-02 has it.
fn drive(args: &RunArgs, chosen: &Chosen) -> Result<Motor, BadInput> {
    let Some(file) = &args.drive else {
        if let Some(motor) = chosen.motor().filter(|_| args.time_constant.is_none()) {
            return Ok(motor);
        }
        return Ok(match args.time_constant.unwrap_or_default() {
            TimeConstantArg::Thesis => Motor::SRV02,
            TimeConstantArg::Datasheet => Motor::SRV02_DATASHEET,
        });
    };
    let say =
        |what: String| BadInput(format!("the drive {} cannot be used: {what}", file.display()));
    let text = files::input::text(file).map_err(|e| say(e.to_string()))?;
    read_motor(&text).map_err(|error| say(format!("{error}{}", drive_advice(&error))))
}

/// The calibration of a real rig.
pub fn calibration(chosen: &Chosen, file: Option<&Path>) -> Result<Option<Calibration>, BadInput> {
    let rig = &chosen.rig;
    let Some(file) = file else {
        return Ok(chosen.of_real().and_then(|profile| profile.calibration));
    };
    if *rig == RigChoice::Simulated {
        let why = "--calibration corrects a real rig; the simulated one's readings are true";
        return Err(BadInput(why.to_owned()));
    }
    if matches!(rig, RigChoice::Nodes { .. }) {
        let why = "--calibration corrects a rig that is opened here; the node rig_driver has it as parameters, `calibration.*`";
        return Err(BadInput(why.to_owned()));
    }
    let say = |what: String| {
        BadInput(format!("the calibration {} cannot be used: {what}", file.display()))
    };
    let text = files::input::text(file).map_err(|e| say(e.to_string()))?;
    read_calibration(&text)
        .map(Some)
        .map_err(|error| say(format!("{error}{}", calibration_advice(&error))))
}

/// The command that writes what a file given with `--calibration` lacks.
#[must_use]
pub const fn calibration_advice(error: &RigFileError) -> &'static str {
    match error {
        RigFileError::NoCalibration => "; `frictionlab rig calibrate --rig-file FILE` adds it",
        error if error.is_missing() => "; `frictionlab rig calibrate` writes one",
        _ => "",
    }
}

/// A protocol that was given, and the experiment that it is of.
type OfFile = (Arc<dyn Experiment>, Put);

/// Reads the protocols.
fn protocols(files: &[PathBuf]) -> Result<Vec<OfFile>, BadInput> {
    let mut protocols: Vec<OfFile> = Vec::with_capacity(files.len());
    for path in files {
        let say = |what: String| {
            BadInput(format!("the protocol {} cannot be driven: {what}", path.display()))
        };
        let text = files::input::text(path).map_err(|e| say(e.to_string()))?;
        let experiment = experiments::of_protocol(&text).map_err(|e| say(e.to_string()))?;
        let put = experiment.read(&text).map_err(|e| say(e.to_string()))?;
        if protocols.iter().any(|(other, _)| other.name() == experiment.name()) {
            return Err(say(format!(
                "there is another for {}; give one of a kind",
                experiment.name()
            )));
        }
        protocols.push((experiment, put));
    }
    Ok(protocols)
}

/// What is run: as asked for, or as the protocols say.
fn experiment(args: &RunArgs, protocols: &[OfFile]) -> Result<Selection, BadInput> {
    let selection = match (&args.experiment, protocols) {
        (Some(selection), _) => selection.clone(),
        (None, []) => experiments::whole_job(),
        (None, [(experiment, _)]) => Selection::alone(Arc::clone(experiment)),
        (None, _) => experiments::characterise(),
    };
    let name = selection.as_str();
    if let Some((other, _)) = protocols.iter().find(|(one, _)| !selection.includes(one.name())) {
        return Err(BadInput(format!(
            "`{name}` does not run {}, for which a protocol is given; leave the name out, or the protocol",
            other.name()
        )));
    }
    if args.thesis_tables && name != CompensationProtocol::NAME {
        let mend = "`frictionlab run compensation --thesis-tables` does";
        return Err(BadInput(format!(
            "`{name}` does not compute the thesis's tables of compensation; {mend}"
        )));
    }
    if let Some(part) = selection.parts().find(|part| part.needs_protocol())
        && protocols.is_empty()
    {
        let name = part.name();
        let mend = format!("`frictionlab protocols {name} > mine.yaml` prints one to start from");
        return Err(BadInput(format!("`run {name}` needs its protocol, --protocol FILE; {mend}")));
    }
    Ok(selection)
}

/// The thesis's tables, where they are wanted.
fn appendix(args: &RunArgs, beside: &Beside) -> Result<Option<Appendix>, BadInput> {
    if args.thesis_tables && beside.run.is_none() {
        let why = "the thesis's tables were asked for, but this program has none";
        return Err(BadInput(why.to_owned()));
    }
    Ok(beside.run.filter(|_| args.thesis_tables))
}

/// The plant's friction.
fn plant(args: &RunArgs) -> Result<AnyModel, BadInput> {
    let Some(path) = &args.plant_parameters else { return Ok(AnyModel::test_bed(args.plant)) };
    let say = |what: String| {
        BadInput(format!("the plant's parameters {} cannot be used: {what}", path.display()))
    };
    let text = files::input::text(path).map_err(|e| say(e.to_string()))?;
    file::read(&text, Some(args.plant)).map_err(|error| say(error.to_string()))
}

/// What the parameter files say together, later ones above earlier ones.
pub fn given(files: &[PathBuf]) -> Result<Given, BadInput> {
    let mut given = Given::default();
    for file in files {
        let say = |what: String| {
            BadInput(format!(
                "the parameter file {} cannot be used: {what}; expected a parameters.yaml as `frictionlab run` and `identify` write it, or a controller.yaml of `design`",
                file.display()
            ))
        };
        let text = files::input::text(file).map_err(|e| say(e.to_string()))?;
        let taken = given.take(&file.display().to_string(), &text);
        taken.map_err(|error| say(error.to_string()))?;
    }
    Ok(given)
}

/// Each of them once, in the order of the first time.
fn once_each<T: Copy + PartialEq>(given: &[T]) -> Vec<T> {
    let mut each = Vec::new();
    for one in given {
        if !each.contains(one) {
            each.push(*one);
        }
    }
    each
}
