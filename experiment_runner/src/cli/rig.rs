//! `frictionlab rig`: find a rig, look at it, move it a little, calibrate it.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use controller::{ControlMode, Controller, ControllerOptions, Feedback, Reference};
use friction_model::{AnyModel, ModelName};
use rig_driver::Miswiring;
use rig_driver::quanser::find_library;

use super::{BadInput, Interrupted, interruption, model_name, print};
use crate::output::write_all;
use crate::rig::{
    Display, Findings, Procedure, RigChoice, RigSetupError, Session, findings_table, read_calibration,
    render_calibration, run_procedure, serial_ports,
};

/// Set a rig up: list, check, jog, calibrate
///
/// A new rig goes through these in order. Every voltage goes through the driver's safety layer (docs/safety.md), and ctrl-C
/// puts the motor at zero volts.
///
///   frictionlab rig list                        what is connected
///   frictionlab rig jog --volts 0.8 --seconds 1 a first small move, all channels shown
///   frictionlab rig check                       are signs, gains and zeros right?
///   frictionlab rig calibrate                   find them and write calibration.yaml
///
/// To practise, the simulated rig can be wired wrong:
///
///   frictionlab rig calibrate --miswired encoder,tachometer=0.9,torque-zero=0.05
///   frictionlab rig check --miswired encoder,tachometer=0.9,torque-zero=0.05 --calibration calibration.yaml
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct RigArgs {
    #[command(subcommand)]
    command: RigCommand,
}

#[derive(Debug, clap::Subcommand)]
enum RigCommand {
    /// Show which rigs this machine has
    ///
    /// The simulated one, devices on serial ports, and Quanser's library if it is installed. Nothing is opened.
    List,
    /// Show the channels, then find out whether signs, gains and zeros are right
    ///
    /// The shaft turns: a few slow ramps of voltage until it moves, then steady voltages up to --max-volts both ways in turn,
    /// about half a minute in all. Ends with exit code 1 if something is wrong, and says how to mend it.
    Check {
        #[command(flatten)]
        which: Which,
        /// How long the channels are shown before anything moves [s]
        #[arg(long, value_name = "SECONDS", default_value_t = 3.0)]
        seconds: f64,
    },
    /// Move the shaft by a small voltage or at a low velocity, and show the channels
    ///
    /// It moves while the command lives: ctrl-C, or the end of --seconds, puts the motor at zero volts.
    Jog {
        #[command(flatten)]
        which: Which,
        /// Voltage [V], at most --max-volts
        #[arg(
            long,
            value_name = "V",
            allow_negative_numbers = true,
            conflicts_with = "velocity",
            required_unless_present = "velocity"
        )]
        volts: Option<f64>,
        /// Velocity [rad/s], at most 2, by the tachometer: check its sign first
        #[arg(long, value_name = "RAD_S", allow_negative_numbers = true)]
        velocity: Option<f64>,
        /// How long [s], at most 600
        #[arg(long, value_name = "SECONDS", default_value_t = 2.0)]
        seconds: f64,
    },
    /// Find signs, gains and zeros and write calibration.yaml
    ///
    /// The same steps as `check`. The file is a ROS 2 parameter file for /rig_driver: encoder sign, tachometer gain and zero, torque sign and
    /// zero, and the voltages that just move the shaft, with standard errors.
    Calibrate {
        #[command(flatten)]
        which: Which,
        /// Folder for calibration.yaml
        #[arg(long, value_name = "DIR", default_value = ".")]
        out: PathBuf,
    },
}

/// Which rig, and how.
#[derive(Debug, clap::Args)]
struct Which {
    /// `simulated`, `quanser[:CARD]` or `serial:PORT`
    #[arg(long, value_name = "RIG", default_value = "simulated")]
    rig: RigChoice,
    /// Highest voltage of all steps [V]
    #[arg(long, value_name = "V", default_value_t = 2.0)]
    max_volts: f64,
    /// Correct the readings by this calibration.yaml
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Wire the simulated rig wrong: motor, encoder, torque, encoder-unplugged, tachometer-unplugged, tachometer=GAIN, tachometer-zero=RAD_S,
    /// torque-zero=NM; parted by commas
    #[arg(long, value_name = "MISTAKES")]
    miswired: Option<Miswiring>,
    /// Friction model of the simulated rig
    #[arg(long, value_name = "NAME", default_value = "proposed", value_parser = model_name)]
    plant: ModelName,
    /// Seed of the simulated rig's noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Show no channels, print the results only
    #[arg(long, short)]
    quiet: bool,
}

/// Fastest velocity of a jog [rad/s].
const JOG_VELOCITY: f64 = 2.0;

/// Runs it.
///
/// # Errors
/// [`BadInput`] for what the user can mend, [`Interrupted`] at ctrl-C; a plain error if the check found something wrong.
pub fn execute(args: &RigArgs) -> anyhow::Result<()> {
    match &args.command {
        RigCommand::List => print(&list()),
        RigCommand::Check { which, seconds } => {
            within("--seconds", *seconds, 0.0, 600.0)?;
            check(which, *seconds)
        }
        RigCommand::Jog { which, volts, velocity, seconds } => {
            within("--seconds", *seconds, 0.0, 600.0)?;
            jog(which, *volts, *velocity, *seconds)
        }
        RigCommand::Calibrate { which, out } => {
            let found = find(which, None)?;
            print(&findings_table(&found))?;
            write_all(out, &[("calibration.yaml", render_calibration(&found, &which.rig))])?;
            let file = out.join("calibration.yaml");
            print(&format!("\nCalibration  {}\n", file.display()))
        }
    }
}

/// What this machine has.
fn list() -> String {
    let mut text = String::from("simulated      the test bed of the thesis, always there\n");
    match find_library() {
        Ok(library) => {
            let _ = writeln!(
                text,
                "quanser        HIL library {} is there; which cards are, only opening one tells",
                library.display()
            );
        }
        Err(error) => {
            let _ = writeln!(text, "quanser        {error}");
        }
    }
    let ports = serial_ports();
    for port in &ports {
        let name = port.by_id.as_ref().unwrap_or(&port.device);
        let product = port.product.as_deref().unwrap_or("a device that does not tell its name");
        // Writing to a string cannot fail.
        let _ = writeln!(text, "serial:{}  {product} ({})", name.display(), port.device.display());
    }
    if ports.is_empty() {
        text += "serial         no serial port with a device on it; plug the board in, and see that your user may open it (group dialout)\n";
    }
    text
}

fn check(which: &Which, seconds: f64) -> anyhow::Result<()> {
    let found = find(which, Some(seconds))?;
    print(&findings_table(&found))?;
    let wrong = found.verdicts().iter().filter(|verdict| verdict.wrong.is_some()).count();
    anyhow::ensure!(wrong == 0, "{wrong} of {} are wrong, as said above", found.verdicts().len());
    print("\nAll is right.\n")
}

/// Shows the channels for some seconds, if asked to, and goes through the steps.
fn find(which: &Which, show: Option<f64>) -> anyhow::Result<Findings> {
    let stop = watch_ctrl_c()?;
    let say = |text: &str| {
        if !which.quiet {
            eprintln!("{text}");
        }
    };
    if let Some(seconds) = show.filter(|_| !which.quiet) {
        drive(which, &stop, true, |session| {
            say("channels at zero volts; turn the shaft by hand and look");
            session.hold(0.0, seconds).map(drop)
        })?;
    }
    drive(which, &stop, false, |session| run_procedure(session, &Procedure::default(), say))
}

fn jog(which: &Which, volts: Option<f64>, velocity: Option<f64>, seconds: f64) -> anyhow::Result<()> {
    if let Some(volts) = volts {
        within("--volts", volts.abs(), 0.0, which.max_volts)?;
    }
    if let Some(velocity) = velocity {
        within("--velocity", velocity.abs(), 0.0, JOG_VELOCITY)?;
    }
    let stop = watch_ctrl_c()?;
    drive(which, &stop, !which.quiet, |session| {
        let Some(velocity) = velocity else { return session.hold(volts.unwrap_or(0.0), seconds).map(drop) };
        let options = ControllerOptions {
            mode: ControlMode::Velocity,
            period: session.period(),
            voltage_limit: session.max_volts(),
            ..ControllerOptions::default()
        };
        let mut controller =
            Controller::new(options).map_err(|error| RigSetupError::NotDriven(error.to_string()))?;
        let reference = Reference { velocity, ..Reference::default() };
        for _ in 0..(seconds / session.period()).round() as u64 {
            session.step(|seen| {
                let feedback = Feedback {
                    position: seen.encoder_position,
                    velocity: seen.tachometer_velocity,
                    friction: 0.0,
                    cycle: Some(seen.cycle),
                };
                controller.step(&reference, &feedback).total
            })?;
        }
        Ok(())
    })
}

/// Opens the rig and drives it; afterwards it is at zero volts.
fn drive<T>(
    which: &Which,
    stop: &AtomicBool,
    shown: bool,
    work: impl FnOnce(&mut Session<'_>) -> Result<T, RigSetupError>,
) -> anyhow::Result<T> {
    if which.miswired.is_some() && which.rig != RigChoice::Simulated {
        return Err(
            BadInput("--miswired is for the simulated rig; a real one is wired as it is".to_owned()).into()
        );
    }
    let calibration = match &which.calibration {
        None => None,
        Some(file) => {
            let bad = |said: String| BadInput(format!("{}: {said}", file.display()));
            let text = crate::input::text(file).map_err(|error| bad(error.to_string()))?;
            Some(read_calibration(&text).map_err(bad)?)
        }
    };
    let mut display = Display::default();
    let outcome = which
        .rig
        .open(AnyModel::test_bed(which.plant), which.seed, which.miswired, calibration)
        .and_then(|opened| Session::new(opened, which.max_volts, stop))
        .and_then(|session| {
            let mut session = if shown { session.shown(|seen| display.show(seen)) } else { session };
            work(&mut session)
        });
    display.end();
    outcome.map_err(|error| match error {
        RigSetupError::Stopped => Interrupted(error.to_string()).into(),
        RigSetupError::Rig(rig_driver::RigError::OutOfRange { .. } | rig_driver::RigError::Quanser(_))
        | RigSetupError::NotDriven(_) => BadInput(error.to_string()).into(),
        error => anyhow::Error::new(error),
    })
}

fn within(name: &str, value: f64, low: f64, high: f64) -> Result<(), BadInput> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(BadInput(format!("{name} must be a number of at most {high} in magnitude, but is {value}")))
    }
}

fn watch_ctrl_c() -> anyhow::Result<Arc<AtomicBool>> {
    interruption::watch(interruption::DRIVING)
}
