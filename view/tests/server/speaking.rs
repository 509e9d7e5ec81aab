//! The protocol, as a viewer sees it.

use std::sync::atomic::Ordering;

use serde_json::json;

use crate::stranger::Server;

#[test]
fn a_viewer_hears_what_it_subscribes_to() {
    let server = Server::start("127.0.0.1");
    let mut viewer = server.viewer(None);
    let info = viewer.hear_op("serverInfo");
    assert!(info["capabilities"].as_array().unwrap().contains(&json!("clientPublish")));
    let channels = viewer.hear_op("advertise");
    assert_eq!(channels["channels"][0]["topic"], "/numbers");
    assert_eq!(viewer.hear_op("advertiseServices")["services"][0]["name"], "/stop");
    viewer.say(&json!({ "op": "subscribe", "subscriptions": [{ "id": 9, "channelId": 1 }] }));
    // The answer to a question shows that the subscription was taken.
    viewer.say(&json!({ "op": "getParameters", "parameterNames": [], "id": "x" }));
    assert_eq!(viewer.hear_op("parameterValues")["parameters"][0]["name"], "/a.b");
    server.view.hub().publish(server.channel, 7, b"{\"a\":1}");
    let bytes = viewer.hear_bytes();
    let expected = [&[1, 9, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0][..], b"{\"a\":1}"].concat();
    assert_eq!(bytes, expected);
    viewer.say(&json!({ "op": "subscribe", "subscriptions": [{ "id": 10, "channelId": 77 }] }));
    assert_eq!(viewer.hear_op("status")["message"], "there is no channel 77");
}

#[test]
fn a_refused_parameter_is_told_with_the_reason_and_the_value_that_counts() {
    let server = Server::start("127.0.0.1");
    let mut viewer = server.viewer(None);
    let parameter = json!({ "name": "/a.b", "value": 3 });
    viewer.say(&json!({ "op": "setParameters", "parameters": [parameter], "id": "s" }));
    let refused = viewer.hear_op("status");
    assert_eq!(refused["message"], "b must be 0 to 2, but is 3");
    assert_eq!(viewer.hear_op("parameterValues")["parameters"][0]["value"], 1.0);
}

#[test]
fn a_stop_does_not_wait_for_calls_that_do() {
    let server = Server::start("127.0.0.1");
    let mut viewer = server.viewer(None);
    for call in 0..30 {
        viewer.call(3, call);
    }
    viewer.call(1, 100);
    loop {
        let answer = viewer.hear_bytes();
        if answer[0] == 3 && answer[5..9] == 100_u32.to_le_bytes() {
            break;
        }
    }
    assert_eq!(server.stand_in.stopped.load(Ordering::SeqCst), 1);
}

#[test]
fn nonsense_is_told_and_ends_nothing() {
    let server = Server::start("127.0.0.1");
    let mut viewer = server.viewer(None);
    for text in ["", "{", "[]", "{\"op\":\"unknown\"}", "{\"op\":\"subscribe\"}", "null"] {
        viewer.socket.send(text.into()).unwrap();
        let told = viewer.hear_op("status");
        assert!(told["message"].as_str().unwrap().contains("cannot be read"), "{told}");
    }
    for bytes in [&b""[..], b"\x02", b"\xff", b"\x02\xff\xff\xff\xff\0\0\0\0\xff\xff\xff\xff"] {
        viewer.socket.send(bytes.to_vec().into()).unwrap();
        assert_eq!(viewer.hear_op("status")["message"], "a binary message cannot be read");
    }
    viewer.call(1, 1);
    assert_eq!(viewer.hear_bytes()[0], 3);
}
