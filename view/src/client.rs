//! One viewer: what it says, and what it is told.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use futures::stream::{SplitSink, SplitStream};
use futures::{SinkExt, StreamExt};
use hyper::upgrade::Upgraded;
use hyper_util::rt::TokioIo;
use tokio::time::{Instant, MissedTickBehavior, interval, sleep_until, timeout};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::protocol::{Role, WebSocketConfig};

use crate::Access;
use crate::caller::Caller;
use crate::pace::Pace;
use crate::protocol::incoming::Said;
use crate::protocol::reading::{self, Bytes};
use crate::protocol::{incoming, outgoing};
use crate::queue::{Out, Queue};
use crate::shared::Shared;

/// Longest message of a viewer \[bytes\].
const MESSAGE: usize = 256 << 10;
/// Time between two signs of life that are asked for, and between two reports of losses.
const LIFE: Duration = Duration::from_secs(2);
/// A viewer that says nothing for so long, not even that it lives, has gone.
const SILENT: Duration = Duration::from_secs(10);
/// A viewer that takes nothing for so long has gone.
const STUCK: Duration = Duration::from_secs(10);
/// Messages of one viewer within [`WINDOW`]; more are read later.
const AT_ONCE: u32 = 400;
/// See [`AT_ONCE`].
const WINDOW: Duration = Duration::from_millis(200);
/// Channels of one viewer's own.
const OWN: usize = 64;

type Socket = WebSocketStream<TokioIo<Upgraded>>;

/// Serves a viewer until it leaves.
pub(crate) async fn serve(stream: TokioIo<Upgraded>, shared: &Arc<Shared>, access: Access) {
    let config = WebSocketConfig::default()
        .read_buffer_size(16 << 10)
        .write_buffer_size(16 << 10)
        .max_write_buffer_size(1 << 20)
        .max_message_size(Some(MESSAGE))
        .max_frame_size(Some(MESSAGE));
    let socket = WebSocketStream::from_raw_socket(stream, Role::Server, Some(config)).await;
    let queue = Arc::new(Queue::default());
    let steering = Arc::clone(&shared.steering);
    let recording = steering.recording();
    queue.answer(Out::Text(outgoing::server_info(
        &shared.name,
        &shared.session,
        access,
        shared.key.as_str(),
        recording,
    )));
    let number = shared.hub.enter(&queue);
    let services = steering.services();
    queue.answer(Out::Text(outgoing::advertise_services(&services)));
    let caller = Caller::new(steering, shared.hub.clone(), Arc::clone(&queue), services, access);
    let pace = Pace::default();
    let own = BTreeMap::new();
    let mut viewer = Viewer { shared, number, queue: &queue, pace: &pace, caller, own };
    let (sink, stream) = socket.split();
    tokio::select! {
        () = tell(sink, &queue, &pace) => {}
        () = viewer.listen(stream) => {}
    }
    shared.hub.leave(number);
}

/// Sends what waits, until the viewer does not take it any more.
async fn tell(mut sink: SplitSink<Socket, Message>, queue: &Queue, pace: &Pace) {
    let mark = || Message::Ping(bytes::Bytes::copy_from_slice(&pace.mark()));
    let mut life = interval(LIFE);
    life.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut told = 0;
    loop {
        while let Some(out) = queue.take(pace.is_open()) {
            let mark_is_due = pace.sent(out.len());
            let message = match out {
                Out::Text(text) => Message::text(text),
                Out::Binary(bytes) => Message::binary(bytes),
            };
            let Ok(Ok(())) = timeout(STUCK, sink.feed(message)).await else { return };
            if mark_is_due {
                let Ok(Ok(())) = timeout(STUCK, sink.feed(mark())).await else { return };
            }
        }
        let Ok(Ok(())) = timeout(STUCK, sink.flush()).await else { return };
        if queue.is_closed() {
            return;
        }
        tokio::select! {
            () = queue.stirred.notified() => {}
            _ = life.tick() => {
                let Ok(Ok(())) = timeout(STUCK, sink.feed(mark())).await else { return };
                let dropped = queue.dropped();
                if dropped > told {
                    told = dropped;
                    let text = format!("{dropped} messages were left out: this viewer reads too slowly");
                    queue.answer(Out::Text(outgoing::status(outgoing::WARNING, &text, Some("losses"))));
                }
            }
        }
    }
}

struct Viewer<'a> {
    shared: &'a Shared,
    number: u64,
    queue: &'a Queue,
    pace: &'a Pace,
    caller: Caller,
    /// Topics of its own channels.
    own: BTreeMap<u32, String>,
}

impl Viewer<'_> {
    /// Takes what it says, until it has gone.
    async fn listen(&mut self, mut stream: SplitStream<Socket>) {
        let (mut begun, mut count) = (Instant::now(), 0);
        while let Ok(Some(Ok(message))) = timeout(SILENT, stream.next()).await {
            match message {
                Message::Text(text) => self.text(&text),
                Message::Binary(bytes) => self.bytes(&bytes),
                Message::Pong(mark) => {
                    self.pace.came_back(&mark);
                    self.queue.stirred.notify_one();
                }
                Message::Close(_) => return,
                _ => {}
            }
            if begun.elapsed() >= WINDOW {
                (begun, count) = (Instant::now(), 0);
            }
            count += 1;
            if count >= AT_ONCE {
                sleep_until(begun + WINDOW).await;
            }
        }
    }

    fn text(&mut self, text: &str) {
        match serde_json::from_str(text) {
            Ok(said) => self.said(said),
            Err(error) => self.refuse(&format!("what was said cannot be read: {error}")),
        }
    }

    fn said(&mut self, said: Said) {
        let hub = &self.shared.hub;
        match said {
            Said::Subscribe { subscriptions } => {
                for incoming::Subscription { id, channel_id } in subscriptions {
                    if let Err(why) = hub.subscribe(self.number, id, channel_id) {
                        self.refuse(&why);
                    }
                }
            }
            Said::Unsubscribe { subscription_ids } => {
                for id in subscription_ids {
                    hub.unsubscribe(self.number, id);
                }
            }
            Said::Advertise { channels } => {
                for incoming::Own { id, topic, encoding } in channels {
                    if encoding != "json" {
                        self.refuse(&format!("{topic}: only json is taken, not {encoding}"));
                    } else if self.own.len() >= OWN {
                        self.refuse(&format!("{OWN} channels are all that a viewer may have"));
                    } else {
                        self.own.insert(id, topic);
                    }
                }
            }
            Said::Unadvertise { channel_ids } => {
                self.own.retain(|id, _| !channel_ids.contains(id));
            }
            Said::GetParameters { parameter_names, id } => {
                self.caller.get_parameters(parameter_names, id);
            }
            Said::SetParameters { parameters, id } => self.caller.set_parameters(parameters, id),
            Said::SubscribeParameterUpdates { parameter_names } => {
                hub.watch(self.number, parameter_names, true);
            }
            Said::UnsubscribeParameterUpdates { parameter_names } => {
                hub.watch(self.number, parameter_names, false);
            }
        }
    }

    fn bytes(&mut self, bytes: &[u8]) {
        match reading::read(bytes) {
            Some(Bytes::Message { channel, payload }) => {
                let Some(topic) = self.own.get(&channel) else {
                    return self.refuse(&format!("channel {channel} was not advertised"));
                };
                let topic = topic.clone();
                self.caller.publish(topic, payload);
            }
            Some(Bytes::Call { service, call, encoding, payload }) => {
                self.caller.call(service, call, encoding, payload);
            }
            Some(Bytes::Play(request)) => self.caller.play(request),
            None => self.refuse("a binary message cannot be read"),
        }
    }

    fn refuse(&self, why: &str) {
        self.queue.answer(Out::Text(outgoing::status(outgoing::ERROR, why, None)));
    }
}
