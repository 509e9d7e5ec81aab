//! The stages, in their order.

/// A stage of a commission.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    serde::Serialize,
    serde::Deserialize,
    strum::Display,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantArray,
    strum::VariantNames,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Stage {
    /// Signs, zeros, noise and the voltages that just move the shaft.
    Meet,
    /// Gain, time constant and delay.
    Drive,
    /// The friction curve, block by block.
    Friction,
    /// Which curve, on a block that was kept back.
    Model,
    /// Linear gains, and what is fed forward beside them.
    Control,
    /// Before and after, in alternating blocks.
    Proof,
    /// Parameters for the nodes and the report.
    HandOver,
}

impl Stage {
    /// All of them, in order.
    pub const ALL: &'static [Self] = <Self as strum::VariantArray>::VARIANTS;

    /// The file that keeps what the stage found.
    #[must_use]
    pub const fn file(self) -> &'static str {
        match self {
            Self::Meet => "meet.json",
            Self::Drive => "drive.json",
            Self::Friction => "friction.json",
            Self::Model => "model.json",
            Self::Control => "control.json",
            Self::Proof => "proof.json",
            Self::HandOver => "commission.json",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_read_by_name_and_have_files_of_their_own() {
        let mut files = std::collections::BTreeSet::new();
        for stage in Stage::ALL {
            assert_eq!(stage.to_string().parse(), Ok(*stage));
            assert!(files.insert(stage.file()));
        }
        assert!("friktion".parse::<Stage>().is_err());
    }
}
