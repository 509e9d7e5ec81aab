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

use rig_protocol::{
    FaultReport, Hello, HostMessage, Message, Origin, Session, State, VoltageCommand,
};

use super::{
    Latency, LinkStatistics, SerialError, SerialOptions,
    handshake::handshake,
    monitor::{Finding, LineMonitor},
    port::{Port, Sent},
    reader::{Counts, Event, Reader},
    scaling::Scaling,
    scheduling,
    stopping::{AGAIN, Next, PATIENCE, Stopping},
    supervision,
};
use crate::{
    Measurement, Rig, RigError,
    safety::{self, Fault},
};

/// Measurements that wait to be used: an eighth of a second at 1 kHz. What is older is of no use to
/// a loop.
const QUEUE: usize = 128;
/// Longest time between two frames to a device that is not driven: it is to know that its host is
/// alive.
const SIGN_OF_LIFE: Duration = Duration::from_millis(20);
/// Longest wait for the acknowledgement of an emergency stop. The thread that drives is in it, with
/// the motor at zero volts.
const STOPS_WITHIN: Duration = Duration::from_millis(20);

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
    /// The device is being activated: it may be active before this side knows.
    activating: bool,
    stopping: Option<Stopping>,
    monitor: LineMonitor,
    /// What the monitor found out, until it is cleared.
    finding: Option<safety::FaultReport>,
    /// When the rig was opened, and when something was last sent.
    opened: Instant,
    last_sent: Instant,
    last_fault: Option<FaultReport>,
    asked: f64,
    cut: bool,
    sequence: u32,
    statistics: LinkStatistics,
    counts: Arc<Mutex<Counts>>,
    end_reader: Arc<AtomicBool>,
    reader: Option<JoinHandle<()>>,
}

impl SerialRig {
    /// Opens the port, lowers its latency timer where it has one, and says hello to the device,
    /// whose motor is at zero volts from then on.
    ///
    /// # Errors
    /// [`SerialError`] if the port does not open, another program has it, nothing answers, or the
    /// device speaks another version.
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
            present: Default::default(),
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
            monitor: LineMonitor::new(&hello),
            activating: false,
            stopping: None,
            finding: None,
            opened: Instant::now(),
            last_sent: Instant::now(),
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
            end_reader: stop,
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
            others: counts.others,
            dropped: counts.dropped,
            rejections: counts.rejections,
            rejected_before: counts.rejected_before,
            reconnects: counts.reconnects,
            restarts: counts.restarts,
            ..self.statistics
        }
    }

    /// The session that the device has granted; none while the line is down. It is no secret, and
    /// no proof of anything: see `PROTOCOL.md`.
    #[must_use]
    pub const fn session(&self) -> Option<Session> {
        match &self.link {
            Link::Up(_, session) => Some(*session),
            Link::Down(_) => None,
        }
    }

    /// Keeps the device active while there is no voltage to command. Its host's silence would make
    /// it inactive.
    ///
    /// # Errors
    /// [`SerialError::Disconnected`] if the line is gone.
    pub fn heartbeat(&mut self) -> Result<(), SerialError> {
        self.send(HostMessage::Heartbeat)
    }

    /// Tells the device to stop, and to say that it did. Does not wait for that.
    fn stop(&mut self, emergency: bool) -> Result<(), SerialError> {
        (self.active, self.asked, self.cut) = (false, 0.0, false);
        // An emergency stop that is on its way is not made less of.
        let emergency = emergency || self.stopping.is_some_and(|stopping| stopping.emergency);
        self.stopping = Some(Stopping::new(emergency, Instant::now()));
        self.tell_to_stop(emergency)
    }

    fn tell_to_stop(&mut self, emergency: bool) -> Result<(), SerialError> {
        if emergency {
            self.send(|_| HostMessage::EmergencyStop)?;
        }
        self.send(|_| HostMessage::Deactivate)
    }

    /// Sees to it that what was told to stop says so. `state` is what a new measurement shows.
    fn see_to_the_stop(&mut self, state: Option<State>) {
        let now = Instant::now();
        if self.stopping.is_none()
            && state == Some(State::Active)
            && !self.active
            && !self.activating
        {
            // Nobody here let the motor move.
            self.stopping = Some(Stopping::new(false, now - AGAIN));
        }
        let Some(mut stopping) = self.stopping.take() else { return };
        let next = stopping.next(now, state);
        if next == Next::Done {
            return;
        }
        let overdue = stopping.overdue(now);
        self.stopping = Some(stopping);
        if next == Next::Again {
            // A line that is gone says so by itself.
            let _ = self.tell_to_stop(stopping.emergency);
        }
        if overdue {
            let seconds = PATIENCE.as_secs_f64();
            self.latch((Fault::StopNotAcknowledged, seconds, seconds));
        }
    }

    /// Latches what was found out, and has the device rest.
    fn latch(&mut self, (fault, value, limit): Finding) {
        let time = self.newest.map_or(0.0, |(_, seen, _)| seen.time);
        self.finding.get_or_insert(safety::FaultReport { fault, time, value, limit });
        if self.stopping.is_none() {
            // A line that is gone says so by itself.
            let _ = self.stop(false);
        }
    }

    /// Sends what `message` makes of the session and the next number in it.
    fn send(&mut self, message: impl FnOnce(Origin) -> HostMessage) -> Result<(), SerialError> {
        let (port, session) = match &self.link {
            Link::Up(port, session) => (port, *session),
            Link::Down(error) => return Err(error.clone()),
        };
        // Zero is the number of no message.
        self.sequence = self.sequence.checked_add(1).unwrap_or(1);
        let message = message(Origin { session, sequence: self.sequence });
        if let HostMessage::Voltage(command) = &message {
            self.monitor.sent(self.sequence, command.voltage);
        }
        self.last_sent = Instant::now();
        match port.send(message.frame().as_bytes()) {
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

    /// Sends a message until a measurement shows the state that it asks for, or one in which it
    /// cannot be had.
    fn request(
        &mut self,
        message: impl Fn(Origin) -> HostMessage,
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
                again = Instant::now() + AGAIN;
            }
            let measured = self.next(again)?;
            let state = self.state().filter(|_| measured);
            if state.is_some_and(&reached) {
                return Ok(());
            }
            if state.is_some_and(&hopeless) || Instant::now() >= end {
                return Err(match self.newest {
                    Some((device, ..)) => {
                        SerialError::NotActive { state: device.state, cause: device.cause }
                    }
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
                    return Err(SerialError::Thread {
                        reason: "the serial reader has ended".into(),
                    });
                }
            }
        }
    }

    /// Takes one event in. Says whether it was a measurement.
    fn take(&mut self, event: Event) -> Result<bool, SerialError> {
        match event {
            Event::Measurement(device, came) => {
                let (scaled, jump) = self.scaling.scaled(&device, self.asked, self.cut);
                let before = self.newest.map_or(device, |(before, ..)| before);
                let (refused, foreign) = (
                    device.refused.wrapping_sub(before.refused),
                    device.foreign.wrapping_sub(before.foreign),
                );
                self.statistics.commands_refused += u64::from(refused);
                self.statistics.foreign += u64::from(foreign);
                self.active &= device.state == State::Active;
                self.newest = Some((device, scaled, came));
                let now = came.saturating_duration_since(self.opened).as_secs_f64();
                if let Some(finding) = self.monitor.heard(&device, now, jump) {
                    self.latch(finding);
                }
                self.see_to_the_stop(Some(device.state));
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
                self.monitor = LineMonitor::new(&hello);
                // The numbers of a session begin anew; a new session is at zero volts.
                (self.sequence, self.newest, self.active) = (0, None, false);
                self.stopping = self.stopping.filter(|stopping| stopping.emergency);
                if restarted {
                    Err(SerialError::Restarted { path: self.path.clone() })
                } else {
                    Ok(false)
                }
            }
        }
    }

    fn lose(&mut self, error: &SerialError) {
        self.active = false;
        self.link = Link::Down(error.clone());
    }

    /// Time without a frame after which the device is told that its host is alive.
    fn sign_of_life(&self) -> Duration {
        SIGN_OF_LIFE.min(Duration::from_micros(self.hello().host_timeout_us.into()) / 4)
    }

    /// The reader has the class of the thread that waits for it.
    fn follow(&self) {
        if let Some(reader) = &self.reader {
            // Refused, it stays as it is: late, which the supervisor sees.
            let _ = scheduling::follow(reader);
        }
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

    fn voltage_range(&self) -> f64 {
        supervision::voltage_range(self.hello())
    }

    fn keeps_time(&self) -> bool {
        true
    }

    fn wait(&mut self) -> Result<(), RigError> {
        if !self.seen {
            self.follow();
        }
        self.see_to_the_stop(None);
        if !self.active
            && self.last_sent.elapsed() >= self.sign_of_life()
            && matches!(self.link, Link::Up(..))
        {
            // A line that is gone says so by itself.
            let _ = self.heartbeat();
        }
        let end = Instant::now() + Duration::from_secs_f64(self.options.silence);
        // Measurements that lie there already: the newest counts. If none does, wait for the next.
        let mut fresh = false;
        while let Ok(event) = self.events.try_recv() {
            let measured = self.take(event)?;
            self.statistics.skipped += u64::from(measured && fresh);
            fresh |= measured;
        }
        // Who comes late to a full queue finds only old ones in it; the device would refuse the
        // answer.
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

    /// The newest measurement. Without a [`wait`](Rig::wait) before, it waits itself; if no cycle
    /// comes, the measurement is the last one, marked as a fault.
    fn measure(&mut self) -> Measurement {
        let failed = !self.waited && self.wait().is_err();
        (self.waited, self.seen) = (false, true);
        let seen = self.newest.map(|(_, seen, _)| seen).unwrap_or_default();
        Measurement { fault: seen.fault || self.fault || self.finding.is_some() || failed, ..seen }
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
                return Err(
                    SerialError::NotActive { state: device.state, cause: device.cause }.into()
                );
            }
            (Link::Up(..), None) => return Err(self.silent().into()),
        };
        let validity_us = (self.options.validity * 1e6).round() as u32;
        self.statistics.commands += 1;
        self.send(|origin| {
            HostMessage::Voltage(VoltageCommand { origin, answers, voltage, validity_us })
        })?;
        if volts.is_finite() { Ok(()) } else { Err(RigError::VoltageNotFinite(volts)) }
    }

    fn activate(&mut self) -> Result<(), RigError> {
        self.follow();
        if let Some(report) = self.finding {
            return Err(RigError::Safety(report));
        }
        (self.stopping, self.activating) = (None, true);
        let outcome = self.request(
            HostMessage::Activate,
            |state| state == State::Active,
            |state| matches!(state, State::Fault | State::EmergencyStopped),
        );
        self.activating = false;
        if let Err(error) = outcome {
            // It may have gone active all the same.
            let _ = self.stop(false);
            return Err(error.into());
        }
        (self.active, self.asked, self.cut) = (true, 0.0, false);
        if !self.seen {
            // Time begins with the cycle that follows.
            self.scaling.restart_clock();
        }
        Ok(())
    }

    /// Tells the device to rest, without waiting for it to say so; if it does not within 0.1 s,
    /// that is a fault.
    fn halt(&mut self) -> Result<(), RigError> {
        Ok(self.stop(false)?)
    }

    /// Latches an emergency stop in the device. Waits up to 20 ms for a measurement that shows it;
    /// the device is told again every 10 ms until one does, and if none does within 0.1 s, that is
    /// a fault.
    fn emergency_stop(&mut self) -> Result<(), RigError> {
        self.stop(true)?;
        let end = Instant::now() + STOPS_WITHIN;
        while self.stopping.is_some() && Instant::now() < end {
            self.next(end)?;
        }
        if self.stopping.is_none() {
            return Ok(());
        }
        let milliseconds = STOPS_WITHIN.as_millis() as u64;
        Err(SerialError::StopNotAcknowledged { path: self.path.clone(), milliseconds }.into())
    }

    /// Clears what is latched in the device, a voltage here that was not a number, and what was
    /// found out about the line. The motor stays at zero volts until activated.
    fn clear(&mut self) -> Result<(), RigError> {
        (self.fault, self.finding, self.stopping) = (false, None, None);
        self.monitor.restart();
        self.request(
            HostMessage::Clear,
            |state| matches!(state, State::Inactive | State::Active),
            |_| false,
        )?;
        Ok(())
    }

    fn latched_fault(&self) -> Option<safety::FaultReport> {
        self.finding
    }
}

impl Drop for SerialRig {
    /// Leaves the motor at zero volts, and says so to the device rather than wait for the command's
    /// end.
    fn drop(&mut self) {
        // The line may be gone; the device knows what to do then.
        let _ = self.send(|_| HostMessage::Deactivate);
        let _ = self.send(HostMessage::Close);
        self.end_reader.store(true, Ordering::Relaxed);
        // A reader that waits to tell something is told that nobody listens.
        let (_, nobody) = sync_channel(1);
        drop(std::mem::replace(&mut self.events, nobody));
        if let Some(reader) = self.reader.take() {
            let _ = reader.join();
        }
    }
}
