//! `frictionlab live`: the loop in real time on ROS 2.

#![expect(
    rustdoc::broken_intra_doc_links,
    reason = "options are read in a terminal, where units are not escaped"
)]

use std::{path::PathBuf, sync::atomic::Ordering};

use controller::{ControlMode, ControllerOptions};
use friction_model::{AnyModel, ModelName};
use friction_observer::EstimatorOptions;
use friction_observer::parameters::ObserverParameters;
use rig_driver::parameters::RigParameters;
use rig_driver::{RigRegistry, SimulationOptions};

use super::serve::{USUAL, meaning, meaning_of};
use crate::interruption;
use crate::live::of_files::{self, OfFiles};
use crate::live::{self, LiveOptions, Serving};
use crate::viewing::ViewArgs;
use experiment_runner::asked::rig::{Chosen, RigParser, choose};
use experiment_runner::compensation::Means;
use experiment_runner::protocol::TrackingProtocol;
use experiment_runner::test_bed::TestBed;
use experiment_runner::test_bed::nominal_drive;
use experiment_runner::waveform::Waveform;
use files::OutputFile;
use recording::bag::remove;
use rig_setup::RigChoice;
use work::BadInput;
use work::Interrupted;
use work::destination::{RUNS, ToFolder};
use work::model_name::model_name;

/// Run the loop in real time and publish it over ROS 2
///
/// One process with the nodes rig_driver, friction_observer, controller and experiment_runner, as
/// the executables have them: parameters, lifecycle and services. The loop goes through memory on
/// one control thread at 1 kHz; the options here are the nodes' parameters, which `ros2 param set`
/// changes while it runs. Publishes /joint_states, /rig_measurement, /reference,
/// /friction_estimate, /motor_voltage, /controller_state and /diagnostics, and records them into DIR/bag. ROS_DOMAIN_ID is honoured; only this
/// machine sees it unless ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET. Ctrl-C ends the run cleanly.
///
/// --rig serial:PORT drives a real rig: a device on a serial port that speaks the protocol of
/// rig_driver/PROTOCOL.md. The device's clock sets the pace then, and it takes the motor to zero
/// volts by itself 20 ms after the last command, whatever happens here. `rig_emulator` is such a
/// device without hardware.
#[derive(Debug, clap::Args)]
pub struct LiveArgs {
    /// The rig
    #[arg(long, value_name = "RIG", value_parser = RigParser, hide_possible_values = true, help = format!(
        "The rig: {} [default: the rig of --rig-file, else simulated]",
        RigRegistry::installed().grammar()
    ))]
    pub rig: Option<RigChoice>,
    /// Rig profile: address, calibration, limits and drive in one file
    /// [default: rig.yaml of this folder, where --rig names the rig that it is of]
    #[arg(long, value_name = "FILE")]
    pub rig_file: Option<PathBuf>,
    /// Correct a real rig's readings by the calibration.yaml of `frictionlab rig calibrate`
    #[arg(long, value_name = "FILE")]
    pub calibration: Option<PathBuf>,
    /// Length of the run [s] [default: until ctrl-C]
    #[arg(long, value_name = "SECONDS")]
    pub duration: Option<f64>,
    /// What the controller regulates [default: as --parameters says, else velocity]
    #[arg(long, value_enum)]
    pub mode: Option<ModeArg>,
    /// The observer's friction model
    #[arg(long, value_name = "NAME", value_parser = model_name, help = format!(
        "{} [default: as --parameters says, else proposed]",
        meaning_of(&ObserverParameters::default(), "model")
    ))]
    pub model: Option<ModelName>,
    /// Parameters of observer and controller: a parameters.yaml of `commission`, `run` or
    /// `identify`, a controller.yaml of `design`. What they say counts where no option says
    /// otherwise. May be given several times; of a value that several files have the last counts
    /// [default: the thesis's test bed]
    #[arg(long, value_name = "FILE")]
    pub parameters: Vec<PathBuf>,
    /// The simulated plant's own friction model
    #[arg(long, value_name = "NAME", default_value = "proposed", value_parser = model_name,
        help = meaning_of(&RigParameters::default(), "simulated.model"))]
    pub plant: ModelName,
    /// Shape of the reference
    #[arg(long, value_enum, default_value_t)]
    pub reference: ReferenceArg,
    /// Amplitude of the sine, or the constant velocity [rad/s or rad, by mode]
    /// [default: 0.3 rad/s or 1 rad]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub amplitude: Option<f64>,
    /// Angular frequency of the sine [rad/s] [default: 0.107 for velocity, 0.546 for position]
    #[arg(long, value_name = "W")]
    pub frequency: Option<f64>,
    /// By what means friction is compensated [default: as --parameters says, else feedback]
    #[arg(long, value_enum, value_name = "MEANS")]
    pub means: Option<Means>,
    /// Estimate friction, but do not compensate it
    #[arg(long)]
    pub no_compensation: bool,
    /// Control cycles a second [Hz] [default: 1000, or what the device on the serial port says]
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(100..=2000))]
    pub rate: Option<u32>,
    /// Where the results go.
    #[command(flatten)]
    pub to: ToFolder,
    /// Meanwhile run experiments for whoever asks over ROS 2, as `frictionlab serve` does; their
    /// folders go to `runs`
    #[arg(long)]
    pub serve: bool,
    /// With --serve: rigs that requests may use, separated by commas; `nodes` are those of this run
    #[arg(
        long,
        value_name = "RIGS",
        value_delimiter = ',',
        requires = "serve",
        default_value = USUAL.allow_rigs.as_str(),
        help = format!("With --serve: {}", meaning("allow_rigs"))
    )]
    pub allow_rigs: Vec<RigChoice>,
    /// The view.
    #[command(flatten)]
    pub view: ViewArgs,
    /// Seed of the sensors' noise
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64),
        help = meaning_of(&RigParameters::default(), "simulated.seed"))]
    pub seed: u64,
    /// Write the exact percentiles of the periods' errors to FILE, as JSON; - is standard output,
    /// and nothing else is printed there
    #[arg(long, value_name = "FILE")]
    pub timing: Option<PathBuf>,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
    /// Print what the run came to as JSON for programs, and nothing else on standard output
    /// (docs/reference/json.md)
    #[arg(long)]
    pub json: bool,
    /// Arguments of ROS for the nodes, last on the line: -r __ns:=/axis_1, -p controller:fade:=0.2,
    /// --params-file FILE
    #[arg(long = "ros-args", value_name = "ROS ARGUMENTS", num_args = 0.., allow_hyphen_values = true)]
    pub ros_arguments: Vec<String>,
}

/// Control cycles a second of the simulated rig [Hz].
const RATE: u32 = 1000;

/// [`ControlMode`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum ModeArg {
    /// Velocity, by the lag compensator
    Velocity,
    /// Position, by the PID
    Position,
}

/// Shape of the reference on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum ReferenceArg {
    /// A sine of velocity or position, by mode
    #[default]
    Sine,
    /// A constant velocity
    Constant,
    /// Whatever comes on the topic /reference; without any the shaft stands
    Ros,
}

/// Runs it.
///
/// # Errors
/// [`BadInput`] for what the user can mend, [`Interrupted`] if ctrl-C came before the end of
/// `--duration`.
pub fn execute(args: &LiveArgs) -> anyhow::Result<()> {
    let chosen = choose(args.rig.as_ref(), args.rig_file.as_deref())?;
    let options = options(args, &chosen)?;
    if let Some(note) = chosen.note.as_ref().filter(|_| !args.quiet) {
        eprintln!("{note}");
    }
    let folder = args.to.reserve("live")?;
    if args.to.force {
        remove(&folder.join("bag"))?;
    }
    let options = LiveOptions { out: folder.path().to_owned(), ..options };
    let stop = interruption::watch(ros_node::ENDS_WITHIN_WRITING)?;
    ros_node::terminal::tell_panics();
    // Standard output may be for the percentiles alone.
    let quiet =
        args.quiet || args.json || options.timing.as_ref().is_some_and(OutputFile::is_stdout);
    let say = |text: &str| {
        if !quiet {
            // A terminal that went away must not stop the loop.
            let _ = work::saying::print(&format!("{text}\n"));
        }
    };
    if !args.quiet {
        super::offer_recovery(std::path::Path::new(RUNS));
    }
    let report = live::run(&options, &stop, |priority| {
        let rate = match (args.rate, &chosen.rig) {
            (None, rig) if rig.is_opened() => "the device's rate".to_owned(),
            (rate, _) => format!("{} Hz", rate.unwrap_or(RATE)),
        };
        // The rig runs: a terminal that takes nothing must not keep its nodes from being looked
        // after.
        if !quiet {
            ros_node::terminal::say(format!("{priority}\nlive at {rate}; ctrl-C ends the run"));
        }
    })?;
    ros_node::terminal::flush();
    if args.json {
        work::saying::print(&format!("{:#}\n", report.document()))?;
    }
    say(&report.to_string());
    let bag = report.bag.dir.display();
    if report.interrupted {
        return Err(Interrupted(format!(
            "stopped before the end; the bag in {bag} is whole as far as it goes"
        ))
        .into());
    }
    if stop.load(Ordering::Relaxed) {
        say(&format!("stopped by ctrl-C; the bag in {bag} is whole"));
    }
    Ok(())
}

fn options(args: &LiveArgs, chosen: &Chosen) -> anyhow::Result<LiveOptions> {
    let given = experiment_runner::asked::given(&args.parameters)?;
    let mode = match args.mode {
        Some(ModeArg::Velocity) => ControlMode::Velocity,
        Some(ModeArg::Position) => ControlMode::Position,
        None => of_files::mode(&given).unwrap_or_default(),
    };
    let of_files = OfFiles::of(&given, args.no_compensation || args.means.is_some());
    let mut controller = given
        .controller(&ControllerOptions::default())
        .map_err(|error| BadInput(error.to_string()))?;
    let usual = SimulationOptions::default();
    let limits = chosen.limits(None);
    let drive = chosen.motor().unwrap_or(usual.drive);
    let voltage_limit = limits.voltage.unwrap_or(usual.voltage_limit);
    controller.compensation.volts_per_newton_metre = of_files
        .of_controller("volts_per_newton_metre")
        .unwrap_or_else(|| usual.friction_coupling.volts_per_newton_metre(&drive));
    let test_bed = TestBed {
        simulation: SimulationOptions {
            period: 1.0 / f64::from(args.rate.unwrap_or(RATE)),
            drive,
            voltage_limit,
            // A real rig tells its own when it is opened, and nothing moves before.
            voltage_range: usual.voltage_range.max(voltage_limit),
            ..usual
        },
        friction: AnyModel::test_bed(args.plant),
        controller,
        estimator: EstimatorOptions {
            drive: nominal_drive(&drive, usual.friction_coupling),
            ..Default::default()
        },
    };
    Ok(LiveOptions {
        out: PathBuf::new(),
        rig: chosen.rig.clone(),
        calibration: experiment_runner::asked::calibration(chosen, args.calibration.as_deref())?,
        limits,
        description: chosen.of_real().and_then(|profile| profile.description.clone()),
        rate_given: args.rate.is_some(),
        test_bed,
        mode,
        reference: reference(args, mode)?,
        observer: args.model.or_else(|| of_files::model(&given)).unwrap_or(ModelName::Proposed),
        of_files,
        models: given.compensators,
        origins: {
            let mut origins = given.origins;
            chosen.drive_origin(&mut origins);
            chosen.limit_origin(&mut origins);
            origins
        },
        means: (!args.no_compensation).then_some(args.means.unwrap_or_default()),
        seed: args.seed,
        duration: args.duration,
        serve: args.serve.then(|| Serving {
            runs: PathBuf::from(RUNS),
            allow_rigs: args.allow_rigs.clone(),
            offers: super::ERRANDS,
        }),
        view: args.view.options("live"),
        view_runs: args.view.runs(RUNS).to_owned(),
        ros_arguments: args
            .quiet
            .then_some(["--log-level", "error"].map(str::to_owned))
            .into_iter()
            .flatten()
            .chain(args.ros_arguments.iter().cloned())
            .collect(),
        timing: args
            .timing
            .as_deref()
            .map(|file| OutputFile::new(file, args.to.force))
            .transpose()?,
    })
}

fn reference(args: &LiveArgs, mode: ControlMode) -> anyhow::Result<Option<Waveform>> {
    if args.reference == ReferenceArg::Ros {
        return if args.amplitude.or(args.frequency).is_none() {
            Ok(None)
        } else {
            Err(BadInput(
                "--amplitude and --frequency belong to a reference of its own; with --reference ros leave them out"
                    .to_owned(),
            )
            .into())
        };
    }
    let finite = |name: &str, value: Option<f64>| match value {
        Some(value) if !value.is_finite() || (name == "--frequency" && value <= 0.0) => {
            Err(BadInput(format!(
                "{name} must be a finite number{}, but is {value}",
                if name == "--frequency" { " above 0" } else { "" }
            )))
        }
        value => Ok(value),
    };
    let (amplitude_given, frequency_given) =
        (finite("--amplitude", args.amplitude)?, finite("--frequency", args.frequency)?);
    // Above half the rate a sampled sine is another, slower one.
    let rate = args.rate.unwrap_or(RATE);
    let highest = std::f64::consts::PI * f64::from(rate);
    if let Some(given) = frequency_given.filter(|given| *given > highest) {
        return Err(BadInput(format!(
            "--frequency must be above 0 and at most {highest:.0} rad/s, half the {rate} Hz of the loop, but is {given}"
        ))
        .into());
    }
    let default = match mode {
        ControlMode::Velocity => TrackingProtocol::velocity().reference,
        ControlMode::Position => TrackingProtocol::position().reference,
    };
    Ok(Some(match (args.reference, default) {
        (ReferenceArg::Constant | ReferenceArg::Ros, _) => {
            Waveform::ConstantVelocity { velocity: amplitude_given.unwrap_or(0.3) }
        }
        (ReferenceArg::Sine, Waveform::SineVelocity { amplitude, angular_frequency }) => {
            Waveform::SineVelocity {
                amplitude: amplitude_given.unwrap_or(amplitude),
                angular_frequency: frequency_given.unwrap_or(angular_frequency),
            }
        }
        (ReferenceArg::Sine, Waveform::SinePosition { amplitude, angular_frequency }) => {
            Waveform::SinePosition {
                amplitude: amplitude_given.unwrap_or(amplitude),
                angular_frequency: frequency_given.unwrap_or(angular_frequency),
            }
        }
        (ReferenceArg::Sine, other) => other,
    }))
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use experiment_runner::asked::rig::choose;
    use ros_node::ParameterValue;

    use super::*;

    #[derive(clap::Parser)]
    struct Command {
        #[command(flatten)]
        args: LiveArgs,
    }

    /// What a commission hands over, as far as `live` would else do as it pleases.
    const HANDED_OVER: &str = "
/friction_observer:
  ros__parameters:
    model: stribeck
    stribeck: {f_s: 0.5, f_c: 0.4, v_s: 0.1, delta: 2.0, f_v: 0.0}
    technique: feedforward
    mode: position
    drive: {gain: 1.2, time_constant: 0.05, volts_per_newton_metre: 1.0}
    period: 0.002
/controller:
  ros__parameters:
    mode: position
    compensation: true
    volts_per_newton_metre: 1.0
    voltage_limit: 8.0
    resting_angle: 0.003
    pid: {k_p: 9.0, k_i: 20.0, k_d: 0.1}
";

    fn of(more: &[&str]) -> LiveOptions {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("parameters.yaml");
        std::fs::write(&file, HANDED_OVER).unwrap();
        let file = file.display().to_string();
        let command = Command::parse_from([&["live", "--parameters", &file], more].concat());
        options(&command.args, &choose(Some(&RigChoice::Simulated), None).unwrap()).unwrap()
    }

    #[test]
    fn what_was_handed_over_counts_by_its_file_alone() {
        let options = of(&[]);
        assert_eq!((options.mode, options.observer), (ControlMode::Position, ModelName::Stribeck));
        assert_eq!(options.models.get(ModelName::Stribeck).parameter("f_s"), Some(0.5));
        assert_eq!(options.test_bed.controller.compensation.volts_per_newton_metre, 1.0);
        assert_eq!(options.test_bed.controller.resting_angle, 0.003);
        let said = |name: &str| options.of_files.observer.get(name).cloned();
        assert_eq!(said("technique"), Some(ParameterValue::String("feedforward".to_owned())));
        assert_eq!(said("drive.gain"), Some(ParameterValue::Double(1.2)));
        assert_eq!(said("period"), None);
        assert_eq!(options.of_files.controller["compensation"], ParameterValue::Boolean(true));
        assert_eq!(options.of_files.controller["voltage_limit"], ParameterValue::Double(8.0));
    }

    #[test]
    fn what_an_option_says_counts_above_the_file() {
        let options = of(&["--mode", "velocity", "--model", "lugre", "--means", "fuzzy"]);
        assert_eq!((options.mode, options.observer), (ControlMode::Velocity, ModelName::LuGre));
        assert_eq!(options.means, Some(Means::Fuzzy));
        assert!(!options.of_files.observer.contains_key("technique"));
        assert!(!of(&["--no-compensation"]).of_files.controller.contains_key("compensation"));
    }
}
