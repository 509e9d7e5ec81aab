//! Why a fitted model cannot be chosen.

use crate::estimate::{Doubt, Estimate, Estimates, Verdict};
use crate::parameter_id::ParameterId;
use crate::staged::Identified;

/// A level of friction beyond this multiple of the largest friction measured was not found but run
/// away to.
const RUN_AWAY: f64 = 10.0;

/// Why a fitted model cannot be chosen.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unfit {
    /// Somebody stopped the search.
    #[error("its fit was stopped before its end")]
    Stopped,
    /// The search was still going down when it ran out of iterations.
    #[error("its fit did not converge")]
    NotConverged,
    /// A parameter or its prediction is no number.
    #[error("its fit diverged: {0} is not a finite number")]
    NotFinite(String),
    /// A level of friction far beyond anything measured.
    #[error(
        "its fit diverged: {id} is {value:.3e}, and the largest friction measured {largest:.3e}"
    )]
    RanAway {
        /// The parameter.
        id: ParameterId,
        /// Its value \[N or N m\].
        value: f64,
        /// Largest friction in the recordings \[N or N m\].
        largest: f64,
    },
    /// Nothing is known of the parameters: their errors are infinite.
    #[error("its fit diverged: the errors of {0} are infinite")]
    NoErrors(String),
    /// The search ended at a limit that was set to it, not at a minimum.
    #[error("its fit ended at a bound: {id} is {bound:.3e}")]
    AtBound {
        /// The parameter.
        id: ParameterId,
        /// The bound.
        bound: f64,
    },
}

/// Why `found` cannot be chosen; none where it can. `largest` is the largest magnitude of friction
/// in the recordings it was fitted to \[N or N m\].
///
/// An effect that is absent is no bound: a viscous friction of zero, and static friction that is no
/// higher than the kinetic one, are ends of what friction can be.
#[must_use]
pub fn unfit(found: &Identified, largest: f64) -> Option<Unfit> {
    if found.stopped {
        return Some(Unfit::Stopped);
    }
    if !found.converged {
        return Some(Unfit::NotConverged);
    }
    if !found.information.mse.is_finite() {
        return Some(Unfit::NotFinite("its error".to_owned()));
    }
    let estimates = &found.estimates;
    let free = || {
        let given = |estimate: &&Estimate| matches!(estimate.verdict, Verdict::Given { .. });
        estimates.parameters.iter().filter(move |estimate| !given(estimate))
    };
    if let Some(estimate) = estimates.parameters.iter().find(|e| !e.value.is_finite()) {
        return Some(Unfit::NotFinite(estimate.id.to_string()));
    }
    let level = |estimate: &&Estimate| ["f_s", "f_c"].contains(&estimate.id.name);
    if let Some(far) = free().filter(level).find(|e| e.value.abs() > RUN_AWAY * largest) {
        return Some(Unfit::RanAway { id: far.id, value: far.value, largest });
    }
    let stuck = free().find_map(|estimate| match &estimate.verdict {
        Verdict::NotIdentifiable { doubt: Doubt::AtBound { bound }, .. }
            if !is_absent(estimate, estimates) =>
        {
            Some(Unfit::AtBound { id: estimate.id, bound: *bound })
        }
        _ => None,
    });
    if stuck.is_some() {
        return stuck;
    }
    let nameless: Vec<String> =
        free().filter(|e| without_error(e)).map(|e| e.id.to_string()).collect();
    (!nameless.is_empty()).then(|| Unfit::NoErrors(nameless.join(", ")))
}

/// Whether the bound that holds a parameter says only that the effect is not there.
fn is_absent(estimate: &Estimate, all: &Estimates) -> bool {
    let ParameterId { name, side, .. } = estimate.id;
    let kinetic = || all.value(ParameterId::new("f_c").side(side));
    let no_dip = || kinetic().is_some_and(|f_c| estimate.value <= f_c * (1.0 + 1e-9));
    estimate.value == 0.0 || (name == "f_s" && no_dip())
}

/// Whether a search left a parameter without an error, or with one that is no number. One that has
/// no effect at all has none either, and does no harm.
fn without_error(estimate: &Estimate) -> bool {
    match (&estimate.verdict, estimate.standard_error) {
        (_, Some(error)) => !error.is_finite(),
        (Verdict::NotIdentifiable { doubt: Doubt::LargeError { relative_error }, .. }, None) => {
            !relative_error.is_finite()
        }
        _ => false,
    }
}
