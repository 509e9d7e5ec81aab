//! The guard against over-compensation.
//!
//! Compensation that exceeds the friction acts as negative friction: the shaft is driven away from
//! rest, the estimate changes its sign at the turn, and the loop hunts. The guard counts *swings*:
//! changes of sign of the compensating voltage, from beyond the threshold on one side to beyond it
//! on the other. A reversal of the reference's velocity explains one swing. Swings that nothing
//! explains, one soon after the other, under an error that does not die down, are a limit cycle. An
//! error that grows while the voltage stands at its limit and drives the shaft away from the
//! target, with the compensation pushing that way, is a growing one. Either scales the compensation
//! back by a factor; what remains is judged anew. Later the scale recovers slowly, up to a little
//! below the level that hunted. Compensation whose swings stay below the threshold is not judged.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::ControllerError;

/// What the guard found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Diagnosis {
    /// Error and compensation alternate without a reason in the reference.
    LimitCycle,
    /// The error grows while the compensation works against the controller.
    GrowingError,
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LimitCycle => {
                "limit cycle: the compensation exceeds the friction and is scaled back"
            }
            Self::GrowingError => {
                "growing error: the compensation works against the controller and is scaled back"
            }
        })
    }
}

/// When the guard acts, and how.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuardOptions {
    /// Compensating voltage that counts as a side of a swing \[V\], above zero: well below the
    /// Coulomb level in volts, well above the noise of the estimate.
    pub threshold: f64,
    /// Unexplained swings in a row that are a limit cycle, at least 4.
    pub swings: u32,
    /// Longest time between two swings of one limit cycle \[s\], above zero.
    pub longest_swing: f64,
    /// Factor by which the compensation is scaled back, between 0 and 1.
    pub reduction: f64,
    /// Recovery of the scale \[1/s\], zero or more.
    pub recovery: f64,
}

impl Default for GuardOptions {
    /// For the SRV-02, whose Coulomb level is 0.45 V, found by trying on the simulated rig: a
    /// correct compensation by a dynamic model is never touched, 1.6 times as much is scaled back
    /// within its first swings.
    fn default() -> Self {
        Self { threshold: 0.3, swings: 6, longest_swing: 3.0, reduction: 0.7, recovery: 0.02 }
    }
}

impl GuardOptions {
    pub(crate) fn check(&self) -> Result<(), ControllerError> {
        let fail = |name, value, expected: &'static str| {
            Err(ControllerError::OutOfRange { name, value, expected: expected.into() })
        };
        if !(self.threshold > 0.0 && self.threshold.is_finite()) {
            return fail("guard threshold", self.threshold, "a finite number of volts above zero");
        }
        if self.swings < 4 {
            return fail("guard swings", f64::from(self.swings), "at least 4");
        }
        if !(self.longest_swing > 0.0 && self.longest_swing.is_finite()) {
            return fail(
                "guard longest_swing",
                self.longest_swing,
                "a finite number of seconds above zero",
            );
        }
        if !(self.reduction > 0.0 && self.reduction < 1.0) {
            return fail("guard reduction", self.reduction, "between 0 and 1");
        }
        if !(self.recovery >= 0.0 && self.recovery.is_finite()) {
            return fail("guard recovery", self.recovery, "a finite number, zero or more");
        }
        Ok(())
    }
}

/// Part of the level that hunted to which the scale recovers.
const CEILING: f64 = 0.9;

/// Time for which an error must grow against the limited voltage \[s\].
const GROWING: f64 = 0.1;

/// Part of the first swing's error below which an oscillation is dying down.
const DYING: f64 = 0.5;

/// The guard, running at a fixed period.
#[derive(Debug, Clone)]
pub(crate) struct CompensationGuard {
    options: GuardOptions,
    dt: f64,
    scale: f64,
    /// Up to where the scale may recover.
    ceiling: f64,
    diagnosis: Option<Diagnosis>,
    /// Side on which the compensation last was: -1, 1, or 0 before the first.
    side: f64,
    /// Sign of the reference's velocity when it last had one.
    reference: f64,
    /// A reversal of the reference whose swing is still to come.
    explained: bool,
    /// Unexplained swings in a row, and the time since the last \[s\].
    swings: u32,
    since: f64,
    /// Largest error since the last swing, and that of the first swing of the row.
    error: f64,
    first_error: f64,
    error_before: f64,
    /// How long the error has been growing \[s\].
    growing: f64,
}

impl CompensationGuard {
    pub(crate) fn new(options: GuardOptions, dt: f64) -> Result<Self, ControllerError> {
        options.check()?;
        Ok(Self {
            options,
            dt,
            scale: 1.0,
            ceiling: 1.0,
            diagnosis: None,
            side: 0.0,
            reference: 0.0,
            explained: false,
            swings: 0,
            since: 0.0,
            error: 0.0,
            first_error: 0.0,
            error_before: 0.0,
            growing: 0.0,
        })
    }

    /// Fraction of the compensation that passes.
    #[inline]
    pub(crate) const fn scale(&self) -> f64 {
        self.scale
    }

    /// Why it is not 1.
    #[inline]
    pub(crate) const fn diagnosis(&self) -> Option<Diagnosis> {
        self.diagnosis
    }

    /// Sees one cycle: the compensating voltage that was added, the error, the reference's
    /// velocity, and the direction in which the whole command was cut.
    #[inline]
    pub(crate) fn watch(
        &mut self,
        friction: f64,
        error: f64,
        reference_velocity: f64,
        limited: f64,
    ) {
        self.since += self.dt;
        self.error = self.error.max(error.abs());
        if reference_velocity != 0.0 {
            let sign = reference_velocity.signum();
            self.explained |= sign != self.reference;
            self.reference = sign;
        }
        let found = if self.is_limit_cycle(friction) {
            Some(Diagnosis::LimitCycle)
        } else if self.is_growing(friction, error, limited) {
            Some(Diagnosis::GrowingError)
        } else {
            None
        };
        if found.is_some() {
            self.diagnosis = found;
            self.ceiling = CEILING * self.scale;
            self.scale *= self.options.reduction;
            (self.swings, self.growing) = (0, 0.0);
        } else if self.since > 2.0 * self.options.longest_swing {
            self.scale =
                (self.scale + self.options.recovery * self.dt).min(self.ceiling.max(self.scale));
        }
    }

    #[inline]
    fn is_limit_cycle(&mut self, friction: f64) -> bool {
        if friction.abs() < self.options.threshold || friction.signum() == self.side {
            return false;
        }
        let first = self.side == 0.0;
        self.side = friction.signum();
        if first || self.explained {
            self.explained = false;
            self.error = 0.0;
            return false;
        }
        let (since, error) = (self.since, self.error);
        (self.since, self.error) = (0.0, 0.0);
        if self.swings == 0
            || since > self.options.longest_swing
            || error < DYING * self.first_error
        {
            (self.swings, self.first_error) = (1, error);
            return false;
        }
        self.swings += 1;
        self.swings >= self.options.swings
    }

    #[inline]
    fn is_growing(&mut self, friction: f64, error: f64, limited: f64) -> bool {
        let away =
            limited * error < 0.0 && limited * friction > 0.0 && error.abs() > self.error_before;
        self.error_before = error.abs();
        self.growing = if away { self.growing + self.dt } else { 0.0 };
        self.growing > GROWING
    }

    /// Back to the whole compensation.
    pub(crate) fn reset(&mut self) {
        // The options were checked when it was built.
        if let Ok(fresh) = Self::new(self.options, self.dt) {
            *self = fresh;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-3;

    fn guard() -> CompensationGuard {
        CompensationGuard::new(GuardOptions::default(), DT).unwrap()
    }

    /// Shows so many seconds of `(friction, error, reference velocity)` at time t.
    fn show(guard: &mut CompensationGuard, seconds: f64, signals: impl Fn(f64) -> (f64, f64, f64)) {
        for k in 0..(seconds / DT) as usize {
            let (friction, error, reference) = signals(k as f64 * DT);
            guard.watch(friction * guard.scale(), error, reference, 0.0);
        }
    }

    fn square(t: f64, frequency: f64) -> f64 {
        if (t * frequency).fract() < 0.5 { 1.0 } else { -1.0 }
    }

    #[test]
    fn swings_without_a_reason_scale_the_compensation_back() {
        let mut guard = guard();
        show(&mut guard, 4.0, |t| (0.8 * square(t, 2.0), 0.05 * square(t, 2.0), 0.0));
        assert_eq!(guard.diagnosis(), Some(Diagnosis::LimitCycle));
        // Six swings of a quarter of a second, then six more, in four seconds.
        assert!((guard.scale() - 0.49).abs() < 1e-12, "{}", guard.scale());
        // It recovers slowly, and not up to where it hunted.
        show(&mut guard, 100.0, |_| (0.8, 0.0, 0.0));
        assert!((guard.scale() - 0.9 * 0.7).abs() < 1e-9, "{}", guard.scale());
        guard.reset();
        assert_eq!((guard.scale(), guard.diagnosis()), (1.0, None));
    }

    #[test]
    fn what_the_reference_explains_is_left_alone() {
        let mut guard = guard();
        show(&mut guard, 20.0, |t| (0.8 * square(t, 2.0), 0.05, square(t + 0.01, 2.0)));
        assert_eq!((guard.scale(), guard.diagnosis()), (1.0, None));
    }

    #[test]
    fn an_oscillation_that_dies_down_is_left_alone() {
        let mut guard = guard();
        show(&mut guard, 20.0, |t| (0.8 * square(t, 1.0), (-0.5 * t).exp(), 0.0));
        assert_eq!(guard.diagnosis(), None);
    }

    #[test]
    fn an_error_that_grows_at_the_voltage_limit_is_noticed() {
        let mut guard = guard();
        for k in 0..150 {
            guard.watch(3.0, -0.1 * f64::from(k), 0.0, 1.0);
        }
        assert_eq!(guard.diagnosis(), Some(Diagnosis::GrowingError));
        assert!((guard.scale() - 0.7).abs() < 1e-12);
    }

    #[test]
    fn options_out_of_range_are_named() {
        let options = GuardOptions { reduction: 1.0, ..GuardOptions::default() };
        assert!(
            CompensationGuard::new(options, DT)
                .unwrap_err()
                .to_string()
                .starts_with("guard reduction")
        );
    }
}
