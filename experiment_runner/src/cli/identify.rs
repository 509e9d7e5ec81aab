//! `frictionlab identify`: friction and inertia from a recording.

use std::path::{Path, PathBuf};

use anyhow::Context;
use friction_ident::Conditioning;
use friction_ident::axis_structure::AxisStructure;
use rig_driver::DriveParameters;

use super::destination::ToFolder;
use super::identify_friction::{self, FrictionArgs};
use super::saying::Saying;
use super::{BadInput, Interrupted, interruption};
use crate::drive::parameters::DriveConstants;
use crate::identify::structure::{StructureChoice, Structured, structured};
use crate::identify::{self, Settings};
use crate::progress::Progress;
use crate::recording::rosbag::{self, Motor};
use crate::recording::table;
use crate::recording::timing::{TOLERANCE, tolerance};
use crate::recording::{AxisKind, Column, Recording};

/// Find friction and inertia in your recordings (CSV or bags)
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
/// /joint_states, steady points (columns velocity_rad_s and torque_Nm, no time), several files, or
/// any file with --model. Files are cut at pauses and sorted by what they show: constant velocity,
/// pre-sliding, velocity that varies one way, mixed motion.
///
///   frictionlab identify steady.csv presliding.csv chirp.csv --model all \
///     --inertia 0.0026:0.00003 --validate other_steady.csv other_chirp.csv
///
/// A driving force gives friction models too, once the inertia is known:
///
///   frictionlab identify estimation.csv --force-column control_V:35.150651882485472 --model lugre
///   \
///     --torque-source driving --inertia 95.1:0.1 --validate validation.csv
///
/// Bag with --torque-from-voltage: the driving torque worked out from /rig_measurement.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct IdentifyArgs {
    /// CSV files, .mcap files or bag folders; several only for friction models.
    #[arg(value_name = "FILE", required = true)]
    pub(super) files: Vec<PathBuf>,

    /// Try the fitted models on this recording too (the cross-test); several only for friction
    /// models.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub(super) validate: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) to: ToFolder,

    /// Print nothing but errors.
    #[arg(long)]
    pub(super) quiet: bool,
    #[command(flatten)]
    pub(super) saying: Saying,

    #[command(flatten)]
    pub(super) friction: FrictionArgs,

    /// Column of the time [s].
    #[arg(long, value_name = "NAME[:SCALE]", help_heading = "Columns of a CSV file")]
    pub(super) time: Option<Column>,

    /// Column of the position [m or rad].
    #[arg(long, value_name = "NAME[:SCALE]", help_heading = "Columns of a CSV file")]
    pub(super) position: Option<Column>,

    /// Column of the velocity [m/s or rad/s], to be used in place of the position.
    #[arg(long, value_name = "NAME[:SCALE]", help_heading = "Columns of a CSV file")]
    pub(super) velocity: Option<Column>,

    /// Column of the force [N] or torque [N m]; SCALE turns its values into that unit.
    #[arg(
        id = "force_column",
        long = "force-column",
        value_name = "NAME[:SCALE]",
        help_heading = "Columns of a CSV file"
    )]
    pub(super) force: Option<Column>,

    /// Kind of axis, where the column names do not tell it; decides the units shown.
    #[arg(long, value_enum, help_heading = "Columns of a CSV file")]
    pub(super) axis: Option<AxisKind>,

    /// Cutoff of the low-pass for the motion [Hz]
    /// [default: a tenth of the sampling rate, at most 100].
    #[arg(long, value_name = "HZ", help_heading = "Conditioning", allow_negative_numbers = true)]
    pub(super) cutoff: Option<f64>,

    /// Order of the low-pass, 1 to 12.
    #[arg(long, value_name = "N", default_value_t = 4, help_heading = "Conditioning")]
    pub(super) order: usize,

    /// Keep one sample in N for the fit, after an anti-alias low-pass
    /// [default: sampling rate over cutoff].
    #[arg(long, value_name = "N", help_heading = "Conditioning")]
    pub(super) decimate: Option<usize>,

    /// Samples dropped at each end.
    #[arg(long, value_name = "N", default_value_t = 50, help_heading = "Conditioning")]
    trim: usize,

    /// How far a time step may be from the usual one for its sample to be taken as it is, as a
    /// fraction of it, at most 0.5; samples off by more are read between their neighbours, and gaps
    /// split the recording.
    #[arg(long, value_name = "FRACTION", default_value_t = TOLERANCE, value_parser = tolerance, allow_negative_numbers = true, help_heading = "Conditioning")]
    pub(super) time_tolerance: f64,

    /// The force is friction alone and drives no inertia; so for a bag's friction torque anyway.
    #[arg(long, help_heading = "Model")]
    without_inertia: bool,

    /// Choose the structure of the axis by cross-validation: auto, or names as
    /// asymmetric+stribeck+delay, separated by commas.
    #[arg(
        long,
        value_name = "auto|NAMES",
        help_heading = "Model",
        conflicts_with = "without_inertia"
    )]
    structure: Option<StructureChoice>,

    /// Voltage- or current-driven recording: drive.yaml of identify-drive gives the motor's
    /// constants, and the inertia for --torque-source.
    #[arg(long, value_name = "FILE", help_heading = "Bag", conflicts_with_all = ["gear_ratio", "motor_constant", "resistance"])]
    drive: Option<PathBuf>,

    /// No constant force in the symmetric model.
    #[arg(long, help_heading = "Model")]
    without_offset: bool,

    /// Bag: work the driving torque out from the motor voltage, (A Km / Ra) (u - A Km w).
    #[arg(long, help_heading = "Bag")]
    pub(super) torque_from_voltage: bool,

    /// Gear ratio A of the motor.
    #[arg(long, value_name = "A", default_value_t = Motor::default().gear_ratio, help_heading = "Bag")]
    gear_ratio: f64,

    /// Torque constant Km of the motor [N m/A].
    #[arg(long, value_name = "KM", default_value_t = Motor::default().motor_constant, help_heading = "Bag")]
    motor_constant: f64,

    /// Armature resistance Ra of the motor [Ohm].
    #[arg(long, value_name = "RA", default_value_t = Motor::default().resistance, help_heading = "Bag")]
    resistance: f64,
}

/// Reads, identifies, writes `identification.json`, `report.html` and `parameters.yaml`, and prints
/// a table.
///
/// # Errors
/// [`BadInput`] for whatever is wrong with the files, the options or the output folder; nothing is
/// written then.
pub fn execute(args: &IdentifyArgs) -> anyhow::Result<()> {
    check(args)?;
    args.saying.begin();
    if args.is_friction() {
        return identify_friction::execute(args);
    }
    let motor = motor(args)?;
    let Some(file) = args.files.first() else {
        return Err(BadInput("a file is missing: give a CSV file or a bag".to_owned()).into());
    };
    let recording = read(file, args, &motor)?;
    let validation = args.validate.first().map(|file| read(file, args, &motor)).transpose()?;
    let conditioning = conditioning(args, recording.time_step);
    let assumed = recording.axis.is_none() && args.axis.is_none();
    let settings = Settings {
        conditioning,
        inertia: !(args.without_inertia || recording.friction_only),
        offset: !args.without_offset,
        axis: args.axis.or(recording.axis).unwrap_or(AxisKind::Linear),
    };
    let mut found = identify::identify(&recording, validation.as_ref(), &settings)
        .map_err(|error| BadInput(error.to_string()))?;
    if assumed {
        found.notes.push(
            "The column names do not tell whether the axis is linear or rotary; units are shown for a linear one. \
             Say --axis rotary if it turns."
                .to_owned(),
        );
    }

    let validation = validation.as_ref();
    let structured = match &args.structure {
        Some(_) if !settings.inertia => {
            return Err(BadInput("--structure needs a driving force, but this recording's force is friction alone; with a bag add --torque-from-voltage".to_owned()).into());
        }
        Some(wanted) => compare(&recording, validation, &settings, wanted, args.quiet)?,
        None => None,
    };
    let mut page = identify::page::page(&found, &recording, validation);
    let mut document = identify::document::render(&found, &recording, validation);
    if let Some(structured) = &structured {
        page.blocks.extend(identify::structure_page::blocks(structured, settings.axis));
        document = with_structure(&document, structured)?;
    }
    let files = [
        ("identification.json", document),
        (
            "report.html",
            crate::report::render_page(&crate::report::linked(
                page,
                ["parameters.yaml", "identification.json"],
            )),
        ),
        (
            "parameters.yaml",
            identify::parameters::render(&found, &recording.path.display().to_string()),
        ),
    ];
    let folder = args.to.reserve("identify")?;
    folder.write(&files)?;
    let mut text = identify::terminal::render(&found, &recording, validation);
    if let Some(structured) = &structured {
        text.push_str(&identify::structure_page::terminal(structured));
    }
    let names = files.each_ref().map(|(name, _)| *name).join(", ");
    let text = format!("{text}\nwritten to {}: {names}\n", folder.path().display());
    args.saying.result(args.quiet, &files[0].1, &text)
}

/// Compares structures with a progress bar; ctrl-C ends the comparison with what there is.
fn compare(
    recording: &Recording,
    validation: Option<&Recording>,
    settings: &Settings,
    wanted: &StructureChoice,
    quiet: bool,
) -> anyhow::Result<Option<Structured>> {
    let blame = |error: &dyn std::fmt::Display| BadInput(error.to_string());
    let estimation = identify::conditioned(recording, settings).map_err(|error| blame(&error))?;
    let other = validation.map(|other| identify::conditioned(other, settings)).transpose();
    let other = other.map_err(|error| blame(&error))?;
    let cancel = interruption::watch(interruption::WRITING)?;
    let count = match wanted {
        StructureChoice::Auto => AxisStructure::candidates().len(),
        StructureChoice::Named(named) => named.len(),
    };
    let progress = Progress::counting(count as u64, "structures", quiet);
    let found = structured(&estimation, other.as_ref(), wanted, settings.axis, &progress, &cancel);
    progress.finish();
    let found =
        found.map_err(|error| BadInput(format!("{}: {error}", recording.path.display())))?;
    if found.is_none() {
        return Err(Interrupted(
            "stopped before any structure was compared; nothing was written".to_owned(),
        )
        .into());
    }
    Ok(found)
}

/// The document with the structure in it.
fn with_structure(document: &str, found: &Structured) -> anyhow::Result<String> {
    let mut tree: serde_json::Value =
        serde_json::from_str(document).context("cannot describe the results")?;
    tree["structure"] = identify::structure_page::document(found);
    Ok(format!("{tree:#}\n"))
}

/// What `--drive` says of the drive.
pub(super) fn drive_file(args: &IdentifyArgs) -> Result<Option<DriveParameters>, BadInput> {
    let Some(file) = &args.drive else { return Ok(None) };
    let blame = |error: String| BadInput(format!("--drive {}: {error}", file.display()));
    let text = crate::input::text(file).map_err(|error| blame(error.to_string()))?;
    Ok(Some(DriveConstants::read(&text).map_err(blame)?.parameters))
}

/// The motor's constants, from the options or a drive's file.
pub(super) fn motor(args: &IdentifyArgs) -> Result<Motor, BadInput> {
    Ok(match drive_file(args)? {
        Some(drive) => Motor {
            gear_ratio: drive.gear_ratio,
            motor_constant: drive.motor_constant,
            resistance: drive.armature_resistance,
        },
        None => Motor {
            gear_ratio: args.gear_ratio,
            motor_constant: args.motor_constant,
            resistance: args.resistance,
        },
    })
}

fn check(args: &IdentifyArgs) -> Result<(), BadInput> {
    // A column's name behind --force would be taken for a file.
    let column = args.files.iter().find(|file| args.to.force && !file.exists());
    if let Some(column) = column {
        let column = column.display();
        return Err(BadInput(format!(
            "there is no file {column}; --force replaces results that are there, and the column of the force is named by --force-column {column}"
        )));
    }
    for (option, value) in [
        ("--gear-ratio", args.gear_ratio),
        ("--motor-constant", args.motor_constant),
        ("--resistance", args.resistance),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(BadInput(format!(
                "{option} must be a finite number above zero, but is {value}"
            )));
        }
    }
    Ok(())
}

fn conditioning(args: &IdentifyArgs, time_step: f64) -> Conditioning {
    let usual = Conditioning::for_time_step(time_step);
    let cutoff = args.cutoff.unwrap_or(usual.cutoff);
    // A cutoff out of range is refused later, with the sampling rate in the message.
    let factor = (1.0 / time_step / cutoff).round().clamp(1.0, 1000.0) as usize;
    Conditioning {
        cutoff,
        order: args.order,
        trim: args.trim,
        decimate: args.decimate.unwrap_or(factor),
    }
}

fn read(file: &Path, args: &IdentifyArgs, motor: &Motor) -> Result<Recording, BadInput> {
    let is_bag = file.is_dir() || file.extension().is_some_and(|extension| extension == "mcap");
    let recording = if is_bag {
        rosbag::read(file, args.torque_from_voltage.then_some(motor), args.time_tolerance)
    } else {
        let columns = args.columns();
        table::read(file, &columns, args.time_tolerance)
    };
    recording.map_err(|error| BadInput(error.to_string()))
}
