//! One run of an experiment on the nodes.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use controller::{Command, ControlMode, Reference};
use rig_driver::{Measurement, RigError};
use ros_node::RosNodeError;
use ros_node::lifecycle::Phase;

use super::link::{Event, Link, PATIENCE, STOPPING};
use super::{Source, Whole};
use crate::control_loop::RunningLoop;
use crate::cycle::CycleSample;
use crate::profile::Excitation;
use crate::waveform::Waveform;
use rig_setup::REST;

/// Time without a whole cycle after which the run ends.
const SILENCE: Duration = Duration::from_millis(500);
/// Silence after which a node counts as the one that is missing.
const MISSING: Duration = Duration::from_millis(300);
/// How often the wish to stop is looked for while nothing is heard.
const LOOK: Duration = Duration::from_millis(20);
/// Time in which the driver tells in `/diagnostics` why it stopped the motor.
const TELLING: Duration = Duration::from_millis(1500);

/// What is driven.
#[derive(Debug, Clone)]
pub enum Task {
    /// The controller follows a reference.
    Follow(Waveform),
    /// The controller follows a profile, or the profile's voltage goes to the motor and the
    /// controller rests.
    Excite(Excitation),
}

impl Task {
    fn reference(&self, t: f64) -> Reference {
        match self {
            Self::Follow(waveform) => waveform.at(t),
            Self::Excite(excitation) => excitation.reference(t),
        }
    }

    fn volts(&self, t: f64, volts_per_newton_metre: f64) -> Option<f64> {
        match self {
            Self::Follow(_) => None,
            Self::Excite(excitation) => excitation.open_loop(t, volts_per_newton_metre),
        }
    }
}

/// The loop in the nodes, followed cycle by cycle. Dropped, it leaves the motor at zero volts.
#[derive(Debug)]
pub struct NodesLoop {
    link: Arc<Link>,
    stop: Arc<AtomicBool>,
    period: f64,
    task: Task,
    voltage_limit: f64,
    volts_per_newton_metre: f64,
    mode: ControlMode,
    start_ns: u64,
    origin: Option<(u64, Measurement)>,
    /// Voltages that were sent and whose cycle was not seen whole yet, by stamp.
    sent: std::collections::VecDeque<(u64, Command)>,
    last: Instant,
    lost: Arc<AtomicU64>,
    moving: bool,
}

impl NodesLoop {
    pub(super) fn new(
        link: Arc<Link>,
        stop: Arc<AtomicBool>,
        period: f64,
        task: Task,
        (voltage_limit, volts_per_newton_metre): (f64, f64),
        lost: Arc<AtomicU64>,
    ) -> Self {
        Self {
            link,
            stop,
            period,
            task,
            voltage_limit,
            volts_per_newton_metre,
            mode: ControlMode::Velocity,
            start_ns: 0,
            origin: None,
            sent: std::collections::VecDeque::new(),
            last: Instant::now(),
            lost,
            moving: false,
        }
    }

    /// Waits for the shaft to come to rest, and lets the motor move.
    pub(super) fn begin(&mut self, mode: ControlMode) -> Result<(), RigError> {
        self.mode = mode;
        let open = self.task.volts(0.0, self.volts_per_newton_metre).is_some();
        let Self { link, .. } = self;
        link.rig.lifecycle.lead_to(Phase::Inactive, PATIENCE).map_err(elsewhere)?;
        link.controller.lifecycle.lead_to(Phase::Inactive, PATIENCE).map_err(elsewhere)?;
        link.observer.lifecycle.lead_to(Phase::Active, PATIENCE).map_err(elsewhere)?;
        let rested = Instant::now() + Duration::from_secs_f64(REST);
        while Instant::now() < rested {
            if self.stop.load(Ordering::Relaxed) {
                return Err(RigError::Stopped);
            }
            std::thread::sleep(LOOK);
        }
        link.reset_observer().map_err(elsewhere)?;
        if !open {
            // Without a reference it keeps the shaft where it is.
            link.controller.lifecycle.lead_to(Phase::Active, PATIENCE).map_err(elsewhere)?;
        }
        // However the next step ends, the motor may move from now on.
        self.moving = true;
        link.rig.lifecycle.lead_to(Phase::Active, PATIENCE).map_err(elsewhere)?;
        link.begin(!open);
        self.start_ns =
            SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |now| now.as_nanos() as u64);
        self.last = Instant::now();
        Ok(())
    }

    /// Answers a measurement: with a reference for the next cycle, or with a voltage.
    fn answer(&mut self, stamp_ns: u64, measurement: &Measurement) -> Result<(), RigError> {
        let (_, origin) = *self.origin.get_or_insert((stamp_ns, *measurement));
        let time = measurement.time - origin.time;
        if let Some(volts) = self.task.volts(time, self.volts_per_newton_metre) {
            let total = volts.min(self.voltage_limit).max(-self.voltage_limit);
            let mode = self.mode;
            let command = Command { mode, total, saturated: total != volts, ..Command::default() };
            self.sent.push_back((stamp_ns, command));
            return self.link.drive(stamp_ns, total).map_err(elsewhere);
        }
        // It takes effect with the next measurement.
        let reference = self.task.reference(time + self.period);
        let absolute =
            Reference { position: reference.position + origin.encoder_position, ..reference };
        let next_ns = stamp_ns + (self.period * 1e9).round() as u64;
        self.link.refer(next_ns, &absolute).map_err(elsewhere)
    }

    /// The cycle, counted from the first one; none for what came before.
    fn sample(&mut self, whole: &Whole) -> Option<CycleSample> {
        let (first_ns, origin) = self.origin?;
        if whole.stamp_ns < first_ns {
            return None;
        }
        let command = match whole.command {
            Some(command) => command,
            None => {
                while self.sent.front().is_some_and(|(stamp_ns, _)| *stamp_ns < whole.stamp_ns) {
                    self.sent.pop_front();
                }
                self.sent.front().map_or_else(Command::default, |(_, command)| *command)
            }
        };
        let shift =
            if command.mode == ControlMode::Position { origin.encoder_position } else { 0.0 };
        let seen = &whole.measurement;
        let measurement = Measurement {
            cycle: seen.cycle.saturating_sub(origin.cycle),
            time: seen.time - origin.time,
            encoder_counts: seen.encoder_counts - origin.encoder_counts,
            encoder_position: seen.encoder_position - origin.encoder_position,
            potentiometer_position: seen.potentiometer_position - origin.potentiometer_position,
            ..*seen
        };
        Some(CycleSample {
            stamp_ns: whole.stamp_ns,
            reference: self.task.reference(measurement.time),
            measurement,
            estimate: whole.estimate,
            command: Command {
                reference: command.reference - shift,
                feedback: command.feedback - shift,
                ..command
            },
            truth: None,
        })
    }

    /// Why no cycle comes.
    fn why(&self) -> RigError {
        let open = self.task.volts(0.0, self.volts_per_newton_metre).is_some();
        let chain = [Source::Rig, Source::Observer, Source::Controller];
        let silent = chain
            .into_iter()
            .filter(|source| !(open && *source == Source::Controller))
            .map(|source| (source, self.link.silence(source)))
            .find(|(_, silence)| silence.is_none_or(|silence| silence > MISSING));
        RigError::Elsewhere(match silent {
            Some((source, Some(silence))) => format!(
                "/{source} was not heard for {:.1} s: it ended, hangs or was deactivated; the motor is at zero volts. Its log says more; start it again and run the experiment anew",
                silence.as_secs_f64()
            ),
            Some((source, None)) => {
                format!("/{source} was never heard; are its topics remapped? The motor is at zero volts")
            }
            None => "the nodes are heard, but not of the same cycles; the motor is at zero volts. Do two axes share one namespace?"
                .to_owned(),
        })
    }

    fn halt(&mut self) -> Result<(), RigError> {
        if !std::mem::take(&mut self.moving) {
            return Ok(());
        }
        self.lost.fetch_add(self.link.lost(), Ordering::Relaxed);
        // The motor first. Where a node is gone the driver's own watchdog has stopped it.
        let rig = self.link.rig.lifecycle.lead_to(Phase::Inactive, STOPPING);
        let controller = self.link.controller.lifecycle.lead_to(Phase::Inactive, STOPPING);
        rig.and(controller).map_err(elsewhere)
    }
}

impl RunningLoop for NodesLoop {
    fn period(&self) -> f64 {
        self.period
    }

    fn start_ns(&self) -> u64 {
        self.start_ns
    }

    fn step(&mut self) -> Result<CycleSample, RigError> {
        loop {
            if self.stop.load(Ordering::Relaxed) {
                self.halt()?;
                return Err(RigError::Stopped);
            }
            match self.link.next(LOOK) {
                Some(Event::Measured { measurement, .. }) if measurement.fault => {
                    let said =
                        self.link.fault(TELLING).unwrap_or_else(|| "its log says why".to_owned());
                    return Err(RigError::Elsewhere(format!(
                        "/rig_driver stopped the motor: {said}"
                    )));
                }
                Some(Event::Measured { stamp_ns, measurement }) => {
                    self.answer(stamp_ns, &measurement)?
                }
                Some(Event::Whole(whole)) => {
                    self.last = Instant::now();
                    if let Some(sample) = self.sample(&whole) {
                        return Ok(sample);
                    }
                }
                None => {}
            }
            if self.last.elapsed() > SILENCE {
                return Err(self.why());
            }
            if self.link.was_deactivated() {
                return Err(RigError::Elsewhere(
                    "somebody deactivated /rig_driver; the motor is at zero volts".to_owned(),
                ));
            }
        }
    }

    fn stop(&mut self) -> Result<(), RigError> {
        self.halt()
    }
}

impl Drop for NodesLoop {
    fn drop(&mut self) {
        // Whoever wants to know calls `stop`.
        let _ = self.halt();
    }
}

fn elsewhere(error: RosNodeError) -> RigError {
    RigError::Elsewhere(error.to_string())
}
