//! The friction that a target computes, as a model of ours.

use friction_model::{
    AnyModel, CoulombViscous, CoulombViscousParameters, LuGre, LuGreParameters, ModelError,
    Stribeck, StribeckParameters, Viscous, ViscousParameters,
};

/// The friction of a target, with its parameters \[N m, rad, s; or N, m, s\].
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "models live in place: they are copied, and there are few of them"
)]
pub enum Contact {
    /// A level and a viscous coefficient; the level may be zero.
    CoulombViscous {
        /// The level.
        f_c: f64,
        /// The viscous coefficient.
        f_v: f64,
    },
    /// A level at rest, one in motion, and a viscous coefficient.
    StaticDynamicViscous {
        /// The level up to which it holds.
        f_s: f64,
        /// The level in motion.
        f_d: f64,
        /// The viscous coefficient.
        f_v: f64,
    },
    /// A Stribeck curve.
    Stribeck(StribeckParameters),
    /// LuGre.
    LuGre(LuGreParameters),
    /// The model that was identified.
    Own(AnyModel),
}

impl Contact {
    /// The model whose friction under a given motion is the target's.
    ///
    /// # Errors
    /// [`ModelError`] for parameters that no model takes.
    pub fn model(&self) -> Result<AnyModel, ModelError> {
        Ok(match *self {
            Self::CoulombViscous { f_c, f_v }
            | Self::StaticDynamicViscous { f_d: f_c, f_v, .. } => {
                if f_c > 0.0 {
                    let parameters = CoulombViscousParameters { f_c, f_v };
                    AnyModel::CoulombViscous(CoulombViscous::try_from(parameters)?)
                } else {
                    AnyModel::Viscous(Viscous::try_from(ViscousParameters { f_v })?)
                }
            }
            Self::Stribeck(parameters) => AnyModel::Stribeck(Stribeck::try_from(parameters)?),
            Self::LuGre(parameters) => AnyModel::LuGre(LuGre::try_from(parameters)?),
            Self::Own(model) => model,
        })
    }
}
