//! `frictionlab rig`: find a rig, look at it, move it a little, calibrate it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::{Duration, SystemTime};

use controller::{ControlMode, Controller, ControllerOptions, Feedback, Reference};
use friction_model::{AnyModel, ModelName};
use rig_driver::registry::Listed;
use rig_driver::{Calibration, Miswiring, RigRegistry, SimulationOptions};

use crate::interruption;
use experiment_runner::asked::calibration_advice;
use experiment_runner::asked::rig::{Chosen, RigParser, choose};
use files::{OutputError, OutputFile};
use rig_setup::{
    Display, Findings, JogSummary, Procedure, RigChoice, RigDescription, RigLimits, RigProfile,
    RigSetup, RigSetupError, SensorsPresent, Session, findings_table, read_calibration,
    render_calibration, require_device, run_procedure,
};
use work::BadInput;
use work::Interrupted;
use work::destination::Force;
use work::model_name::model_name;
use work::saying::print;

/// Set a rig up: list, check, jog, calibrate
///
/// A new rig goes through these in order. Every voltage goes through the driver's safety layer
/// (docs/explanation/safety.md), and ctrl-C puts the motor at zero volts.
///
///   frictionlab rig list                        what is connected
///   frictionlab rig jog --volts 0.8 --seconds 1 a first small move, all channels shown
///   frictionlab rig check                       are signs, gains and zeros right?
///   frictionlab rig calibrate                   find them and write calibration.yaml
///
/// To practise, the simulated rig can be wired wrong:
///
///   frictionlab rig calibrate --miswired encoder,tachometer=0.9,torque-zero=0.05
///   frictionlab rig check --miswired encoder,tachometer=0.9,torque-zero=0.05 --calibration
///   calibration.yaml
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
    /// The simulated one, devices on serial ports, emulators that run on this machine, and
    /// Quanser's library if it is installed. Nothing is opened.
    List,
    /// Show the channels, then find out whether signs, gains and zeros are right
    ///
    /// The shaft turns: a few slow ramps of voltage until it moves, then steady voltages up to
    /// --max-volts both ways in turn, about half a minute in all. Ends with exit code 1 if
    /// something is wrong, and says how to mend it.
    Check {
        #[command(flatten)]
        which: Which,
        /// How long the channels are shown before anything moves [s]
        #[arg(long, value_name = "SECONDS", default_value_t = 3.0)]
        seconds: f64,
    },
    /// Move the shaft by a small voltage or at a low velocity, and show the channels
    ///
    /// It moves while the command lives: ctrl-C, or the end of --seconds, puts the motor at zero
    /// volts.
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
    /// The same steps as `check`. The file is a ROS 2 parameter file for /rig_driver: encoder sign,
    /// tachometer gain and zero, torque sign and zero, and the voltages that just move the shaft,
    /// with standard errors.
    Calibrate {
        #[command(flatten)]
        which: Which,
        /// Folder for calibration.yaml
        /// [default: this folder; with a rig profile none, the profile has the calibration]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        #[command(flatten)]
        replace: Force,
    },
}

/// Which rig, and how.
#[derive(Debug, clap::Args)]
struct Which {
    /// Which rig
    #[arg(long, value_name = "RIG", value_parser = RigParser, hide_possible_values = true, help = format!(
        "Which rig: {} [default: the rig of --rig-file, else simulated]",
        RigRegistry::installed().grammar()
    ))]
    rig: Option<RigChoice>,
    /// Rig profile: address, limits, calibration and drive in one file. `check` and `calibrate`
    /// write it, and make it if --rig names the rig
    /// [default: rig.yaml of this folder, where --rig names the rig that it is of]
    #[arg(long, value_name = "FILE")]
    rig_file: Option<PathBuf>,
    /// Voltage limit of this rig [V], at most its own voltage range; `check` and `calibrate` put it
    /// into the profile [default: that of the profile, else 6]
    #[arg(long, value_name = "V")]
    voltage_limit: Option<f64>,
    /// Highest voltage of all steps [V]
    #[arg(long, value_name = "V", default_value_t = 2.0)]
    max_volts: f64,
    /// Correct the readings by this calibration.yaml
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Wire the simulated rig wrong: motor, encoder, torque, encoder-unplugged,
    /// tachometer-unplugged, tachometer=GAIN, tachometer-zero=RAD_S, torque-zero=NM; parted by
    /// commas
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

impl Which {
    /// The simulated rig as the options have it.
    fn simulated(&self) -> RigSetup {
        RigSetup {
            simulation: SimulationOptions { seed: self.seed, ..SimulationOptions::default() },
            friction: AnyModel::test_bed(self.plant),
            wiring: self.miswired,
            ..RigSetup::default()
        }
    }
}

/// How often the steps are begun again where the line to a device failed.
const REPEATS: u32 = 20;
/// Steps that took longer, because the program or its machine was stopped meanwhile, are not:
/// nobody knows who is at the rig by then.
const LONGEST: Duration = Duration::from_secs(90);

/// Fastest velocity of a jog [rad/s].
const JOG_VELOCITY: f64 = 2.0;

/// Runs it.
///
/// # Errors
/// [`BadInput`] for what the user can mend, [`Interrupted`] at ctrl-C; a plain error if the check
/// found something wrong.
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
        RigCommand::Calibrate { which, out, replace } => calibrate(which, out.as_deref(), replace),
    }
}

fn calibrate(which: &Which, out: Option<&Path>, replace: &Force) -> anyhow::Result<()> {
    let place = Place::of(which, true)?;
    let out = out.or(if place.file.is_none() { Some(Path::new(".")) } else { None });
    // Before anything moves.
    if let Some(folder) = out {
        fs::create_dir_all(folder)
            .map_err(|source| OutputError::Write { path: folder.to_owned(), source })?;
    }
    let name = out.map(|folder| folder.join("calibration.yaml"));
    let file = name.as_deref().map(|name| replace.file(name)).transpose()?;
    let profile = place.writable()?;
    // Against the readings as they come: what an earlier calibration put right is found once more.
    let (calibration, limits) = (explicit_calibration(which)?, place.limits(which));
    let setup = RigSetup { calibration, limits, ..which.simulated() };
    let (found, seen) = find(which, &place, setup, None)?;
    print(&findings_table(&found))?;
    print("\n")?;
    if let Some(file) = file {
        file.write(render_calibration(&found, &place.chosen.rig).as_bytes())?;
        print(&format!("Calibration  {}\n", file.name()))?;
    }
    place.write(profile, which, &seen, Some(found.calibration()))
}

/// Which rig a command drives, and which profile it may write.
struct Place {
    chosen: Chosen,
    file: Option<PathBuf>,
}

/// What an opened rig said of itself.
struct Seen {
    description: Option<RigDescription>,
    sensors: SensorsPresent,
}

impl Place {
    /// Of the options; a profile that `creates` may make need not be there.
    fn of(which: &Which, creates: bool) -> Result<Self, BadInput> {
        let new =
            which.rig_file.as_deref().filter(|file| creates && file.symlink_metadata().is_err());
        let chosen = match (new, &which.rig) {
            (Some(_), Some(rig @ RigChoice::Nodes { .. })) => {
                return Err(BadInput(format!("{rig} is driven by its nodes and has no profile")));
            }
            (Some(_), Some(rig)) => Chosen { rig: rig.clone(), profile: None, note: None },
            (Some(file), None) => {
                return Err(BadInput(format!(
                    "there is no rig profile {} yet: name the rig once, as in --rig serial:/dev/ttyACM0 --rig-file {}",
                    file.display(),
                    file.display()
                )));
            }
            (None, rig) => choose(rig.as_ref(), which.rig_file.as_deref())?,
        };
        if let Some(note) = chosen.note.as_ref().filter(|_| !which.quiet) {
            eprintln!("{note}");
        }
        let used = || chosen.profile.as_ref().map(|(file, _)| file.clone());
        let file = which.rig_file.clone().or_else(used);
        Ok(Self { chosen, file })
    }

    /// The profile, where it is of the rig that is driven.
    fn profile(&self) -> Option<&RigProfile> {
        self.chosen.profile()
    }

    fn limits(&self, which: &Which) -> RigLimits {
        let limits = self.profile().map(|profile| profile.limits).unwrap_or_default();
        RigLimits { voltage: which.voltage_limit.or(limits.voltage), ..limits }
    }

    /// As a check, a jog and a run see the rig: with what is known of it.
    fn setup(&self, which: &Which) -> Result<RigSetup, BadInput> {
        let calibration = match explicit_calibration(which)? {
            None => self.profile().and_then(|profile| profile.calibration),
            given => given,
        };
        Ok(RigSetup { calibration, limits: self.limits(which), ..which.simulated() })
    }

    /// The profile's file, if there is to be one: its parts are written anew, and it can be
    /// written.
    fn writable(&self) -> anyhow::Result<Option<OutputFile>> {
        let folder = self.file.as_deref().and_then(Path::parent);
        if let Some(folder) =
            folder.filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir())
        {
            return Err(BadInput(format!(
                "there is no folder {} for the rig profile",
                folder.display()
            ))
            .into());
        }
        let file = self.file.as_deref().map(|file| OutputFile::new(file, true));
        Ok(file.transpose()?)
    }

    /// Writes the profile, if there is to be one: what was `seen`, the limits, and the calibration
    /// that was `found`.
    fn write(
        &self,
        file: Option<OutputFile>,
        which: &Which,
        seen: &Seen,
        found: Option<Calibration>,
    ) -> anyhow::Result<()> {
        let Some(file) = file else { return Ok(()) };
        let before =
            self.profile().cloned().unwrap_or_else(|| RigProfile::new(self.chosen.rig.clone()));
        let other = before.description.as_ref().zip(seen.description.as_ref());
        // The drive of another device is not this one's.
        let same = other.is_none_or(|(before, seen)| before.differs_from(seen).is_none());
        let profile = RigProfile {
            rig: self.chosen.rig.clone(),
            description: seen.description.clone(),
            sensors: Some(seen.sensors),
            limits: self.limits(which),
            calibration: found.or(before.calibration),
            drive: before.drive.filter(|_| same),
        };
        file.write(profile.text().as_bytes())?;
        print(&format!("Rig profile  {}: {}, {}\n", file.name(), profile.rig, profile.parts()))
    }
}

/// The calibration of `--calibration`.
fn explicit_calibration(which: &Which) -> Result<Option<Calibration>, BadInput> {
    let Some(file) = &which.calibration else { return Ok(None) };
    let bad = |said: String| BadInput(format!("{}: {said}", file.display()));
    let text = files::input::text(file).map_err(|error| bad(error.to_string()))?;
    read_calibration(&text)
        .map(Some)
        .map_err(|error| bad(format!("{error}{}", calibration_advice(&error))))
}

/// What this machine has.
fn list() -> String {
    let line = |listed: Listed| format!("{:<13}  {}\n", listed.address, listed.about);
    RigRegistry::installed().listed().into_iter().map(line).collect()
}

fn check(which: &Which, seconds: f64) -> anyhow::Result<()> {
    let place = Place::of(which, true)?;
    let profile = place.writable()?;
    let (found, seen) = find(which, &place, place.setup(which)?, Some(seconds))?;
    print(&findings_table(&found))?;
    if profile.is_some() {
        print("\n")?;
        place.write(profile, which, &seen, None)?;
    }
    let wrong = found.verdicts().iter().filter(|verdict| verdict.wrong.is_some()).count();
    anyhow::ensure!(wrong == 0, "{wrong} of {} are wrong, as said above", found.verdicts().len());
    print("\nAll is right.\n")
}

/// Shows the channels for some seconds, if asked to, and goes through the steps.
fn find(
    which: &Which,
    place: &Place,
    setup: RigSetup,
    show: Option<f64>,
) -> anyhow::Result<(Findings, Seen)> {
    let stop = watch_ctrl_c()?;
    let say = |text: &str| {
        if !which.quiet {
            eprintln!("{text}");
        }
    };
    if let Some(seconds) = show.filter(|_| !which.quiet) {
        drive(which, place, setup, (&stop, true), |session| {
            say("channels at zero volts; turn the shaft by hand and look");
            session.hold(0.0, seconds).map(drop)
        })?;
    }
    // What a line that fails costs is the steps at hand: they are begun again, on a serial device
    // whose travel is not limited.
    let may_repeat = place.chosen.rig.comes_back() && setup.limits.travel.is_none();
    let mut repeats = 0;
    loop {
        let begun = SystemTime::now();
        let outcome = drive(which, place, setup, (&stop, false), |session| {
            run_procedure(session, &Procedure::default(), say)
        });
        let of_the_line = |error: &anyhow::Error| match error.downcast_ref::<RigSetupError>() {
            Some(RigSetupError::Rig(error)) => error.is_of_the_line(),
            _ => false,
        };
        let soon = || begun.elapsed().is_ok_and(|since| since < LONGEST);
        match outcome {
            Err(error) if may_repeat && repeats < REPEATS && of_the_line(&error) && soon() => {
                repeats += 1;
                eprintln!(
                    "{error}: zero volts. The steps begin again; ctrl-C before you touch the rig"
                );
                // The device's old session ends.
                thread::sleep(Duration::from_secs(1));
            }
            other => return other,
        }
    }
}

fn jog(
    which: &Which,
    volts: Option<f64>,
    velocity: Option<f64>,
    seconds: f64,
) -> anyhow::Result<()> {
    if let Some(volts) = volts {
        within("--volts", volts.abs(), 0.0, which.max_volts)?;
    }
    if let Some(velocity) = velocity {
        within("--velocity", velocity.abs(), 0.0, JOG_VELOCITY)?;
    }
    let place = Place::of(which, false)?;
    let stop = watch_ctrl_c()?;
    let mut summary = JogSummary::default();
    let (outcome, _) =
        drive(which, &place, place.setup(which)?, (&stop, !which.quiet), |session| {
            let outcome = jogged(session, (volts, velocity), seconds, &mut summary);
            // What happened until then is told all the same.
            Ok(outcome)
        })?;
    print(&summary.text())?;
    outcome.map_err(told)
}

/// Drives the jog, and notes what is seen.
fn jogged(
    session: &mut Session<'_>,
    (volts, velocity): (Option<f64>, Option<f64>),
    seconds: f64,
    summary: &mut JogSummary,
) -> Result<(), RigSetupError> {
    let cycles = (seconds / session.period()).round() as u64;
    let Some(velocity) = velocity else {
        for _ in 0..cycles {
            summary.add(&session.step(|_| volts.unwrap_or(0.0))?);
        }
        return Ok(());
    };
    let options = ControllerOptions {
        mode: ControlMode::Velocity,
        period: session.period(),
        voltage_limit: session.max_volts(),
        ..ControllerOptions::default()
    };
    let mut controller =
        Controller::new(options).map_err(|error| RigSetupError::NotDriven(error.to_string()))?;
    let reference = Reference { velocity, ..Reference::default() };
    for _ in 0..cycles {
        let seen = session.step(|seen| {
            let feedback = Feedback {
                position: seen.encoder_position,
                velocity: seen.tachometer_velocity,
                friction: 0.0,
                cycle: Some(seen.cycle),
            };
            controller.step(&reference, &feedback).total
        })?;
        summary.add(&seen);
    }
    Ok(())
}

/// Opens the rig and drives it; afterwards it is at zero volts.
fn drive<T>(
    which: &Which,
    place: &Place,
    setup: RigSetup,
    (stop, shown): (&AtomicBool, bool),
    work: impl FnOnce(&mut Session<'_>) -> Result<T, RigSetupError>,
) -> anyhow::Result<(T, Seen)> {
    let rig = &place.chosen.rig;
    if which.miswired.is_some() && *rig != RigChoice::Simulated {
        return Err(BadInput(
            "--miswired is for the simulated rig; a real one is wired as it is".to_owned(),
        )
        .into());
    }
    let mut display = Display::default();
    let outcome = rig.open(&setup).and_then(|opened| {
        let seen = Seen { description: opened.description.clone(), sensors: opened.sensors };
        let expected = place.profile().and_then(|profile| profile.description.as_ref());
        // A calibration is found anew; one that is used has to be of this device.
        if let Some(expected) = expected.filter(|_| setup.calibration.is_some()) {
            require_device(expected, rig, seen.description.as_ref())?;
        }
        let session = Session::new(opened, which.max_volts, stop)?;
        let mut session = if shown { session.shown(|seen| display.show(seen)) } else { session };
        Ok((work(&mut session)?, seen))
    });
    display.end();
    outcome.map_err(told)
}

/// An error of the rig, where the command line has other words for it.
fn told(error: RigSetupError) -> anyhow::Error {
    match error {
        RigSetupError::Stopped => Interrupted(error.to_string()).into(),
        RigSetupError::Rig(rig_driver::RigError::BeyondRange { limit, range }) => {
            BadInput(super::run::beyond_range(limit, range)).into()
        }
        error => error.into(),
    }
}

fn within(name: &str, value: f64, low: f64, high: f64) -> Result<(), BadInput> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(BadInput(format!(
            "{name} must be a number of at most {high} in magnitude, but is {value}"
        )))
    }
}

fn watch_ctrl_c() -> anyhow::Result<Arc<AtomicBool>> {
    interruption::watch(interruption::DRIVING)
}
