//! A service apart answers whatever the rest of its node does.

use std::{
    sync::{
        Mutex,
        atomic::{AtomicU32, Ordering},
        mpsc::channel,
    },
    thread,
    time::{Duration, Instant},
};

use msgs::{
    RosMessage,
    friction_msgs::{MotorVoltage, Reference},
    std_msgs::Header,
    std_srvs::{Trigger, TriggerRequest, TriggerResponse},
    topics,
};
use ros_node::{Discovery, Participant};
use tests::network::{namespaced, run_ignored};

const PATIENCE: Duration = Duration::from_secs(60);

fn until(what: &str, mut done: impl FnMut() -> bool) {
    let began = Instant::now();
    while !done() {
        assert!(began.elapsed() < PATIENCE, "{what}");
        thread::sleep(Duration::from_millis(10));
    }
}

#[tests::needs(namespace)]
#[test]
fn it_answers_while_all_shared_threads_are_stuck() {
    run_ignored(namespaced(), "stuck", &[]);
}

#[test]
#[ignore = "speaks DDS: run in a network namespace by the test above"]
fn stuck() {
    static STUCK: AtomicU32 = AtomicU32::new(0);
    let discovery = Discovery { domain: 91, ..Discovery::default() };
    let (participant, other) =
        (Participant::join(&discovery).unwrap(), Participant::join(&discovery).unwrap());
    let (node, asking) = (participant.node("stuck").unwrap(), other.node("asking").unwrap());
    let (asked, asks) = channel();
    node.serve_apart::<Trigger>("~/stop", move |_| {
        let _ = asked.send(thread::current().id());
        TriggerResponse { success: true, message: "stopped".into() }
    })
    .unwrap();

    let (free, waits) = channel::<()>();
    let waits = std::sync::Arc::new(Mutex::new(waits));
    let block = move || {
        STUCK.fetch_add(1, Ordering::Relaxed);
        let _ = waits.lock().unwrap().recv();
    };
    let again = block.clone();
    node.subscribe(&topics::MOTOR_VOLTAGE, move |_| block()).unwrap();
    node.subscribe(&topics::REFERENCE, move |_| again()).unwrap();
    let volts = asking.publisher(&topics::MOTOR_VOLTAGE).unwrap();
    let references = asking.publisher(&topics::REFERENCE).unwrap();
    until("both of the node's shared threads are stuck", || {
        let _ = volts.publish(MotorVoltage { header: Header::at(1), voltage: 0.0 });
        let _ = references.publish(Reference { header: Header::at(1), ..Default::default() });
        STUCK.load(Ordering::Relaxed) == 2
    });

    // A client that was not there before: its reader has to be found.
    let stop = asking.client::<Trigger>("/stuck/stop").unwrap();
    let answer = stop.call_until_answered(&TriggerRequest::default(), PATIENCE).unwrap();
    assert!(answer.success, "{}", MotorVoltage::type_name());
    assert!(asks.try_iter().all(|id| id != thread::current().id()));
    // And the stuck node still leaves.
    let began = Instant::now();
    drop(node);
    drop(participant);
    assert!(began.elapsed() < PATIENCE);
    assert!(asks.recv().is_err(), "the service's thread has ended");
    drop(free);
}
