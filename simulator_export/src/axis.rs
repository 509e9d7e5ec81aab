//! Which way an axis moves, and the units that follow.

/// Whether an axis turns or slides.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    strum::Display,
    strum::EnumString,
    strum::VariantArray,
)]
#[strum(serialize_all = "lowercase")]
pub enum Axis {
    /// It turns: N m, rad.
    #[default]
    Rotary,
    /// It slides: N, m.
    Linear,
}

impl Axis {
    /// Unit of a torque or force.
    #[must_use]
    pub const fn effort(self) -> &'static str {
        match self {
            Self::Rotary => "N m",
            Self::Linear => "N",
        }
    }

    /// Unit of a speed.
    #[must_use]
    pub const fn speed(self) -> &'static str {
        match self {
            Self::Rotary => "rad/s",
            Self::Linear => "m/s",
        }
    }

    /// Unit of a travel.
    #[must_use]
    pub const fn travel(self) -> &'static str {
        match self {
            Self::Rotary => "rad",
            Self::Linear => "m",
        }
    }
}
