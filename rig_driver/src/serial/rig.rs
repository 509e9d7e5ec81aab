//! The rig behind a serial port.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, sync_channel},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use rig_protocol::{FaultReport, Hello, HostMessage, Message, Session, State, VoltageCommand};

use super::{
    Latency, LinkStatistics, SerialError, SerialOptions,
    handshake::handshake,
    port::{Port, Sent},
    reader::{Counts, Event, Reader},
    scaling::Scaling,
};
use crate::{Measurement, Rig, RigError};

/// Measurements that wait to be used: an eighth of a second at 1 kHz. What is older is of no use to a loop.
const QUEUE: usize = 128;
/// Time between two requests for a change of state.
const REQUEST: Duration = Duration::from_millis(10);

/// The line to the device, as far as the loop knows.
#[derive(Debug)]
enum Link {
    Up(Arc<Port>, Session),
    Down(SerialError),
}

/// A rig behind a serial port.
#[derive(Debug)]
pub struct SerialRig {
    path: PathBuf,
    options: SerialOptions,
    link: Link,
    scaling: Scaling,
    events: Receiver<Event>,
    latency: Latency,
    /// The newest measurement: as it came, in SI units, and when.
    newest: Option<(rig_protocol::Measurement, Measurement, Instant)>,
    /// A measurement was returned: time has begun.
    seen: bool,
    /// `wait` has fetched the measurement that `measure` is to return.
    waited: bool,
    /// The device was activated in this session, and has not gone inactive since.
    active: bool,
    /// A voltage that was not a number is latched.
    fault: bool,
    last_fault: Option<FaultReport>,
    asked: f64,
    cut: bool,
    sequence: u32,
    statistics: LinkStatistics,
    counts: Arc<Mutex<Counts>>,
    stop: Arc<AtomicBool>,
    reader: Option<JoinHandle<()>>,
}

impl SerialRig {
    /// Opens the port, lowers its latency timer where it has one, and says hello to the device, whose motor is at zero
    /// volts from then on.
    ///
    /// # Errors
    /// [`SerialError`] if the port does not open, another program has it, nothing answers, or the device speaks another version.
    pub fn open(path: &Path, options: SerialOptions) -> Result<Self, SerialError> {
        options.check()?;
        let port = Arc::new(Port::open(path, options.baud)?);
        let latency = Latency::lower(path, Path::new("/sys"));
        let patience = Duration::from_secs_f64(options.answer);
        let agreed = handshake(&port, options.baud, patience)?;
        let (session, hello) = (agreed.session, agreed.hello);
        let (sender, events) = sync_channel(QUEUE);
        let (counts, stop) = (Arc::<Mutex<Counts>>::default(), Arc::<AtomicBool>::default());
        let reader = Reader {
            path: path.to_owned(),
            baud: options.baud,
            patience,
            events: sender,
            counts: Arc::clone(&counts),
            stop: Arc::clone(&stop),
        };
        let its_port = Arc::clone(&port);
        let reader = thread::Builder::new()
            .name("serial reader".into())
            .spawn(move || reader.run(its_port, agreed))
            .map_err(|error| SerialError::Thread { reason: error.to_string() })?;
        Ok(Self {
            path: path.to_owned(),
            options,
            link: Link::Up(port, session),
            scaling: Scaling::new(hello),
            events,
            latency,
            newest: None,
            seen: false,
            waited: false,
            active: false,
            fault: false,
            last_fault: None,
            asked: 0.0,
            cut: false,
            sequence: 0,
            statistics: LinkStatistics::default(),
            counts,
            stop,
            reader: Some(reader),
        })
    }

    /// What the device is and how it scales.
    #[must_use]
    pub const fn hello(&self) -> &Hello {
        self.scaling.hello()
    }

    /// What is known of the port's latency.
    #[must_use]
    pub const fn latency(&self) -> &Latency {
        &self.latency
    }

    /// The device's state in the newest measurement; none before the first.
    #[must_use]
    pub fn state(&self) -> Option<State> {
        self.newest.map(|(device, ..)| device.state)
    }

    /// The last fault that the device reported.
    #[must_use]
    pub const fn last_fault(&self) -> Option<&FaultReport> {
        self.last_fault.as_ref()
    }

    /// Time since the newest measurement came [s]; none before the first.
    #[must_use]
    pub fn age(&self) -> Option<f64> {
        self.newest.map(|(_, _, came)| came.elapsed().as_secs_f64())
    }

    /// What the line has carried and lost so far.
    #[must_use]
    pub fn statistics(&self) -> LinkStatistics {
        let counts = *self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        LinkStatistics {
            measurements: counts.measurements,
            gaps: counts.gaps,
            repeated: counts.repeated,
            dropped: counts.dropped,
            rejections: counts.rejections,
            rejected_before: counts.rejected_before,
            reconnects: counts.reconnects,
            restarts: counts.restarts,
            ..self.statistics
        }
    }

    /// Latches an emergency stop in the device.
    ///
    /// # Errors
    /// [`SerialError::Disconnected`] if the line is gone; the device stops by itself then.
    pub fn emergency_stop(&mut self) -> Result<(), SerialError> {
        self.active = false;
        self.send(|_| HostMessage::EmergencyStop)
    }

    /// Keeps the device active while there is no voltage to command. Its host's silence would make it inactive.
    ///
    /// # Errors
    /// [`SerialError::Disconnected`] if the line is gone.
    pub fn heartbeat(&mut self) -> Result<(), SerialError> {
        self.send(|session| HostMessage::Heartbeat { session })
    }

    /// Sends what `message` makes of the session.
    fn send(&mut self, message: impl FnOnce(Session) -> HostMessage) -> Result<(), SerialError> {
        let (port, session) = match &self.link {
            Link::Up(port, session) => (port, *session),
            Link::Down(error) => return Err(error.clone()),
        };
        match port.send(message(session).frame().as_bytes()) {
            Ok(Sent::All) => Ok(()),
            Ok(Sent::Full) => {
                self.statistics.not_sent += 1;
                Ok(())
            }
            Err(error) => {
                self.lose(&error);
                Err(error)
            }
        }
    }

    /// Sends a message until a measurement shows the state that it asks for, or one in which it cannot be had.
    fn request(
        &mut self,
        message: impl Fn(Session) -> HostMessage,
        reached: impl Fn(State) -> bool,
        hopeless: impl Fn(State) -> bool,
    ) -> Result<(), SerialError> {
        let end = Instant::now() + Duration::from_secs_f64(self.options.answer);
        let mut again = Instant::now();
        // What was measured before the request says nothing about it.
        while let Ok(event) = self.events.try_recv() {
            self.take(event)?;
        }
        loop {
            if Instant::now() >= again {
                self.send(&message)?;
                again = Instant::now() + REQUEST;
            }
            let measured = self.next(again)?;
            let state = self.state().filter(|_| measured);
            if state.is_some_and(&reached) {
                return Ok(());
            }
            if state.is_some_and(&hopeless) || Instant::now() >= end {
                return Err(match self.newest {
                    Some((device, ..)) => SerialError::NotActive { state: device.state, cause: device.cause },
                    None => self.silent(),
                });
            }
        }
    }

    /// Takes events until a measurement has come, but not longer than `end`. Says whether one has.
    fn next(&mut self, end: Instant) -> Result<bool, SerialError> {
        loop {
            let left = end.saturating_duration_since(Instant::now());
            match self.events.recv_timeout(left) {
                Ok(event) => {
                    if self.take(event)? {
                        return Ok(true);
                    }
                }
                Err(RecvTimeoutError::Timeout) => return Ok(false),
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(SerialError::Thread { reason: "the serial reader has ended".into() });
                }
            }
        }
    }

    /// Takes one event in. Says whether it was a measurement.
    fn take(&mut self, event: Event) -> Result<bool, SerialError> {
        match event {
            Event::Measurement(device, came) => {
                let scaled = self.scaling.scaled(&device, self.asked, self.cut);
                let before =
                    self.newest.map_or(device.commands_refused, |(before, ..)| before.commands_refused);
                let refused = device.commands_refused.wrapping_sub(before);
                self.statistics.commands_refused += u64::from(refused);
                self.active &= device.state == State::Active;
                self.newest = Some((device, scaled, came));
                Ok(true)
            }
            Event::Fault(report) => {
                self.last_fault = Some(report);
                Ok(false)
            }
            Event::Lost(error) => {
                self.lose(&error);
                Err(error)
            }
            Event::Connected { port, session, hello, restarted } => {
                self.link = Link::Up(port, session);
                self.scaling.rejoin(hello);
                self.newest = None;
                self.active = false;
                if restarted { Err(SerialError::Restarted { path: self.path.clone() }) } else { Ok(false) }
            }
        }
    }

    fn lose(&mut self, error: &SerialError) {
        self.active = false;
        self.link = Link::Down(error.clone());
    }

    fn silent(&self) -> SerialError {
        let milliseconds = (self.options.silence * 1e3).round() as u64;
        SerialError::Silent { path: self.path.clone(), milliseconds }
    }
}

impl Rig for SerialRig {
    fn period(&self) -> f64 {
        self.scaling.period()
    }

    fn keeps_time(&self) -> bool {
        true
    }

    fn wait(&mut self) -> Result<(), RigError> {
        let end = Instant::now() + Duration::from_secs_f64(self.options.silence);
        // Measurements that lie there already: the newest counts. If none does, wait for the next.
        let mut fresh = false;
        while let Ok(event) = self.events.try_recv() {
            let measured = self.take(event)?;
            self.statistics.skipped += u64::from(measured && fresh);
            fresh |= measured;
        }
        // Who comes late to a full queue finds only old ones in it; the device would refuse the answer.
        fresh &= self.age().is_some_and(|age| age < 0.5 * self.options.validity);
        if fresh || self.next(end)? {
            self.waited = true;
            if let Some(age) = self.age() {
                let age_us = (age * 1e6) as u64;
                self.statistics.longest_age_us = self.statistics.longest_age_us.max(age_us);
            }
            return Ok(());
        }
        Err(match &self.link {
            Link::Down(error) => error.clone(),
            Link::Up(..) => self.silent(),
        }
        .into())
    }

    /// The newest measurement. Without a [`wait`](Rig::wait) before, it waits itself; if no cycle comes, the
    /// measurement is the last one, marked as a fault.
    fn measure(&mut self) -> Measurement {
        let failed = !self.waited && self.wait().is_err();
        (self.waited, self.seen) = (false, true);
        let seen = self.newest.map(|(_, seen, _)| seen).unwrap_or_default();
        Measurement { fault: seen.fault || self.fault || failed, ..seen }
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.fault |= !volts.is_finite();
        self.asked = if volts.is_finite() { volts } else { 0.0 };
        let (mut voltage, cut) = self.scaling.counts(self.asked);
        self.cut = cut;
        if self.fault {
            voltage = 0;
        }
        let answers = match (&self.link, self.newest) {
            (Link::Down(error), _) => return Err(error.clone().into()),
            (Link::Up(..), Some((device, ..))) if self.active => device.cycle,
            // A motor that may not move has zero volts already.
            (Link::Up(..), _) if voltage == 0 && volts.is_finite() => return Ok(()),
            (Link::Up(..), Some((device, ..))) => {
                return Err(SerialError::NotActive { state: device.state, cause: device.cause }.into());
            }
            (Link::Up(..), None) => return Err(self.silent().into()),
        };
        self.sequence = self.sequence.wrapping_add(1);
        let (sequence, validity_us) = (self.sequence, (self.options.validity * 1e6).round() as u32);
        self.statistics.commands += 1;
        self.send(|_| HostMessage::Voltage(VoltageCommand { sequence, answers, voltage, validity_us }))?;
        if volts.is_finite() { Ok(()) } else { Err(RigError::VoltageNotFinite(volts)) }
    }

    fn activate(&mut self) -> Result<(), RigError> {
        self.request(
            |session| HostMessage::Activate { session },
            |state| state == State::Active,
            |state| matches!(state, State::Fault | State::EmergencyStopped),
        )?;
        (self.active, self.asked, self.cut) = (true, 0.0, false);
        if !self.seen {
            // Time begins with the cycle that follows.
            self.scaling.restart_clock();
        }
        Ok(())
    }

    /// Tells the device to deactivate, without waiting for it to say so.
    fn halt(&mut self) -> Result<(), RigError> {
        (self.active, self.asked, self.cut) = (false, 0.0, false);
        Ok(self.send(|_| HostMessage::Deactivate)?)
    }

    /// Clears what is latched in the device, and a voltage here that was not a number. The motor stays at zero volts until activated.
    fn clear(&mut self) -> Result<(), RigError> {
        self.fault = false;
        self.request(
            |session| HostMessage::Clear { session },
            |state| matches!(state, State::Inactive | State::Active),
            |_| false,
        )?;
        Ok(())
    }
}

impl Drop for SerialRig {
    /// Leaves the motor at zero volts, and says so to the device rather than wait for the command's end.
    fn drop(&mut self) {
        // The line may be gone; the device knows what to do then.
        let _ = self.send(|_| HostMessage::Deactivate);
        self.stop.store(true, Ordering::Relaxed);
        // A reader that waits to tell something is told that nobody listens.
        let (_, nobody) = sync_channel(1);
        drop(std::mem::replace(&mut self.events, nobody));
        if let Some(reader) = self.reader.take() {
            let _ = reader.join();
        }
    }
}
