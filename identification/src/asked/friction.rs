//! The part of `frictionlab identify` that identifies friction models from recordings of friction.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::thread;

use friction_ident::output_error::OutputErrorOptions;
use friction_ident::position_load::LoadShape;
use friction_ident::{DriveConstants, Hampel, IdentError, StagedOptions, TorqueSource, Uncertain};
use friction_model::ModelName;

use files::Folder;
use recording::joints::{Effort, JointChoice};
use recording::stretches::{self, FrictionRecording, Preparation, Smoothing};
use recording::table::{Columns, Measured};
use recording::{AxisKind, RecordingError};
use report::figure::Block;
use work::model_name::model_name;
use work::progress::Progress;
use work::{BadInput, Interrupted, drive_errors};

use super::IdentifyArgs;
use crate::friction::{self, FrictionError, FrictionIdentification, Settings};

/// What somebody else has to show beside the models found, for their page.
pub type Beside = fn(&FrictionIdentification) -> Vec<Block>;

/// The options.
#[derive(Debug, clap::Args)]
pub struct FrictionArgs {
    /// Friction models to identify, separated by commas, or all
    /// [default: coulomb_viscous,stribeck,lugre,proposed].
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = choice, help_heading = "Friction models")]
    model: Vec<Choice>,

    /// Separate parameters for each direction of motion.
    #[arg(long, help_heading = "Friction models")]
    asymmetric: bool,

    /// Elements of the models that have any (GMS, Xiong) [default: 4].
    #[arg(long, value_name = "N", help_heading = "Friction models")]
    elements: Option<usize>,

    /// Inertia that moves on the bristles [kg or kg m^2] and its standard error, as in
    /// 0.0026:0.00003. The micro-damping is then computed from it, unless the recordings contradict
    /// that; --torque-source other than sensor needs it, from here or from --drive. Without :SE the
    /// last of --drive-errors counts there.
    #[arg(long, value_name = "J[:SE]", value_parser = inertia, allow_negative_numbers = true, help_heading = "Friction models")]
    inertia: Option<Inertia>,

    /// Damping ratio from which the micro-damping is computed, with the inertia [default: 0.7].
    #[arg(long, value_name = "Z", allow_negative_numbers = true, help_heading = "Friction models")]
    damping_ratio: Option<f64>,

    /// Leave out the refinement of all parameters together over all recordings.
    #[arg(long, help_heading = "Friction models")]
    no_joint: bool,

    /// How far the contact bends before it slides [m or rad]; motion within twice that counts as
    /// pre-sliding [default: told from the friction].
    #[arg(long, value_name = "X", allow_negative_numbers = true, help_heading = "Friction models")]
    reach: Option<f64>,

    /// Where the friction comes from. sensor: the force column is friction. driving: it drives the
    /// axis, friction is that less inertia times acceleration. voltage, current: the column is the
    /// motor's mean over the period before each sample (voltage_V, current_A, or --force-column
    /// NAME); the motor's constants come from --drive or --gear-ratio, --motor-constant and
    /// --resistance. What the errors of the constants add to each parameter is shown beside its
    /// standard error, as `from the drive`.
    #[arg(long, value_enum, value_name = "SOURCE", help_heading = "Friction models")]
    torque_source: Option<SourceChoice>,

    /// Standard errors of the drive's constants in percent: torque constant, armature resistance,
    /// inertia (where --inertia has none) [default: 1,2,2].
    #[arg(long, value_name = "K,R,J", value_delimiter = ',', help_heading = "Friction models")]
    drive_errors: Option<Vec<f64>>,

    /// How the motion is smoothed; the friction never is [default: sg].
    #[arg(long, value_enum, help_heading = "Friction models")]
    smooth: Option<Smoothing>,

    /// Replace samples that cannot be true (Hampel identifier), and list them.
    #[arg(long, help_heading = "Friction models")]
    outliers: bool,

    /// Show the thesis's tables 4.2 to 4.16 beside what is found; for recordings of its test bed.
    #[arg(long, help_heading = "Friction models")]
    thesis_tables: bool,

    /// Threads [default: all cores]; the results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = "Friction models")]
    jobs: Option<u16>,
}

/// An inertia as given on the command line.
#[derive(Debug, Clone, Copy)]
struct Inertia {
    value: f64,
    standard_error: Option<f64>,
}

/// A model, or all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Choice {
    One(ModelName),
    All,
}

/// [`TorqueSource`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum SourceChoice {
    Sensor,
    Driving,
    Voltage,
    Current,
}

/// What `--model all` means.
const ALL: [ModelName; 8] = [
    ModelName::CoulombViscous,
    ModelName::Stribeck,
    ModelName::Dahl,
    ModelName::ElastoPlastic,
    ModelName::LuGre,
    ModelName::Gms,
    ModelName::Xiong,
    ModelName::Proposed,
];
/// What no `--model` means.
const USUAL: [ModelName; 4] =
    [ModelName::CoulombViscous, ModelName::Stribeck, ModelName::LuGre, ModelName::Proposed];

fn choice(text: &str) -> Result<Choice, String> {
    if text.trim().eq_ignore_ascii_case("all") {
        return Ok(Choice::All);
    }
    let name = model_name(text).map_err(|error| error.to_string())?;
    let known = || ALL.map(ModelName::as_str).join(", ");
    if ALL.contains(&name) {
        Ok(Choice::One(name))
    } else {
        Err(format!(
            "{name} cannot be identified stage by stage; expected all or some of {}",
            known()
        ))
    }
}

fn inertia(text: &str) -> Result<Inertia, String> {
    let (value, error) = match text.split_once(':') {
        Some((value, error)) => (value, Some(error)),
        None => (text, None),
    };
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    match (number(value), error.map(number)) {
        (Some(value), None) if value > 0.0 => Ok(Inertia { value, standard_error: None }),
        (Some(value), Some(Some(error))) if value > 0.0 && error >= 0.0 => {
            Ok(Inertia { value, standard_error: Some(error) })
        }
        _ => {
            Err("expected an inertia above zero, and after a colon its standard error, as in 0.0026:0.00003"
                .to_owned())
        }
    }
}

impl IdentifyArgs {
    /// Whether these are recordings of friction, and not of what drives an axis.
    pub fn is_friction(&self) -> bool {
        let columns = self.columns();
        let alone = |file: &Path| {
            let input = self.input(file);
            input.is_bag()
                && !self.torque_from_voltage
                && self.effort != Some(Effort::Driving)
                && file.exists()
                || stretches::holds_points(input, &columns)
        };
        !self.friction.model.is_empty()
            || self.friction.torque_source.is_some()
            || self.files.iter().any(|file| alone(file))
    }
}

/// The files that an identification leaves.
pub const FILES: [&str; 3] = ["identification.json", "report.html", "parameters.yaml"];

/// What was found, and the folder it was written to.
pub struct Written {
    /// The models.
    pub found: FrictionIdentification,
    /// Folder of `identification.json`, `report.html` and `parameters.yaml`.
    pub folder: Folder,
}

/// Reads, identifies every model and writes the files. Once `cancel` is set it ends with what there
/// is. With `--thesis-tables` the page shows what `beside` has as well.
///
/// # Errors
/// [`BadInput`], [`RecordingError`] or [`OutputError`](files::OutputError) for whatever is wrong
/// with the options, the files or the output folder; nothing is written then. [`Interrupted`] where nothing was found before `cancel` was set.
pub fn identify(
    args: &IdentifyArgs,
    beside: Option<Beside>,
    progress: &Progress,
    cancel: &AtomicBool,
) -> anyhow::Result<Written> {
    let asked = Asked::read(args)?;
    // Before the work: a folder that cannot be written is told at once.
    let folder = args.to.reserve("identify")?;
    let found = asked.identify(progress, cancel)?;
    let beside = beside.filter(|_| args.friction.thesis_tables);
    let contents = contents(&found, beside.map_or_else(Vec::new, |beside| beside(&found)))?;
    let files: Vec<(&str, String)> = FILES.into_iter().zip(contents).collect();
    folder.write(&files)?;
    Ok(Written { found, folder })
}

/// What is to be identified, read.
#[derive(Debug)]
pub struct Asked {
    files: Vec<FrictionRecording>,
    validation: Vec<FrictionRecording>,
    settings: Settings,
}

impl Asked {
    /// Reads the recordings as the options say.
    ///
    /// # Errors
    /// [`BadInput`] or [`RecordingError`] for whatever is wrong with the options or the files.
    pub fn read(args: &IdentifyArgs) -> anyhow::Result<Self> {
        let preparation = preparation(args)?;
        let files = read(&args.files, args, &preparation)?;
        let validation = read(&args.validate, args, &preparation)?;
        let settings = settings(args, preparation, &files)?;
        Ok(Self { files, validation, settings })
    }

    /// Identifies every model. Once `cancel` is set it ends with what there is.
    ///
    /// # Errors
    /// [`BadInput`] where no model could be identified; [`Interrupted`] where nothing was found
    /// before `cancel` was set.
    pub fn identify(
        &self,
        progress: &Progress,
        cancel: &AtomicBool,
    ) -> anyhow::Result<FrictionIdentification> {
        let Self { files, validation, settings } = self;
        progress.expect(settings.models.len() as u64);
        let found = friction::run::identify(files, validation, settings, progress, cancel);
        progress.finish();
        match found {
            Err(error @ FrictionError::Nothing) => Err(Interrupted(error.to_string()).into()),
            Err(error @ FrictionError::Refused { source: IdentError::NotFriction { .. }, .. }) => {
                let turned = format!("{error} (--force-column NAME:-SCALE turns it)");
                Err(BadInput(turned).into())
            }
            other => Ok(other.map_err(|error| BadInput(error.to_string()))?),
        }
    }
}

/// The contents of [`FILES`], the page with `beside` in it.
///
/// # Errors
/// If the parameters cannot be said in YAML, a mistake of this program.
pub fn contents(found: &FrictionIdentification, beside: Vec<Block>) -> anyhow::Result<[String; 3]> {
    let page = friction::page::page(found, beside);
    Ok([
        friction::document::render(found),
        report::render_page(&report::linked(page, ["parameters.yaml", "identification.json"])),
        friction::parameters::render(found)?,
    ])
}

fn read(
    files: &[PathBuf],
    args: &IdentifyArgs,
    preparation: &Preparation,
) -> Result<Vec<FrictionRecording>, RecordingError> {
    let measured = match args.friction.torque_source {
        Some(SourceChoice::Voltage) => Measured::Voltage,
        Some(SourceChoice::Current) => Measured::Current,
        _ => Measured::Force,
    };
    let columns = Columns { measured, ..args.columns() };
    let read = |file: &PathBuf| stretches::read(args.input(file), &columns, preparation);
    files.iter().map(read).collect()
}

fn preparation(args: &IdentifyArgs) -> Result<Preparation, BadInput> {
    let friction = &args.friction;
    let torque = match args.source() {
        None | Some(SourceChoice::Sensor) => TorqueSource::Sensor,
        Some(SourceChoice::Driving) => TorqueSource::Driving,
        Some(SourceChoice::Voltage) => TorqueSource::Voltage,
        Some(SourceChoice::Current) => TorqueSource::Current,
    };
    let drive =
        if torque == TorqueSource::Sensor { None } else { Some(drive_constants(args, torque)?) };
    let effort = match torque {
        TorqueSource::Sensor => Some(Effort::Friction),
        TorqueSource::Driving => Some(Effort::Driving),
        _ => None,
    };
    if friction.torque_source.is_some() && args.effort.is_some() && args.effort != effort {
        return Err(BadInput(
            "--effort says something else than --torque-source: driving goes with driving, friction with sensor"
                .to_owned(),
        ));
    }
    if torque == TorqueSource::Current && args.files.iter().any(|file| args.input(file).is_bag()) {
        return Err(BadInput(
            "a bag has no current; use --torque-source sensor or voltage".to_owned(),
        ));
    }
    Ok(Preparation {
        smoothing: friction.smooth.unwrap_or_default(),
        cutoff: args.cutoff,
        order: args.order.unwrap_or(super::ORDER),
        decimate: args.decimate.unwrap_or(1),
        outliers: friction.outliers.then(Hampel::default),
        torque,
        drive,
        tolerance: args.time_tolerance,
        resample: args.resample,
        joint: args.joint_choice(),
    })
}

/// The drive as far as it is known: from `--drive` or the options, with the standard errors of
/// `--drive-errors`.
fn drive_constants(args: &IdentifyArgs, source: TorqueSource) -> Result<DriveConstants, BadInput> {
    let percentages = args.friction.drive_errors.as_deref().unwrap_or(&[1.0, 2.0, 2.0]);
    let [k, r, j] = drive_errors::fractions(percentages)?;
    let file = super::drive_file(args)?;
    let inertia = match (args.friction.inertia, file) {
        (Some(Inertia { value, standard_error: Some(standard_error) }), _) => {
            Uncertain { value, standard_error }
        }
        (Some(Inertia { value, standard_error: None }), _) => Uncertain::relative(value, j),
        (None, Some(file)) => Uncertain::relative(file.inertia, j),
        (None, None) => {
            return Err(BadInput(format!(
                "friction from {} needs the inertia; give it with --inertia J:SE or --drive drive.yaml (`frictionlab identify` without --model and \
                 `frictionlab identify-drive` find it)",
                source.describe()
            )));
        }
    };
    if source == TorqueSource::Driving {
        return Ok(DriveConstants::force_recorded(inertia));
    }
    let motor = super::motor(args)?;
    Ok(DriveConstants {
        torque_constant: Uncertain::relative(motor.back_emf(), k),
        armature_resistance: Uncertain::relative(motor.armature_resistance, r),
        inertia,
    })
}

fn settings(
    args: &IdentifyArgs,
    preparation: Preparation,
    files: &[FrictionRecording],
) -> Result<Settings, BadInput> {
    let friction = &args.friction;
    let mut models: Vec<ModelName> = Vec::new();
    for choice in &friction.model {
        let names = match choice {
            Choice::All => &ALL[..],
            Choice::One(name) => std::slice::from_ref(name),
        };
        for name in names {
            if !models.contains(name) {
                models.push(*name);
            }
        }
    }
    if models.is_empty() {
        models = USUAL.to_vec();
    }
    let elements = friction.elements.unwrap_or(4);
    if !(1..=16).contains(&elements) {
        return Err(BadInput(format!("--elements must lie between 1 and 16, but is {elements}")));
    }
    let has_elements = |name: &ModelName| matches!(name, ModelName::Gms | ModelName::Xiong);
    if friction.elements.is_some() && !models.iter().any(has_elements) {
        return Err(BadInput(
            "--elements speaks of gms and xiong, but --model names neither; leave it out"
                .to_owned(),
        ));
    }
    let damping_ratio = friction.damping_ratio.unwrap_or(0.7);
    if !(damping_ratio > 0.0 && damping_ratio <= 10.0) {
        return Err(BadInput(format!(
            "--damping-ratio must lie above 0 and be at most 10, as in 0.7, but is {damping_ratio}"
        )));
    }
    if let Some(reach) = friction.reach.filter(|reach| !(*reach > 0.0 && reach.is_finite())) {
        return Err(BadInput(format!(
            "--reach must be a length or an angle above zero, but is {reach}"
        )));
    }
    let axis = args.axis.or(files.iter().find_map(|file| file.axis)).unwrap_or(AxisKind::Rotary);
    let output_error =
        OutputErrorOptions { rotary: axis == AxisKind::Rotary, ..OutputErrorOptions::default() };
    Ok(Settings {
        models,
        staged: StagedOptions {
            asymmetric: friction.asymmetric,
            joint: !friction.no_joint,
            elements,
            inertia: preparation.drive.map(|drive| drive.inertia).or(friction.inertia.map(
                |Inertia { value, standard_error }| Uncertain {
                    value,
                    standard_error: standard_error.unwrap_or(0.0),
                },
            )),
            damping_ratio,
            // The recordings decide.
            beside: LoadShape::NONE,
            output_error,
        },
        preparation,
        axis,
        reach: friction.reach,
        workers: friction
            .jobs
            .map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from),
    })
}

impl IdentifyArgs {
    /// The joint of a bag that was named, and what its effort is.
    #[must_use]
    pub fn joint_choice(&self) -> JointChoice {
        let effort = self.effort.or(match self.friction.torque_source {
            Some(SourceChoice::Driving) => Some(Effort::Driving),
            Some(SourceChoice::Sensor) => Some(Effort::Friction),
            _ => None,
        });
        JointChoice { name: self.joint.clone(), effort }
    }

    /// Refuses options that would be without effect on these files.
    ///
    /// # Errors
    /// [`BadInput`] names the option.
    pub(super) fn check_options(&self) -> Result<(), BadInput> {
        let bags = self.files.iter().filter(|file| self.input(file).is_bag()).count();
        let refuse = |option: &str, why: &str| Err(BadInput(format!("{option} {why}")));
        if bags == 0 {
            for (option, given) in [
                ("--effort", self.effort.is_some()),
                ("--torque-from-voltage", self.torque_from_voltage),
            ] {
                if given {
                    return refuse(option, "speaks of a bag, but no file is one; leave it out");
                }
            }
        } else if bags == self.files.len()
            && let Some(option) = self.table.given().first()
        {
            return refuse(
                option,
                "names a column of a table, but every file is a bag; leave it out",
            );
        }
        let friction = &self.friction;
        if self.is_friction() {
            for (option, given) in [
                ("--structure", self.structure.is_some()),
                ("--without-inertia", self.without_inertia),
                ("--without-offset", self.without_offset),
                ("--free-run", self.free_run),
            ] {
                if given {
                    return refuse(
                        option,
                        "speaks of recordings of a driving force, but these are identified as friction models; leave it out",
                    );
                }
            }
            return self.check_friction_options();
        }
        for (option, given) in [
            ("--asymmetric", friction.asymmetric),
            ("--elements", friction.elements.is_some()),
            ("--inertia", friction.inertia.is_some()),
            ("--damping-ratio", friction.damping_ratio.is_some()),
            ("--drive-errors", friction.drive_errors.is_some()),
            ("--smooth", friction.smooth.is_some()),
            ("--no-joint", friction.no_joint),
            ("--reach", friction.reach.is_some()),
            ("--outliers", friction.outliers),
            ("--thesis-tables", friction.thesis_tables),
            ("--jobs", friction.jobs.is_some()),
        ] {
            if given {
                return refuse(
                    option,
                    "speaks of friction models; add --model NAMES or leave it out",
                );
            }
        }
        let motor = self.motor_options().next();
        if let Some(option) = motor.filter(|_| !self.torque_from_voltage) {
            return refuse(
                option,
                "speaks of the motor, which a force or torque does not need; add --torque-from-voltage or leave it out",
            );
        }
        Ok(())
    }

    /// The options that were given and speak of the motor.
    fn motor_options(&self) -> impl Iterator<Item = &'static str> {
        [
            ("--drive", self.drive.is_some()),
            ("--gear-ratio", self.gear_ratio.is_some()),
            ("--motor-constant", self.motor_constant.is_some()),
            ("--resistance", self.resistance.is_some()),
        ]
        .into_iter()
        .filter_map(|(option, given)| given.then_some(option))
    }

    /// Refuses options that friction models have no use for as they are asked for.
    fn check_friction_options(&self) -> Result<(), BadInput> {
        let friction = &self.friction;
        let refuse = |option: &str, why: &str| Err(BadInput(format!("{option} {why}")));
        if self.trim.is_some() {
            return refuse(
                "--trim",
                "speaks of recordings of a driving force, but these are identified as friction models; leave it out",
            );
        }
        if friction.smooth != Some(Smoothing::Butterworth) {
            for (option, given) in
                [("--cutoff", self.cutoff.is_some()), ("--order", self.order.is_some())]
            {
                if given {
                    return refuse(
                        option,
                        "speaks of a low-pass, which friction models have with --smooth butterworth alone; add that or leave it out",
                    );
                }
            }
        }
        if friction.damping_ratio.is_some() && friction.inertia.is_none() && self.drive.is_none() {
            return refuse(
                "--damping-ratio",
                "turns the inertia into micro-damping; add --inertia J:SE or leave it out",
            );
        }
        let source = self.source();
        let of_sensor = matches!(source, None | Some(SourceChoice::Sensor));
        if of_sensor && friction.drive_errors.is_some() {
            return refuse(
                "--drive-errors",
                "speaks of the drive, which friction from a sensor does not need; add --torque-source or leave it out",
            );
        }
        // An inertia of a drive's file is used with a driving torque too.
        let of_driving = source == Some(SourceChoice::Driving);
        let idle = |option: &&str| of_sensor || of_driving && *option != "--drive";
        if let Some(option) = self.motor_options().find(idle) {
            return refuse(
                option,
                "speaks of the motor, which this source of the friction does not need; add --torque-source voltage or current, or leave it out",
            );
        }
        Ok(())
    }

    /// Where the friction comes from, as the options say.
    fn source(&self) -> Option<SourceChoice> {
        match self.friction.torque_source {
            None if self.torque_from_voltage => Some(SourceChoice::Voltage),
            None if self.effort == Some(Effort::Driving) => Some(SourceChoice::Driving),
            other => other,
        }
    }

    /// The columns that were named.
    pub fn columns(&self) -> Columns {
        self.table.columns(Measured::Force, self.joint.as_deref())
    }
}
