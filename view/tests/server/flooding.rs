//! What strangers cost who ask for too much.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::json;

use crate::stranger::{PATIENCE, Server};

#[test]
fn a_viewer_that_does_not_read_loses_its_own_messages_only() {
    let server = Server::start("127.0.0.1");
    let subscribe = json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 1 }] });
    let ask = json!({ "op": "getParameters", "parameterNames": [], "id": "x" });
    let mut reading = server.viewer(None);
    let mut stuck = server.viewer(None);
    for viewer in [&mut reading, &mut stuck] {
        viewer.say(&subscribe);
        viewer.say(&ask);
        viewer.hear_op("parameterValues");
    }
    let message = vec![b'x'; 16 << 10];
    let mut number = 0_u64;
    let began = Instant::now();
    while server.view.hub().dropped() < 100 {
        assert!(began.elapsed() < PATIENCE, "nothing is lost");
        server.view.hub().publish(server.channel, number, &message);
        // The one that reads hears every message, in order.
        let bytes = reading.hear_bytes();
        assert_eq!(bytes[5..13], number.to_le_bytes());
        number += 1;
    }
    // The stuck one is told how many it lost, once it reads.
    let told = stuck.hear(|said| said["id"] == "losses");
    assert!(told["message"].as_str().unwrap().contains("left out"), "{told}");
}

#[test]
fn an_answer_overtakes_what_a_slow_viewer_has_not_read() {
    let server = Server::start("127.0.0.1");
    let mut viewer = server.viewer(None);
    viewer.say(&json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 1 }] }));
    viewer.say(&json!({ "op": "getParameters", "parameterNames": [], "id": "x" }));
    viewer.hear_op("parameterValues");
    // More than the system keeps between the two; it is given the time to.
    let message = vec![b'x'; 1 << 10];
    let began = Instant::now();
    let mut number = 0;
    while number < 32 << 10 || server.view.hub().dropped() < 1000 {
        assert!(began.elapsed() < PATIENCE, "nothing is lost");
        server.view.hub().publish(server.channel, number, &message);
        number += 1;
        if number % 64 == 0 {
            thread::sleep(Duration::from_millis(2));
        }
    }
    viewer.call(1, 5);
    let (mut before, mut last) = (0, 0);
    loop {
        let bytes = viewer.hear_bytes();
        if bytes[0] == 3 {
            break;
        }
        before += bytes.len();
        last = u64::from_le_bytes(bytes[5..13].try_into().unwrap());
    }
    // What was under way, and, where the answer was long in coming, what else waited.
    assert!(before < 3 << 19, "{before} bytes of messages came before the answer");
    // What it reads afterwards is the newest, and no more than a second of a rig's messages is old.
    let mut older = 0;
    while last + 1 < number {
        let bytes = viewer.hear_bytes();
        older += bytes.len();
        last = u64::from_le_bytes(bytes[5..13].try_into().unwrap());
    }
    assert!(older < 2 << 20, "{older} bytes of messages are older than the newest");
}

#[test]
fn a_huge_frame_ends_its_own_viewer() {
    let server = Server::start("127.0.0.1");
    let mut other = server.viewer(None);
    let mut huge = server.viewer(None);
    huge.hear_op("serverInfo");
    // A frame that says it is 2^62 bytes long.
    let mut head = vec![0x82, 0xff];
    head.extend((1_u64 << 62).to_be_bytes());
    head.extend([0; 4]);
    let stream = huge.socket.get_mut();
    stream.write_all(&head).unwrap();
    let mut rest = Vec::new();
    // It is shown out, by an end or by a reset.
    let _ = stream.read_to_end(&mut rest);
    other.call(1, 1);
    assert_eq!(other.hear_bytes()[0], 3);
}

#[test]
fn a_flood_of_questions_is_read_slowly_and_others_are_answered() {
    let server = Server::start("127.0.0.1");
    let address = server.address();
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        let mut flooding = server.viewer(None);
        flooding.socket.get_mut().set_write_timeout(Some(Duration::from_millis(200))).unwrap();
        let over = &over;
        scope.spawn(move || {
            let text = json!({ "op": "getParameters", "parameterNames": [], "id": "x" });
            while !over.load(Ordering::SeqCst) {
                // It is shown out at last, because it does not read its answers.
                if flooding.socket.send(text.to_string().into()).is_err() {
                    break;
                }
            }
        });
        for call in 0..20 {
            let mut viewer = server.viewer(None);
            viewer.call(1, call);
            assert_eq!(viewer.hear_bytes()[0], 3, "{address}");
        }
        over.store(true, Ordering::SeqCst);
    });
}

#[test]
fn a_thousand_sockets_leave_room_for_those_who_are_there() {
    let server = Server::start("127.0.0.1");
    let mut viewer = server.viewer(None);
    let mut sockets = Vec::new();
    for _ in 0..1000 {
        if let Ok(stream) = TcpStream::connect_timeout(&server.address(), Duration::from_secs(5)) {
            sockets.push(stream);
        }
    }
    viewer.call(1, 1);
    assert_eq!(viewer.hear_bytes()[0], 3);
    // Those that were half open are closed after a while, and others come in again.
    let began = Instant::now();
    loop {
        let host = server.address();
        let answered = TcpStream::connect(host).is_ok_and(|mut stream| {
            let _ = stream.set_read_timeout(Some(Duration::from_secs(2)));
            let mut answer = [0; 12];
            write!(stream, "GET / HTTP/1.1\r\nHost: {host}\r\n\r\n").is_ok()
                && stream.read_exact(&mut answer).is_ok()
                && &answer == b"HTTP/1.1 200"
        });
        if answered {
            break;
        }
        assert!(began.elapsed() < PATIENCE, "no way in any more");
        thread::sleep(Duration::from_millis(100));
    }
}

#[test]
fn more_viewers_than_can_be_are_told_so() {
    let server = Server::start("127.0.0.1");
    let mut viewers: Vec<_> = (0..16).map(|_| server.viewer(None)).collect();
    let host = server.address();
    let head = format!(
        "GET / HTTP/1.1\r\nHost: {host}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: foxglove.sdk.v1"
    );
    assert_eq!(server.status(&head), 503);
    viewers.pop();
    let began = Instant::now();
    while server.status(&head) != 101 {
        assert!(began.elapsed() < PATIENCE, "a viewer that left keeps its place");
    }
}

#[test]
fn a_viewer_that_is_silent_has_gone() {
    let server = Server::start("127.0.0.1");
    let mut viewer = server.viewer(None);
    viewer.hear_op("serverInfo");
    // It reads nothing, so it does not say that it lives either.
    let began = Instant::now();
    while server.view.hub().viewers() > 0 {
        assert!(began.elapsed() < PATIENCE, "it stays for ever");
        thread::sleep(Duration::from_millis(50));
    }
}
