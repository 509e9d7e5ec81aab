//! A topic of which one writer counts: [`OneWriter`] with names, a log and figures for
//! `/diagnostics`.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use msgs::diagnostic_msgs::KeyValue;

use crate::{
    Graph, Logger, Named, RosNode, RosNodeError,
    deadlines::now_ns,
    one_writer::{OneWriter, Verdict, WriterId},
};

/// Shortest time between two lines of the log about strangers \[ns\].
const LINES: u64 = 10_000_000_000;

/// Lets one writer of a topic through. Clones are one.
///
/// It goes by the GUID in each message, which is not authenticated unless DDS Security is: see
/// [`one_writer`](crate::one_writer).
#[derive(Clone)]
pub struct Gate(Arc<Inner>);

struct Inner {
    topic: String,
    graph: Graph,
    logger: Logger,
    state: Mutex<State>,
}

struct State {
    one: OneWriter,
    /// Absolute name of the only node that may be obeyed; empty for any.
    only: String,
    refused: u64,
    /// How many were refused when it was told last.
    told: u64,
    last: Option<(WriterId, Why)>,
    logged: Option<u64>,
}

/// Why a message was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Why {
    Other(WriterId),
    Contested(WriterId),
    NotNamed,
}

/// What becomes of a message, told by who sent it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passes {
    /// It counts.
    Yes {
        /// It is the first of its writer.
        first: bool,
    },
    /// It does not. If it is a stranger's, that was counted and will be told.
    No,
}

/// What a gate tells of the time since it was asked last.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GateReport {
    /// For `/diagnostics`: who is obeyed, who spoke within the last half second, and how many messages
    /// of others were refused since the start.
    pub values: Vec<KeyValue>,
    /// Messages were refused since it was asked last: a sentence that says whose.
    pub error: Option<String>,
}

/// Two writers of one topic, of whom none may be preferred.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "two publish on {topic} at the same time, {one} and {other}, and none may be preferred; end one of them"
)]
pub struct TwoWriters {
    /// Absolute name of the topic.
    pub topic: String,
    /// One of them, as far as the graph tells.
    pub one: String,
    /// The other.
    pub other: String,
}

impl Gate {
    /// A gate, closed, for the topic that the code calls `topic`. After `handover` of silence
    /// another writer may follow the one that is obeyed.
    ///
    /// # Errors
    /// [`RosNodeError`] if the name is none, or the middleware does not tell who is there.
    pub fn new(
        node: &RosNode,
        topic: &str,
        handover: Option<Duration>,
    ) -> Result<Self, RosNodeError> {
        let topic = node.resolve(Named::Topic, topic)?;
        Ok(Self::of(topic, node.graph()?, node.logger().clone(), handover))
    }

    fn of(topic: String, graph: Graph, logger: Logger, handover: Option<Duration>) -> Self {
        let one = OneWriter::new(handover.map(nanoseconds));
        let state =
            State { one, only: String::new(), refused: 0, told: 0, last: None, logged: None };
        Self(Arc::new(Inner { topic, graph, logger, state: Mutex::new(state) }))
    }

    /// Only the node of that absolute name may be obeyed from now on, as far as the graph tells; an
    /// empty name is any.
    pub fn only(&self, node: &str) {
        node.clone_into(&mut self.state().only);
    }

    /// From now on that silence lets another writer follow.
    pub fn hand_over_after(&self, silence: Duration) {
        self.state().one.hand_over_after(nanoseconds(silence));
    }

    /// Obeys the first that speaks from now on.
    ///
    /// # Errors
    /// [`TwoWriters`] names two that spoke within the last half second: none may be preferred,
    /// unless [`only`](Self::only) says which.
    pub fn open(&self) -> Result<(), TwoWriters> {
        let mut state = self.state();
        if !state.only.is_empty() {
            // The name says who is preferred.
            state.one.open_first();
            return Ok(());
        }
        let opened = state.one.open(now_ns());
        drop(state);
        opened.map_err(|(one, other)| TwoWriters {
            topic: self.0.topic.clone(),
            one: self.told(one),
            other: self.told(other),
        })
    }

    /// Obeys the first that speaks from now on, once no other was heard for half a second.
    pub fn open_contested(&self) {
        self.state().one.open_contested();
    }

    /// Obeys nobody from now on.
    pub fn close(&self) {
        self.state().one.close();
    }

    /// Takes notice of a message of `writer`, and says whether it counts.
    pub fn hear(&self, writer: WriterId) -> Passes {
        let now = now_ns();
        let mut state = self.state();
        let may = state.only.is_empty()
            || state.one.owner() == Some(writer)
            || self.is(&state.only, writer);
        let why = if may {
            let mut verdict = state.one.hear(writer, now);
            if let Verdict::Other(owner) = verdict
                && state.one.hands_over()
                && self.0.graph.has_left(owner)
            {
                state.one.let_go();
                verdict = state.one.hear(writer, now);
            }
            match verdict {
                Verdict::Taken { first } => return Passes::Yes { first },
                Verdict::Closed => return Passes::No,
                Verdict::Other(owner) => Why::Other(owner),
                Verdict::Contested(rival) => Why::Contested(rival),
            }
        } else {
            if !state.one.is_open() {
                return Passes::No;
            }
            Why::NotNamed
        };
        state.refused += 1;
        state.last = Some((writer, why));
        if state.logged.is_none_or(|logged| now.saturating_sub(logged) >= LINES) {
            state.logged = Some(now);
            let text = self.sentence(&state, state.refused);
            drop(state);
            self.0.logger.error(&text);
        }
        Passes::No
    }

    /// What is to be told since the last report.
    #[must_use]
    pub fn report(&self) -> GateReport {
        let mut state = self.state();
        let owner = state.one.owner().map_or_else(|| "nobody".to_owned(), |owner| self.told(owner));
        let heard: Vec<String> =
            state.one.heard(now_ns()).map(|writer| self.told(writer)).collect();
        let heard = if heard.is_empty() { "nobody".to_owned() } else { heard.join(", ") };
        let topic = &self.0.topic;
        let value = |key: String, value: String| KeyValue { key, value };
        let values = vec![
            value(format!("{topic} is taken from"), owner),
            value(format!("{topic} refused from others"), state.refused.to_string()),
            value(format!("{topic} is heard from"), heard),
        ];
        let new = state.refused - state.told;
        let error = (new > 0).then(|| self.sentence(&state, new));
        state.told = state.refused;
        GateReport { values, error }
    }

    fn sentence(&self, state: &State, count: u64) -> String {
        let topic = &self.0.topic;
        let Some((writer, why)) = state.last else { return String::new() };
        let writer = self.told(writer);
        let refused =
            format!("{count} messages of others on {topic} were refused, the last from {writer}");
        match why {
            Why::Other(owner) => {
                format!(
                    "{refused}: it is taken from {} only; end the other publisher",
                    self.told(owner)
                )
            }
            Why::Contested(rival) => {
                format!(
                    "{refused}: {} publishes too, and none may be preferred; end one of them",
                    self.told(rival)
                )
            }
            Why::NotNamed => {
                format!(
                    "{refused}: it is taken from the node {} only; end the other publisher",
                    state.only
                )
            }
        }
    }

    /// Whether the graph tells that a writer is that node's.
    fn is(&self, node: &str, writer: WriterId) -> bool {
        self.0.graph.node_of(writer).is_some_and(|name| name == node)
    }

    /// A writer with its node's name, as far as the graph tells.
    fn told(&self, writer: WriterId) -> String {
        let node = self
            .0
            .graph
            .node_of(writer)
            .unwrap_or_else(|| "a node that does not tell its name".to_owned());
        format!("{} (GUID {writer})", crate::quoted(&node))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LogLevel, NodeClock};

    const A: WriterId = WriterId([1; 16]);
    const B: WriterId = WriterId([2; 16]);

    fn gate(handover: Option<Duration>) -> Gate {
        let logger = Logger::new(
            "test".into(),
            LogLevel::Fatal,
            false,
            NodeClock::default(),
            None,
            crate::inside::Ears::default(),
        );
        Gate::of("/motor_voltage".into(), Graph::default(), logger, handover)
    }

    #[test]
    fn a_stranger_is_told_while_it_comes_and_no_longer() {
        let gate = gate(None);
        assert_eq!(gate.hear(B), Passes::No);
        assert_eq!(gate.report().error, None, "before activation everybody may speak");
        gate.open().unwrap();
        assert_eq!(gate.hear(A), Passes::Yes { first: true });
        assert_eq!(gate.hear(A), Passes::Yes { first: false });
        assert_eq!(gate.report().error, None);
        (0..3).for_each(|_| assert_eq!(gate.hear(B), Passes::No));
        let report = gate.report();
        let said = report.error.unwrap();
        assert!(said.starts_with("3 messages of others on /motor_voltage were refused"), "{said}");
        assert!(said.contains(&A.to_string()) && said.contains(&B.to_string()), "{said}");
        assert!(report.values[0].value.contains(&A.to_string()) && report.values[1].value == "3");
        assert_eq!(gate.report().error, None);
        gate.close();
        assert_eq!(gate.report().values[0].value, "nobody");
        let heard = &gate.report().values[2].value;
        assert!(heard.contains(&A.to_string()) && heard.contains(&B.to_string()), "{heard}");
    }

    #[test]
    fn two_before_activation_are_both_named() {
        let gate = gate(None);
        assert_eq!(gate.report().values[2].value, "nobody");
        gate.hear(A);
        gate.hear(B);
        let said = gate.open().unwrap_err().to_string();
        assert!(said.contains(&A.to_string()) && said.contains(&B.to_string()), "{said}");
        assert_eq!(gate.hear(A), Passes::No);
    }

    #[test]
    fn who_is_not_the_named_node_is_refused_and_does_not_stand_in_the_way() {
        let gate = gate(None);
        gate.hear(A);
        gate.hear(B);
        gate.only("/controller");
        assert_eq!(gate.hear(B), Passes::No);
        assert_eq!(gate.report().error, None, "before activation everybody may speak");
        gate.open().unwrap();
        assert_eq!(gate.hear(A), Passes::No);
        assert!(gate.report().error.unwrap().contains("the node /controller only"));
    }

    #[test]
    fn another_may_follow_one_that_has_left() {
        let gate = gate(Some(Duration::from_secs(60)));
        gate.open_contested();
        assert_eq!(gate.hear(A), Passes::Yes { first: true });
        assert_eq!(gate.hear(B), Passes::No);
        gate.0.graph.lost_writer(A);
        assert_eq!(gate.hear(B), Passes::Yes { first: true });
    }
}
