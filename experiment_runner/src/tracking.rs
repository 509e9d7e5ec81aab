//! Following a reference with and without friction compensation.

use rig_driver::RigError;
use serde::{Deserialize, Serialize};

use crate::compensation::{Arm, LimitCycle};
use crate::control_loop::RunningLoop;
use crate::cycle::CycleSample;
use crate::protocol::TrackingProtocol;
use crate::waveform::Waveform;

/// One run to be driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackingJob {
    /// What compensates.
    pub arm: Arm,
    /// Repetition, from 0.
    pub repetition: u32,
}

/// Figures of one run. Errors are reference minus response, rad/s or rad by the task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrackingRun {
    /// What compensated.
    pub arm: Arm,
    /// Repetition, from 0.
    pub repetition: u32,
    /// Mean square of the error of the shaft itself, by the trapezoidal rule.
    pub mse: f64,
    /// Largest magnitude of the error of the shaft itself.
    pub max_error: f64,
    /// Mean square of the error as measured, sensor noise and quantisation included.
    pub mse_measured: f64,
    /// Largest magnitude of the error as measured.
    pub max_error_measured: f64,
    /// Root mean square of the voltage \[V\].
    pub effort: f64,
    /// Root mean square of the measured minus the estimated friction [N m].
    #[serde(deserialize_with = "crate::exact::or_nan")]
    pub torque_residual: f64,
    /// Root mean square of the true minus the estimated friction [N m], where the rig is simulated.
    pub torque_error: Option<f64>,
    /// The oscillation that remains after a step of position.
    pub limit_cycle: Option<LimitCycle>,
}

impl TrackingJob {
    /// Cycles between the samples that a limit cycle is looked for in.
    const CYCLE_EVERY: u64 = 10;
    /// Smallest amplitude that counts as a limit cycle \[rad\]: two counts of the encoder.
    const LEAST_AMPLITUDE: f64 = 2.0 * std::f64::consts::TAU / 4096.0;

    /// All runs of the protocol: each arm, each repetition.
    #[must_use]
    pub fn all(protocol: &TrackingProtocol, arms: &[Arm]) -> Vec<Self> {
        arms.iter()
            .flat_map(|&arm| {
                (0..protocol.repetitions).map(move |repetition| Self { arm, repetition })
            })
            .collect()
    }

    /// Drives the run on a loop that is at rest, showing every cycle to `record`.
    ///
    /// # Errors
    /// [`RigError`] if the rig refuses a command.
    pub fn run(
        &self,
        protocol: &TrackingProtocol,
        mut control: impl RunningLoop,
        mut record: impl FnMut(&CycleSample),
    ) -> Result<TrackingRun, RigError> {
        let cycles = (protocol.duration / control.period()).round() as u64;
        let (mut true_error, mut measured_error) = (SquareMean::default(), SquareMean::default());
        let (mut volts, mut residual) = (SquareMean::default(), SquareMean::default());
        let mut torque_error: Option<SquareMean> = None;
        let stepped = matches!(protocol.reference, Waveform::StepPosition { .. });
        let mut path = Vec::new();
        for _ in 0..=cycles {
            let sample = control.step()?;
            record(&sample);
            measured_error.add(sample.command.error);
            true_error.add(sample.error());
            volts.add(sample.command.total);
            residual.add(sample.measurement.torque - sample.estimate.torque);
            if let Some(truth) = sample.truth {
                let error = truth.friction - sample.estimate.torque;
                torque_error.get_or_insert_default().add(error);
            }
            if stepped && sample.measurement.cycle.is_multiple_of(Self::CYCLE_EVERY) {
                path.push(sample.error());
            }
        }
        let between = Self::CYCLE_EVERY as f64 * control.period();
        Ok(TrackingRun {
            arm: self.arm,
            repetition: self.repetition,
            mse: true_error.mean(),
            max_error: true_error.max,
            mse_measured: measured_error.mean(),
            max_error_measured: measured_error.max,
            effort: volts.mean().sqrt(),
            torque_residual: residual.mean().sqrt(),
            torque_error: torque_error.map(|error| error.mean().sqrt()),
            limit_cycle: LimitCycle::find(&path, between, Self::LEAST_AMPLITUDE),
        })
    }
}

/// Mean of the square of equally spaced samples by the trapezoidal rule, and the largest magnitude.
#[derive(Debug, Clone, Copy, Default)]
pub struct SquareMean {
    n: u64,
    sum: f64,
    first: f64,
    last: f64,
    max: f64,
}

impl SquareMean {
    /// Takes the next sample in.
    pub fn add(&mut self, value: f64) {
        let square = value * value;
        if self.n == 0 {
            self.first = square;
        }
        self.n += 1;
        self.sum += square;
        self.last = square;
        self.max = self.max.max(value.abs());
    }

    /// Largest magnitude so far.
    pub const fn max(&self) -> f64 {
        self.max
    }

    /// Mean of the squares so far.
    pub fn mean(&self) -> f64 {
        if self.n < 2 {
            self.sum
        } else {
            (self.sum - 0.5 * (self.first + self.last)) / (self.n - 1) as f64
        }
    }
}

#[cfg(test)]
mod tests {
    use controller::ControllerOptions;
    use friction_model::{AnyModel, ModelName};
    use rig_driver::{FrictionCoupling, Sensors, SimulationOptions};

    use super::*;
    use crate::test_bed::TestBed;

    /// One run with ideal sensors, as the thesis's simulations are.
    fn run(protocol: &TrackingProtocol, coupling: FrictionCoupling, arm: Arm) -> TrackingRun {
        let simulation = SimulationOptions {
            sensors: Sensors::ideal(),
            friction_coupling: coupling,
            voltage_limit: 10.0,
            ..Default::default()
        };
        let mut controller = ControllerOptions {
            derivative_on: controller::DerivativeOn::Error,
            derivative_filter: 0.0,
            ..Default::default()
        };
        controller.compensation.volts_per_newton_metre =
            coupling.volts_per_newton_metre(&simulation.drive);
        let plant = AnyModel::test_bed(ModelName::Proposed);
        let bed =
            TestBed { simulation, friction: plant, controller, estimator: Default::default() };
        let model = arm.model().map_or(plant, AnyModel::test_bed);
        let control =
            bed.control_loop(protocol.mode, protocol.reference, &model, arm.means(), 1, 0).unwrap();
        TrackingJob { arm, repetition: 0 }.run(protocol, control, |_| {}).unwrap()
    }

    fn close(value: f64, expected: f64, relative: f64) -> bool {
        (value / expected - 1.0).abs() < relative
    }

    /// The thesis's Table 6.5 in its own units (friction in N m taken off the volts), as
    /// independently computed: PID 1.96e-5 and 165e-4 rad/s, proposed 0.503e-5 and 31.7e-4.
    #[test]
    fn velocity_tracking_in_the_thesis_units() {
        let protocol = TrackingProtocol::velocity();
        let none = run(&protocol, FrictionCoupling::NewtonMetreAsVolt, Arm::None);
        assert!(close(none.mse, 1.96e-5, 0.03) && close(none.max_error, 165e-4, 0.03), "{none:?}");
        let proposed =
            run(&protocol, FrictionCoupling::NewtonMetreAsVolt, Arm::observer(ModelName::Proposed));
        assert!(
            close(proposed.mse, 0.503e-5, 0.05) && close(proposed.max_error, 31.7e-4, 0.05),
            "{proposed:?}"
        );
    }

    /// Table 6.7: PID 3.30e-4 and 572e-4 rad, proposed 1.473e-4 and 421e-4.
    #[test]
    fn position_tracking_in_the_thesis_units() {
        let protocol = TrackingProtocol::position();
        let none = run(&protocol, FrictionCoupling::NewtonMetreAsVolt, Arm::None);
        assert!(close(none.mse, 3.30e-4, 0.03) && close(none.max_error, 572e-4, 0.03), "{none:?}");
        let proposed =
            run(&protocol, FrictionCoupling::NewtonMetreAsVolt, Arm::observer(ModelName::Proposed));
        assert!(
            close(proposed.mse, 1.473e-4, 0.05) && close(proposed.max_error, 421e-4, 0.05),
            "{proposed:?}"
        );
    }

    /// With friction as a torque: 16.8e-5 and 470e-4 rad/s; 19.3e-4 and 1237e-4 rad. Any observer
    /// is better than none.
    #[test]
    fn tracking_in_physical_units() {
        let velocity = run(&TrackingProtocol::velocity(), FrictionCoupling::Physical, Arm::None);
        assert!(
            close(velocity.mse, 16.8e-5, 0.03) && close(velocity.max_error, 470e-4, 0.03),
            "{velocity:?}"
        );
        let position = run(&TrackingProtocol::position(), FrictionCoupling::Physical, Arm::None);
        assert!(
            close(position.mse, 19.3e-4, 0.03) && close(position.max_error, 1237e-4, 0.03),
            "{position:?}"
        );
        for name in [ModelName::LuGre, ModelName::Proposed] {
            let arm = Arm::observer(name);
            assert!(
                run(&TrackingProtocol::velocity(), FrictionCoupling::Physical, arm).mse
                    < velocity.mse / 3.0
            );
            assert!(
                run(&TrackingProtocol::position(), FrictionCoupling::Physical, arm).mse
                    < position.mse / 2.0
            );
        }
    }

    #[test]
    fn the_mean_square_is_trapezoidal() {
        let mut mean = SquareMean::default();
        for value in [2.0, 1.0, -3.0] {
            mean.add(value);
        }
        assert!((mean.mean() - (0.5 * 4.0 + 1.0 + 0.5 * 9.0) / 2.0).abs() < 1e-15);
        assert_eq!(mean.max, 3.0);
    }
}
