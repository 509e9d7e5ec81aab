//! The simulations of the thesis's section 6.5: its test bed in its own units, with the inputs that
//! its printed figures imply.
//!
//! Friction in N m is taken off the volts (K = 1.863 rad/s per V, T = 0.02388 s), sensors are
//! ideal. The thesis does not print the references: r = 0.30 sin(0.107 t) rad/s and r = 1.0
//! sin(0.546 t) rad are those with which its rows come out, the inverse B(s) off in tracking and
//! its gain on in regulation, the opposite of what its text says.

use controller::{ControllerOptions, DerivativeOn};
use friction_model::AnyModel;
use rig_driver::{FrictionCoupling, Sensors, SimulationOptions};
use serde::Serialize;

use experiment_runner::compensation::Arm;
use experiment_runner::protocol::{InverseUse, TrackingProtocol};
use experiment_runner::run::RunError;
use experiment_runner::test_bed::TestBed;
use experiment_runner::tracking::{TrackingJob, TrackingRun};
use experiment_runner::waveform::Waveform;

/// A simulation of section 6.5.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, strum::VariantArray)]
#[serde(rename_all = "snake_case")]
pub enum ThesisTask {
    /// Table 6.5.
    VelocityTracking,
    /// Table 6.6.
    VelocityRegulation,
    /// Table 6.7.
    PositionTracking,
}

impl ThesisTask {
    /// All three.
    pub const ALL: &'static [Self] = <Self as strum::VariantArray>::VARIANTS;

    /// In words.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::VelocityTracking => "velocity tracking",
            Self::VelocityRegulation => "velocity regulation",
            Self::PositionTracking => "position tracking",
        }
    }

    /// What is driven, once.
    #[must_use]
    pub fn protocol(self) -> TrackingProtocol {
        let protocol = match self {
            Self::VelocityTracking => TrackingProtocol::velocity(),
            Self::VelocityRegulation => TrackingProtocol {
                reference: Waveform::StepVelocity { velocity: 1.0, at: 0.0 },
                inverse: InverseUse::Gain,
                duration: 36.0,
                ..TrackingProtocol::velocity()
            },
            Self::PositionTracking => TrackingProtocol::position(),
        };
        TrackingProtocol { repetitions: 1, ..protocol }
    }

    /// One run under the friction `plant`, compensated by an observer over `observer`, or by none.
    ///
    /// # Errors
    /// [`RunError`] if the loop cannot be put together.
    pub fn run(
        self,
        plant: &AnyModel,
        observer: Option<&AnyModel>,
    ) -> Result<TrackingRun, RunError> {
        let coupling = FrictionCoupling::NewtonMetreAsVolt;
        // The loop's own transient is all there is to the step of velocity: a controller that holds
        // its voltage for 1 ms makes it 5 % shorter than the continuous one that the thesis
        // simulated.
        let (period, substeps) = match self {
            Self::VelocityRegulation => (2e-4, 1),
            Self::VelocityTracking | Self::PositionTracking => (1e-3, 2),
        };
        let simulation = SimulationOptions {
            period,
            substeps,
            sensors: Sensors::ideal(),
            friction_coupling: coupling,
            voltage_limit: 10.0,
            ..Default::default()
        };
        let mut controller = ControllerOptions {
            derivative_on: DerivativeOn::Error,
            derivative_filter: 0.0,
            ..Default::default()
        };
        controller.compensation.volts_per_newton_metre =
            coupling.volts_per_newton_metre(&simulation.drive);
        let bed =
            TestBed { simulation, friction: *plant, controller, estimator: Default::default() };
        let protocol = self.protocol();
        let arm = observer.map_or(Arm::None, |model| Arm::observer(model.name()));
        let control = bed.with_inverse(protocol.inverse).control_loop(
            protocol.mode,
            protocol.reference,
            observer.unwrap_or(plant),
            arm.means(),
            0,
            0,
        )?;
        Ok(TrackingJob { arm, repetition: 0 }.run(&protocol, control, |_| {})?)
    }
}
