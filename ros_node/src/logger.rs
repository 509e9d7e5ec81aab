//! Log lines, on the terminal and on `/rosout`.

use std::{
    panic::Location,
    sync::{Arc, Mutex, OnceLock, PoisonError},
    time::{Duration, Instant},
};

use ros2_client::{
    Log, MessageTypeName, Name, Node, Publisher,
    builtin_interfaces::Time,
    qos::{Durability, History, QosProfile, WhenFull},
};

use crate::{
    LogLevel, NodeClock,
    inside::{Ears, Inside},
    outbox::{Out, Outbox},
    repeated::Repeated,
    terminal,
};

/// Lines that wait for the network.
const WAITING: usize = 256;
/// Lines that are kept for who comes late.
const KEPT: usize = 1000;
/// How long they are.
const LATE: Duration = Duration::from_secs(10);
/// Longest wait for a leaving node's lines on `/rosout`.
const LAST_LINES: Duration = Duration::from_millis(500);

/// Writes log lines of one node. Clones write the same. Never waits, neither for the terminal nor
/// for the network: the lines go through bounded queues, and those for which there is no room are
/// dropped and counted. It allocates: not for a control thread.
#[derive(Clone)]
pub struct Logger(Arc<Inner>);

struct Inner {
    name: String,
    level: LogLevel,
    terminal: bool,
    clock: NodeClock,
    rosout: Arc<Rosout>,
    repeated: Mutex<Repeated>,
    ears: Ears,
}

/// `None` once the node has left, or where `/rosout` is switched off.
type Rosout = Mutex<Option<Publisher<Log>>>;

/// A line on its way to `/rosout`.
struct Line {
    rosout: Arc<Rosout>,
    stamp_ns: u64,
    level: LogLevel,
    name: String,
    text: String,
    /// Where in the sources it was written.
    place: &'static Location<'static>,
}

/// All nodes' way to `/rosout`: another thread than the terminal's, so that neither waits for the
/// other.
fn network() -> &'static Outbox<Line> {
    static NETWORK: OnceLock<Outbox<Line>> = OnceLock::new();
    NETWORK.get_or_init(|| {
        let mut last = None::<(Arc<Rosout>, String, u64, &Location<'_>)>;
        Outbox::start("rosout", WAITING, move |out: Out<Line>| match out {
            Out::Item(line) => {
                line.publish();
                last = Some((line.rosout, line.name, line.stamp_ns, line.place));
            }
            Out::Dropped(count) => {
                if let Some((rosout, name, stamp_ns, place)) = last.take() {
                    let text =
                        format!("{count} log lines were dropped: the network did not take them");
                    Line { rosout, stamp_ns, level: LogLevel::Warn, name, text, place }.publish();
                }
            }
        })
    })
}

impl Line {
    fn publish(&self) {
        if let Some(publisher) = &*self.rosout.lock().unwrap_or_else(PoisonError::into_inner) {
            let level = match self.level {
                LogLevel::Debug => Log::DEBUG,
                LogLevel::Info => Log::INFO,
                LogLevel::Warn => Log::WARN,
                LogLevel::Error => Log::ERROR,
                LogLevel::Fatal => Log::FATAL,
            };
            // A line that the network does not take is on the terminal.
            let _ = publisher.publish(Log {
                stamp: Time::from_nanos(i64::try_from(self.stamp_ns).unwrap_or(i64::MAX)),
                level,
                name: self.name.clone(),
                msg: self.text.clone(),
                file: self.place.file().to_owned(),
                // The compiler tells where a call stands, but not in which function.
                function: String::new(),
                line: self.place.line(),
            });
        }
    }
}

/// `/rosout` of a node as rcl offers it: who comes late gets the lines of the last [`LATE`]. The
/// client library's own keeps one line.
pub(crate) fn rosout(node: &mut Node) -> Result<Publisher<Log>, String> {
    let name = Name::new("/", "rosout").map_err(|error| error.to_string())?;
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Wait(Duration::from_millis(5)))
        .durability(Durability::TransientLocal)
        .history(History::KeepLast { depth: KEPT })
        .lifespan(Some(LATE));
    let topic = node
        .create_topic(&name, MessageTypeName::new("rcl_interfaces", "Log"), &qos)
        .map_err(|error| error.to_string())?;
    node.create_publisher(&topic, Some(qos)).map_err(|error| error.to_string())
}

impl Logger {
    pub(crate) fn new(
        name: String,
        level: LogLevel,
        terminal: bool,
        clock: NodeClock,
        rosout: Option<Publisher<Log>>,
        ears: Ears,
    ) -> Self {
        let rosout = Arc::new(Mutex::new(rosout));
        let repeated = Mutex::default();
        Self(Arc::new(Inner { name, level, terminal, clock, rosout, repeated, ears }))
    }

    /// Whether both are of one node.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Lets go of `/rosout`, once the lines are out or had their time.
    pub(crate) fn leave(&self) {
        let _ = network().flush(LAST_LINES);
        self.0.rosout.lock().unwrap_or_else(PoisonError::into_inner).take();
    }

    /// Writes a line of that level.
    #[track_caller]
    pub fn log(&self, level: LogLevel, text: &str) {
        let Inner { name, clock, rosout, ears, .. } = &*self.0;
        if level < self.0.level {
            return;
        }
        let now = clock.now_ns();
        let text = crate::limits::line(text);
        if self.0.terminal {
            terminal::tell(format!(
                "[{level}] [{}.{:09}] [{name}]: {text}",
                now / 1_000_000_000,
                now % 1_000_000_000
            ));
        }
        ears.hear(Inside::Line { node: name, level, stamp_ns: now, text: &text });
        network().put(Line {
            rosout: Arc::clone(rosout),
            stamp_ns: now,
            level,
            name: name.clone(),
            text: text.into_owned(),
            place: Location::caller(),
        });
    }

    /// Writes a warning that anybody on the network can cause, as often as he likes: of one `kind`
    /// at most one a second is written, and it says how many were not. `text` is made only if it is
    /// written.
    #[track_caller]
    pub fn warn_of(&self, kind: &str, text: impl FnOnce() -> String) {
        let mut repeated = self.0.repeated.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(before) = repeated.may_be_told(kind, Instant::now()) else { return };
        drop(repeated);
        match before {
            0 => self.warn(&text()),
            before => self.warn(&format!("{} (and {before} more like this before)", text())),
        }
    }

    /// For those who look for a mistake.
    #[track_caller]
    pub fn debug(&self, text: &str) {
        self.log(LogLevel::Debug, text);
    }

    /// What happens.
    #[track_caller]
    pub fn info(&self, text: &str) {
        self.log(LogLevel::Info, text);
    }

    /// What somebody should look at.
    #[track_caller]
    pub fn warn(&self, text: &str) {
        self.log(LogLevel::Warn, text);
    }

    /// What does not work.
    #[track_caller]
    pub fn error(&self, text: &str) {
        self.log(LogLevel::Error, text);
    }
}
