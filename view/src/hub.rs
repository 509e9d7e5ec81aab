//! Channels, and who listens to them.

use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bytes::Bytes;

use crate::channel::{Channel, ChannelId};
use crate::protocol::{outgoing, writing};
use crate::queue::{Out, Queue};
use crate::{Parameter, Playback};

/// Channels and viewers. Clones are the same.
#[derive(Debug, Clone, Default)]
pub struct Hub(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    state: Mutex<State>,
    /// What was lost for viewers that have left.
    lost: AtomicU64,
}

#[derive(Debug, Default)]
struct State {
    channels: Vec<Offered>,
    viewers: BTreeMap<u64, Viewer>,
    next: u64,
}

#[derive(Debug)]
struct Offered {
    channel: Channel,
    /// How many messages are kept for who comes late.
    keep: usize,
    kept: VecDeque<(u64, Bytes)>,
}

#[derive(Debug)]
struct Viewer {
    queue: Arc<Queue>,
    /// Which channels, under which number of the viewer's own.
    subscribed: BTreeMap<u32, ChannelId>,
    /// Parameters of which it wants to hear.
    parameters: Vec<String>,
}

/// Subscriptions of one viewer at most.
const SUBSCRIPTIONS: usize = 1024;
/// Parameters of which one viewer may want to hear at most.
const WATCHED: usize = 4096;

impl Hub {
    /// Offers a channel, to those who are there too.
    #[must_use]
    pub fn offer(&self, channel: Channel) -> ChannelId {
        let mut state = self.state();
        let id = ChannelId(u32::try_from(state.channels.len() + 1).unwrap_or(u32::MAX));
        let told = outgoing::advertise(&[(id, &channel)]);
        let keep = usize::from(channel.latched);
        state.channels.push(Offered { channel, keep, kept: VecDeque::new() });
        state.viewers.values().for_each(|viewer| viewer.queue.answer(Out::Text(told.clone())));
        id
    }

    /// Who comes late gets the last so many messages of a channel, as of a log.
    pub fn keep(&self, id: ChannelId, messages: usize) {
        if let Some(offered) = self.state().channels.get_mut(id.0 as usize - 1) {
            offered.keep = messages;
        }
    }

    /// A message on a channel, with its time \[ns since the epoch\]. Never waits for a viewer; not
    /// for a control thread, because it allocates.
    pub fn publish(&self, id: ChannelId, time: u64, message: &[u8]) {
        let mut state = self.state();
        let State { channels, viewers, .. } = &mut *state;
        let Some(offered) = channels.get_mut(id.0 as usize - 1) else { return };
        if offered.keep > 0 {
            offered.kept.push_back((time, Bytes::copy_from_slice(message)));
            let old = offered.kept.len().saturating_sub(offered.keep);
            offered.kept.drain(..old);
        }
        for viewer in viewers.values() {
            for (&number, _) in viewer.subscribed.iter().filter(|(_, of)| **of == id) {
                let bytes = writing::message(number, time, message);
                if offered.channel.latched {
                    viewer.queue.answer(Out::Binary(bytes));
                } else {
                    viewer.queue.message(bytes);
                }
            }
        }
    }

    /// Tells all viewers what time it is \[ns since the epoch\].
    pub fn time(&self, now: u64) {
        self.to_all(|| Out::Binary(writing::time(now)));
    }

    /// Tells all viewers that something happened: level 0 is news, 1 a warning, 2 an error.
    pub fn status(&self, level: u8, text: &str) {
        self.to_all(|| Out::Text(outgoing::status(level, text, None)));
    }

    /// Tells who wants to hear of these parameters their new values.
    pub fn changed(&self, parameters: &[Parameter]) {
        for viewer in self.state().viewers.values() {
            let told: Vec<_> = parameters
                .iter()
                .filter(|parameter| viewer.parameters.contains(&parameter.name))
                .cloned()
                .collect();
            if !told.is_empty() {
                viewer.queue.answer(Out::Text(outgoing::parameter_values(&told, None)));
            }
        }
    }

    /// Tells all viewers how the recording is played.
    pub fn playback(&self, playback: &Playback) {
        self.to_all(|| Out::Binary(writing::playback(playback)));
    }

    /// How many viewers there are.
    #[must_use]
    pub fn viewers(&self) -> usize {
        self.state().viewers.len()
    }

    /// Messages that viewers lost because they read too slowly.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        let now: u64 = self.state().viewers.values().map(|viewer| viewer.queue.dropped()).sum();
        now + self.0.lost.load(Ordering::Relaxed)
    }

    /// Takes a viewer in and tells it the channels.
    pub(crate) fn enter(&self, queue: &Arc<Queue>) -> u64 {
        let mut state = self.state();
        let channels: Vec<_> = state
            .channels
            .iter()
            .enumerate()
            .map(|(at, offered)| (ChannelId(at as u32 + 1), &offered.channel))
            .collect();
        queue.answer(Out::Text(outgoing::advertise(&channels)));
        state.next += 1;
        let number = state.next;
        let viewer = Viewer {
            queue: Arc::clone(queue),
            subscribed: BTreeMap::new(),
            parameters: Vec::new(),
        };
        state.viewers.insert(number, viewer);
        number
    }

    pub(crate) fn leave(&self, viewer: u64) {
        if let Some(viewer) = self.state().viewers.remove(&viewer) {
            self.0.lost.fetch_add(viewer.queue.dropped(), Ordering::Relaxed);
        }
    }

    /// Subscribes a viewer to a channel under a number of its own. Returns why not.
    pub(crate) fn subscribe(&self, viewer: u64, number: u32, channel: u32) -> Result<(), String> {
        let mut state = self.state();
        let State { channels, viewers, .. } = &mut *state;
        let offered = usize::try_from(channel).ok().and_then(|at| channels.get(at.checked_sub(1)?));
        let offered = offered.ok_or_else(|| format!("there is no channel {channel}"))?;
        let Some(viewer) = viewers.get_mut(&viewer) else { return Ok(()) };
        if viewer.subscribed.len() >= SUBSCRIPTIONS {
            return Err(format!("{SUBSCRIPTIONS} subscriptions are all that one viewer may have"));
        }
        if viewer.subscribed.insert(number, ChannelId(channel)).is_some() {
            return Err(format!("subscription {number} was there before; the later one counts"));
        }
        for (time, message) in &offered.kept {
            viewer.queue.answer(Out::Binary(writing::message(number, *time, message)));
        }
        Ok(())
    }

    pub(crate) fn unsubscribe(&self, viewer: u64, number: u32) {
        if let Some(viewer) = self.state().viewers.get_mut(&viewer) {
            viewer.subscribed.remove(&number);
        }
    }

    /// A viewer wants to hear of parameters, or no more.
    pub(crate) fn watch(&self, viewer: u64, names: Vec<String>, wanted: bool) {
        if let Some(viewer) = self.state().viewers.get_mut(&viewer) {
            viewer.parameters.retain(|known| !names.contains(known));
            if wanted {
                viewer.parameters.extend(names);
                viewer.parameters.truncate(WATCHED);
            }
        }
    }

    fn to_all(&self, make: impl Fn() -> Out) {
        self.state().viewers.values().for_each(|viewer| viewer.queue.answer(make()));
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_comers_get_the_last_lines_of_a_log() {
        let hub = Hub::default();
        let log = Channel { latched: false, ..Channel::latched_json("/log", "Log") };
        let log = hub.offer(log);
        hub.publish(log, 1, b"lost");
        hub.keep(log, 2);
        for (time, line) in [(2, b"a"), (3, b"b"), (4, b"c")] {
            hub.publish(log, time, line);
        }
        let queue = Arc::new(Queue::default());
        let viewer = hub.enter(&queue);
        queue.take(true);
        hub.subscribe(viewer, 1, 1).unwrap();
        for (time, line) in [(3, b"b"), (4, b"c")] {
            assert_eq!(queue.take(true), Some(Out::Binary(writing::message(1, time, line))));
        }
        assert_eq!(queue.take(true), None);
    }

    #[test]
    fn late_comers_get_the_last_message_of_a_latched_channel() {
        let hub = Hub::default();
        let channel = hub.offer(Channel::latched_json("/state", "State"));
        hub.publish(channel, 1, b"{}");
        hub.publish(channel, 2, b"{\"a\":1}");
        let queue = Arc::new(Queue::default());
        let viewer = hub.enter(&queue);
        assert!(matches!(queue.take(true), Some(Out::Text(text)) if text.contains("\"/state\"")));
        hub.subscribe(viewer, 7, 1).unwrap();
        let Some(Out::Binary(bytes)) = queue.take(true) else { panic!("nothing came") };
        assert_eq!(bytes, writing::message(7, 2, b"{\"a\":1}"));
        assert!(hub.subscribe(viewer, 8, 0).is_err());
        assert!(hub.subscribe(viewer, 8, 2).is_err());
    }
}
