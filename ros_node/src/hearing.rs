//! Who can hear an answer, and who a request.
//!
//! A request may come before this process has found the reader that waits for its answer: the two
//! are told on different ways. RustDDS 0.15 leaves out for a reader what was written before it was
//! found, for good, so the client would wait for ever. The middlewares of rclcpp and rclpy hold
//! such an answer back for a moment; so do the nodes here. What a node says of its parameters at its
//! start waits likewise for those who listen.

use std::{
    collections::{BTreeMap, BTreeSet},
    time::Duration,
};

use futures::StreamExt;
use ros2_client::{Gid, RmwRequestId};
use rustdds::{DomainParticipant, DomainParticipantStatusEvent as Event, GUID, StatusEvented};
use tokio::sync::watch;

use crate::{
    Graph,
    dialect::{ANSWERS, REQUESTS, ROS, process},
    lagging::Lagging,
    one_writer::WriterId,
    security::Others,
};

/// Longest time an answer is held back. Then it is sent to whoever is there: its client has gone,
/// or listens with a quality of service that cannot be served.
const LONGEST: Duration = Duration::from_secs(10);
/// What the name of a topic with events of parameters ends with.
pub(crate) const PARAMETER_EVENTS: &str = "/parameter_events";
/// How long the first event of a node waits for its listeners.
pub(crate) const FOR_LISTENERS: ForListeners =
    ForListeners { longest: Duration::from_secs(5), quiet: Duration::from_millis(300) };
/// Answers of one service that are held back at most; what comes then is sent at once.
pub(crate) const MOST_HELD: usize = 100;

/// A wait for listeners.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForListeners {
    /// It ends then, whoever is there.
    longest: Duration,
    /// Once somebody listens, it ends when nobody new has been found for so long.
    quiet: Duration,
}

/// The readers of answers, requests and events of parameters that this process has found.
#[derive(Default)]
pub(crate) struct Hearers(watch::Sender<Readers>);

#[derive(Default)]
struct Readers {
    /// Topics of all readers of answers and events of parameters that were told of.
    topics: BTreeMap<GUID, String>,
    /// Those that a writer of this process sends to.
    found: BTreeSet<GUID>,
    /// Topics of all readers of requests that were told of.
    servers: BTreeMap<GUID, String>,
}

impl Hearers {
    /// Takes what the participant tells of others, until it ends; who leaves is told to `graph`
    /// too.
    pub(crate) async fn follow(
        &self,
        participant: DomainParticipant,
        graph: Graph,
        others: &Others,
        lagging: &Lagging,
    ) {
        let listener = participant.status_listener();
        // The listener keeps what it needs; the participant itself may leave.
        drop(participant);
        let mut events = listener.as_async_status_stream();
        while let Some(event) = events.next().await {
            others.take(&event);
            // Before the graph forgets who left.
            lagging.take(&event, &graph);
            ROS.take(&event);
            match event {
                Event::ReaderDetected { reader }
                    if reader.topic_name.starts_with(ANSWERS)
                        || reader.topic_name.ends_with(PARAMETER_EVENTS) =>
                {
                    self.0.send_modify(|readers| readers.told(reader.guid, reader.topic_name));
                }
                Event::ReaderDetected { reader } if reader.topic_name.starts_with(REQUESTS) => {
                    self.0.send_modify(|readers| {
                        readers.servers.insert(reader.guid, reader.topic_name);
                    });
                }
                Event::RemoteReaderMatched { remote_reader, .. } => {
                    self.0.send_if_modified(|readers| readers.found(remote_reader));
                }
                Event::ReaderLost { guid, .. } => {
                    self.0.send_if_modified(|readers| readers.lost(|reader| *reader == guid));
                }
                Event::WriterLost { guid, .. } => {
                    graph.lost_writer(WriterId(Gid::from(guid).to_bytes16()))
                }
                Event::ParticipantLost { id, .. } => {
                    graph.lost(|participant| participant.prefix == id);
                    self.0.send_if_modified(|readers| readers.lost(|reader| reader.prefix == id));
                }
                _ => {}
            }
        }
    }

    /// Whether an answer on `topic` to that request reaches its client now.
    pub(crate) fn hear(&self, request: &RmwRequestId, topic: &str) -> bool {
        self.0.borrow().hear(GUID::from(request.writer_gid), topic)
    }

    /// Waits until somebody listens to the topic and the others that are there have been found too,
    /// but not for long.
    pub(crate) async fn until_listened_to(&self, topic: &str, wait: ForListeners) {
        let mut readers = self.0.subscribe();
        let quiet = async {
            if readers.wait_for(|readers| readers.listen(topic)).await.is_ok() {
                while let Ok(Ok(())) = tokio::time::timeout(wait.quiet, readers.changed()).await {}
            }
        };
        // Both ways it is told.
        let _ = tokio::time::timeout(wait.longest, quiet).await;
    }

    /// Whether somebody takes requests on `topic`, and all that do are of Cyclone DDS.
    pub(crate) fn are_of_cyclone(&self, topic: &str) -> bool {
        self.0.borrow().are_of_cyclone(topic)
    }

    /// Waits until an answer on `topic` to that request reaches its client, but not for ever.
    pub(crate) async fn until_heard(&self, request: &RmwRequestId, topic: &str) {
        let client = GUID::from(request.writer_gid);
        let mut readers = self.0.subscribe();
        let heard = readers.wait_for(|readers| readers.hear(client, topic));
        // Both ways the answer is sent.
        let _ = tokio::time::timeout(LONGEST, heard).await;
    }
}

impl Readers {
    fn told(&mut self, reader: GUID, topic: String) {
        self.topics.insert(reader, topic);
    }

    fn are_of_cyclone(&self, topic: &str) -> bool {
        let mut servers = self.servers.iter().filter(|(_, of)| *of == topic).peekable();
        servers.peek().is_some() && servers.all(|(reader, _)| ROS.is_cyclone(*reader))
    }

    fn listen(&self, topic: &str) -> bool {
        self.found.iter().any(|reader| self.topics.get(reader).is_some_and(|of| of == topic))
    }

    fn found(&mut self, reader: GUID) -> bool {
        self.topics.contains_key(&reader) && self.found.insert(reader)
    }

    fn lost(&mut self, is_lost: impl Fn(&GUID) -> bool) -> bool {
        let before = self.topics.len();
        self.topics.retain(|reader, _| !is_lost(reader));
        self.found.retain(|reader| !is_lost(reader));
        self.servers.retain(|reader, _| !is_lost(reader));
        self.topics.len() < before
    }

    /// A request carries the reader of its answer where the client's middleware is Fast DDS, the
    /// writer of the request where it is RustDDS, and no more than the process where it is Cyclone
    /// DDS.
    fn hear(&self, client: GUID, topic: &str) -> bool {
        let listens = |reader: &GUID| self.topics.get(reader).is_some_and(|of| of == topic);
        if ROS.is_cyclone(client) {
            return self
                .found
                .iter()
                .any(|reader| process(*reader) == process(client) && listens(reader));
        }
        if client.entity_id.entity_kind.is_reader() {
            return self.found.contains(&client);
        }
        self.found.iter().any(|reader| reader.prefix == client.prefix && listens(reader))
    }
}

/// The topic of that absolute name, as DDS has it.
pub(crate) fn topic_of(name: &str) -> String {
    format!("rt{name}")
}

/// The topic on which a service of that absolute name answers, as DDS has it.
pub(crate) fn answers_of(service: &str) -> String {
    format!("{ANSWERS}{}Reply", service.trim_start_matches('/'))
}

/// The topic on which a service of that absolute name is asked, as DDS has it.
pub(crate) fn requests_of(service: &str) -> String {
    format!("{REQUESTS}{}Request", service.trim_start_matches('/'))
}

#[cfg(test)]
mod tests {
    use super::*;

    const READER: u8 = 0x04;
    const WRITER: u8 = 0x03;

    /// An endpoint of participant `participant`.
    fn endpoint(participant: u8, number: u8, kind: u8) -> GUID {
        let mut bytes = [participant; 16];
        bytes[12..].copy_from_slice(&[0, 0, number, kind]);
        GUID::from(Gid::from(bytes))
    }

    #[test]
    fn a_reader_named_by_the_request_is_heard_by_once_it_is_found() {
        let mut readers = Readers::default();
        let (reader, other) = (endpoint(1, 19, READER), endpoint(1, 20, READER));
        readers.told(reader, "rr/pingReply".into());
        assert!(!readers.hear(reader, "rr/pingReply"), "told of, not yet found");
        assert!(readers.found(reader));
        assert!(!readers.found(reader), "nothing new");
        assert!(readers.hear(reader, "rr/pingReply"));
        assert!(!readers.hear(other, "rr/pingReply"), "a second client of the same process");
        assert!(readers.lost(|lost| *lost == reader));
        assert!(!readers.hear(reader, "rr/pingReply"));
    }

    #[test]
    fn a_request_that_names_its_writer_is_answered_once_its_participant_listens_there() {
        let mut readers = Readers::default();
        let (writer, reader) = (endpoint(7, 1, WRITER), endpoint(7, 2, READER));
        readers.told(endpoint(7, 3, READER), "rr/pongReply".into());
        readers.found(endpoint(7, 3, READER));
        readers.told(endpoint(8, 2, READER), "rr/pingReply".into());
        readers.found(endpoint(8, 2, READER));
        assert!(!readers.hear(writer, "rr/pingReply"), "another topic, another participant");
        readers.told(reader, "rr/pingReply".into());
        readers.found(reader);
        assert!(readers.hear(writer, "rr/pingReply"));
        assert!(readers.lost(|lost| lost.prefix == reader.prefix));
        assert!(!readers.hear(writer, "rr/pingReply"));
        assert!(
            readers.hear(endpoint(8, 1, WRITER), "rr/pingReply"),
            "the other one is still there"
        );
    }

    #[test]
    fn a_request_of_cyclone_is_answered_once_its_process_listens_there() {
        let mut readers = Readers::default();
        let mut bytes = [1; 16];
        bytes[1] = 0x10;
        bytes[12..].copy_from_slice(&[0, 0, 1, READER]);
        let reader = GUID::from(Gid::from(bytes));
        // The second half is a number of the client: here one that looks like a reader.
        bytes[8..].copy_from_slice(&[9, 9, 9, 9, 9, 9, 9, READER]);
        let client = GUID::from(Gid::from(bytes));
        readers.told(reader, "rr/pingReply".into());
        assert!(!readers.hear(client, "rr/pingReply"), "told of, not yet found");
        readers.found(reader);
        assert!(readers.hear(client, "rr/pingReply"));
        assert!(!readers.hear(client, "rr/pongReply"));
    }

    #[test]
    fn a_service_is_asked_as_cyclone_reads_if_all_its_servers_are() {
        let mut readers = Readers::default();
        let mut bytes = endpoint(1, 1, READER).to_bytes();
        bytes[1] = 0x10;
        let (server, other) = (GUID::from(Gid::from(bytes)), endpoint(9, 1, READER));
        assert!(!readers.are_of_cyclone("rq/pingRequest"), "nobody serves");
        readers.servers.insert(server, "rq/pingRequest".into());
        assert!(readers.are_of_cyclone("rq/pingRequest"));
        assert!(!readers.are_of_cyclone("rq/pongRequest"));
        readers.servers.insert(other, "rq/pingRequest".into());
        assert!(!readers.are_of_cyclone("rq/pingRequest"), "one of another middleware serves too");
        readers.lost(|lost| *lost == other);
        assert!(readers.are_of_cyclone("rq/pingRequest"));
    }

    #[test]
    fn the_first_event_waits_for_who_listens_and_then_for_the_others() {
        const NEVER: Duration = Duration::from_secs(3600);
        let hearers = Hearers::default();
        let topic = topic_of("/axis_1/parameter_events");
        assert_eq!(topic, "rt/axis_1/parameter_events");
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build();
        runtime.expect("a runtime").block_on(async {
            let wait =
                |longest, quiet| hearers.until_listened_to(&topic, ForListeners { longest, quiet });
            let moment = Duration::from_millis(20);
            let waits = |wait| tokio::time::timeout(moment, wait);
            wait(Duration::ZERO, NEVER).await;
            assert!(waits(wait(NEVER, Duration::ZERO)).await.is_err(), "nobody listens");
            hearers.0.send_modify(|readers| readers.told(endpoint(1, 1, READER), topic.clone()));
            assert!(waits(wait(NEVER, Duration::ZERO)).await.is_err(), "told of, not yet found");
            hearers.0.send_modify(|readers| _ = readers.found(endpoint(1, 1, READER)));
            wait(NEVER, Duration::ZERO).await;
            assert!(waits(wait(NEVER, NEVER)).await.is_err(), "there may be others");
        });
    }

    #[test]
    fn only_readers_of_answers_are_kept() {
        let mut readers = Readers::default();
        assert!(!readers.found(endpoint(1, 1, READER)), "of a topic that is no answer's");
        assert!(readers.found.is_empty());
    }

    #[test]
    fn answers_have_the_topic_that_ros_gives_them() {
        assert_eq!(answers_of("/axis_1/controller/reset"), "rr/axis_1/controller/resetReply");
        assert_eq!(requests_of("/axis_1/controller/reset"), "rq/axis_1/controller/resetRequest");
    }
}
