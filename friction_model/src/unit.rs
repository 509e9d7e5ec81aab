//! Units of parameters.

/// Unit of a parameter, for a linear axis and for a rotary one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Unit {
    /// N or N m
    Force,
    /// N/m or N m/rad
    Stiffness,
    /// N s/m or N m s/rad
    Damping,
    /// m or rad
    Deflection,
    /// m/s or rad/s
    Speed,
    /// s/m or s/rad
    PerSpeed,
    /// m/s^2 or rad/s^2
    Acceleration,
    /// N/s or N m/s
    ForceRate,
    /// s
    Time,
    /// A pure number
    None,
}

impl Unit {
    /// The unit on a linear axis; empty for a pure number.
    #[must_use]
    pub const fn linear(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Stiffness => "N/m",
            Self::Damping => "N s/m",
            Self::Deflection => "m",
            Self::Speed => "m/s",
            Self::PerSpeed => "s/m",
            Self::Acceleration => "m/s^2",
            Self::ForceRate => "N/s",
            Self::Time => "s",
            Self::None => "",
        }
    }

    /// The unit on a rotary axis; empty for a pure number.
    #[must_use]
    pub const fn rotary(self) -> &'static str {
        match self {
            Self::Force => "N m",
            Self::Stiffness => "N m/rad",
            Self::Damping => "N m s/rad",
            Self::Deflection => "rad",
            Self::Speed => "rad/s",
            Self::PerSpeed => "s/rad",
            Self::Acceleration => "rad/s^2",
            Self::ForceRate => "N m/s",
            Self::Time => "s",
            Self::None => "",
        }
    }
}
