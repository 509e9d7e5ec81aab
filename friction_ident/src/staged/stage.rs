//! The stages, the parameters that each estimates, and what one finds.

use serde::Serialize;

use crate::estimate::Estimates;
use crate::near_rest::LeftNearRest;

/// Which stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Static characteristic from constant velocities.
    Static,
    /// Stiffness from pre-sliding.
    PreSliding,
    /// Micro-damping computed from inertia and damping ratio.
    MicroDamping,
    /// Lag from velocity that varies one way.
    Lag,
    /// All parameters together.
    Joint,
}

impl Stage {
    /// In words.
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Static => "static characteristic",
            Self::PreSliding => "pre-sliding",
            Self::MicroDamping => "computed micro-damping",
            Self::Lag => "frictional lag",
            Self::Joint => "joint refinement",
        }
    }
}

/// What a stage found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageResult {
    /// Which.
    pub stage: Stage,
    /// Points and samples it used; zero for one that computes.
    pub samples: usize,
    /// Root mean square of predicted minus measured friction on them \[N or N m\].
    pub rms: f64,
    /// The parameters it estimated.
    pub estimates: Estimates,
    /// What it leaves near rest, where the model lacks something there.
    #[serde(skip)]
    pub left: Option<LeftNearRest>,
}

/// Parameters of the static characteristic.
pub(super) const STATIC: [&str; 4] = ["f_s", "f_c", "v_s", "f_v"];
/// Parameters of pre-sliding.
pub(super) const PRE_SLIDING: [&str; 6] = ["z_b", "sigma0", "k", "alpha", "lambda", "z_ba"];
/// Parameters of the micro-damping.
pub(super) const DAMPING: [&str; 2] = ["sigma", "sigma1"];
/// Parameters of the lag.
pub(super) const LAG: [&str; 2] = ["tau", "c"];
