//! A machine as it goes on in time.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

use friction_model::{FrictionModel, ModelVisitor};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rig_driver::{Measurement, Truth};

use crate::shaft::{Shaft, Turning};
use crate::{Break, Machine, MachineError, Peaks};

/// A machine that goes on from one opening to the next.
pub(crate) struct Simulated {
    pub(crate) machine: Machine,
    shaft: Box<dyn Turning>,
    noise: Pcg64Mcg,
    current_noise: Pcg64Mcg,
    /// Voltages on their way to the motor.
    underway: VecDeque<f64>,
    /// What the motor has \[V\].
    on_motor: f64,
    velocity_before: f64,
    pub(crate) cycle: u64,
    broken: bool,
    /// Position \[rad\] that the encoder lost, and where it stands once it is unplugged.
    lost: f64,
    unplugged_at: Option<f64>,
    /// True position at which the encoder turned its count round \[rad\].
    reversed_at: Option<f64>,
    position_before: f64,
    pub(crate) peaks: Peaks,
}

/// Builds the shaft around a model whose type is known.
struct Build<'a>(&'a Machine);

impl ModelVisitor for Build<'_> {
    type Output = Box<dyn Turning>;

    fn visit<M>(self, model: M) -> Self::Output
    where
        M: FrictionModel<Continuous: Send + Sync, Memory: Send + Sync, Discrete: Send + Sync>
            + Send
            + Sync
            + 'static,
    {
        Box::new(Shaft::new(self.0, model))
    }
}

impl Simulated {
    /// Cold, at rest and at zero.
    pub(crate) fn new(machine: Machine) -> Result<Self, MachineError> {
        machine.check()?;
        let shaft = machine.friction.visit(Build(&machine));
        Ok(Self {
            shaft,
            noise: Pcg64Mcg::seed_from_u64(machine.seed),
            current_noise: Pcg64Mcg::seed_from_u64(!machine.seed),
            underway: std::iter::repeat_n(0.0, machine.delay as usize).collect(),
            on_motor: 0.0,
            velocity_before: 0.0,
            cycle: 0,
            broken: false,
            lost: 0.0,
            unplugged_at: None,
            reversed_at: None,
            position_before: 0.0,
            peaks: Peaks::default(),
            machine,
        })
    }

    /// What no sensor shows.
    pub(crate) fn truth(&self) -> Truth {
        self.shaft.truth(self.on_motor)
    }

    fn now(&self) -> f64 {
        self.cycle as f64 * self.machine.period
    }

    pub(crate) fn is_broken(&self, what: Break) -> bool {
        self.broken && self.machine.breaks.is_some_and(|breaks| breaks.what == what)
    }

    /// What the encoder shows of the true position.
    fn shown(&self, position: f64) -> f64 {
        let position = self.reversed_at.map_or(position, |at| 2.0 * at - position);
        self.unplugged_at.unwrap_or(position - self.lost) * self.machine.position_scale
    }

    pub(crate) fn measure(&mut self) -> Measurement {
        let truth = self.shaft.truth(self.on_motor);
        let (sensors, sensed) = (&self.machine.sensors, self.machine.sensed);
        let (encoder_counts, encoder_position) = sensors.encoder(self.shown(truth.position));
        let motor = &self.machine.motor;
        let mean_velocity = 0.5 * (self.velocity_before + truth.velocity);
        let current =
            (self.on_motor - motor.back_emf() * mean_velocity) / motor.armature_resistance;
        let torque = if self.is_broken(Break::TorqueSaturated) {
            sensors.torque.range
        } else {
            truth.friction
        };
        let noise = &mut self.noise;
        let mut tell = |there: bool, value: f64, channel: rig_driver::Channel| {
            if there { channel.read(value, noise) } else { 0.0 }
        };
        Measurement {
            encoder_counts,
            encoder_position,
            tachometer_velocity: tell(sensed.tachometer, truth.velocity, sensors.tachometer),
            potentiometer_position: 0.0,
            torque: tell(sensed.torque, torque, sensors.torque),
            motor_current: sensed
                .current
                .then(|| sensors.current.read(current, &mut self.current_noise)),
            ..Measurement::default()
        }
    }

    /// A cycle with `volts` given out.
    pub(crate) fn advance(&mut self, volts: f64) {
        self.underway.push_back(volts);
        self.on_motor = self.underway.pop_front().unwrap_or(volts);
        if let Some(breaks) = self.machine.breaks
            && !self.broken
            && self.now() >= breaks.after
        {
            self.broken = true;
            self.shaft.break_down(breaks.what);
            if breaks.what == Break::EncoderUnplugged {
                self.unplugged_at = Some(self.shaft.truth(0.0).position - self.lost);
            }
            if breaks.what == Break::EncoderReversed {
                self.reversed_at = Some(self.shaft.truth(0.0).position);
            }
        }
        let h = self.machine.period / f64::from(self.machine.substeps);
        self.velocity_before = self.shaft.truth(self.on_motor).velocity;
        for _ in 0..self.machine.substeps {
            self.shaft.advance(self.on_motor, h);
        }
        self.cycle += 1;
        let truth = self.shaft.truth(self.on_motor);
        if self.is_broken(Break::EncoderSkips) {
            self.lost += 0.05 * (truth.position - self.position_before).max(0.0);
        }
        if let Some(stops) = self.machine.stops
            && stops.beyond(self.position_before) == 0.0
            && stops.beyond(truth.position) != 0.0
        {
            self.peaks.hit = self.peaks.hit.max(self.velocity_before.abs());
        }
        self.position_before = truth.position;
        self.peaks.voltage = self.peaks.voltage.max(volts.abs());
        self.peaks.last_voltage = volts;
        self.peaks.velocity = self.peaks.velocity.max(truth.velocity.abs());
        self.peaks.position = self.peaks.position.max(truth.position.abs());
        self.peaks.time = self.now();
    }
}

/// What a lock protects here is whole even if somebody panicked beside it.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
