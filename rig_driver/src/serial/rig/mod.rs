//! The rig behind a serial port.

mod drive;
mod line;
mod stop;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rig_protocol::{FaultReport, Hello, HostMessage, Session, State};

use super::handshake::handshake;
use super::monitor::LineMonitor;
use super::port::Port;
use super::reader::{Counts, Event, Reader};
use super::scaling::Scaling;
use super::stopping::Stopping;
use super::{Latency, LinkStatistics, SerialError, SerialOptions};
use crate::{Measurement, safety};

/// Measurements that wait to be used: an eighth of a second at 1 kHz. What is older is of no use to
/// a loop.
const QUEUE: usize = 128;

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

    /// Time since the newest measurement came \[s\]; none before the first.
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
