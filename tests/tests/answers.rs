//! A service's answer reaches a client whose reader is found only after the request: RustDDS alone
//! would leave it out for good.

use std::fmt::Debug;
use std::net::{IpAddr, Ipv4Addr};
use std::process::Command;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use msgs::friction_msgs::{RunExperiment, RunExperimentGoal};
use msgs::std_srvs::{Trigger, TriggerRequest, TriggerResponse};
use ros_node::{ActionHandler, Discovery, Goal, GoalId, Participant};
use rustdds::no_key::{DataReader, DataWriter};
use rustdds::policy::{Durability, History, Reliability};
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, QosPolicies, QosPolicyBuilder, Topic, TopicKind,
};
use serde::{Deserialize, Serialize};

/// Set where the test runs itself in a namespace.
const INSIDE: &str = "FRICTION_ANSWERS_INSIDE";
/// Longest wait for what must come.
const PATIENCE: Duration = Duration::from_secs(30);
/// Time that answers have to get lost.
const MUTE: Duration = Duration::from_secs(1);

#[tests::needs(namespace)]
#[test]
fn answers_wait_for_a_reader_that_is_found_late() {
    if std::env::var_os(INSIDE).is_some() {
        return inside();
    }
    let mut command = tests::network::namespaced();
    let this = std::env::current_exe().expect("a test knows its program");
    command.arg(this).args([
        "--exact",
        "answers_wait_for_a_reader_that_is_found_late",
        "--nocapture",
    ]);
    passes(command.env(INSIDE, "1"));
}

fn passes(command: &mut Command) {
    let output = command.output().expect("unshare starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("1 passed"), "{said}");
}

/// Starts no experiment: it tells that it was asked.
struct Asked(Sender<()>);

impl ActionHandler<RunExperiment> for Asked {
    fn start(&self, _: RunExperimentGoal, _: Goal<RunExperiment>) {
        let _ = self.0.send(());
    }

    fn cancel(&self, _: GoalId) -> bool {
        false
    }
}

/// A goal as it travels.
#[derive(Debug, Serialize)]
struct SendGoal {
    id: [u8; 16],
    goal: RunExperimentGoal,
}

/// Its answer as it travels.
#[derive(Deserialize)]
struct GoalAnswer {
    accepted: bool,
    _seconds: i32,
    _nanoseconds: u32,
}

fn inside() {
    let server = Participant::join(&Discovery::default()).expect("joins");
    let node = server.node("server").expect("a node");
    let (tell, asked) = channel();
    let told = tell.clone();
    node.serve::<Trigger>("/ping", move |_| {
        let _ = told.send(());
        TriggerResponse { success: true, message: "pong".into() }
    })
    .expect("a service");
    let _action = node.serve_action::<RunExperiment>("/go", Asked(tell)).expect("an action");

    let client = Client::new();
    client.ask("rq/pingRequest", &TriggerRequest::default(), &asked);
    let answer: TriggerResponse = client.answer("rr/pingReply");
    assert_eq!(answer, TriggerResponse { success: true, message: "pong".into() });

    let goal = SendGoal { id: [7; 16], goal: RunExperimentGoal::default() };
    client.ask("rq/go/_action/send_goalRequest", &goal, &asked);
    let answer: GoalAnswer = client.answer("rr/go/_action/send_goalReply");
    assert!(answer.accepted);
}

/// A bare participant, which reads answers only when it is told to.
struct Client {
    participant: DomainParticipant,
    qos: QosPolicies,
}

impl Client {
    fn new() -> Self {
        let participant = DomainParticipantBuilder::new(0)
            .with_only_networks(vec![IpAddr::V4(Ipv4Addr::LOCALHOST)])
            .build()
            .expect("joins");
        let qos = QosPolicyBuilder::new()
            .reliability(Reliability::Reliable {
                max_blocking_time: rustdds::Duration::from_millis(100),
            })
            .durability(Durability::Volatile)
            .history(History::KeepLast { depth: 10 })
            .build();
        Self { participant, qos }
    }

    fn topic(&self, name: &str) -> Topic {
        let kind = "any".to_owned();
        self.participant
            .create_topic(name.to_owned(), kind, &self.qos, TopicKind::NoKey)
            .expect("a topic")
    }

    /// Asks until the server says that it heard; then gives its answer time to get lost.
    fn ask<Q: Serialize + Debug>(&self, topic: &str, request: &Q, asked: &Receiver<()>) {
        let publisher = self.participant.create_publisher(&self.qos).expect("a publisher");
        let writer: DataWriter<&Q> =
            publisher.create_datawriter_no_key_cdr(&self.topic(topic), None).expect("a writer");
        let until = Instant::now() + PATIENCE;
        loop {
            writer.write(request, None).expect("room for a request");
            match asked.recv_timeout(Duration::from_millis(500)) {
                Ok(()) => break,
                Err(_) => assert!(Instant::now() < until, "nobody heard the request on {topic}"),
            }
        }
        thread::sleep(MUTE);
    }

    /// Begins to listen, and waits for an answer.
    fn answer<A: for<'a> Deserialize<'a> + 'static>(&self, topic: &str) -> A {
        let subscriber = self.participant.create_subscriber(&self.qos).expect("a subscriber");
        let mut reader: DataReader<A> =
            subscriber.create_datareader_no_key_cdr(&self.topic(topic), None).expect("a reader");
        let until = Instant::now() + PATIENCE;
        loop {
            if let Some(sample) = reader.take_next_sample().expect("what comes is an answer") {
                return sample.into_value();
            }
            assert!(Instant::now() < until, "no answer on {topic}");
            thread::sleep(Duration::from_millis(20));
        }
    }
}
