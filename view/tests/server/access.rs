//! Whose page asks, and who has which token.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use serde_json::json;
use view::{Hub, View, ViewError, ViewOptions};

use crate::stranger::{Server, StandIn};

/// The head of an upgrade with these headers.
fn upgrade(host: &str, more: &str) -> String {
    format!(
        "GET / HTTP/1.1\r\nHost: {host}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{more}"
    )
}

const SPOKEN: &str = "Sec-WebSocket-Protocol: foxglove.websocket.v1";

#[test]
fn the_page_comes_with_a_strict_policy() {
    let server = Server::start("127.0.0.1");
    let host = server.address();
    let answer = server.answer(&format!("GET / HTTP/1.1\r\nHost: {host}"));
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    let answer = answer.to_ascii_lowercase();
    assert!(answer.contains("content-security-policy: default-src 'none'; script-src 'self'"));
    assert!(!answer.contains("unsafe-inline"));
    assert!(answer.contains("x-frame-options: deny"));
    assert_eq!(server.status(&format!("GET /other HTTP/1.1\r\nHost: {host}")), 404);
    assert_eq!(server.status(&format!("POST / HTTP/1.1\r\nHost: {host}")), 405);
}

#[test]
fn a_name_that_somebody_points_here_is_not_answered() {
    let server = Server::start("127.0.0.1");
    let port = server.address().port();
    let evil = format!("evil.example:{port}");
    assert_eq!(server.status(&format!("GET / HTTP/1.1\r\nHost: {evil}")), 421);
    assert_eq!(server.status("GET / HTTP/1.1\r\nX: y"), 421);
    let more = format!("Origin: http://{evil}\r\n{SPOKEN}");
    assert_eq!(server.status(&upgrade(&evil, &more)), 421);
}

#[test]
fn another_page_opens_no_socket() {
    let server = Server::start("127.0.0.1");
    let host = server.address().to_string();
    let with = |origin: &str| format!("Origin: {origin}\r\n{SPOKEN}");
    for origin in ["http://evil.example", "null", "https://app.foxglove.dev", "file://"] {
        assert_eq!(server.status(&upgrade(&host, &with(origin))), 403, "{origin}");
    }
    assert_eq!(server.status(&upgrade(&host, &with(&format!("http://{host}")))), 101);
    // A program that is no browser says no origin.
    assert_eq!(server.status(&upgrade(&host, SPOKEN)), 101);
    assert_eq!(server.status(&upgrade(&host, "X: y")), 400, "no protocol that is spoken here");
}

/// The network of nodes is secured: another user of this machine must not steer by the view's key.
#[test]
fn where_a_token_is_wanted_this_machine_needs_one_too() {
    let server = Server::with(ViewOptions { token: true, ..ViewOptions::default() });
    let host = server.address().to_string();
    assert_eq!(server.status(&upgrade(&host, SPOKEN)), 401);
    let known = format!("{SPOKEN}, token.{}", server.token(false));
    assert_eq!(server.status(&upgrade(&host, &known)), 101);
}

#[test]
fn an_address_of_another_machine_is_told_from_a_port_that_is_taken() {
    let options = ViewOptions { address: "192.0.2.1".parse().unwrap(), ..ViewOptions::default() };
    let error = View::start(&options, Hub::default(), Arc::new(StandIn::default())).unwrap_err();
    assert!(matches!(error, ViewError::NotHere { .. }) && error.is_bad_input(), "{error}");
}

#[test]
fn on_the_network_only_a_token_opens_the_socket() {
    let server = Server::start("0.0.0.0");
    let host = server.address().to_string();
    let full = server.token(false);
    assert_eq!(server.status(&upgrade(&host, SPOKEN)), 401);
    for wrong in ["", "0", &full[1..], &format!("{full}0"), &full.replace('a', "b").to_uppercase()]
    {
        let more = format!("{SPOKEN}, token.{wrong}");
        assert_eq!(server.status(&upgrade(&host, &more)), 401, "{wrong}");
    }
    assert_eq!(server.status(&upgrade(&host, &format!("{SPOKEN}, token.{full}"))), 101);
    let by_query = upgrade(&host, SPOKEN).replace("GET / ", &format!("GET /?token={full} "));
    assert_eq!(server.status(&by_query), 101);
    // The page itself holds no secret.
    assert_eq!(server.status(&format!("GET / HTTP/1.1\r\nHost: {host}")), 200);
}

#[test]
fn a_file_is_shown_to_who_was_let_in_and_reaches_nobody() {
    let server = Server::start("0.0.0.0");
    let host = server.address();
    let get = |path: &str| format!("GET {path} HTTP/1.1\r\nHost: {host}");
    let mut viewer = server.viewer(Some(&server.token(true)));
    let files = viewer.hear_op("serverInfo")["metadata"]["files"].as_str().unwrap().to_owned();
    let answer = server.answer(&get(&format!("{files}7/report.html"))).to_ascii_lowercase();
    assert!(answer.starts_with("http/1.1 200"), "{answer}");
    assert!(answer.contains("content-security-policy: sandbox allow-scripts"), "{answer}");
    assert!(answer.contains("default-src 'none'") && !answer.contains("allow-same-origin"));
    assert!(answer.contains("referrer-policy: no-referrer"));
    let other = "/files/0000000000000000000000000000000000000000/7/report.html".to_owned();
    for wrong in [
        other,
        "/files/7/report.html".to_owned(),
        format!("{files}8/report.html"),
        format!("{files}7/other.html"),
        format!("{files}7/../7/report.html"),
        format!("{files}7/%2e%2e/report.html"),
        format!("{files}7/report.html/"),
    ] {
        assert_eq!(server.status(&get(&wrong)), 404, "{wrong}");
    }
    // The key opens no socket.
    let key = files.trim_start_matches("/files/").trim_end_matches('/');
    let more = format!("{SPOKEN}, token.{key}");
    assert_eq!(server.status(&upgrade(&host.to_string(), &more)), 401);
}

#[test]
fn who_may_only_look_changes_nothing() {
    let server = Server::start("0.0.0.0");
    let mut viewer = server.viewer(Some(&server.token(true)));
    assert_eq!(viewer.hear_op("serverInfo")["metadata"]["access"], "read-only");
    viewer.call(1, 1);
    let refused = viewer.hear_op("serviceCallFailure");
    assert_eq!(refused["message"], "this viewer may only look");
    viewer.say(&json!({ "op": "setParameters", "parameters": [{ "name": "/a.b", "value": 3 }] }));
    assert_eq!(viewer.hear_op("status")["message"], "this viewer may only look");
    let channel = json!({ "id": 1, "topic": "/motor_voltage", "encoding": "json" });
    viewer.say(&json!({ "op": "advertise", "channels": [channel] }));
    let message = [&[1, 1, 0, 0, 0][..], b"{\"voltage\":1}"].concat();
    viewer.socket.send(message.into()).unwrap();
    assert_eq!(viewer.hear_op("status")["message"], "this viewer may only look");
    // What only looks is answered.
    viewer.call(2, 2);
    assert_eq!(viewer.hear_bytes()[0], 3);
    let stand_in = &server.stand_in;
    for count in [&stand_in.stopped, &stand_in.changed, &stand_in.said] {
        assert_eq!(count.load(Ordering::SeqCst), 0);
    }
}
