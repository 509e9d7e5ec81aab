//! The friction of the example: the thesis's parameters in N m, rad and s.

use friction_model::{
    Elements, Gms, GmsParameters, LuGre, LuGreParameters, ModelError, ModelName, Proposed,
    ProposedParameters, Viscous, ViscousParameters, Xiong, XiongParameters,
};
use serde::Serialize;

use super::closed_loop::Contact;

/// A model with the parameters of section 5.4.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExampleModel {
    /// The thesis's own.
    Proposed,
    /// LuGre.
    LuGre,
    /// GMS of four elements, 100 N m/rad in all as the thesis prints it.
    Gms,
    /// Xiong's of four elements, 10 N m/rad in all as the thesis prints it.
    Xiong,
    /// GMS as stiff as the proposed model at rest, 520 N m/rad in all.
    StiffGms,
    /// Xiong's as stiff as the proposed model at rest, 520 N m/rad in all.
    StiffXiong,
}

impl ExampleModel {
    /// The four that the thesis compares, in its order.
    pub const PRINTED: [Self; 4] = [Self::Proposed, Self::LuGre, Self::Gms, Self::Xiong];

    /// Which model it is.
    #[must_use]
    pub const fn name(self) -> ModelName {
        match self {
            Self::Proposed => ModelName::Proposed,
            Self::LuGre => ModelName::LuGre,
            Self::Gms | Self::StiffGms => ModelName::Gms,
            Self::Xiong | Self::StiffXiong => ModelName::Xiong,
        }
    }

    /// The name in tables.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::StiffGms => "GMS, 520 N m/rad",
            Self::StiffXiong => "Xiong, 520 N m/rad",
            other => other.name().title(),
        }
    }
}

/// Levels of all four: F_s, F_c [N m], v_s [rad/s], f_v [N m s/rad].
const LEVELS: (f64, f64, f64, f64) = (0.33, 0.28, 0.01, 0.0176);
const TAU: f64 = 0.002;

/// The proposed model.
pub(super) fn proposed() -> Result<Contact<Proposed>, ModelError> {
    let ((f_s, f_c, v_s, f_v), sigma) = (LEVELS, 60.0);
    let parameters =
        ProposedParameters { f_s, f_c, v_s, delta: 2.0, sigma, tau: TAU, z_b: 0.001, f_v };
    Ok(Contact::new(parameters.try_into()?, sigma))
}

/// LuGre.
pub(super) fn lugre() -> Result<Contact<LuGre>, ModelError> {
    let ((f_s, f_c, v_s, f_v), sigma1) = (LEVELS, 20.0);
    let parameters =
        LuGreParameters { f_s, f_c, v_s, delta: 2.0, sigma0: 1000.0, sigma1, v_d: None, f_v };
    Ok(Contact::new(parameters.try_into()?, sigma1))
}

/// GMS with four elements of stiffness `sigma0` and micro-damping `sigma1`.
pub(super) fn gms(sigma0: f64, sigma1: f64) -> Result<Contact<Gms<4>>, ModelError> {
    let (f_s, f_c, v_s, f_v) = LEVELS;
    let four = |value: f64| Elements::from([value; 4]);
    let parameters = GmsParameters {
        f_s,
        f_c,
        v_s,
        delta: 2.0,
        alpha: four(0.25),
        sigma0: four(sigma0),
        sigma1: four(sigma1),
        c: four(0.025),
        f_v,
    };
    Ok(Contact::new(parameters.try_into()?, 4.0 * sigma1))
}

/// Xiong's with four elements of stiffness `k` and micro-damping `sigma`.
pub(super) fn xiong(k: f64, sigma: f64) -> Result<Contact<Xiong<4>>, ModelError> {
    let (f_s, f_c, v_s, f_v) = LEVELS;
    let four = |value: f64| Elements::from([value; 4]);
    let parameters = XiongParameters {
        f_s,
        f_c,
        v_s,
        delta: 2.0,
        tau: TAU,
        lambda: four(0.25),
        k: four(k),
        sigma: four(sigma),
        f_v,
    };
    Ok(Contact::new(parameters.try_into()?, 4.0 * sigma))
}

/// No friction at all.
pub(super) fn frictionless() -> Result<Contact<Viscous>, ModelError> {
    Ok(Contact::new(ViscousParameters { f_v: 0.0 }.try_into()?, 0.0))
}

/// Runs `$body` with `$contact` bound to the model of an `Option<ExampleModel>`.
macro_rules! with_contact {
    ($model:expr, $contact:ident => $body:expr) => {
        match $model {
            None => {
                let $contact = $crate::example_5_4::models::frictionless()?;
                $body
            }
            Some(ExampleModel::Proposed) => {
                let $contact = $crate::example_5_4::models::proposed()?;
                $body
            }
            Some(ExampleModel::LuGre) => {
                let $contact = $crate::example_5_4::models::lugre()?;
                $body
            }
            Some(model @ (ExampleModel::Gms | ExampleModel::StiffGms)) => {
                let (stiffness, damping) =
                    if model == ExampleModel::Gms { (25.0, 0.0015) } else { (130.0, 15.0) };
                let $contact = $crate::example_5_4::models::gms(stiffness, damping)?;
                $body
            }
            Some(model @ (ExampleModel::Xiong | ExampleModel::StiffXiong)) => {
                let (stiffness, damping) =
                    if model == ExampleModel::Xiong { (2.5, 1.5) } else { (130.0, 15.0) };
                let $contact = $crate::example_5_4::models::xiong(stiffness, damping)?;
                $body
            }
        }
    };
}
pub(super) use with_contact;
