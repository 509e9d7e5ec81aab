//! Experiments as data: what is driven, for how long, how often.
//!
//! A protocol is a YAML file in which every number carries its unit (`15 s`, `0.03 rad/s`). The
//! files of the thesis's four experiments are part of the program ([`Kind::shipped`]): what
//! `frictionlab protocols` prints is what runs. Inside the program everything is in SI units.

mod breakaway_rate;
mod compensation;
mod constant_velocity;
mod drive_excitation;
mod error;
mod pre_sliding;
pub mod quantity;
mod sequence;
mod tracking;
mod varying_velocity;

use serde::{Deserialize, Serialize};

pub use breakaway_rate::BreakawayRateProtocol;
pub use compensation::{CompensationProtocol, CompensationTask};
pub use constant_velocity::ConstantVelocityProtocol;
pub use drive_excitation::DriveExcitationProtocol;
pub use error::ProtocolError;
pub use pre_sliding::{Displacement, OnsetRule, PreSlidingProtocol, REST};
pub use sequence::SequenceProtocol;
pub use tracking::{InverseUse, TrackingProtocol};
pub use varying_velocity::VaryingVelocityProtocol;

use quantity::{Dimension, Quantity};

/// Which experiment a protocol describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Experiment 1: friction at constant velocities.
    ConstantVelocity,
    /// Experiment 2: friction under a velocity that varies but keeps its sign.
    VaryingVelocity,
    /// Experiment 3: breakaway and hysteresis before sliding.
    PreSliding,
    /// Experiment 4: breakaway against the rate of the torque.
    BreakawayRate,
    /// Compensations compared in tracking and regulation.
    Compensation,
    /// Voltage that shows the drive, for `identify-drive`.
    DriveExcitation,
    /// A sequence of one's own.
    Sequence,
}

impl Kind {
    /// Every kind, in the order of the thesis.
    pub const ALL: [Self; 7] = [
        Self::ConstantVelocity,
        Self::VaryingVelocity,
        Self::PreSliding,
        Self::BreakawayRate,
        Self::Compensation,
        Self::DriveExcitation,
        Self::Sequence,
    ];

    /// Name on the command line and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ConstantVelocity => "constant-velocity",
            Self::VaryingVelocity => "varying-velocity",
            Self::PreSliding => "pre-sliding",
            Self::BreakawayRate => "breakaway-rate",
            Self::Compensation => "compensation",
            Self::DriveExcitation => "drive-excitation",
            Self::Sequence => "sequence",
        }
    }

    /// The protocol's file that is part of the program, with comments.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::ConstantVelocity => include_str!("../../protocols/constant-velocity.yaml"),
            Self::VaryingVelocity => include_str!("../../protocols/varying-velocity.yaml"),
            Self::PreSliding => include_str!("../../protocols/pre-sliding.yaml"),
            Self::BreakawayRate => include_str!("../../protocols/breakaway-rate.yaml"),
            Self::Compensation => include_str!("../../protocols/compensation.yaml"),
            Self::DriveExcitation => include_str!("../../protocols/drive-excitation.yaml"),
            Self::Sequence => include_str!("../../protocols/sequence.yaml"),
        }
    }

    /// What it does, in one line.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::ConstantVelocity => "friction at constant velocities: the Stribeck curve",
            Self::VaryingVelocity => "velocity varied without a reversal: frictional lag",
            Self::PreSliding => "breakaway torque and displacement, and hysteresis below them",
            Self::BreakawayRate => "breakaway against the rate of the torque",
            Self::Compensation => {
                "compensations compared in tracking and regulation of velocity and position"
            }
            Self::DriveExcitation => "voltage that shows the drive, for `identify-drive`",
            Self::Sequence => "an example of a sequence of one's own",
        }
    }
}

/// A protocol of any kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Protocol {
    /// Experiment 1.
    ConstantVelocity(ConstantVelocityProtocol),
    /// Experiment 2.
    VaryingVelocity(VaryingVelocityProtocol),
    /// Experiment 3.
    PreSliding(PreSlidingProtocol),
    /// Experiment 4.
    BreakawayRate(BreakawayRateProtocol),
    /// Compensations compared.
    Compensation(CompensationProtocol),
    /// Voltage that shows the drive.
    DriveExcitation(DriveExcitationProtocol),
    /// A sequence of one's own.
    Sequence(SequenceProtocol),
}

impl Protocol {
    /// Reads a protocol.
    ///
    /// # Errors
    /// [`ProtocolError`] with the key, or the line and column, that is wrong.
    pub fn read(text: &str) -> Result<Self, ProtocolError> {
        #[derive(Deserialize)]
        struct Head {
            experiment: Kind,
        }
        let kind = sheet::<Head>(text, "pre-sliding")?.experiment;
        let name = kind.name();
        Ok(match kind {
            Kind::ConstantVelocity => {
                Self::ConstantVelocity(sheet::<constant_velocity::Sheet>(text, name)?.try_into()?)
            }
            Kind::VaryingVelocity => {
                Self::VaryingVelocity(sheet::<varying_velocity::Sheet>(text, name)?.try_into()?)
            }
            Kind::PreSliding => {
                Self::PreSliding(sheet::<pre_sliding::Sheet>(text, name)?.try_into()?)
            }
            Kind::BreakawayRate => {
                Self::BreakawayRate(sheet::<breakaway_rate::Sheet>(text, name)?.try_into()?)
            }
            Kind::Compensation => {
                Self::Compensation(sheet::<compensation::Sheet>(text, name)?.try_into()?)
            }
            Kind::DriveExcitation => {
                Self::DriveExcitation(sheet::<drive_excitation::Sheet>(text, name)?.try_into()?)
            }
            Kind::Sequence => Self::Sequence(sheet::<sequence::Sheet>(text, name)?.try_into()?),
        })
    }

    /// Which experiment it describes.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::ConstantVelocity(_) => Kind::ConstantVelocity,
            Self::VaryingVelocity(_) => Kind::VaryingVelocity,
            Self::PreSliding(_) => Kind::PreSliding,
            Self::BreakawayRate(_) => Kind::BreakawayRate,
            Self::Compensation(_) => Kind::Compensation,
            Self::DriveExcitation(_) => Kind::DriveExcitation,
            Self::Sequence(_) => Kind::Sequence,
        }
    }
}

fn sheet<T: for<'de> Deserialize<'de>>(text: &str, name: &'static str) -> Result<T, ProtocolError> {
    serde_saphyr::from_str(text).map_err(|error| {
        let said = error.to_string();
        let detail =
            said.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned();
        ProtocolError::Form { detail, name }
    })
}

/// The value of a quantity of the right kind within `least` to `most`.
fn within(
    quantity: Quantity,
    key: &str,
    dimension: Dimension,
    least: f64,
    most: f64,
) -> Result<f64, ProtocolError> {
    if quantity.dimension == dimension && (least..=most).contains(&quantity.value) {
        return Ok(quantity.value);
    }
    let unit = dimension.unit();
    let expected = format!("{} from {least} to {most} {unit}", dimension.describe());
    Err(ProtocolError::new(key, quantity, expected))
}

/// A number of things within `least` to `most`.
fn count(number: u32, key: &str, least: u32, most: u32) -> Result<u32, ProtocolError> {
    if (least..=most).contains(&number) {
        return Ok(number);
    }
    Err(ProtocolError::new(key, number, format!("a whole number from {least} to {most}")))
}

#[cfg(test)]
mod tests;
