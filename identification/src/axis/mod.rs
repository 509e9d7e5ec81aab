//! Identification of a recorded axis: what `frictionlab identify` does between reading and
//! printing.
//!
//! [`identify`] works out everything; [`document`] is the JSON, [`page`] the HTML, [`parameters`]
//! the ROS parameter file, [`terminal`] the text.

mod along;
mod band;
mod beside;
pub mod document;
mod errors;
mod faults;
mod held;
mod longest;
mod one_speed;
pub mod page;
pub mod parameters;
mod ramps;
pub mod structure;
pub mod structure_page;
pub mod structure_parameters;
pub mod terminal;

use std::path::{Path, PathBuf};

use friction_ident::adequacy::FitDoubt;
use friction_ident::rigid_axis::free_run::free_run_error;
use friction_ident::{
    AxisFit, AxisModel, AxisTerm, Conditioned, Conditioning, IdentError, Load, LoadChoice,
    Prediction, Rest, Signals, adequacy, choose_load, condition_stretches, fit_axis,
    fit_axis_freely,
};

pub use band::TooFast;
pub use faults::Fault;
use faults::alike;
use friction_ident::statistics::root_mean_square;
use longest::longest;
pub use one_speed::OneSpeed;
use recording::{AxisKind, RecordedStretch, Recording};

/// How a recording is to be identified.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Filtering and thinning.
    pub conditioning: Conditioning,
    /// The same of the recording for the cross-test.
    pub elsewhere: Conditioning,
    /// Whether the cutoff was asked for.
    pub given_cutoff: bool,
    /// Whether the force drives an inertia.
    pub inertia: bool,
    /// Whether the symmetric model has an offset.
    pub offset: bool,
    /// Units.
    pub axis: AxisKind,
    /// Whether the axis may turn under gravity: it does, or nobody knows.
    pub gravity: bool,
    /// Structures are compared besides: a plain model that cannot be is then no error.
    pub structured: bool,
    /// Run the models freely: moved by the force alone.
    pub free_run: bool,
}

/// A fitted model with what it says about the recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelResult {
    /// The fit.
    pub fit: AxisFit,
    /// On the recording it was fitted to.
    pub estimation: Prediction,
    /// On the other one: the cross-test.
    pub validation: Option<Prediction>,
    /// The free run, where it was asked for.
    pub free_run: Option<FreeRun>,
    /// Whether one of the warnings is of it.
    pub warned: bool,
    /// Those that are of it alone.
    pub faults: Vec<Fault>,
}

/// By how much the position of a [`free_run`](friction_ident::rigid_axis::free_run) is off, root
/// mean square \[m or rad\]; none where there is nothing to run, or no such axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeRun {
    /// Along the recording it was fitted to.
    pub estimation: Option<f64>,
    /// Along the other one.
    pub validation: Option<f64>,
}

/// Everything that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Identification {
    /// How it was done.
    pub settings: Settings,
    /// Which force of the position both models have; none where nothing was compared.
    pub load: Option<LoadChoice>,
    /// One viscous and one Coulomb coefficient.
    pub symmetric: ModelResult,
    /// A pair for each direction; none where the recording does not show both.
    pub asymmetric: Option<ModelResult>,
    /// That the motion is faster than what can be taken of it.
    pub too_fast: Option<TooFast>,
    /// Why a model is not to be trusted as a whole: said before any table.
    pub warnings: Vec<String>,
    /// The one of them that says that the motion has one speed.
    pub one_speed: Option<OneSpeed>,
    /// What the reader must know to read the numbers right.
    pub notes: Vec<String>,
}

impl Identification {
    /// That the motion cannot be followed and nothing explains the force, neither a plain model nor
    /// one with the relative error of `other` \[%\]; never where a cutoff was asked for.
    pub fn refusal(&self, other: f64) -> Option<IdentError> {
        let too_fast = self.too_fast.filter(|_| !self.settings.given_cutoff)?;
        let errors = self.plain().map(|model| model.fit.relative_error);
        too_fast.refusal(errors.fold(other, f64::min))
    }
}

/// A recording that could not be identified.
#[derive(Debug, thiserror::Error)]
#[error("{}: {}{source}", path.display(), stretch.as_deref().unwrap_or_default())]
pub struct IdentifyError {
    /// The recording.
    pub path: PathBuf,
    /// Which of several stretches it is about, in words.
    pub stretch: Option<String>,
    /// Why.
    pub source: IdentError,
}

/// Fits both models to `recording` and tries them on `validation`.
///
/// # Errors
/// [`IdentifyError`] with the recording's path. A recording that shows only one direction is no
/// error: the asymmetric model, and if need be the offset, is then left out and a note says so.
pub fn identify(
    recording: &Recording,
    validation: Option<&Recording>,
    settings: &Settings,
) -> Result<Identification, IdentifyError> {
    let (estimation, rest) = moving(recording, &settings.conditioning)?;
    let mut notes = timing_notes(recording, &estimation, rest);
    notes.extend(band::note(recording, &settings.conditioning));
    notes.extend(band::of_the_force(recording, &settings.conditioning));
    let other = validation;
    let validation = match validation {
        Some(other) => {
            let (there, rest) = moving(other, &settings.elsewhere)?;
            notes.extend(timing_notes(other, &there, rest));
            // Where it is the first one that needs the low-pass, that has been said.
            if !settings.conditioning.low_pass_force {
                notes.extend(band::of_the_force(other, &settings.elsewhere));
            }
            notes.extend(band::faster(other, &settings.conditioning, &settings.elsewhere));
            Some((other.path.as_path(), there))
        }
        None => None,
    };
    let blame = |source| IdentifyError { path: recording.path.clone(), stretch: None, source };
    let result = |fit: AxisFit| -> Result<ModelResult, IdentifyError> {
        let here = fit.predict(&estimation).map_err(blame)?;
        let there = match &validation {
            Some((path, other)) => {
                let blame =
                    |source| IdentifyError { path: Path::to_path_buf(path), stretch: None, source };
                Some(fit.predict(other).map_err(blame)?)
            }
            None => None,
        };
        let free_run = settings.free_run.then(|| FreeRun {
            estimation: free_run(&fit, recording),
            validation: other.and_then(|other| free_run(&fit, other)),
        });
        let (warned, faults) = (false, Vec::new());
        Ok(ModelResult { fit, estimation: here, validation: there, free_run, warned, faults })
    };

    let loads = load(&estimation, validation.as_ref().map(|(_, other)| other), settings);
    notes.extend(loads.as_ref().and_then(said_of));
    let load = loads.as_ref().map_or(Load::None, |choice| choice.chosen);
    let wanted =
        AxisModel { asymmetric: false, inertia: settings.inertia, offset: settings.offset, load };
    let symmetric = match fit_axis_freely(&estimation, wanted) {
        Err(IdentError::NotExcited { terms }) if terms == [AxisTerm::Coulomb, AxisTerm::Offset] => {
            notes.push(
                "The axis moves in one direction only, so that a constant force cannot be told from Coulomb \
                 friction: the offset was left out and is contained in the Coulomb friction."
                    .to_owned(),
            );
            fit_axis_freely(&estimation, AxisModel { offset: false, ..wanted })
        }
        other => other,
    };
    let symmetric = symmetric.map_err(blame)?;
    let too_fast = TooFast::of(recording, &settings.conditioning);
    let mut warnings: Vec<String> = too_fast.iter().map(TooFast::to_string).collect();
    for recording in std::iter::once(recording).chain(other) {
        let said = recording.irregularities.doubts().into_iter();
        warnings.extend(said.map(|said| format!("{}: {said}", recording.path.display())));
    }
    for (warning, said) in held::said(recording, &settings.conditioning) {
        if warning { warnings.push(said) } else { notes.push(said) }
    }
    let mut faults = Vec::new();
    if let Err(error) = symmetric.possible() {
        if !settings.structured {
            return Err(blame(error));
        }
        let said = format!("The symmetric model cannot be: {error}.");
        warnings.push(said.clone());
        faults.push(Fault { doubt: None, said });
    }
    let mut changes: Vec<(FitDoubt, String)> = Vec::new();
    let mut symmetric = ModelResult { warned: !faults.is_empty(), faults, ..result(symmetric)? };
    let wanted = AxisModel { asymmetric: true, inertia: settings.inertia, offset: false, load };
    let mut asymmetric = match fit_axis(&estimation, wanted) {
        Ok(fit) => Some(result(fit)?),
        Err(error) => {
            notes.push(format!(
                "The model with separate friction for each direction was left out: {error}."
            ));
            None
        }
    };
    for model in [Some(&mut symmetric), asymmetric.as_mut()].into_iter().flatten() {
        let name = if model.fit.model.asymmetric { "asymmetric" } else { "symmetric" };
        let fails = model.validation.as_ref().and_then(|there| {
            let ModelResult { fit, estimation, .. } = &*model;
            let size = root_mean_square(&estimation.measured);
            adequacy::elsewhere(fit.relative_error, size * size, there)
        });
        let whole = adequacy::doubts(&model.estimation, &estimation).into_iter().chain(fails);
        let impossible = model.fit.impossible();
        let whole =
            whole.chain(impossible.map(|term| FitDoubt::Impossible { id: term.name().into() }));
        let whole: Vec<FitDoubt> = whole.collect();
        let more = if settings.structured { "" } else { " --structure auto offers more." };
        let condemned = too_fast.is_some() || whole.iter().any(FitDoubt::condemns);
        model.warned |= !whole.is_empty();
        for doubt in whole {
            let said = format!("The {name} model {doubt}.{more}");
            // What is of the recording and not of the model is said once.
            if doubt.is_of_the_recording() {
                if changes.iter().any(|(told, _)| alike(*told, doubt)) {
                    continue;
                }
                changes.push((doubt, said.clone()));
            } else {
                warnings.push(said.clone());
            }
            model.faults.push(Fault { doubt: Some(doubt), said });
        }
        notes.extend(doubts(&model.fit));
        if condemned {
            model.fit.distrust();
        }
    }
    let models = (&mut symmetric, asymmetric.as_mut());
    let one_speed = OneSpeed::of(&estimation.velocity, models, settings.axis);
    warnings.extend(one_speed.iter().map(|found| found.said.clone()));
    if let Some(said) = beside::note(&recording.beside).filter(|_| settings.inertia) {
        notes.push(said);
        for model in [Some(&mut symmetric), asymmetric.as_mut()].into_iter().flatten() {
            model.fit.distrust_what_other_joints_move();
        }
    }
    warnings.extend(changes.into_iter().map(|(_, said)| said));
    let found = Identification {
        settings: *settings,
        load: loads,
        symmetric,
        asymmetric,
        too_fast,
        warnings,
        one_speed,
        notes,
    };
    match found.refusal(f64::INFINITY) {
        Some(refusal) if !settings.structured => Err(blame(refusal)),
        _ => Ok(found),
    }
}

/// Compares what of the position may act on the axis; none where nothing can be compared. Friction
/// alone has no load, and without a position in the other recording none could be tried there.
fn load(
    estimation: &Conditioned,
    validation: Option<&Conditioned>,
    settings: &Settings,
) -> Option<LoadChoice> {
    if !(settings.inertia && settings.offset) {
        return None;
    }
    if validation.is_some_and(|other| other.position.is_none()) {
        return None;
    }
    let mut loads = vec![Load::Spring];
    if settings.gravity {
        loads.push(Load::Gravity);
    }
    // Friction of each direction leaves less that could be taken for a load.
    choose_load(estimation, AxisModel::ASYMMETRIC, &loads)
        .or_else(|| choose_load(estimation, AxisModel::SYMMETRIC, &loads))
}

/// Each stretch of a recording, run by its force alone.
fn free_run(fit: &AxisFit, recording: &Recording) -> Option<f64> {
    let position = recording.position.as_deref()?;
    let run = |stretch: &RecordedStretch| {
        let position = position.get(stretch.samples.clone())?;
        let force = recording.force.get(stretch.samples.clone())?;
        Some((fit.free_run(force, position, recording.time_step)?, position))
    };
    let runs: Vec<_> = recording.stretches.iter().filter_map(run).collect();
    free_run_error(runs.iter().map(|(run, position)| (run.as_slice(), *position)))
}

/// What was chosen, and why.
fn said_of(choice: &LoadChoice) -> Option<String> {
    let error = |load| choice.compared.iter().find(|(of, _)| *of == load).map(|(_, error)| *error);
    let (without, with) = (error(Load::None)?, error(choice.chosen)?);
    (choice.chosen != Load::None).then(|| {
        format!(
            "Both models have {}: with it a fit to the rest of the recording predicts each part with an error of {with:.2} %, \
             without any force of the position with {without:.2} %.",
            choice.chosen.describe()
        )
    })
}

/// Filters and differentiates a recording, as the settings say of it.
///
/// # Errors
/// [`IdentifyError`] with the recording's path.
pub fn conditioned(
    recording: &Recording,
    how: &Conditioning,
) -> Result<Conditioned, IdentifyError> {
    moving(recording, how).map(|(conditioned, _)| conditioned)
}

/// The channels of each stretch, with the time of its first sample.
pub(crate) fn channels(recording: &Recording) -> Vec<(f64, Signals<'_>)> {
    let stretch = |stretch: &RecordedStretch| {
        let signals = Signals {
            time_step: recording.time_step,
            position: recording.position.as_deref().map(|all| &all[stretch.samples.clone()]),
            readings: recording.readings.as_deref().map(|all| &all[stretch.samples.clone()]),
            velocity: recording.velocity.as_deref().map(|all| &all[stretch.samples.clone()]),
            force: &recording.force[stretch.samples.clone()],
        };
        (stretch.start, signals)
    };
    recording.stretches.iter().map(stretch).collect()
}

/// Time of which a tenth of a second is shown \[s\].
const SHOWN: f64 = 0.05;

/// The motion of a recording, and for how long it stands still.
fn moving(recording: &Recording, how: &Conditioning) -> Result<(Conditioned, Rest), IdentifyError> {
    let stretches = channels(recording);
    let found = condition_stretches(&stretches, how);
    found.and_then(Conditioned::coarsened).and_then(Conditioned::moving).map_err(|source| {
        let stretch = match source {
            IdentError::TooFewSamples { .. } => longest(recording),
            _ => None,
        };
        IdentifyError { path: recording.path.clone(), stretch, source }
    })
}

/// What is to be said about the times of a recording.
fn timing_notes(recording: &Recording, used: &Conditioned, rest: Rest) -> Vec<String> {
    let path = recording.path.display();
    let mut notes = Vec::new();
    notes.extend(recording.irregularities.describe().map(|said| format!("{path}: {said}")));
    let (found, long) = (recording.stretches.len(), used.stretches());
    if long < found {
        notes.push(format!(
            "{path}: {} of {found} stretches are shorter than the low-pass and --trim need and were left out.",
            found - long
        ));
    }
    if rest.out >= SHOWN {
        let sticks = match rest.sticks {
            sticks if sticks < SHOWN => String::new(),
            sticks => format!(
                " ({sticks:.1} s of that are short sticks that the encoder shows, with what the low-pass spreads of them)"
            ),
        };
        notes.push(format!(
            "{path}: the axis stands still for {:.1} s{sticks}, where friction is whatever is applied; fits and errors are those of the motion.",
            rest.out
        ));
    }
    if rest.kept >= SHOWN {
        notes.push(format!(
            "{path}: the axis sticks so often that too little motion is left between: {:.1} s of short sticks, with what the low-pass spreads \
             of them, are fitted as if it slid there. A recording with fewer turns, or with longer strokes, tells more.",
            rest.kept
        ));
    }
    notes
}

/// What in a fit is not to be trusted.
fn doubts(fit: &AxisFit) -> Vec<String> {
    let model = if fit.model.asymmetric { "asymmetric" } else { "symmetric" };
    let mut doubts = Vec::new();
    for estimate in &fit.terms {
        let what = estimate.term.describe();
        if let Some(doubt) = &estimate.doubt {
            doubts.push(format!(
                "In the {model} model the interval of {what} is not to be trusted: {doubt}."
            ));
            continue;
        }
        if estimate.term.is_signed() {
            // An offset of about zero is a finding, not a failure.
            continue;
        }
        if estimate.is_impossible() && -estimate.value <= estimate.half_width {
            doubts.push(format!("In the {model} model {what} is not different from zero."));
        } else if estimate.is_impossible() {
            doubts.push(format!(
                "In the {model} model {what} comes out negative, which it cannot be, and is not identified; the model is too simple \
                 for this axis, or the recording too poor."
            ));
        } else if !estimate.is_identifiable() {
            doubts.push(format!(
                "In the {model} model {what} is not determined by this recording: its standard error is more than \
                 half its value."
            ));
        }
    }
    doubts
}

/// Unit of a term.
pub fn unit(term: AxisTerm, axis: AxisKind) -> &'static str {
    match term {
        AxisTerm::Inertia => axis.inertia_unit(),
        AxisTerm::Viscous | AxisTerm::ViscousPositive | AxisTerm::ViscousNegative => {
            axis.viscous_unit()
        }
        AxisTerm::Spring => along::stiffness_unit(axis),
        _ => axis.force_unit(),
    }
}
