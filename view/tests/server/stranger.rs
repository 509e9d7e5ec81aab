//! A view with a stand-in behind it, and strangers who speak to it.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use serde_json::{Value, json};
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::protocol::WebSocket;
use tokio_tungstenite::tungstenite::{Message, client};
use view::{
    Access, Channel, ChannelId, Hub, Parameter, Service, Shown, Steering, View, ViewOptions,
};

/// Longest wait for what must come.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// Counts what it is asked for.
#[derive(Default)]
pub struct StandIn {
    pub stopped: AtomicUsize,
    pub changed: AtomicUsize,
    pub said: AtomicUsize,
}

impl Steering for StandIn {
    fn services(&self) -> Vec<Service> {
        let service = |name: &str, access, stops| Service {
            name: name.to_owned(),
            kind: "std_srvs/srv/Trigger".to_owned(),
            request: json!({}),
            response: json!({ "success": false, "message": "" }),
            access,
            stops,
        };
        vec![
            service("/stop", Access::Full, true),
            service("/list", Access::ReadOnly, false),
            service("/slow", Access::Full, false),
        ]
    }

    fn call(&self, service: &str, _: Value) -> Result<Value, String> {
        match service {
            "/stop" => {
                self.stopped.fetch_add(1, Ordering::SeqCst);
                Ok(json!({ "success": true, "message": "stopped" }))
            }
            "/list" => Ok(json!({ "success": true, "message": "a list" })),
            _ => {
                std::thread::sleep(Duration::from_millis(300));
                Err("it is slow".to_owned())
            }
        }
    }

    fn parameters(&self, _: &[String]) -> Result<Vec<Parameter>, String> {
        Ok(vec![Parameter { name: "/a.b".into(), value: json!(1.0), kind: None }])
    }

    fn set_parameters(&self, _: Vec<Parameter>) -> Result<(), String> {
        self.changed.fetch_add(1, Ordering::SeqCst);
        Err("b must be 0 to 2, but is 3".to_owned())
    }

    fn file(&self, folder: u32, name: &str) -> Option<Shown> {
        let known = (folder, name) == (7, "report.html");
        known.then(|| Shown { kind: "text/html; charset=utf-8", bytes: b"<p>a report".to_vec() })
    }

    fn publish(&self, _: &str, _: Value) -> Result<(), String> {
        self.said.fetch_add(1, Ordering::SeqCst);
        Ok(())
    }
}

/// A running view with one channel, `/numbers`.
pub struct Server {
    pub view: View,
    pub channel: ChannelId,
    pub stand_in: Arc<StandIn>,
}

impl Server {
    pub fn start(address: &str) -> Self {
        Self::with(ViewOptions { address: address.parse().unwrap(), ..ViewOptions::default() })
    }

    pub fn with(options: ViewOptions) -> Self {
        let stand_in = Arc::new(StandIn::default());
        let options = ViewOptions { port: Some(0), ..options };
        let hub = Hub::default();
        let channel = hub.offer(Channel {
            topic: "/numbers".into(),
            latched: false,
            ..Channel::latched_json("/numbers", "Numbers")
        });
        let steering: Arc<dyn Steering> = stand_in.clone();
        let view = View::start(&options, hub, steering).unwrap();
        Self { view, channel, stand_in }
    }

    /// Where it is reached from this machine.
    pub fn address(&self) -> SocketAddr {
        SocketAddr::from(([127, 0, 0, 1], self.view.address().port()))
    }

    /// The word behind `#token=` of an address.
    pub fn token(&self, read_only: bool) -> String {
        let (full, other) = self.view.urls();
        let url = if read_only { other.unwrap() } else { full };
        url.split_once("#token=").unwrap().1.to_owned()
    }

    /// What is answered to a plain request with these headers: the status.
    pub fn status(&self, headers: &str) -> u16 {
        let answer = self.answer(headers);
        answer.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0)
    }

    pub fn answer(&self, head: &str) -> String {
        let mut stream = TcpStream::connect(self.address()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.write_all(format!("{head}\r\n\r\n").as_bytes()).unwrap();
        let mut answer = Vec::new();
        let mut part = [0; 4096];
        // A socket stays open: the head is enough.
        while !answer.windows(4).any(|four| four == b"\r\n\r\n") {
            match stream.read(&mut part) {
                Ok(0) | Err(_) => break,
                Ok(count) => answer.extend_from_slice(&part[..count]),
            }
        }
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// A viewer that speaks the protocol.
    pub fn viewer(&self, token: Option<&str>) -> Viewer {
        let mut request = format!("ws://{}/", self.address()).into_client_request().unwrap();
        let spoken = match token {
            None => "foxglove.websocket.v1".to_owned(),
            Some(token) => format!("foxglove.websocket.v1, token.{token}"),
        };
        request.headers_mut().insert("Sec-WebSocket-Protocol", spoken.parse().unwrap());
        let stream = TcpStream::connect(self.address()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let (socket, _) = client::client(request, stream).unwrap();
        Viewer { socket }
    }
}

/// A viewer's end of the socket.
pub struct Viewer {
    pub socket: WebSocket<TcpStream>,
}

impl Viewer {
    pub fn say(&mut self, what: &Value) {
        self.socket.send(Message::text(what.to_string())).unwrap();
    }

    /// A call in bytes.
    pub fn call(&mut self, service: u32, call: u32) {
        let mut bytes = vec![2];
        bytes.extend(service.to_le_bytes());
        bytes.extend(call.to_le_bytes());
        bytes.extend(4_u32.to_le_bytes());
        bytes.extend(b"json{}");
        self.socket.send(Message::binary(bytes)).unwrap();
    }

    /// The next thing in JSON of which `wanted` is true.
    pub fn hear(&mut self, wanted: impl Fn(&Value) -> bool) -> Value {
        loop {
            if let Message::Text(text) = self.socket.read().unwrap() {
                let said: Value = serde_json::from_str(&text).unwrap();
                if wanted(&said) {
                    return said;
                }
            }
        }
    }

    pub fn hear_op(&mut self, op: &str) -> Value {
        self.hear(|said| said["op"] == op)
    }

    /// The next thing in bytes.
    pub fn hear_bytes(&mut self) -> Vec<u8> {
        loop {
            if let Message::Binary(bytes) = self.socket.read().unwrap() {
                return bytes.to_vec();
            }
        }
    }
}
