//! `frictionlab simulate`: any model along any motion.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::{fs, iter};

use friction_model::{AnyModel, ModelName};

use crate::interruption;
use experiment_runner::models::file;
use files::{OutputError, OutputFile};
use recording::trajectory::{self, Point};
use studies::simulate::{Done, Motion, Scheme, Settings, Stopped, holds_a_tolerance, simulate};
use work::destination::Force;
use work::model_name::model_name;
use work::progress::Progress;
use work::saying::print;
use work::{BadInput, Interrupted};

/// Largest error of a step of Runge and Kutta where none is given.
const TOLERANCE: f64 = 1e-6;

/// How much of the motion is read before the progress says so [KiB].
const TOLD_AT_ONCE: u64 = 64;

/// Evaluate a friction model along a motion
///
/// The motion is a table with a time and a velocity, as t_s and velocity_rad_s (or velocity_m_s), at
/// any spacing; columns and encodings are recognised as `frictionlab identify` does. Between the
/// rows the velocity is a straight line. The contact starts at rest and unloaded at the first row.
///
/// The result has one line for each row of the motion:
///
///   t_s, velocity_rad_s   as in the motion (and load_Nm with --load-gain)
///   torque_Nm             the friction, which opposes the motion
///   deflection_rad        of the bristles
///   gamma_Nm              the level at which the contact slides
///   regime                stick or slip
///   stored_energy_J       in the bristles, where the model defines it
///   state_1, state_2 ...  the model's continuous states; of an asymmetric contact first those
///                         of the forward direction
///
/// or force_N and metres for a linear axis. Everything is as it stands at the row's time and
/// velocity, before the contact moves on. Models without bristles know no force at exactly zero
/// velocity (Karnopp's: in its band), where it depends on what is applied: they say 0 with every
/// scheme, and how many rows that are is told. The load changes the force alone. Velocities beyond
/// 1e6 are refused.
///
///   frictionlab models lugre --yaml > lugre.yaml
///   frictionlab simulate --params lugre.yaml --velocity motion.csv --out friction.csv
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct SimulateArgs {
    /// The model [default: the one that the parameter file names].
    #[arg(long, value_name = "NAME", value_parser = model_name, required_unless_present = "params")]
    model: Option<ModelName>,

    /// Its parameters in YAML, as `frictionlab models NAME --yaml` prints them; the bare
    /// parameters, a contact with `asymmetric`, and the parameters.yaml of a run are accepted too
    /// [default: the thesis's test bed].
    #[arg(long, value_name = "FILE.yaml")]
    params: Option<PathBuf>,

    /// The motion.
    #[arg(long, value_name = "FILE.csv")]
    velocity: PathBuf,

    /// Where the result goes; - is standard output.
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,

    #[command(flatten)]
    force: Force,

    /// How the states advance.
    #[arg(long, value_enum, default_value_t)]
    scheme: Scheme,

    /// Longest step [s]; the time between two rows is divided into equal steps.
    #[arg(long, value_name = "SECONDS", default_value = "1e-5", allow_negative_numbers = true)]
    dt: f64,

    /// Largest difference between a step with --scheme rk4 and its two halves, in the states and
    /// the deflection relative to the largest that they have had, in the force and its level
    /// relative to these; a step that does not hold it is halved [default: 1e-6].
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    tolerance: Option<f64>,

    /// Let every level of the contact grow by C of itself for each N m (or N) in the column load_Nm
    /// (or load_N) of the motion; the viscous part does not depend on the load.
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    load_gain: Option<f64>,

    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

/// Simulates and writes the result.
///
/// # Errors
/// [`BadInput`] for whatever is wrong with the files or the options, [`Interrupted`] after ctrl-C;
/// no file is written then. Standard output, a pipe or a device has what was done before.
pub fn execute(args: &SimulateArgs) -> anyhow::Result<()> {
    if let (Some(_), true) = (args.tolerance, args.scheme != Scheme::Rk4) {
        let why = "--tolerance speaks of the steps of --scheme rk4; add that or leave it out";
        return Err(BadInput(why.to_owned()).into());
    }
    let model = model(args)?;
    if args.tolerance.is_some() && !holds_a_tolerance(&model) {
        let why = "--tolerance cannot be held by this model: it draws its bonds at random at each \
                   step, so other steps are another draw; leave it out";
        return Err(BadInput(why.to_owned()).into());
    }
    let mut motion = trajectory::open(&args.velocity)?;
    let out = destination(args)?;
    let SimulateArgs { scheme, dt, load_gain, .. } = *args;
    let tolerance = args.tolerance.unwrap_or(TOLERANCE);
    let settings = Settings { scheme, dt, tolerance, load_gain };
    let cancel = interruption::watch(interruption::DRIVING)?;
    let length = fs::metadata(&args.velocity).map_or(0, |file| file.len());
    let progress = Progress::counting(length >> 10, "KiB of the motion", args.quiet);
    progress.stage(model.name().title());
    let (axis, loaded) = (motion.axis, motion.loaded);
    let notes = std::mem::take(&mut motion.notes);
    let (mut done_of_it, mut span) = (0, None);
    let points = iter::from_fn(|| {
        if cancel.load(Ordering::Relaxed) {
            return None;
        }
        let point = motion.next()?;
        if let Ok(Point { time, .. }) = point {
            span = Some((span.map_or(time, |(first, _)| first), time));
        }
        let read = motion.bytes() >> 10;
        if read >= done_of_it + TOLD_AT_ONCE {
            progress.advance((read - done_of_it) as f64);
            done_of_it = read;
        }
        Some(point)
    });
    let mut growing = out.grow()?;
    let result = simulate(&model, Motion { axis, loaded, points }, &settings, &mut growing);
    progress.finish();
    let done = match result {
        Ok(_) if cancel.load(Ordering::Relaxed) => {
            let what = "stopped before the end of the motion; no file was written";
            return Err(Interrupted(what.to_owned()).into());
        }
        Ok(done) => done,
        Err(Stopped::Motion(error)) => return Err(error.into()),
        Err(Stopped::Refused(error)) => return Err(BadInput(error.to_string()).into()),
        Err(Stopped::Write(source)) => {
            let path = out.name().into();
            return Err(OutputError::Write { path, source }.into());
        }
    };
    growing.finish()?;
    // Standard output has the result and nothing else.
    if args.quiet || out.is_stdout() {
        return Ok(());
    }
    let (title, rows, path) = (model.name().title(), done.rows, out.name());
    let duration = span.map_or(0.0, |(first, last)| last - first);
    let mut what = said(args, holds_a_tolerance(&model).then_some(tolerance), &done);
    for note in notes {
        what += &format!("{note}\n");
    }
    print(&format!(
        "{title} along {duration:.6} s of motion: {rows} rows written to {path}\n{what}"
    ))
}

/// What the reader of the result should know of how it was made.
fn said(args: &SimulateArgs, tolerance: Option<f64>, done: &Done) -> String {
    let mut said = String::new();
    let halvings = done.halvings;
    match tolerance.filter(|_| args.scheme == Scheme::Rk4) {
        None if args.scheme == Scheme::Rk4 => {
            said += "the model draws its bonds at random at each step: another --dt is another \
                     draw, and no tolerance is held\n";
        }
        None => {}
        Some(tolerance) if halvings.halved == 0 => {
            said = format!("every step held the tolerance of {tolerance}\n");
        }
        Some(tolerance) => {
            said = format!(
                "{} times a step was halved to hold the tolerance of {tolerance}: {} steps were \
                 taken, the shortest of about {:.1e} s\n",
                halvings.halved,
                halvings.taken,
                args.dt / 2f64.powi(halvings.most.cast_signed())
            );
        }
    }
    if halvings.jumps > 0 {
        said += &format!(
            "{} times the contact switched: where, is known to the shortest step\n",
            halvings.jumps
        );
    }
    if done.held > 0 {
        said += &format!(
            "{} rows stand still: what the contact holds there depends on the force applied, which \
             a motion does not tell; they have the force 0\n",
            done.held
        );
    }
    said
}

fn model(args: &SimulateArgs) -> Result<AnyModel, BadInput> {
    match (&args.params, args.model) {
        (Some(path), wanted) => {
            let refused = |what: String| {
                BadInput(format!("the parameter file {} cannot be used: {what}", path.display()))
            };
            let text = files::input::text(path).map_err(|error| refused(error.to_string()))?;
            file::read(&text, wanted).map_err(|error| refused(error.to_string()))
        }
        (None, Some(name)) => Ok(AnyModel::test_bed(name)),
        // The command line asks for one of them.
        (None, None) => Err(BadInput("expected --model NAME or --params FILE.yaml".to_owned())),
    }
}

/// The file of the result, which must not take the place of what was read.
fn destination(args: &SimulateArgs) -> anyhow::Result<OutputFile> {
    let out = &args.out;
    let same = |other: &Path| matches!((out.canonicalize(), other.canonicalize()), (Ok(a), Ok(b)) if a == b);
    if [Some(&args.velocity), args.params.as_ref()].into_iter().flatten().any(|input| same(input)) {
        let out = out.display();
        let why = format!("--out {out} is a file that is read; the result needs another");
        return Err(BadInput(why).into());
    }
    Ok(args.force.file(&args.out)?)
}
