//! Puts together what several nodes say of one cycle.

use std::collections::BTreeMap;
use std::fmt;

use controller::{Command, ControlMode};
use friction_model::Regime;
use friction_observer::{Estimate, Source as EstimateSource};
use msgs::friction_msgs::{ControllerState, FrictionEstimate, RigMeasurement};
use rig_driver::Measurement;

/// Cycles that may be incomplete at the same time; older ones are given up.
const WAITING: usize = 256;

/// Who says something of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// `/rig_driver`, on `/rig_measurement`.
    Rig,
    /// `/friction_observer`, on `/friction_estimate`.
    Observer,
    /// `/controller`, on `/controller_state`.
    Controller,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rig => "rig_driver",
            Self::Observer => "friction_observer",
            Self::Controller => "controller",
        })
    }
}

/// What one of them says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Heard {
    /// Every channel of the rig.
    Measurement(Measurement),
    /// What the observer thinks.
    Estimate(Estimate),
    /// What the controller decided.
    Command(Command),
}

impl Heard {
    /// Who says such things.
    #[must_use]
    pub const fn source(&self) -> Source {
        match self {
            Self::Measurement(_) => Source::Rig,
            Self::Estimate(_) => Source::Observer,
            Self::Command(_) => Source::Controller,
        }
    }
}

/// One cycle of which everything was heard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Whole {
    /// Time of the measurement [ns since the Unix epoch].
    pub stamp_ns: u64,
    /// What was measured.
    pub measurement: Measurement,
    /// What the observer thought of it.
    pub estimate: Estimate,
    /// What the controller answered; none while it is inactive.
    pub command: Option<Command>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Parts {
    measurement: Option<Measurement>,
    estimate: Option<Estimate>,
    command: Option<Command>,
}

/// Cycles by the stamp of their measurement, until they are whole.
#[derive(Debug, Default)]
pub struct Assembler {
    waiting: BTreeMap<u64, Parts>,
    /// The controller takes part.
    controlled: bool,
    /// Stamp of the last whole cycle.
    last: u64,
    lost: u64,
}

impl Assembler {
    /// Begins anew; with `controlled` a cycle is whole only with the controller's command.
    pub fn begin(&mut self, controlled: bool) {
        *self = Self { controlled, last: self.last, ..Self::default() };
    }

    /// Takes in what was said of the cycle stamped `stamp_ns`; the cycle, if that made it whole.
    /// Whole cycles come in the order of their stamps; those that others overtook are lost.
    pub fn hear(&mut self, stamp_ns: u64, heard: Heard) -> Option<Whole> {
        if stamp_ns <= self.last {
            return None;
        }
        let parts = self.waiting.entry(stamp_ns).or_default();
        match heard {
            Heard::Measurement(measurement) => parts.measurement = Some(measurement),
            Heard::Estimate(estimate) => parts.estimate = Some(estimate),
            Heard::Command(command) => parts.command = Some(command),
        }
        let whole = match *parts {
            Parts { measurement: Some(measurement), estimate: Some(estimate), command }
                if command.is_some() || !self.controlled =>
            {
                Whole { stamp_ns, measurement, estimate, command }
            }
            _ => {
                if self.waiting.len() > WAITING {
                    self.waiting.pop_first();
                    self.lost += 1;
                }
                return None;
            }
        };
        let after = self.waiting.split_off(&(stamp_ns + 1));
        self.lost += self.waiting.len() as u64 - 1;
        self.waiting = after;
        self.last = stamp_ns;
        Some(whole)
    }

    /// Cycles of which something was not heard since [`begin`](Self::begin).
    #[must_use]
    pub const fn lost(&self) -> u64 {
        self.lost
    }
}

impl From<&RigMeasurement> for Heard {
    fn from(message: &RigMeasurement) -> Self {
        let &RigMeasurement {
            header: _,
            cycle,
            rig_time,
            encoder_counts,
            encoder_position,
            tachometer_velocity,
            potentiometer_position,
            torque,
            voltage_asked,
            voltage_applied,
            saturated,
            watchdog_expired,
            fault,
        } = message;
        Self::Measurement(Measurement {
            cycle,
            time: rig_time,
            encoder_counts,
            encoder_position,
            tachometer_velocity,
            potentiometer_position,
            torque,
            // The message has no field for it.
            motor_current: None,
            voltage_asked,
            voltage_applied,
            saturated,
            watchdog_expired,
            fault,
        })
    }
}

impl Heard {
    /// An estimate as the observer tells it; none if nobody knows what made it.
    #[must_use]
    pub fn estimate(message: &FrictionEstimate) -> Option<Self> {
        let FrictionEstimate {
            header: _,
            model,
            torque,
            deflection,
            gamma,
            regime,
            velocity,
            residual,
        } = message;
        Some(Self::Estimate(Estimate {
            source: EstimateSource::named(model)?,
            torque: *torque,
            deflection: *deflection,
            gamma: *gamma,
            regime: if *regime == FrictionEstimate::STICK { Regime::Stick } else { Regime::Slip },
            velocity: *velocity,
            residual: Some(*residual).filter(|residual| !residual.is_nan()),
        }))
    }
}

impl From<&ControllerState> for Heard {
    fn from(message: &ControllerState) -> Self {
        Self::Command(Command {
            mode: if message.mode == ControllerState::POSITION {
                ControlMode::Position
            } else {
                ControlMode::Velocity
            },
            reference: message.reference,
            feedback: message.feedback,
            error: message.error,
            linear: message.linear,
            inverse: message.inverse,
            friction: message.friction,
            dither: message.dither,
            total: message.total,
            saturated: message.saturated,
            ..Command::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measurement(cycle: u64) -> Heard {
        Heard::Measurement(Measurement { cycle, ..Measurement::default() })
    }

    fn estimate() -> Heard {
        Heard::estimate(&FrictionEstimate {
            model: "lugre".into(),
            torque: 0.1,
            ..Default::default()
        })
        .unwrap()
    }

    #[test]
    fn a_cycle_is_whole_when_everything_was_heard_in_whatever_order() {
        let mut assembler = Assembler::default();
        assembler.begin(true);
        assert_eq!(assembler.hear(10, estimate()), None);
        assert_eq!(assembler.hear(10, Heard::Command(Command::default())), None);
        let whole = assembler.hear(10, measurement(4)).unwrap();
        assert_eq!((whole.stamp_ns, whole.measurement.cycle), (10, 4));
        assert!(whole.command.is_some());
        assert_eq!(assembler.lost(), 0);
    }

    #[test]
    fn without_a_controller_nobody_waits_for_it() {
        let mut assembler = Assembler::default();
        assembler.begin(false);
        assembler.hear(10, measurement(0));
        assert_eq!(assembler.hear(10, estimate()).unwrap().command, None);
    }

    #[test]
    fn what_is_overtaken_is_lost_and_counted_and_does_not_come_back() {
        let mut assembler = Assembler::default();
        assembler.begin(false);
        assembler.hear(10, measurement(0));
        assembler.hear(20, measurement(1));
        assembler.hear(30, measurement(2));
        assert!(assembler.hear(30, estimate()).is_some());
        assert_eq!(assembler.lost(), 2);
        assert_eq!(assembler.hear(10, estimate()), None);
        assembler.hear(40, measurement(3));
        assert!(assembler.hear(40, estimate()).is_some());
    }

    #[test]
    fn incomplete_cycles_do_not_pile_up() {
        let mut assembler = Assembler::default();
        assembler.begin(true);
        for stamp in 1..10_000 {
            assembler.hear(stamp, measurement(stamp));
        }
        assert!(assembler.waiting.len() <= WAITING + 1);
        assert!(assembler.lost() > 9000);
    }

    #[test]
    fn messages_come_back_as_what_they_were_made_of() {
        let measured =
            Measurement { cycle: 7, time: 0.5, torque: 0.2, fault: true, ..Measurement::default() };
        let message = rig_driver::messages::rig_measurement(9, &measured);
        assert_eq!(Heard::from(&message), Heard::Measurement(measured));
        let command =
            Command { mode: ControlMode::Position, error: 0.3, total: 2.0, ..Command::default() };
        let message = controller::messages::controller_state(9, &command);
        assert_eq!(Heard::from(&message), Heard::Command(command));
        let Heard::Estimate(thought) = estimate() else { panic!("an estimate was expected") };
        let message = friction_observer::messages::friction_estimate(9, &thought);
        assert_eq!(Heard::estimate(&message), Some(Heard::Estimate(thought)));
        assert_eq!(Heard::estimate(&FrictionEstimate { model: "newton".into(), ..message }), None);
    }
}
