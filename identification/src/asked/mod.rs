//! What is asked of an identification: the options of `frictionlab identify`, which a request to
//! the node may give too, and what they stand for.

#![expect(
    rustdoc::broken_intra_doc_links,
    reason = "options are read in a terminal, where units are not escaped"
)]

pub mod axis;
pub mod friction;
mod joints;
pub mod mending;

use std::path::{Path, PathBuf};

use friction_ident::{Conditioning, Signals};
use friction_model::Motor;
use recording::column_options::ColumnArgs;
use recording::grid::{Arrays, Input};
use recording::joints::Effort;
use recording::rosbag;
use recording::table;
use recording::timing::{Steps, TOLERANCE, rate, tolerance};
use recording::{AxisKind, Recording, RecordingError};
use work::BadInput;
use work::destination::ToFolder;
use work::saying::Saying;

use self::friction::FrictionArgs;
use crate::axis::channels;
use crate::axis::structure::StructureChoice;
use crate::drive::DriveFileError;
use crate::drive::parameters::read_motor;

/// Find friction and inertia in recordings (tables or bags)
///
/// One CSV file with a driving force gives inertia, viscous and Coulomb friction of the axis. CSV:
/// a header with column names, then one line a sample, evenly spaced. Columns are recognised by
/// names such as t_s, position_m, position_rad, force_N and torque_Nm, or named with the options
/// below. For a public benchmark, whose force is a voltage times a constant:
///
///   frictionlab identify estimation.csv --force-column control_V:35.150651882485472 \
///     --validate validation.csv
///
/// Recordings of friction give friction models with all their parameters: a bag with
/// /joint_states, steady points (columns velocity_rad_s and torque_Nm, no time), or any file with
/// --model. Files are cut at pauses and sorted by what they show: constant velocity, pre-sliding,
/// velocity that varies one way, mixed motion.
///
///   frictionlab identify steady.csv presliding.csv chirp.csv --model all \
///     --inertia 0.0026:0.00003 --validate other_steady.csv other_chirp.csv
///
/// A driving force gives friction models too, once the inertia is known:
///
///   frictionlab identify estimation.csv --force-column control_V:35.150651882485472 \
///     --model lugre --torque-source driving --inertia 95.1:0.1 --validate validation.csv
///
/// Bag with --torque-from-voltage: the driving torque worked out from /rig_measurement.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct IdentifyArgs {
    /// Tables (CSV, .mat, .npz, .npy, .parquet), .mcap or .db3 files, or bag folders; several are
    /// recordings of the same axis.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,

    /// Tables that are in memory: one that is called as a file is read in its place. No option of
    /// the command.
    #[arg(skip)]
    pub arrays: Vec<Arrays>,

    /// Try the fitted models on these recordings too, which no fit sees (the cross-test); they take
    /// part in the choice of a model and of a structure
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub validate: Vec<PathBuf>,

    /// Where the results go.
    #[command(flatten)]
    pub to: ToFolder,

    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
    /// What is told besides.
    #[command(flatten)]
    pub saying: Saying,

    /// Those of friction models.
    #[command(flatten)]
    pub friction: FrictionArgs,

    /// Those that name columns.
    #[command(flatten)]
    pub table: ColumnArgs,

    /// Kind of axis, where the column names do not tell it; decides the units shown.
    #[arg(long, value_enum, help_heading = "Columns of a table")]
    pub axis: Option<AxisKind>,

    /// Cutoff of the low-pass for velocity and acceleration [Hz]
    /// [default: one for each, where the position's noise covers the motion, at most a tenth of the
    /// sampling rate and 100, and a fifth of it where the motion is faster].
    #[arg(long, value_name = "HZ", help_heading = "Conditioning", allow_negative_numbers = true)]
    pub cutoff: Option<f64>,

    /// Order of the low-pass, 1 to 12 [default: 4].
    #[arg(long, value_name = "N", help_heading = "Conditioning")]
    pub order: Option<usize>,

    /// Keep one sample in N for the fit, after an anti-alias low-pass
    /// [default: sampling rate over cutoff].
    #[arg(long, value_name = "N", help_heading = "Conditioning")]
    pub decimate: Option<usize>,

    /// Samples dropped at each end [default: 50, more behind a lower cutoff].
    #[arg(long, value_name = "N", help_heading = "Conditioning")]
    pub trim: Option<usize>,

    /// How far a time step may be from the usual one for its sample to be taken as it is, as a
    /// fraction of it, at most 0.5; samples off by more are read between their neighbours, and gaps
    /// split the recording.
    #[arg(long, value_name = "FRACTION", default_value_t = TOLERANCE, value_parser = tolerance, allow_negative_numbers = true, help_heading = "Conditioning")]
    pub time_tolerance: f64,

    /// Bring samples at irregular times to this rate [Hz]: along straight lines between neighbours,
    /// with an anti-alias low-pass, the same for every channel. What that does to noise is said.
    #[arg(long, value_name = "HZ", value_parser = rate, allow_negative_numbers = true, help_heading = "Conditioning", conflicts_with = "time_tolerance")]
    pub resample: Option<f64>,

    /// The force is friction alone and drives no inertia; so for a bag's friction torque anyway.
    #[arg(long, help_heading = "Model")]
    pub without_inertia: bool,

    /// Choose the structure of the axis by cross-validation: auto, or names as
    /// asymmetric+stribeck+delay, separated by commas. A name begins with symmetric or asymmetric
    /// (friction of each direction); its parts are stribeck, presliding, damping, lag, delay,
    /// position, gravity and harmonic.
    #[arg(
        long,
        value_name = "auto|NAMES",
        help_heading = "Model",
        conflicts_with = "without_inertia"
    )]
    pub structure: Option<StructureChoice>,

    /// Move the fitted plain models by the recorded force alone, from where the axis is after 20
    /// samples, and say by how much the position is off (the metric of the EMPS benchmark).
    #[arg(long, help_heading = "Model", conflicts_with = "without_inertia")]
    pub free_run: bool,

    /// Voltage- or current-driven recording: drive.yaml of identify-drive gives the motor's
    /// constants, and the inertia for --torque-source.
    #[arg(long, value_name = "FILE", help_heading = "Bag", conflicts_with_all = ["gear_ratio", "motor_constant", "resistance"])]
    pub drive: Option<PathBuf>,

    /// No constant force in the symmetric model.
    #[arg(long, help_heading = "Model")]
    pub without_offset: bool,

    /// The joint of a bag's /joint_states, or of a table's columns as q[2] and q2; where there are
    /// several, it must be named. Names with commas between them, or all, give each joint its own
    /// results.
    #[arg(long, value_name = "NAME", help_heading = "Bag", conflicts_with = "torque_from_voltage")]
    pub joint: Option<String>,

    /// Bag: what the effort of /joint_states is. driving: the torque that drives the joint, as of
    /// most robots. friction: friction alone, as in bags of this laboratory, where it need not be
    /// said.
    #[arg(long, value_enum, help_heading = "Bag", conflicts_with = "torque_from_voltage")]
    pub effort: Option<Effort>,

    /// Bag: work the driving torque out from the motor voltage, (A Km / Ra) (u - A Km w).
    #[arg(long, help_heading = "Bag")]
    pub torque_from_voltage: bool,

    /// Gear ratio A of the motor [default: 70].
    #[arg(long, value_name = "A", help_heading = "Bag")]
    pub gear_ratio: Option<f64>,

    /// Torque constant Km of the motor [N m/A] [default: 0.00767].
    #[arg(long, value_name = "KM", help_heading = "Bag")]
    pub motor_constant: Option<f64>,

    /// Armature resistance Ra of the motor [Ohm] [default: 2.6].
    #[arg(long, value_name = "RA", help_heading = "Bag")]
    pub resistance: Option<f64>,
}

/// Order of the low-pass where none is given.
pub const ORDER: usize = 4;

/// The command that writes what a file given with `--drive` lacks.
#[must_use]
pub const fn advice(error: &DriveFileError) -> &'static str {
    match error {
        DriveFileError::Section(error) if error.is_missing() => {
            "; identify-drive writes one where the motor's constants or a torque sensor tell them"
        }
        DriveFileError::NoDrive => "; `frictionlab identify-drive BAG --rig-file FILE` adds it",
        DriveFileError::Nothing => ", as `frictionlab identify-drive` writes them",
        _ => "",
    }
}

/// What `--drive` says of the drive.
pub fn drive_file(args: &IdentifyArgs) -> Result<Option<Motor>, BadInput> {
    let Some(file) = &args.drive else { return Ok(None) };
    let blame = |error: String| BadInput(format!("--drive {}: {error}", file.display()));
    let text = files::input::text(file).map_err(|error| blame(error.to_string()))?;
    read_motor(&text).map(Some).map_err(|error| blame(format!("{error}{}", advice(&error))))
}

/// The motor's constants, from the options or a drive's file.
pub fn motor(args: &IdentifyArgs) -> Result<Motor, BadInput> {
    Ok(drive_file(args)?.unwrap_or(Motor {
        gear_ratio: args.gear_ratio.unwrap_or(Motor::SRV02.gear_ratio),
        motor_constant: args.motor_constant.unwrap_or(Motor::SRV02.motor_constant),
        armature_resistance: args.resistance.unwrap_or(Motor::SRV02.armature_resistance),
        // What is read of a bag does not need it.
        ..Motor::SRV02
    }))
}

/// Refuses options that no recording could be identified with.
///
/// # Errors
/// [`BadInput`] names the option at fault.
pub fn check(args: &IdentifyArgs) -> Result<(), BadInput> {
    // A column's name behind --force would be taken for a file.
    let column = args.files.iter().find(|file| args.to.force && !file.exists());
    if let Some(column) = column {
        let column = column.display();
        return Err(BadInput(format!(
            "there is no file {column}; --force replaces results that are there, and the column of the force is named by --force-column {column}"
        )));
    }
    args.check_options()?;
    for (option, value) in [
        ("--gear-ratio", args.gear_ratio),
        ("--motor-constant", args.motor_constant),
        ("--resistance", args.resistance),
    ] {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
            return Err(BadInput(format!(
                "{option} must be a finite number above zero, but is {value}"
            )));
        }
    }
    Ok(())
}

/// Filtering and thinning as the options say, what suits the recording where they do not.
#[must_use]
pub fn conditioning(args: &IdentifyArgs, recording: &Recording) -> Conditioning {
    let time_step = recording.time_step;
    let stretches: Vec<Signals> =
        channels(recording).into_iter().map(|(_, signals)| signals).collect();
    let mut suits = Conditioning::for_motion(time_step, &stretches);
    if let Some(cutoff) = args.cutoff {
        // A cutoff out of range is refused later, with the sampling rate in the message.
        suits = suits.with_cutoff(time_step, &stretches, cutoff);
    }
    Conditioning {
        order: args.order.unwrap_or(ORDER),
        trim: args.trim.unwrap_or(suits.trim),
        decimate: args.decimate.unwrap_or(suits.decimate),
        ..suits
    }
}

/// Reads tables or bags as the options say; several as one recording of the same axis. None where
/// there is no file.
///
/// # Errors
/// [`RecordingError`] with the file and what is wrong with it.
pub fn read(
    files: &[PathBuf],
    args: &IdentifyArgs,
    motor: &Motor,
) -> Result<Option<Recording>, RecordingError> {
    let recordings: Result<Vec<_>, _> =
        files.iter().map(|file| read_one(file, args, motor)).collect();
    recording::joined(recordings?)
}

/// Reads a table or a bag as the options say.
///
/// # Errors
/// [`RecordingError`] with the file and what is wrong with it.
fn read_one(file: &Path, args: &IdentifyArgs, motor: &Motor) -> Result<Recording, RecordingError> {
    let steps = Steps { tolerance: args.time_tolerance, resample: args.resample };
    let input = args.input(file);
    if input.is_bag() {
        let motor = args.torque_from_voltage.then_some(motor);
        rosbag::read(file, motor, &args.joint_choice(), steps)
    } else {
        let columns = args.columns();
        table::read(input, &columns, steps)
    }
}

impl IdentifyArgs {
    /// What is read for a file that was named.
    #[must_use]
    pub fn input<'a>(&'a self, file: &'a Path) -> Input<'a> {
        let called = self.arrays.iter().find(|arrays| arrays.name() == file);
        called.map_or(Input::Path(file), Input::Arrays)
    }
}
