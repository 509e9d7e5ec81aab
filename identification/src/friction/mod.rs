//! Identification of friction models from recordings of friction: what `frictionlab identify` does
//! with steady points, bags and several files.
//!
//! [`run`] works out everything; [`document`] is the JSON, [`page`] and [`pictures`] the HTML,
//! [`parameters`] the ROS parameter file, [`terminal`] the text; [`band`] the uncertainty of a fitted curve, [`from_drive`] what the
//! drive's constants add to it, [`at_rest_too`] what decides where samples at rest count, [`wording`] what all of them say alike.

pub mod at_rest_too;
pub mod band;
mod constant;
pub mod document;
pub mod from_drive;
pub mod page;
pub mod parameters;
pub mod pictures;
mod ranking;
mod rivals;
pub mod run;
pub mod terminal;
mod trust;
pub mod wording;

use std::path::PathBuf;

use friction_ident::information::{Difference, Standing};
use friction_ident::staged::PositionLoadChoice;
use friction_ident::statistics::root_mean_square;
use friction_ident::{FrictionData, IdentError, Identified, StagedOptions, StretchKind};
use friction_model::ModelName;

use recording::drive_error::AddedUncertainty;
use recording::stretches::{FrictionRecording, Preparation};
use recording::{AxisKind, Irregularities};

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Models, each once.
    pub models: Vec<ModelName>,
    /// How each is identified.
    pub staged: StagedOptions,
    /// How the recordings were conditioned.
    pub preparation: Preparation,
    /// Units.
    pub axis: AxisKind,
    /// How far the contact bends before it slides [m or rad], where it is known.
    pub reach: Option<f64>,
    /// Threads; the results do not depend on it.
    pub workers: usize,
}

/// Kinds of recordings, in the order of the tables.
pub const KINDS: [StretchKind; 4] =
    [StretchKind::Steady, StretchKind::PreSliding, StretchKind::Lag, StretchKind::Mixed];

/// Root mean squares of predicted minus measured friction [N or N m], over what all models that are
/// compared predict: without the samples at rest where one of them predicts a range there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Over all points and samples.
    pub all: f64,
    /// Of each of [`KINDS`], where there is such a recording.
    pub kinds: [Option<f64>; 4],
}

impl Errors {
    /// From what a model leaves, of each of [`KINDS`].
    fn of(residuals: &[Vec<f64>]) -> Self {
        let of_kind = |kind: usize| {
            let residuals = residuals.get(kind).filter(|residuals| !residuals.is_empty());
            residuals.map(|residuals| root_mean_square(residuals))
        };
        Self { all: root_mean_square(&residuals.concat()), kinds: [0, 1, 2, 3].map(of_kind) }
    }
}

/// One model with what it does.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelResult {
    /// The model, its parameters, their uncertainty.
    pub found: Identified,
    /// On the recordings it was fitted to.
    pub fit: Errors,
    /// On the others.
    pub held_out: Option<Errors>,
    /// Mean square worse than the first model's, paired over blocks of the same samples.
    pub difference: Difference,
    /// The same of the logarithms of the blocks' mean squares.
    pub ratio: Difference,
    /// Whether it can be told from the first.
    pub standing: Standing,
    /// Why it cannot be chosen, if it cannot.
    pub cannot_be_chosen: Option<String>,
    /// What the errors of the drive's constants add to the parameters; none with a torque sensor.
    pub from_drive: Option<from_drive::FromDrive>,
}

impl ModelResult {
    /// Root mean square error by which it is judged: on the recordings held out where there are any
    /// [N or N m].
    pub fn error(&self) -> f64 {
        self.held_out.unwrap_or(self.fit).all
    }

    /// Whether it cannot be told from the first.
    pub fn tie(&self) -> bool {
        self.cannot_be_chosen.is_none() && self.standing == Standing::Alike
    }
}

/// By what the models stand in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// Error on recordings that were not used.
    HeldOut,
    /// Schwarz's criterion on those that were.
    Bic,
}

/// A file that was used.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The recording, without its samples.
    pub path: PathBuf,
    /// Samples read.
    pub samples: usize,
    /// Steady points found in it.
    pub points: usize,
    /// Other stretches.
    pub stretches: usize,
    /// What was replaced.
    pub outliers: Vec<recording::stretches::Outlier>,
    /// What the errors of the drive's constants add to the friction.
    pub added: Option<AddedUncertainty>,
    /// What was uneven about the times.
    pub irregularities: Irregularities,
}

impl From<&FrictionRecording> for Source {
    fn from(recording: &FrictionRecording) -> Self {
        Self {
            path: recording.path.clone(),
            samples: recording.samples,
            points: recording.points.len(),
            stretches: recording.stretches.len(),
            outliers: recording.outliers.clone(),
            added: AddedUncertainty::of(&recording.drive_errors),
            irregularities: recording.irregularities,
        }
    }
}

/// Everything that was found.
#[derive(Debug, Clone)]
pub struct FrictionIdentification {
    /// How it was done.
    pub settings: Settings,
    /// The files the models were fitted to.
    pub files: Vec<Source>,
    /// The files they were tried on.
    pub validation: Vec<Source>,
    /// What was fitted to.
    pub data: FrictionData,
    /// What was held out.
    pub held_out: Option<FrictionData>,
    /// The models, best first; one at least. Those that cannot be chosen come last.
    pub models: Vec<ModelResult>,
    /// Place of the model to use among them; none where none can be chosen.
    pub chosen: Option<usize>,
    /// What decided between models that predict at rest too, where others do not.
    pub at_rest_too: Option<at_rest_too::AtRestToo>,
    /// By what they stand in order.
    pub criterion: Criterion,
    /// What is estimated beside friction, and what else was tried.
    pub beside: PositionLoadChoice,
    /// Why the models are not to be trusted as a whole: said before any table.
    pub warnings: Vec<String>,
    /// What the reader must know.
    pub notes: Vec<String>,
    /// It was stopped; what there was by then is here.
    pub interrupted: bool,
}

impl FrictionIdentification {
    /// The model to use, as [`model_choice`](friction_ident::model_choice) chooses it; none where
    /// no fit can be trusted.
    pub fn chosen(&self) -> Option<&ModelResult> {
        self.models.get(self.chosen?)
    }

    /// The result of a model.
    pub fn model(&self, name: ModelName) -> Option<&ModelResult> {
        self.models.iter().find(|result| result.found.name == name)
    }

    /// Recordings held out: steady points, and stretches without a gap.
    pub fn recordings_held_out(&self) -> usize {
        self.held_out.as_ref().map_or(0, |data| {
            data.points.len() + data.pre_sliding.len() + data.lag.len() + data.mixed.len()
        })
    }

    /// The velocities of all that was fitted to [rad/s or m/s].
    pub fn velocities(&self) -> impl Iterator<Item = f64> {
        let data = &self.data;
        let stretches = [&data.pre_sliding, &data.lag, &data.mixed].into_iter().flatten();
        let moving = stretches.flat_map(|stretch| stretch.velocity.iter().copied());
        data.points.iter().map(|point| point.velocity).chain(moving)
    }

    /// Samples and points fitted to, of one kind.
    pub fn count(data: &FrictionData, kind: StretchKind) -> usize {
        match kind {
            StretchKind::Steady => data.points.len(),
            _ => data.stretches(kind).iter().map(friction_ident::Stretch::len).sum(),
        }
    }
}

/// Nothing could be identified.
#[derive(Debug, thiserror::Error)]
pub enum FrictionError {
    /// Every model was refused; the first one's reason.
    #[error("{model} cannot be identified from {files}: {source}{}", hint(source))]
    Refused {
        /// The model.
        model: ModelName,
        /// The files.
        files: String,
        /// Why.
        source: IdentError,
    },
    /// Nothing slides.
    #[error(
        "nothing in {files} slides: a motion of at most {range} {unit} counts as pre-sliding{}, and friction models need sliding too. Add a recording \
         that slides at several velocities{}",
        if *given { " by --reach" } else { "" },
        if *given { ", or give a smaller --reach, or leave it out" } else { ", or say with --reach that the contact bends by less" }
    )]
    OnlyPreSliding {
        /// The files.
        files: String,
        /// How far motion goes that counts as pre-sliding \[m or rad\].
        range: f64,
        /// `m` or `rad`.
        unit: &'static str,
        /// Whether `--reach` said so.
        given: bool,
    },
    /// It was stopped before any model had a parameter.
    #[error("stopped before the first model was identified; nothing is written")]
    Nothing,
}

/// What mends it.
fn hint(error: &IdentError) -> &'static str {
    match error {
        IdentError::TooFewSamples { what, .. } if what.contains("Stribeck") => {
            " (add a file with steady points, columns velocity_rad_s and torque_Nm, or a recording that slides at several velocities)"
        }
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Its advice led to a refusal that spoke of a Stribeck curve and eight samples.
    #[test]
    fn what_does_not_slide_is_refused_with_the_way_out() {
        let refusal = |given| {
            let files = "a.csv".to_owned();
            FrictionError::OnlyPreSliding { files, range: 0.02, unit: "rad", given }.to_string()
        };
        assert!(refusal(true).contains("a smaller --reach"), "{}", refusal(true));
        assert!(refusal(false).contains("say with --reach"), "{}", refusal(false));
        assert!(refusal(true).contains("Add a recording that slides"));
    }
}
