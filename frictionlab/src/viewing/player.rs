//! A recording, played to viewers: play, pause, seek, speed.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use msgs::topics::qos_of;
use recording::bag::{BagReader, RecordedMessage};
use view::{Channel, ChannelId, Hub, Playback, PlaybackRequest, PlaybackStatus, Steering};

/// How often viewers are told where the recording is.
const TOLD: Duration = Duration::from_millis(100);
/// Slowest and fastest speed, times real time.
const SPEEDS: (f32, f32) = (0.01, 100.0);

/// A recording that is played on a thread of its own. Dropped, it ends.
pub struct Player {
    desk: Arc<Desk>,
    thread: Option<JoinHandle<()>>,
}

/// What viewers wish, and whoever plays waits for.
struct Desk {
    span: (u64, u64),
    hub: Hub,
    wish: Mutex<Wish>,
    changed: Condvar,
}

struct Wish {
    status: PlaybackStatus,
    now: u64,
    speed: f32,
    /// Counts the wishes: what plays begins anew with each.
    number: u64,
    over: bool,
}

impl Player {
    /// Offers the topics of a bag, and plays it from its beginning on.
    ///
    /// # Errors
    /// If the system grants no thread.
    pub fn start(bag: BagReader, span: (u64, u64), hub: &Hub) -> std::io::Result<Self> {
        let channels: BTreeMap<String, ChannelId> = bag
            .recorded_topics()
            .into_iter()
            .map(|topic| {
                let id = hub.offer(Channel {
                    latched: qos_of(&topic.name).transient_local,
                    topic: topic.name.clone(),
                    encoding: topic.encoding,
                    schema_name: topic.type_name,
                    schema_encoding: topic.schema_encoding,
                    schema: topic.schema,
                });
                (topic.name, id)
            })
            .collect();
        let wish = Wish {
            status: PlaybackStatus::Playing,
            now: span.0,
            speed: 1.0,
            number: 0,
            over: false,
        };
        let desk = Arc::new(Desk {
            span,
            hub: hub.clone(),
            wish: Mutex::new(wish),
            changed: Condvar::new(),
        });
        let playing = Arc::clone(&desk);
        let run = move || playing.run(&bag, &channels);
        let thread = thread::Builder::new().name("player".into()).spawn(run)?;
        Ok(Self { desk, thread: Some(thread) })
    }

    /// Takes what viewers wish.
    #[must_use]
    pub fn steering(&self) -> Arc<dyn Steering> {
        Arc::new(Wishes(Arc::clone(&self.desk)))
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        let mut wish = self.desk.wish();
        wish.over = true;
        wish.number += 1;
        drop(wish);
        self.desk.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct Wishes(Arc<Desk>);

impl Steering for Wishes {
    fn recording(&self) -> Option<(u64, u64)> {
        Some(self.0.span)
    }

    fn play(&self, request: &PlaybackRequest) -> Option<Playback> {
        let desk = &self.0;
        let mut wish = desk.wish();
        if request.speed.is_finite() {
            wish.speed = request.speed.clamp(SPEEDS.0, SPEEDS.1);
        }
        let ended = wish.status == PlaybackStatus::Ended;
        wish.status = if request.play { PlaybackStatus::Playing } else { PlaybackStatus::Paused };
        if let Some(seek) = request.seek {
            wish.now = seek.clamp(desk.span.0, desk.span.1);
        } else if ended && request.play {
            wish.now = desk.span.0;
        }
        wish.number += 1;
        let sought = request.seek.is_some();
        let told = Playback { sought, id: request.id.clone(), ..wish.told() };
        drop(wish);
        desk.changed.notify_all();
        if sought {
            desk.hub.playback(&Playback { id: String::new(), ..told.clone() });
        }
        Some(told)
    }
}

impl Desk {
    /// Plays what is wished until it is over.
    fn run(&self, bag: &BagReader, channels: &BTreeMap<String, ChannelId>) {
        loop {
            let Some((number, start, speed)) = self.begin() else { return };
            let began = Instant::now();
            let mut told = began;
            let played = bag.play(start, |message| {
                let ahead = Duration::from_nanos(message.time.saturating_sub(start));
                let due = began + ahead.div_f64(f64::from(speed));
                if !self.wait(number, due) {
                    return ControlFlow::Break(());
                }
                self.publish(channels, message);
                if told.elapsed() >= TOLD {
                    told = Instant::now();
                    self.tell(number, message.time);
                }
                ControlFlow::Continue(())
            });
            if let Err(error) = &played {
                self.hub.status(2, &error.to_string());
            }
            if !matches!(played, Ok(false)) {
                self.end(number);
            }
        }
    }

    /// Waits until somebody wants it to play: which wish, from where, how fast.
    fn begin(&self) -> Option<(u64, u64, f32)> {
        let mut wish = self.wish();
        loop {
            if wish.over {
                return None;
            }
            if wish.status == PlaybackStatus::Playing {
                return Some((wish.number, wish.now, wish.speed));
            }
            let told = wish.told();
            let waited = self.changed.wait_timeout(wish, Duration::from_secs(1));
            self.hub.playback(&told);
            wish = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Waits until a message is due; false if something else is wished meanwhile.
    fn wait(&self, number: u64, due: Instant) -> bool {
        let mut wish = self.wish();
        loop {
            if wish.number != number {
                return false;
            }
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return true;
            }
            let waited = self.changed.wait_timeout(wish, left);
            wish = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn publish(&self, channels: &BTreeMap<String, ChannelId>, message: RecordedMessage<'_>) {
        if let Some(channel) = channels.get(message.topic) {
            self.hub.publish(*channel, message.time, message.bytes);
        }
    }

    fn tell(&self, number: u64, now: u64) {
        let mut wish = self.wish();
        if wish.number == number {
            wish.now = now;
            let told = wish.told();
            drop(wish);
            self.hub.time(now);
            self.hub.playback(&told);
        }
    }

    fn end(&self, number: u64) {
        let mut wish = self.wish();
        if wish.number == number {
            wish.status = PlaybackStatus::Ended;
            wish.now = self.span.1;
            let told = wish.told();
            drop(wish);
            self.hub.playback(&told);
        }
    }

    fn wish(&self) -> MutexGuard<'_, Wish> {
        self.wish.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Wish {
    fn told(&self) -> Playback {
        Playback {
            status: self.status,
            now: self.now,
            speed: self.speed,
            sought: false,
            id: String::new(),
        }
    }
}
