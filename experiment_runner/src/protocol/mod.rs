//! Experiments as data: what is driven, for how long, how often.
//!
//! A protocol is a YAML file in which every number carries its unit (`15 s`, `0.03 rad/s`). The
//! files of the thesis's four experiments are part of the program ([`ProtocolFile::shipped`]): what
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

use parameters::with_nearest;
use serde::Deserialize;
use serde::de::DeserializeOwned;

pub use breakaway_rate::BreakawayRateProtocol;
pub use compensation::{CompensationProtocol, CompensationTask};
pub use constant_velocity::ConstantVelocityProtocol;
pub use drive_excitation::DriveExcitationProtocol;
pub use error::ProtocolError;
pub use pre_sliding::{Displacement, OnsetRule, PreSlidingProtocol};
pub use sequence::SequenceProtocol;
pub use tracking::{InverseUse, TrackingProtocol};
pub use varying_velocity::VaryingVelocityProtocol;

use quantity::{Dimension, Quantity};

/// A protocol that files describe, one of which is part of the program.
pub trait ProtocolFile: Sized {
    /// Name of its experiment, which a file says under `experiment`.
    const NAME: &'static str;
    /// The file that is part of the program, with comments.
    const TEXT: &'static str;
    /// The form of a file.
    type Sheet: DeserializeOwned + TryInto<Self, Error = ProtocolError>;

    /// Reads a file.
    ///
    /// # Errors
    /// [`ProtocolError`] with the key, or the line and column, that is wrong.
    fn read(text: &str) -> Result<Self, ProtocolError> {
        sheet::<Self::Sheet>(text, Self::NAME)?.try_into()
    }

    /// The protocol that is part of the program.
    ///
    /// # Errors
    /// [`ProtocolError`] if the file that is part of the program is wrong; a test reads them all.
    fn shipped() -> Result<Self, ProtocolError> {
        Self::read(Self::TEXT)
    }
}

/// Name of the experiment that a file describes.
///
/// # Errors
/// [`ProtocolError`] if it names none.
pub fn experiment_of(text: &str) -> Result<String, ProtocolError> {
    #[derive(Deserialize)]
    struct Head {
        experiment: String,
    }
    Ok(sheet::<Head>(text, "pre-sliding")?.experiment)
}

fn sheet<T: DeserializeOwned>(text: &str, name: &'static str) -> Result<T, ProtocolError> {
    serde_saphyr::from_str(text).map_err(|error| {
        let said = error.to_string();
        let detail =
            with_nearest(said.lines().next().unwrap_or_default().trim_start_matches("error: "));
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
