//! Kinds of runs, and the documents by which they are known.

use serde::Serialize;
use strum::{Display, VariantArray};

/// What a run did. Its name is that of the command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Display, VariantArray, Serialize)]
#[strum(serialize_all = "kebab-case")]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Experiments on a rig.
    Run,
    /// Many machines that were commissioned.
    #[strum(serialize = "commission --trial")]
    Trial,
    /// A rig that was commissioned.
    Commission,
    /// Protocols beside each other.
    #[strum(serialize = "commission --protocols")]
    Protocols,
    /// Friction models, or a driven axis.
    Identify,
    /// A drive.
    IdentifyDrive,
    /// A servo.
    IdentifyServo,
    /// Parameters of a servo, tried on other logs.
    #[strum(serialize = "identify-servo --evaluate")]
    Evaluation,
    /// Sticking and slipping.
    IdentifyStiction,
    /// A linear controller.
    Design,
    /// Features of the models.
    Features,
    /// Compensation with wrong parameters.
    MonteCarlo,
    /// Every observer on every plant.
    TruthMatrix,
    /// What a recording holds.
    Look,
    /// A recording and nothing else, of `live`.
    Recording,
}

impl Kind {
    /// The file that says what was found.
    #[must_use]
    pub const fn document(self) -> &'static str {
        match self {
            Self::Run => "run.json",
            Self::Trial => "trial.json",
            Self::Commission => "commission.json",
            Self::Protocols => "protocols.json",
            Self::Identify => "identification.json",
            Self::IdentifyDrive => "identification-drive.json",
            Self::IdentifyServo => "servo.json",
            Self::Evaluation => "evaluation.json",
            Self::IdentifyStiction => "stiction.json",
            Self::Design => "design.json",
            Self::Features => "features.json",
            Self::MonteCarlo => "monte-carlo.json",
            Self::TruthMatrix => "truth-matrix.json",
            Self::Look => "look.json",
            Self::Recording => "bag/metadata.yaml",
        }
    }

    /// The file that is there before [`document`](Self::document) is: of a run that is not done.
    #[must_use]
    pub const fn begun(self) -> Option<&'static str> {
        match self {
            Self::Run => Some("journal.jsonl"),
            Self::Commission => Some("rig.json"),
            _ => None,
        }
    }

    /// Names that its document has, one of which at least must be there.
    pub(crate) const fn names(self) -> &'static [&'static str] {
        match self {
            Self::Run => &["options"],
            Self::Features => &["limit_cycle"],
            Self::MonteCarlo => &["cells"],
            Self::TruthMatrix => &["rows"],
            Self::Look => &["channels", "form"],
            _ => &["format"],
        }
    }

    /// How to go on with a run that is not done.
    #[must_use]
    pub const fn resumed_by(self) -> Option<&'static str> {
        match self {
            Self::Run => Some("frictionlab run --resume"),
            Self::Commission => Some("frictionlab commission --resume"),
            _ => None,
        }
    }
}
