//! Viewers of `frictionlab live`, where they hear it: most read all that comes, some stop reading.

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};
use tokio_tungstenite::tungstenite::client::{IntoClientRequest, client};
use tokio_tungstenite::tungstenite::protocol::WebSocket;
use tokio_tungstenite::tungstenite::{Error, Message};

/// Of how many viewers one stops reading.
const STOPS: u32 = 3;
/// How long a viewer waits for the next message before it looks whether it is over.
const PATIENCE: Duration = Duration::from_millis(500);

/// Runs `live` with so many viewers until it ends by itself.
///
/// # Errors
/// If it fails, a viewer is not let in, or those who read hear nothing.
pub(super) fn watch(mut live: Command, viewers: u32) -> Result<()> {
    let mut live = live.stdout(Stdio::piped()).spawn().context("starting frictionlab live")?;
    let watched = look(&mut live, viewers);
    let status = live.wait().context("waiting for frictionlab live")?;
    let (reading, over) = watched?;
    over.store(true, Ordering::Release);
    for viewer in reading {
        let heard = viewer.join().map_err(|_| anyhow::anyhow!("a viewer panicked"))??;
        ensure!(heard > 0, "a viewer that reads heard nothing");
    }
    ensure!(status.success(), "frictionlab live ended with {status}");
    Ok(())
}

type Reading = Vec<JoinHandle<Result<u64>>>;

/// Lets the viewers in.
fn look(live: &mut Child, viewers: u32) -> Result<(Reading, Arc<AtomicBool>)> {
    let mut lines = BufReader::new(live.stdout.take().context("its output is ours")?).lines();
    let address = loop {
        let line = lines.next().context("frictionlab live ended without a view")??;
        if let Some((_, url)) = line.split_once("view: http://") {
            break url.trim_end_matches('/').to_owned();
        }
    };
    // It never waits for us.
    thread::spawn(move || lines.map_while(Result::ok).for_each(drop));
    let over = Arc::new(AtomicBool::new(false));
    let mut reading = Reading::new();
    for viewer in 0..viewers {
        let socket = subscribed(&address)?;
        let stops = viewer % STOPS == STOPS - 1;
        let over = Arc::clone(&over);
        if stops {
            // It stays there, and takes nothing.
            thread::spawn(move || {
                while !over.load(Ordering::Acquire) {
                    thread::sleep(PATIENCE);
                }
                drop(socket);
            });
        } else {
            reading.push(thread::spawn(move || read(socket, &over)));
        }
    }
    Ok((reading, over))
}

/// A viewer that has subscribed to every channel.
fn subscribed(address: &str) -> Result<WebSocket<TcpStream>> {
    let mut request = format!("ws://{address}/").into_client_request()?;
    let spoken = "foxglove.websocket.v1".parse()?;
    request.headers_mut().insert("Sec-WebSocket-Protocol", spoken);
    let stream = TcpStream::connect(address).context("reaching the view")?;
    stream.set_read_timeout(Some(PATIENCE))?;
    let (mut socket, _) =
        client(request, stream).map_err(|error| anyhow::anyhow!("not let in: {error}"))?;
    loop {
        match socket.read() {
            Ok(Message::Text(text)) => {
                let said: Value = serde_json::from_str(&text)?;
                let Some(channels) = said["channels"].as_array() else { continue };
                let all: Vec<Value> = channels
                    .iter()
                    .map(|channel| json!({ "id": channel["id"], "channelId": channel["id"] }))
                    .collect();
                let ask = json!({ "op": "subscribe", "subscriptions": all });
                socket.send(Message::text(ask.to_string()))?;
                return Ok(socket);
            }
            Ok(_) => {}
            Err(error) => bail!("the view does not say what there is: {error}"),
        }
    }
}

/// Reads what comes until it is over; how many messages that were.
fn read(mut socket: WebSocket<TcpStream>, over: &AtomicBool) -> Result<u64> {
    let mut heard = 0;
    while !over.load(Ordering::Acquire) {
        match socket.read() {
            Ok(Message::Binary(_)) => heard += 1,
            Ok(Message::Close(_)) => break,
            Ok(_) => {}
            Err(Error::Io(error)) if error.kind() == std::io::ErrorKind::WouldBlock => {}
            // The program has ended.
            Err(_) => break,
        }
    }
    Ok(heard)
}
