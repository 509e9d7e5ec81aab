//! Whether the sensors can be believed.

use super::{Agreement, Fault, SensorChecks};
use crate::Measurement;

/// Cycles in a row with the torque at the end of its range.
const SATURATED_CYCLES: u32 = 10;
/// Cycles in a row in which the rig's time stands still.
const STOPPED_CYCLES: u32 = 20;
/// Window of the encoder's velocity where it is held against no tachometer \[s\].
const WINDOW: f64 = 0.05;

/// What was found: the fault, the value seen and its limit.
pub(super) type Finding = (Fault, f64, f64);

/// Watches the readings, cycle by cycle.
#[derive(Debug, Clone)]
pub(super) struct SensorMonitor {
    checks: SensorChecks,
    window: Window,
    saturated: u32,
    tachometer: Unchanged,
    torque: Unchanged,
    rig_time: Unchanged,
    /// The tachometer never showed anything but zero.
    silent: bool,
}

impl SensorMonitor {
    pub(super) fn new(checks: SensorChecks, period: f64) -> Self {
        Self {
            checks,
            window: Window::new(checks.agreement, period),
            saturated: 0,
            tachometer: Unchanged::default(),
            torque: Unchanged::default(),
            rig_time: Unchanged::default(),
            silent: true,
        }
    }

    /// Forgets what was seen.
    pub(super) fn restart(&mut self) {
        self.window = Window { samples: 0, disagreed: 0, encoder_velocity: None, ..self.window };
        self.saturated = 0;
        (self.tachometer, self.torque, self.rig_time) = Default::default();
    }

    /// Velocity by the encoder over the last whole window [rad/s].
    pub(super) fn encoder_velocity(&self) -> Option<f64> {
        self.window.encoder_velocity
    }

    /// Velocity that the motor turns with, as far as it is known [rad/s]: that of the tachometer, of
    /// the encoder where there is no tachometer. One that is there is never exactly zero for ever.
    pub(super) fn velocity(&self, seen: &Measurement) -> f64 {
        if self.silent { self.encoder_velocity().unwrap_or(0.0) } else { seen.tachometer_velocity }
    }

    /// Takes in one cycle. `broken` says that a cycle was late: means over it say nothing.
    pub(super) fn check(&mut self, seen: &Measurement, broken: bool) -> Option<Finding> {
        let readings = [
            seen.encoder_position,
            seen.tachometer_velocity,
            seen.torque,
            seen.motor_current.unwrap_or(0.0),
        ];
        self.silent &= seen.tachometer_velocity == 0.0;
        if let Some(&wrong) = readings.iter().find(|reading| !reading.is_finite()) {
            return Some((Fault::ReadingNotFinite, wrong, 0.0));
        }
        if self.rig_time.count(seen.time) >= STOPPED_CYCLES {
            return Some((Fault::RigClockStopped, seen.time, 0.0));
        }
        if let Some(range) = self.checks.torque_range {
            self.saturated = if seen.torque.abs() >= range { self.saturated + 1 } else { 0 };
            if self.saturated >= SATURATED_CYCLES {
                return Some((Fault::TorqueSaturated, seen.torque, range));
            }
        }
        if let Some(cycles) = self.checks.frozen_cycles {
            if self.tachometer.count(seen.tachometer_velocity) >= cycles {
                return Some((
                    Fault::TachometerFrozen,
                    seen.tachometer_velocity,
                    f64::from(cycles),
                ));
            }
            // A rig without a torque sensor has nothing that could freeze.
            if self.checks.torque_range.is_some() && self.torque.count(seen.torque) >= cycles {
                return Some((Fault::TorqueFrozen, seen.torque, f64::from(cycles)));
            }
        }
        self.window.add(seen, broken)
    }
}

/// Counts how often in a row a value came again.
#[derive(Debug, Clone, Copy, Default)]
struct Unchanged {
    last: Option<f64>,
    repeats: u32,
}

impl Unchanged {
    fn count(&mut self, value: f64) -> u32 {
        self.repeats = if self.last == Some(value) { self.repeats.saturating_add(1) } else { 0 };
        self.last = Some(value);
        self.repeats
    }
}

/// Means of tachometer and encoder velocity over windows one after the other.
#[derive(Debug, Clone, Copy)]
struct Window {
    agreement: Option<Agreement>,
    length: u32,
    samples: u32,
    /// Way by the tachometer over the window, by the trapezoidal rule \[rad\].
    way: f64,
    last_tachometer: f64,
    last_time: f64,
    start_time: f64,
    start_position: f64,
    encoder_velocity: Option<f64>,
    disagreed: u32,
}

impl Window {
    fn new(agreement: Option<Agreement>, period: f64) -> Self {
        let window = agreement.map_or(WINDOW, |agreement| agreement.window);
        Self {
            agreement,
            length: (window / period).round().max(1.0) as u32,
            samples: 0,
            way: 0.0,
            last_tachometer: 0.0,
            last_time: 0.0,
            start_time: 0.0,
            start_position: 0.0,
            encoder_velocity: None,
            disagreed: 0,
        }
    }

    fn begin(&mut self, seen: &Measurement) {
        self.samples = 1;
        self.way = 0.0;
        (self.start_time, self.start_position) = (seen.time, seen.encoder_position);
        (self.last_time, self.last_tachometer) = (seen.time, seen.tachometer_velocity);
    }

    fn add(&mut self, seen: &Measurement, broken: bool) -> Option<Finding> {
        if self.samples == 0 || broken {
            self.begin(seen);
            return None;
        }
        // By the rig's time: a cycle that was lost on the way counts for as long as it was.
        let mean = 0.5 * (self.last_tachometer + seen.tachometer_velocity);
        self.way += mean * (seen.time - self.last_time);
        (self.last_time, self.last_tachometer) = (seen.time, seen.tachometer_velocity);
        if self.samples < self.length {
            self.samples += 1;
            return None;
        }
        let elapsed = seen.time - self.start_time;
        let tachometer = self.way / elapsed;
        let encoder = (seen.encoder_position - self.start_position) / elapsed;
        self.begin(seen);
        if elapsed <= 0.0 {
            return None;
        }
        self.encoder_velocity = Some(encoder);
        let Agreement { absolute, relative, .. } = self.agreement?;
        let allowed = absolute + relative * encoder.abs();
        let difference = (tachometer - encoder).abs();
        self.disagreed = if difference > allowed { self.disagreed + 1 } else { 0 };
        (self.disagreed >= 2).then_some((Fault::SensorsDisagree, difference, allowed))
    }
}
