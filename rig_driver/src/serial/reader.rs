//! The thread that reads the line, finds the frames, and brings the line back when it was gone.

use std::{
    cell::Cell,
    path::PathBuf,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
        mpsc::{SyncSender, TrySendError},
    },
    thread,
    time::{Duration, Instant},
};

use rig_protocol::{Decoder, DeviceMessage, FaultReport, Hello, Measurement, Rejections, Session};

use super::{
    SerialError,
    handshake::{Agreed, handshake},
    port::Port,
};

/// Longest wait for bytes: how soon the thread ends when told to.
const WAIT: Duration = Duration::from_millis(20);
/// Pause between two attempts to open a port that is gone.
const RETRY: Duration = Duration::from_millis(100);
/// Measurements of another session in a row that say that the device has another host: one may come
/// late from before.
const OTHERS: u32 = 3;

/// What the thread tells.
#[derive(Debug)]
pub(super) enum Event {
    /// A cycle's measurement, and when it came.
    Measurement(Measurement, Instant),
    /// The device stopped the motor by its own decision.
    Fault(FaultReport),
    /// The line is gone.
    Lost(SerialError),
    /// The line is there, with a new session: at zero volts.
    Connected { port: Arc<Port>, session: Session, hello: Hello, restarted: bool },
}

/// What the thread counts.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Counts {
    pub(super) measurements: u64,
    pub(super) gaps: u64,
    pub(super) repeated: u64,
    pub(super) others: u64,
    pub(super) dropped: u64,
    pub(super) reconnects: u64,
    pub(super) restarts: u64,
    /// Of all sessions before the present one's decoder.
    pub(super) rejected_before: u64,
    pub(super) rejections: Rejections,
}

/// What was heard last in a session.
struct Last {
    session: Session,
    cycle: Option<u32>,
    /// Measurements of another session in a row.
    others: u32,
}

/// What ends the reading of one session.
enum End {
    Told,
    Gone(SerialError),
    Restarted,
}

/// The thread's belongings.
pub(super) struct Reader {
    pub(super) path: PathBuf,
    pub(super) baud: u32,
    pub(super) patience: Duration,
    pub(super) events: SyncSender<Event>,
    pub(super) counts: Arc<Mutex<Counts>>,
    /// The counts as they are; `counts` shows them whenever nobody looks at it, so that the thread
    /// never waits for who does.
    pub(super) present: Cell<Counts>,
    pub(super) stop: Arc<AtomicBool>,
}

impl Reader {
    /// Reads until told to stop, or until nobody listens.
    pub(super) fn run(self, mut port: Arc<Port>, mut agreed: Agreed) {
        loop {
            let end = self.read(&port, agreed);
            let restarted = match end {
                End::Told => return,
                End::Gone(error) => {
                    drop(port);
                    if self.events.send(Event::Lost(error)).is_err() {
                        return;
                    }
                    let Some(again) = self.reopen() else { return };
                    (port, agreed) = again;
                    self.count(|counts| counts.reconnects += 1);
                    false
                }
                End::Restarted => {
                    self.count(|counts| counts.restarts += 1);
                    match handshake(&port, self.baud, self.patience) {
                        Ok(again) => agreed = again,
                        Err(error) => {
                            drop(port);
                            if self.events.send(Event::Lost(error)).is_err() {
                                return;
                            }
                            let Some(again) = self.reopen() else { return };
                            (port, agreed) = again;
                        }
                    }
                    true
                }
            };
            let Agreed { session, hello, .. } = agreed;
            let event = Event::Connected { port: Arc::clone(&port), session, hello, restarted };
            if self.events.send(event).is_err() {
                return;
            }
        }
    }

    /// Reads one session.
    fn read(&self, port: &Port, agreed: Agreed) -> End {
        let Agreed { session, mut decoder, rest, .. } = agreed;
        let mut last = Last { session, cycle: None, others: 0 };
        for byte in rest {
            if let Some(end) = self.push(byte, &mut decoder, &mut last) {
                return end;
            }
        }
        let mut buffer = [0; 4096];
        loop {
            if self.stop.load(Ordering::Relaxed) {
                return End::Told;
            }
            let bytes = match port
                .wait(WAIT)
                .and_then(|there| if there { port.read(&mut buffer) } else { Ok(&[][..]) })
            {
                Ok(bytes) => bytes,
                Err(error) => return End::Gone(error),
            };
            for byte in bytes {
                if let Some(end) = self.push(*byte, &mut decoder, &mut last) {
                    return end;
                }
            }
        }
    }

    fn push(&self, byte: u8, decoder: &mut Decoder<DeviceMessage>, last: &mut Last) -> Option<End> {
        let event = match decoder.push(byte) {
            Ok(None) => return None,
            Ok(Some(DeviceMessage::Measurement(measurement)))
                if measurement.session != Some(last.session) =>
            {
                self.count(|counts| counts.others += 1);
                last.others += 1;
                let path = self.path.clone();
                return (last.others >= OTHERS)
                    .then_some(End::Gone(SerialError::TakenOver { path }));
            }
            Ok(Some(DeviceMessage::Measurement(measurement))) => {
                last.others = 0;
                let ahead = last.cycle.map_or(1, |last| measurement.cycle.wrapping_sub(last));
                if ahead == 0 || ahead > u32::MAX / 2 {
                    self.count(|counts| counts.repeated += 1);
                    return None;
                }
                last.cycle = Some(measurement.cycle);
                self.count(|counts| {
                    counts.measurements += 1;
                    counts.gaps += u64::from(ahead - 1);
                });
                Event::Measurement(measurement, Instant::now())
            }
            Ok(Some(DeviceMessage::Fault(report))) => Event::Fault(report),
            // A device that speaks up by itself has just started. An answer to our hello that came
            // twice has its session.
            Ok(Some(DeviceMessage::Hello(hello))) => {
                return hello.session.is_none().then_some(End::Restarted);
            }
            Err(_) => {
                self.count(|counts| counts.rejections = *decoder.rejections());
                return None;
            }
        };
        match self.events.try_send(event) {
            Ok(()) => None,
            Err(TrySendError::Full(_)) => {
                self.count(|counts| counts.dropped += 1);
                None
            }
            Err(TrySendError::Disconnected(_)) => Some(End::Told),
        }
    }

    /// Opens the port and says hello until that works; none when told to stop.
    fn reopen(&self) -> Option<(Arc<Port>, Agreed)> {
        self.count(|counts| {
            counts.rejected_before += counts.rejections.total();
            counts.rejections = Rejections::default();
        });
        while !self.stop.load(Ordering::Relaxed) {
            let again = Port::open(&self.path, self.baud).and_then(|port| {
                handshake(&port, self.baud, self.patience).map(|agreed| (port, agreed))
            });
            match again {
                Ok((port, agreed)) => return Some((Arc::new(port), agreed)),
                Err(_) => thread::sleep(RETRY),
            }
        }
        None
    }

    fn count(&self, change: impl FnOnce(&mut Counts)) {
        let mut present = self.present.get();
        change(&mut present);
        self.present.set(present);
        if let Ok(mut shown) = self.counts.try_lock() {
            *shown = present;
        }
    }
}
