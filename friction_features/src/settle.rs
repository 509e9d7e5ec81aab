//! Step halving: a figure counts once a step of half the size no longer changes it.

use serde::{Deserialize, Serialize};

/// What a figure has been checked with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// Integration step of the result \[s\].
    pub step: f64,
    /// Largest relative change of the result's figures when the step was halved to this one; `None`
    /// if the step was given instead of found, or if another number of figures came out with the
    /// step before (for instance no period).
    pub change: Option<f64>,
}

impl Evidence {
    /// Whether the last halving changed no figure by more than `tolerance`.
    #[must_use]
    pub fn holds_to(&self, tolerance: f64) -> bool {
        self.change.is_some_and(|change| change <= tolerance)
    }
}

/// One number of a result, to be compared between two steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// The number.
    pub value: f64,
    /// Changes are relative to the number or to this, whichever is larger: what would be small for
    /// a figure that may be zero.
    pub scale: f64,
}

impl Figure {
    /// A figure that is compared with its own size.
    #[must_use]
    pub const fn relative(value: f64) -> Self {
        Self { value, scale: 0.0 }
    }

    /// Change from `before` to this.
    fn change(&self, before: &Self) -> f64 {
        let scale = self.value.abs().max(self.scale);
        let change = (self.value - before.value).abs();
        if change == 0.0 { 0.0 } else { change / scale }
    }
}

/// How far to go.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settling {
    /// Relative change at which a figure counts as settled; above zero.
    pub tolerance: f64,
    /// At most so many halvings. The result then says what the last one changed.
    pub halvings: u32,
}

impl Default for Settling {
    /// To 1e-4, with at most 5 halvings.
    fn default() -> Self {
        Self { tolerance: 1e-4, halvings: 5 }
    }
}

/// Runs an experiment with the step `first` \[s\], then with halves of it until `figures` hold; the
/// last result, and the evidence.
///
/// Gives up early, after the third halving, if that still changed a figure by more than a hundred
/// times the tolerance: such a figure depends on every step and will not settle.
pub fn settle<T>(
    settling: Settling,
    first: f64,
    mut run: impl FnMut(f64) -> T,
    figures: impl Fn(&T) -> Vec<Figure>,
) -> (T, Evidence) {
    let mut step = first;
    let mut result = run(step);
    let mut change = None;
    for halving in 1..=settling.halvings {
        step *= 0.5;
        let finer = run(step);
        let (before, after) = (figures(&result), figures(&finer));
        result = finer;
        change = (before.len() == after.len())
            .then(|| after.iter().zip(&before).map(|(a, b)| a.change(b)).fold(0.0, f64::max));
        let settled = change.is_some_and(|change| change <= settling.tolerance);
        let hopeless =
            halving >= 3 && change.is_some_and(|change| change > 100.0 * settling.tolerance);
        if settled || hopeless {
            break;
        }
    }
    (result, Evidence { step, change })
}

/// With the step that is given, if it is above zero, or else with the one that [`settle`] finds
/// from `first`.
pub(crate) fn with_step<T>(
    given: Option<f64>,
    first: f64,
    mut run: impl FnMut(f64) -> T,
    figures: impl Fn(&T) -> Vec<Figure>,
) -> (T, Evidence) {
    match given.filter(|&step| step > 0.0) {
        Some(step) => (run(step), Evidence { step, change: None }),
        None => settle(Settling::default(), first, run, figures),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Euler's method for `y' = -y` over 1 s has an error of about `h / (2 e)`.
    fn euler(h: f64) -> f64 {
        (0..(1.0 / h).round() as usize).fold(1.0, |y, _| y * (1.0 - h))
    }

    #[test]
    fn halving_goes_on_until_the_figure_holds() {
        let settling = Settling { tolerance: 1e-3, halvings: 20 };
        let (value, evidence) = settle(settling, 0.1, euler, |&y| vec![Figure::relative(y)]);
        // A halving to h changes the value by h/2 relative: 1/640 is the first below 1e-3.
        assert_eq!(evidence.step, 0.1 / 64.0);
        assert!(evidence.holds_to(1e-3) && !evidence.holds_to(5e-4), "{evidence:?}");
        assert!((value - (-1.0f64).exp()).abs() < 1e-3);
    }

    #[test]
    fn a_figure_that_does_not_settle_says_so() {
        let settling = Settling { tolerance: 1e-9, halvings: 9 };
        let (_, evidence) = settle(settling, 0.1, euler, |&y| vec![Figure::relative(y)]);
        assert_eq!(evidence.step, 0.0125, "given up after the third halving");
        assert!(!evidence.holds_to(1e-9), "{evidence:?}");
        let vanishing = |&y: &f64| if y < 0.36 { vec![Figure::relative(y)] } else { vec![] };
        let (_, evidence) = settle(Settling { halvings: 1, ..settling }, 0.05, euler, vanishing);
        assert_eq!(evidence.change, None);
    }

    #[test]
    fn figures_that_may_be_zero_are_compared_with_their_scale() {
        let noise = |h: f64| 1e-18 / h;
        let (_, evidence) =
            settle(Settling::default(), 0.1, noise, |&value| vec![Figure { value, scale: 1e-9 }]);
        assert_eq!(evidence.step, 0.05);
        assert_eq!(
            settle(Settling::default(), 0.1, |_| 0.0, |&y| vec![Figure::relative(y)]).1.change,
            Some(0.0)
        );
    }
}
