//! The terms that the model of a rigid axis may have.

use std::fmt;

use serde::Serialize;

/// One term of the axis model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum AxisTerm {
    /// Moving mass \[kg\] or moment of inertia \[kg m^2\], as seen by the force.
    Inertia,
    /// Viscous friction \[N s/m or N m s/rad\].
    Viscous,
    /// Coulomb friction \[N or N m\].
    Coulomb,
    /// Constant force \[N or N m\]: gravity, or the offset of an amplifier.
    Offset,
    /// Viscous friction of motion in the positive direction.
    ViscousPositive,
    /// Viscous friction of motion in the negative direction.
    ViscousNegative,
    /// Coulomb friction of motion in the positive direction.
    CoulombPositive,
    /// Coulomb friction of motion in the negative direction, a positive number.
    CoulombNegative,
    /// Force of a spring, per position \[N/m or N m/rad\].
    Spring,
    /// Torque of gravity that goes with the sine of the angle \[N m\].
    GravitySin,
    /// Torque of gravity that goes with the cosine of the angle \[N m\].
    GravityCos,
}

impl AxisTerm {
    /// Whether the position alone decides its force.
    pub fn is_load(self) -> bool {
        matches!(self, Self::Spring | Self::GravitySin | Self::GravityCos)
    }

    /// Those that may have either sign: they do not change with the velocity.
    pub const SIGNED: [Self; 4] = [Self::Offset, Self::Spring, Self::GravitySin, Self::GravityCos];

    /// Whether it may have either sign.
    pub fn is_signed(self) -> bool {
        Self::SIGNED.contains(&self)
    }

    /// Name in files: `inertia`, `viscous_positive`, ...
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The term in words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Inertia => "the inertia",
            Self::Viscous => "the viscous friction",
            Self::Coulomb => "the Coulomb friction",
            Self::Offset => "the offset",
            Self::ViscousPositive => "the viscous friction of positive motion",
            Self::ViscousNegative => "the viscous friction of negative motion",
            Self::CoulombPositive => "the Coulomb friction of positive motion",
            Self::CoulombNegative => "the Coulomb friction of negative motion",
            Self::Spring => "the spring",
            Self::GravitySin => "gravity with the sine of the angle",
            Self::GravityCos => "gravity with the cosine of the angle",
        }
    }

    /// The direction of motion the term belongs to, if it belongs to one.
    pub fn direction(self) -> Option<f64> {
        match self {
            Self::ViscousPositive | Self::CoulombPositive => Some(1.0),
            Self::ViscousNegative | Self::CoulombNegative => Some(-1.0),
            _ => None,
        }
    }

    /// What multiplies the term in one sample; `sign` is that of the velocity, zero at rest.
    pub(crate) fn regressor(
        self,
        position: f64,
        acceleration: f64,
        velocity: f64,
        sign: f64,
    ) -> f64 {
        let here = |direction: f64| if sign == direction { 1.0 } else { 0.0 };
        match self {
            Self::Inertia => acceleration,
            Self::Viscous => velocity,
            Self::Coulomb => sign,
            Self::Offset => 1.0,
            Self::ViscousPositive => velocity * here(1.0),
            Self::ViscousNegative => velocity * here(-1.0),
            Self::CoulombPositive => here(1.0),
            Self::CoulombNegative => -here(-1.0),
            Self::Spring => position,
            Self::GravitySin => position.sin(),
            Self::GravityCos => position.cos(),
        }
    }
}

impl fmt::Display for AxisTerm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
