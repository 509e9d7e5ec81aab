//! A force that was recorded late: by a pure delay, or behind the low-pass that drives have for their
//! measured current or torque. Both are one parameter, the `delay` below zero; what they do to a
//! reversal of friction is not the same.

use super::search::{Best, Search};
use super::shape::{Late, Shape};
use crate::IdentError;

/// Share of the sum of squares that a force that was recorded late takes off at least.
pub(super) const LATE: f64 = 0.1;
/// Share of what a delay leaves that a low-pass takes off at least to be what made the force late.
const LOW_PASSED: f64 = 0.01;

impl Search<'_> {
    /// The fit with a force that was recorded late, begun from a `prompt` one.
    ///
    /// It is believed only where the motion that follows at once leaves clearly more over: lost motion
    /// and pre-sliding that the structure lacks look like a little of it.
    pub(super) fn late(&mut self, prompt: &Best, enough: f64) -> Result<Option<Best>, IdentError> {
        let delayed = self.closer(prompt.shape, &[], enough)?;
        if delayed.sum() >= (1.0 - LATE) * prompt.sum() {
            return Ok(None);
        }
        let from = Shape { late: Late::LowPassed, ..delayed.shape };
        let low_passed = self.closer(from, &[], enough).ok();
        let better = |best: &Best| best.sum() < (1.0 - LOW_PASSED) * delayed.sum();
        Ok(Some(low_passed.filter(better).unwrap_or(delayed)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::three_tones;
    use super::super::{AxisStructure, AxisUnits, Late, StructureFit, fit_structure};
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    const TAU: f64 = 4e-3;

    /// An axis whose force is recorded as `recorded` makes it, a millisecond a sample.
    fn fit(structure: &str, mut recorded: impl FnMut(f64) -> f64) -> StructureFit {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        let recording = three_tones(20_000, |_, v, a| {
            let noise = 0.02 * rng.sample::<f64, _>(StandardNormal);
            recorded(0.3 * a + 0.2 * v + 2.0 * v.signum()) + noise
        });
        let structure: AxisStructure = structure.parse().unwrap();
        fit_structure(&recording, structure, &AxisUnits::ROTARY).unwrap()
    }

    fn low_passed() -> impl FnMut(f64) -> f64 {
        let (mut behind, left) = (0.0, (-1e-3 / TAU).exp());
        move |force| {
            behind = left * behind + (1.0 - left) * force;
            behind
        }
    }

    fn delayed() -> impl FnMut(f64) -> f64 {
        let mut before = std::collections::VecDeque::from([0.0; 4]);
        move |force| {
            before.push_back(force);
            before.pop_front().unwrap_or_default()
        }
    }

    /// A step of friction that is blunted is no step that comes later.
    #[test]
    fn a_low_pass_of_the_force_is_known_from_a_delay() {
        let fit = fit("symmetric+delay", low_passed());
        assert_eq!(fit.shape.late, Late::LowPassed);
        // The steps of a held input, half a sample, are in the time constant.
        assert!((fit.shape.delay + TAU).abs() < 0.6e-3, "{}", fit.shape.delay);
        assert!(fit.relative_error < 1.5, "{}", fit.relative_error);
        assert!(fit.notes().iter().any(|note| note.contains("behind a low-pass")));
        let value = |name| fit.estimates.value(name).unwrap();
        assert!((value("inertia") - 0.3).abs() < 3e-3, "{}", value("inertia"));
        assert!((value("f_c") - 2.0).abs() < 0.02, "{}", value("f_c"));
    }

    #[test]
    fn a_delay_is_no_low_pass() {
        let fit = fit("symmetric+delay", delayed());
        assert_eq!(fit.shape.late, Late::Delayed);
        assert!((fit.shape.delay + TAU).abs() < 0.6e-3, "{}", fit.shape.delay);
    }
}
