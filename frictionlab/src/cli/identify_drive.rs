//! `frictionlab identify-drive`: gain, time constant, delay, deadband and inertia of a motor.

use std::path::PathBuf;

use friction_ident::Uncertain;
use friction_ident::drive::Calibration;

use experiment_runner::asked::rig as rig_profile;
use files::OutputFile;
use identification::drive::parameters::sheet;
use identification::drive::{Identified, identify, page::page, parameters};
use recording::column_options::LayoutArgs;
use recording::driven::{self, DrivenColumns};
use recording::timing::{Steps, TOLERANCE, rate, tolerance};
use recording::{AxisKind, Column};
use report::{linked, render_page};
use rig_setup::RigProfile;
use work::BadInput;
use work::destination::ToFolder;
use work::saying::Saying;

/// Find a drive's constants from its voltage and motion
///
/// Finds gain K, time constant T, delay and voltage deadband of T w' + w = K (u - friction), and
/// the inertia as far as it can be known: from a torque sensor in the recording (a bag of this
/// laboratory has one), from the motor's constants, or from a known force per volt. Excite the
/// drive with steps or a chirp for T, and with a slow triangle through zero for the deadband.
///
///   frictionlab identify-drive bag/ --gear-ratio 70
///   frictionlab identify-drive run.csv --gear-ratio 70 --motor-constant 0.00767 --resistance
///   2.6:0.05 frictionlab identify-drive estimation.csv --voltage control_V --force-per-volt 35.15
///
/// CSV: t_s, voltage_V, position_rad or velocity_rad_s (or _m), and if there is one friction_Nm.
/// Several files are averaged by their errors.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct IdentifyDriveArgs {
    /// Tables (CSV, .mat, .npz, .npy, .parquet), .mcap or .db3 files, or bag folders.
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,

    #[command(flatten)]
    to: ToFolder,

    /// Rig profile that gets the drive, as `frictionlab rig check --rig-file` writes it; `run` and
    /// `live` take the drive from there.
    #[arg(long, value_name = "FILE")]
    rig_file: Option<PathBuf>,

    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,

    /// Column of the time [s].
    #[arg(long, value_name = "NAME[:SCALE]", help_heading = "Columns of a table")]
    time: Option<Column>,

    /// Column of the voltage [V].
    #[arg(long, value_name = "NAME[:SCALE]", help_heading = "Columns of a table")]
    voltage: Option<Column>,

    /// Column of the position [m or rad].
    #[arg(long, value_name = "NAME[:SCALE]", help_heading = "Columns of a table")]
    position: Option<Column>,

    /// Column of the velocity [m/s or rad/s], to be used in place of the position.
    #[arg(long, value_name = "NAME[:SCALE]", help_heading = "Columns of a table")]
    velocity: Option<Column>,

    /// Column of a measured friction force [N] or torque [N m].
    #[arg(long, value_name = "NAME[:SCALE]", help_heading = "Columns of a table")]
    friction: Option<Column>,

    #[command(flatten)]
    layout: LayoutArgs,

    /// The joint whose columns are read, as 2 of voltage[2] and q[2].
    #[arg(long, value_name = "NAME", help_heading = "Columns of a table")]
    joint: Option<String>,

    /// Kind of axis, where the column names do not tell it.
    #[arg(long, value_enum, help_heading = "Columns of a table")]
    axis: Option<AxisKind>,

    /// How far a time step may be from the usual one for its sample to be taken as it is, as a
    /// fraction of it, at most 0.5; samples off by more are read between their neighbours, and gaps
    /// split the recording.
    #[arg(long, value_name = "FRACTION", default_value_t = TOLERANCE, value_parser = tolerance, allow_negative_numbers = true, help_heading = "Columns of a table")]
    time_tolerance: f64,

    /// Bring samples at irregular times to this rate [Hz]: along straight lines between neighbours,
    /// with an anti-alias low-pass, the same for every channel. What that does to noise is said.
    #[arg(long, value_name = "HZ", value_parser = rate, allow_negative_numbers = true, help_heading = "Columns of a table", conflicts_with = "time_tolerance")]
    resample: Option<f64>,

    /// Use voltage and motion alone, even where the friction torque was measured.
    #[arg(long, conflicts_with = "friction")]
    without_torque: bool,

    /// Gear ratio A.
    #[arg(
        long,
        value_name = "A",
        allow_negative_numbers = true,
        help_heading = "What is known of the motor"
    )]
    gear_ratio: Option<f64>,

    /// Torque constant Km [N m/A], with its standard error if known.
    #[arg(long, value_name = "KM[:ERROR]", value_parser = known, requires = "resistance", help_heading = "What is known of the motor")]
    motor_constant: Option<Uncertain>,

    /// Armature resistance Ra [Ohm], with its standard error if known.
    #[arg(long, value_name = "RA[:ERROR]", value_parser = known, requires = "motor_constant", help_heading = "What is known of the motor")]
    resistance: Option<Uncertain>,

    /// Force or torque per volt [N/V or N m/V], with its standard error if known.
    #[arg(long, value_name = "GAIN[:ERROR]", value_parser = known, conflicts_with = "motor_constant", help_heading = "What is known of the motor")]
    force_per_volt: Option<Uncertain>,
}

/// `VALUE` or `VALUE:ERROR`.
fn known(text: &str) -> Result<Uncertain, String> {
    let (value, error) = text.split_once(':').unwrap_or((text, "0"));
    let number = |text: &str| {
        text.trim().parse::<f64>().map_err(|_| format!("expected a number, but found `{text}`"))
    };
    let known = Uncertain { value: number(value)?, standard_error: number(error)? };
    if !(known.value > 0.0 && known.value.is_finite()) {
        return Err(format!(
            "the value must be a finite number above zero, but is {}",
            known.value
        ));
    }
    if !(known.standard_error >= 0.0 && known.standard_error.is_finite()) {
        return Err(format!(
            "the standard error must be a finite number, zero or more, but is {}",
            known.standard_error
        ));
    }
    Ok(known)
}

/// Reads, identifies, writes `drive.yaml`, `identification-drive.json` and `report.html`, and
/// prints a table.
///
/// # Errors
/// [`BadInput`] for whatever is wrong with the files, the options or the output folder; nothing is
/// written then.
pub fn execute(args: &IdentifyDriveArgs) -> anyhow::Result<()> {
    if let Some(ratio) = args.gear_ratio.filter(|ratio| !(*ratio > 0.0 && ratio.is_finite())) {
        return Err(BadInput(format!(
            "--gear-ratio must be a finite number above zero, but is {ratio}"
        ))
        .into());
    }
    let profile = args
        .rig_file
        .as_deref()
        .map(|file| rig_profile::read(file).map(|read| (file, read)))
        .transpose()?;
    let profile_file = profile.as_ref().map(|(file, _)| OutputFile::new(file, true)).transpose()?;
    // Where there is no sensor its channel says zero, which is no friction torque.
    let senseless = profile
        .as_ref()
        .is_some_and(|(_, profile)| profile.sensors.is_some_and(|sensors| !sensors.torque));
    let columns = DrivenColumns {
        time: args.time.clone(),
        voltage: args.voltage.clone(),
        position: args.position.clone(),
        velocity: args.velocity.clone(),
        friction: args.friction.clone(),
        layout: args.layout.layout(args.joint.as_deref()),
    };
    let steps = Steps { tolerance: args.time_tolerance, resample: args.resample };
    let mut recordings = Vec::new();
    for file in &args.files {
        let mut recording = driven::read(file, &columns, steps)?;
        if args.without_torque || senseless {
            recording.friction = None;
        }
        recordings.push(recording);
    }
    let told = recordings.iter().find_map(|recording| recording.axis);
    let axis = args.axis.or(told).unwrap_or(AxisKind::Rotary);
    let calibration = match (args.motor_constant, args.resistance, args.force_per_volt) {
        (Some(constant), Some(resistance), _) => {
            let ratio = args.gear_ratio.unwrap_or(1.0);
            let torque_constant = Uncertain {
                value: ratio * constant.value,
                standard_error: ratio * constant.standard_error,
            };
            Some(Calibration::Motor { torque_constant, resistance })
        }
        (_, _, Some(gain)) => Some(Calibration::ForcePerVolt(gain)),
        _ => None,
    };
    let ratio = args.gear_ratio.or(args.motor_constant.map(|_| 1.0));
    let found = identify(&recordings, axis, calibration, ratio)
        .map_err(|(path, error)| BadInput(format!("{}: {error}", path.display())))?;
    let folder = args.to.reserve("identify-drive")?;
    let files = [
        ("drive.yaml", parameters::render(&found)),
        ("identification-drive.json", found.document()),
        (
            "report.html",
            render_page(&linked(page(&found), ["drive.yaml", "identification-drive.json"])),
        ),
    ];
    folder.write(&files)?;
    let told = profile_file
        .zip(profile)
        .map(|(file, (_, profile))| update(&found, &file, profile))
        .transpose()?;
    let names = files.each_ref().map(|(name, _)| *name).join(", ");
    let told = told.map_or(String::new(), |told| told + "\n");
    let text =
        format!("{}\nwritten to {}: {names}\n{told}", found.summary(), folder.path().display());
    args.saying.result(args.quiet, &files[1].1, &text)
}

/// Puts the drive into the rig profile; what was done, in a line.
fn update(found: &Identified, file: &OutputFile, profile: RigProfile) -> anyhow::Result<String> {
    let file_name = file.name();
    let drive = sheet(found).ok_or_else(|| {
        anyhow::anyhow!(
            "the rig profile {file_name} was left as it is: the data does not tell gain and time constant"
        )
    })?;
    file.write(RigProfile { drive: Some(drive), ..profile }.text().as_bytes())?;
    let motor = if drive.motor().is_some() {
        "with the motor's constants"
    } else {
        "without the motor's constants, which `run` and `live` need: a torque sensor, or --gear-ratio, --motor-constant and --resistance, tell them"
    };
    Ok(format!("rig profile {file_name}: drive written, {motor}"))
}
