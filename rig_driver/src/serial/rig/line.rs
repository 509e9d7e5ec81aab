//! What goes over the line: messages out, events in.

use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use rig_protocol::{HostMessage, Message, Origin, State};

use super::{Link, SerialRig};
use crate::serial::SerialError;
use crate::serial::monitor::LineMonitor;
use crate::serial::port::Sent;
use crate::serial::reader::Event;
use crate::serial::stopping::AGAIN;

/// Longest time between two frames to a device that is not driven: it is to know that its host is
/// alive.
const SIGN_OF_LIFE: Duration = Duration::from_millis(20);

impl SerialRig {
    /// Keeps the device active while there is no voltage to command. Its host's silence would make
    /// it inactive.
    ///
    /// # Errors
    /// [`SerialError::Disconnected`] if the line is gone.
    pub fn heartbeat(&mut self) -> Result<(), SerialError> {
        self.send(HostMessage::Heartbeat)
    }

    /// Sends what `message` makes of the session and the next number in it.
    pub(super) fn send(
        &mut self,
        message: impl FnOnce(Origin) -> HostMessage,
    ) -> Result<(), SerialError> {
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
    pub(super) fn request(
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
    pub(super) fn next(&mut self, end: Instant) -> Result<bool, SerialError> {
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
    pub(super) fn take(&mut self, event: Event) -> Result<bool, SerialError> {
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
    pub(super) fn sign_of_life(&self) -> Duration {
        SIGN_OF_LIFE.min(Duration::from_micros(self.hello().host_timeout_us.into()) / 4)
    }

    pub(super) fn silent(&self) -> SerialError {
        let milliseconds = (self.options.silence * 1e3).round() as u64;
        SerialError::Silent { path: self.path.clone(), milliseconds }
    }
}
