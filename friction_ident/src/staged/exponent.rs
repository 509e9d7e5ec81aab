//! The exponent of the dip, which steady points alone are asked for.

use super::decided::{Exponent, has_exponent};
use super::work::Work;
use crate::IdentError;
use crate::static_curve::{
    ExponentFit, SteadyPoint, StribeckFit, StribeckOptions, StribeckParameter, fit_exponent,
    fit_stribeck,
};

/// How many times wider than at the usual exponent what all exponents say of the static friction must
/// be to be told.
const WIDER: f64 = 1.5;

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
