//! A drive without friction under a linear law: the loop that designs are about.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::{LinearDrive, Polynomial, TransferFunction};
use crate::{
    ControllerError, DerivativeOn, LagCompensator, PiController, Pid, PidGains, VelocityLaw,
};

/// The linear law of a loop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoopLaw {
    /// Regulates velocity.
    Velocity(VelocityLaw),
    /// Regulates position.
    Position {
        /// Gains of the PID.
        gains: PidGains,
        /// What it differentiates: matters for the response to the reference, not for the margins.
        derivative_on: DerivativeOn,
        /// Time constant of the derivative's filter \[s\], zero or more.
        filter: f64,
    },
}

/// A drive and its law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LinearLoop {
    /// The drive.
    pub drive: LinearDrive,
    /// The law.
    pub law: LoopLaw,
}

impl LinearLoop {
    /// Checks the drive and the gains, at a control period of `dt` \[s\].
    ///
    /// # Errors
    /// [`ControllerError::OutOfRange`] names what is out of range.
    pub fn check(&self, dt: f64) -> Result<(), ControllerError> {
        self.drive.check()?;
        match self.law {
            LoopLaw::Velocity(VelocityLaw::Lag(gains)) => {
                LagCompensator::new(gains, dt).map(|_| ())
            }
            LoopLaw::Velocity(VelocityLaw::Pi(gains)) => PiController::new(gains, dt).map(|_| ()),
            LoopLaw::Position { gains, derivative_on, filter } => {
                Pid::new(gains, derivative_on, filter, dt).map(|_| ())
            }
        }
    }

    /// The controller `C(s)` from error to volts.
    #[must_use]
    pub fn controller(&self) -> TransferFunction {
        self.controller_with_filter(0.0)
    }

    fn controller_with_filter(&self, least: f64) -> TransferFunction {
        match self.law {
            LoopLaw::Velocity(VelocityLaw::Lag(gains)) => TransferFunction::new(
                vec![gains.k_p, gains.k_p * gains.t_i],
                vec![gains.gamma, gains.t_i],
            ),
            // Without an integral gain no pole at zero, which the numerator would cancel.
            LoopLaw::Velocity(VelocityLaw::Pi(gains)) if gains.k_i == 0.0 => {
                TransferFunction::new(vec![gains.k_p], vec![1.0])
            }
            LoopLaw::Velocity(VelocityLaw::Pi(gains)) => {
                TransferFunction::new(vec![gains.k_i, gains.k_p], vec![0.0, 1.0])
            }
            LoopLaw::Position { gains: PidGains { k_p, k_i, k_d }, filter, .. } => {
                let t_f = filter.max(least);
                if k_i == 0.0 {
                    return TransferFunction::new(vec![k_p, k_d + k_p * t_f], vec![1.0, t_f]);
                }
                TransferFunction::new(
                    vec![k_i, k_p + k_i * t_f, k_d + k_p * t_f],
                    vec![0.0, 1.0, t_f],
                )
            }
        }
    }

    /// The drive `P(s)` from volts to what is regulated.
    #[must_use]
    pub fn plant(&self) -> TransferFunction {
        let LinearDrive { gain, time_constant } = self.drive;
        match self.law {
            LoopLaw::Velocity(_) => TransferFunction::new(vec![gain], vec![1.0, time_constant]),
            LoopLaw::Position { .. } => {
                TransferFunction::new(vec![gain], vec![0.0, 1.0, time_constant])
            }
        }
    }

    /// The characteristic polynomial of the closed loop, continuous in time.
    #[must_use]
    pub fn characteristic(&self) -> Polynomial {
        let (c, p) = (self.controller(), self.plant());
        p.denominator.times(&c.denominator).plus(1.0, &p.numerator.times(&c.numerator))
    }

    /// The open loop `C P` at `w` \[rad/s\], continuous in time.
    #[must_use]
    pub fn open(&self, w: f64) -> Complex<f64> {
        self.controller().at_frequency(w) * self.plant().at_frequency(w)
    }

    /// The open loop as it runs at the period `dt` \[s\], at `w` \[rad/s\] below the Nyquist
    /// frequency: the discrete controller (bilinear rule) and the drive between a held voltage and
    /// a sampled measurement. The half period of delay that costs is in its phase.
    #[must_use]
    pub fn open_sampled(&self, w: f64, dt: f64) -> Complex<f64> {
        let z = Complex::from_polar(1.0, w * dt);
        let s = (z - 1.0) / (z + 1.0) * (2.0 / dt);
        let LinearDrive { gain, time_constant } = self.drive;
        let decay = (-dt / time_constant).exp();
        let held = (1.0 - decay) / (z - decay);
        let plant = match self.law {
            LoopLaw::Velocity(_) => held * gain,
            LoopLaw::Position { .. } => (dt / (z - 1.0) - held * time_constant) * gain,
        };
        // The PID keeps its filter at half a period at least.
        self.controller_with_filter(0.5 * dt).at(s) * plant
    }

    /// What remains of a constant reference, as a fraction of it.
    #[must_use]
    pub fn steady_state_error(&self) -> f64 {
        let (c, p) = (self.controller(), self.plant());
        let below = c.denominator.at(0.0) * p.denominator.at(0.0);
        below / (below + c.numerator.at(0.0) * p.numerator.at(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LagGains, PiGains};

    #[test]
    fn a_short_period_is_nearly_continuous() {
        for law in [
            LoopLaw::Velocity(VelocityLaw::Lag(LagGains::THESIS)),
            LoopLaw::Velocity(VelocityLaw::Pi(PiGains { k_p: 1.0, k_i: 20.0 })),
            LoopLaw::Position {
                gains: PidGains::THESIS,
                derivative_on: DerivativeOn::Error,
                filter: 0.005,
            },
        ] {
            let linear = LinearLoop { drive: LinearDrive::THESIS, law };
            for w in [1.0, 30.0, 200.0] {
                let (exact, near) = (linear.open(w), linear.open_sampled(w, 1e-6));
                assert!((near / exact - 1.0).norm() < 2e-4, "{law:?} {w}");
                // At 1 kHz what differs is half a period of delay.
                let delayed = exact * Complex::from_polar(1.0, -w * 5e-4);
                assert!(
                    (linear.open_sampled(w, 1e-3) / delayed - 1.0).norm() < 1e-2,
                    "{law:?} {w}"
                );
            }
        }
    }

    #[test]
    fn only_a_lag_leaves_an_error() {
        let of = |law| LinearLoop { drive: LinearDrive::THESIS, law }.steady_state_error();
        let lag = of(LoopLaw::Velocity(VelocityLaw::Lag(LagGains::THESIS)));
        assert!((lag - 0.010_005_8).abs() < 1e-7, "{lag}");
        assert_eq!(of(LoopLaw::Velocity(VelocityLaw::Pi(PiGains { k_p: 1.0, k_i: 2.0 }))), 0.0);
    }
}
