//! The exponent of the dip, which steady points alone are asked for.

use friction_model::{AnyModel, ModelName};

use super::work::Work;
use crate::IdentError;
use crate::static_curve::{
    ExponentFit, SteadyPoint, StribeckFit, StribeckOptions, StribeckParameter, fit_exponent,
    fit_stribeck,
};

/// How many times wider than at the usual exponent what all exponents say of the static friction must
/// be to be told.
const WIDER: f64 = 1.5;

/// What is known of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Exponent {
    /// Nothing was asked.
    NotAsked,
    /// The points leave the usual one open.
    Usual,
    /// The points refuse the usual one.
    Other,
}

impl Exponent {
    /// Where its value comes from, in words.
    pub fn source(self) -> &'static str {
        match self {
            Self::NotAsked => {
                "the usual exponent: only steady points through a dip are asked for another"
            }
            Self::Usual => "the usual exponent, which the steady points leave open",
            Self::Other => "the exponent with which the steady points fit best",
        }
    }
}

/// Whether the model has an exponent of the dip. Dahl's is another: the shape of its stress-strain
/// curve.
pub(super) fn has_exponent(name: ModelName) -> bool {
    name != ModelName::Dahl && AnyModel::test_bed(name).parameter("delta").is_some()
}

impl Work<'_> {
    /// The static characteristic through points: of steady ones with the exponent that they ask for.
    /// Bins of sliding at changing speed contain some of the lag and tell no exponent.
    pub(super) fn curve(
        &mut self,
        points: &[SteadyPoint],
        steady: bool,
    ) -> Result<StribeckFit, IdentError> {
        if !steady || !has_exponent(self.name) {
            return fit_stribeck(points, &StribeckOptions::default());
        }
        let ExponentFit { fit, exponents, refuses_usual, static_friction } = fit_exponent(points)?;
        if let Some((low, high)) = exponents {
            if refuses_usual {
                self.exponent = Exponent::Other;
                self.notes.push(format!(
                    "The dip has another shape than the usual one: the steady points refuse the exponent 2 and fit best with {:.2} \
                     ({low:.2} to {high:.2}).",
                    fit.parameters.delta
                ));
            } else {
                if self.exponent == Exponent::NotAsked {
                    self.exponent = Exponent::Usual;
                }
                let alone = fit.estimate(StribeckParameter::StaticFriction).interval;
                let wider = alone
                    .zip(static_friction)
                    .filter(|((low, high), (least, most))| most - least > WIDER * (high - low));
                self.notes.extend(wider.map(|(_, (least, most))| {
                    format!(
                        "The interval of f_s holds for the exponent 2. The steady points leave {low:.2} to {high:.2} open, and with those \
                         f_s lies anywhere from {least:.3e} to {most:.3e}: slower steady speeds tell."
                    )
                }));
            }
        }
        Ok(fit)
    }
}
