//! Subscribers that do not keep up: who they are, and when somebody is told.
//!
//! A writer that keeps the last samples waits for no subscriber: one that is frozen, slow or out of
//! reach loses what it did not fetch in time, and nobody else loses anything. The log says who it
//! is, at most once in a while, and when it keeps up again or has left.

use std::{
    collections::BTreeMap,
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use ros2_client::Gid;
use rustdds::{DomainParticipantStatusEvent as Event, GUID};

use crate::{Graph, Logger};

/// Shortest time between two lines about one subscriber of one topic.
const BETWEEN: Duration = Duration::from_secs(10);
/// Subscribers that are remembered: strangers may make up any number of them.
const MOST: usize = 1000;

/// Key in `/diagnostics` of how many subscribers of a node's topics do not keep up now.
pub const SUBSCRIBERS_THAT_LAG: &str = "subscribers that do not keep up";

/// The subscribers of this process's topics that do not keep up.
#[derive(Default)]
pub(crate) struct Lagging(Mutex<Books>);

#[derive(Default)]
struct Books {
    /// Who says what is to be said of a topic: the node that publishes it, by the topic's name in
    /// DDS.
    publishers: BTreeMap<String, Logger>,
    readers: Readers,
}

/// What is known of the readers that lagged.
#[derive(Debug, Default)]
struct Readers(BTreeMap<GUID, Reader>);

#[derive(Debug)]
struct Reader {
    topic: String,
    /// The node it belongs to, or its participant.
    whose: String,
    lags: bool,
    /// The last line said that it lags.
    told: bool,
    last_line: Option<Instant>,
}

/// A line for the log.
#[derive(Debug, PartialEq, Eq)]
struct Line {
    /// The topic as DDS has it.
    topic: String,
    warning: bool,
    text: String,
}

impl Lagging {
    /// A node publishes on an absolute topic: it tells of the topic's subscribers.
    pub(crate) fn publishes(&self, topic: &str, logger: &Logger) {
        self.books().publishers.insert(format!("rt{topic}"), logger.clone());
    }

    /// The node with that logger leaves.
    pub(crate) fn leaves(&self, logger: &Logger) {
        self.books().publishers.retain(|_, other| !other.is(logger));
    }

    /// Takes what the participant tells of others; names of nodes are in `graph`.
    pub(crate) fn take(&self, event: &Event, graph: &Graph) {
        let mut books = self.books();
        let readers = &mut books.readers;
        let lines = match event {
            // The published middleware does not tell.
            #[cfg(feature = "mended")]
            Event::RemoteReaderLags { remote_reader, topic_name, .. } => {
                let whose = || {
                    let id = Gid::from(*remote_reader).to_bytes16();
                    graph.node_of_reader(id).unwrap_or_else(|| participant(id))
                };
                readers
                    .lags(*remote_reader, topic_name, whose, Instant::now())
                    .into_iter()
                    .collect()
            }
            #[cfg(feature = "mended")]
            Event::RemoteReaderCaughtUp { remote_reader, .. } => {
                readers.keeps_up(remote_reader).into_iter().collect()
            }
            Event::ReaderLost { guid, .. } => readers.left(|reader| reader == guid),
            Event::ParticipantLost { id, .. } => readers.left(|reader| reader.prefix == *id),
            _ => return,
        };
        for Line { topic, warning, text } in lines {
            // What a node does not publish itself, such as `/rosout`, any of them tells.
            let publisher =
                books.publishers.get(&topic).or_else(|| books.publishers.values().next());
            match publisher {
                Some(logger) if warning => logger.warn(&text),
                Some(logger) => logger.info(&text),
                None => {}
            }
        }
    }

    /// How many subscribers of the topics of the node with that logger lag now.
    pub(crate) fn count(&self, logger: &Logger) -> u64 {
        let books = self.books();
        let of = |topic: &str| books.publishers.get(topic).is_some_and(|other| other.is(logger));
        books.readers.0.values().filter(|reader| reader.lags && of(&reader.topic)).count() as u64
    }

    fn books(&self) -> MutexGuard<'_, Books> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Readers {
    fn lags(
        &mut self,
        id: GUID,
        topic: &str,
        whose: impl Fn() -> String,
        now: Instant,
    ) -> Option<Line> {
        if self.0.len() >= MOST && !self.0.contains_key(&id) {
            self.0.retain(|_, reader| reader.lags);
            if self.0.len() >= MOST {
                return None;
            }
        }
        let reader = self.0.entry(id).or_insert_with(|| Reader {
            topic: topic.to_owned(),
            whose: whose(),
            lags: false,
            told: false,
            last_line: None,
        });
        reader.lags = true;
        if reader.last_line.is_some_and(|last| now.saturating_duration_since(last) < BETWEEN) {
            return None;
        }
        (reader.told, reader.last_line) = (true, Some(now));
        let (whose, topic) = (&reader.whose, shown(topic));
        Some(Line {
            topic: reader.topic.clone(),
            warning: true,
            text: format!(
                "{whose} does not keep up with {topic}: it is frozen, slow or out of reach, and loses what it does not fetch in time; others lose nothing"
            ),
        })
    }

    fn keeps_up(&mut self, id: &GUID) -> Option<Line> {
        let reader = self.0.get_mut(id)?;
        reader.lags = false;
        std::mem::take(&mut reader.told).then(|| Line {
            topic: reader.topic.clone(),
            warning: false,
            text: format!("{} keeps up again with {}", reader.whose, shown(&reader.topic)),
        })
    }

    /// Forgets readers; one line for each node of those that lagged.
    fn left(&mut self, is_gone: impl Fn(&GUID) -> bool) -> Vec<Line> {
        let mut gone = BTreeMap::new();
        self.0.retain(|id, reader| {
            let stays = !is_gone(id);
            if !stays && reader.told {
                gone.insert(std::mem::take(&mut reader.whose), std::mem::take(&mut reader.topic));
            }
            stays
        });
        let line = |(whose, topic)| Line {
            topic,
            warning: false,
            text: format!("{whose}, which did not keep up, has left"),
        };
        gone.into_iter().map(line).collect()
    }
}

/// A topic as people know it.
fn shown(topic: &str) -> String {
    let (kind, name) = topic.split_at(topic.find('/').unwrap_or(0));
    match kind {
        "rt" => name.to_owned(),
        "rr" => format!("the answers of {}", name.strip_suffix("Reply").unwrap_or(name)),
        _ => topic.to_owned(),
    }
}

/// A reader's participant, for one whose node is not known.
fn participant(reader: [u8; 16]) -> String {
    let prefix: Vec<String> = reader[..12].iter().map(|byte| format!("{byte:02x}")).collect();
    format!("a subscriber of the participant {}", prefix.join("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reader(participant: u8, number: u8) -> GUID {
        let mut bytes = [participant; 16];
        bytes[12..].copy_from_slice(&[0, 0, number, 4]);
        GUID::from(Gid::from(bytes))
    }

    fn echo() -> String {
        "/echo".to_owned()
    }

    #[test]
    fn a_frozen_reader_is_told_of_once_in_a_while_and_when_it_is_back() {
        let (mut readers, start) = (Readers::default(), Instant::now());
        let at = |seconds| start + Duration::from_secs(seconds);
        let line = readers.lags(reader(1, 1), "rt/joint_states", echo, at(0)).expect("a line");
        assert!(
            line.warning && line.text.starts_with("/echo does not keep up with /joint_states:"),
            "{line:?}"
        );
        assert_eq!(line.topic, "rt/joint_states");
        assert_eq!(readers.lags(reader(1, 1), "rt/joint_states", echo, at(1)), None);
        let back = readers.keeps_up(&reader(1, 1)).expect("a line");
        assert_eq!(
            (back.warning, back.text.as_str()),
            (false, "/echo keeps up again with /joint_states")
        );
        // It comes and goes: neither is told.
        assert_eq!(readers.lags(reader(1, 1), "rt/joint_states", echo, at(5)), None);
        assert_eq!(readers.keeps_up(&reader(1, 1)), None);
        assert!(readers.lags(reader(1, 1), "rt/joint_states", echo, at(10)).is_some());
        assert_eq!(readers.keeps_up(&reader(2, 1)), None, "one that never lagged");
    }

    #[test]
    fn who_leaves_is_told_of_once() {
        let (mut readers, now) = (Readers::default(), Instant::now());
        for number in 0..5 {
            readers.lags(reader(1, number), "rt/joint_states", echo, now);
        }
        readers.lags(reader(2, 1), "rt/joint_states", || "/other".to_owned(), now);
        let lines = readers.left(|id| id.prefix == reader(1, 0).prefix);
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert_eq!(lines[0].text, "/echo, which did not keep up, has left");
        assert_eq!(readers.0.len(), 1);
        readers.keeps_up(&reader(2, 1));
        assert_eq!(readers.left(|_| true), [], "it kept up");
    }

    #[test]
    fn strangers_fill_no_memory() {
        let (mut readers, now) = (Readers::default(), Instant::now());
        for number in 0..=255 {
            for other in 0..=255 {
                readers.lags(reader(number, other), "rt/x", echo, now);
            }
        }
        assert_eq!(readers.0.len(), MOST);
    }

    #[test]
    fn topics_are_shown_as_people_know_them() {
        assert_eq!(shown("rt/axis_1/joint_states"), "/axis_1/joint_states");
        assert_eq!(shown("rr/controller/resetReply"), "the answers of /controller/reset");
        assert_eq!(shown("ros_discovery_info"), "ros_discovery_info");
        let text = participant(Gid::from(reader(7, 1)).to_bytes16());
        assert!(text.ends_with("07.07.07.07.07.07.07.07.07.07.07.07"), "{text}");
    }
}
