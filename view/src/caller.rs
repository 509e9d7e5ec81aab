//! Has done what one viewer asks for, on threads that may wait.

use std::sync::Arc;
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::spawn_blocking;

use crate::protocol::{outgoing, writing};
use crate::queue::{Out, Queue};
use crate::{Access, Hub, Parameter, PlaybackRequest, Service, Steering};

/// What one viewer may have asked for and not been answered.
const ASKED: usize = 8;
/// Stops of one viewer that are under way at once.
const STOPS: usize = 4;
/// Messages of one viewer that wait.
const WAITING: usize = 16;
/// A viewer's message that waited for so long is not passed on: it may be a command.
const TOO_OLD: Duration = Duration::from_millis(20);
/// Parameters in one request.
const AT_ONCE: usize = 4096;

/// What is passed on: when it came, its topic, its text.
type Passed = (Instant, String, Value);

/// What one viewer asked for and who does it.
pub(crate) struct Caller {
    steering: Arc<dyn Steering>,
    hub: Hub,
    queue: Arc<Queue>,
    services: Vec<Service>,
    access: Access,
    asked: Arc<Semaphore>,
    stops: Arc<Semaphore>,
    passing: Option<SyncSender<Passed>>,
}

impl Caller {
    pub(crate) fn new(
        steering: Arc<dyn Steering>,
        hub: Hub,
        queue: Arc<Queue>,
        services: Vec<Service>,
        access: Access,
    ) -> Self {
        let (asked, stops) = (Arc::new(Semaphore::new(ASKED)), Arc::new(Semaphore::new(STOPS)));
        Self { steering, hub, queue, services, access, asked, stops, passing: None }
    }

    /// Calls a service by its number.
    pub(crate) fn call(&self, number: u32, call: u32, encoding: &str, payload: &[u8]) {
        let fail = |why: &str| {
            self.queue.answer(Out::Text(outgoing::call_failed(number, call, why)));
        };
        let at = usize::try_from(number).ok().and_then(|number| number.checked_sub(1));
        let Some(service) = at.and_then(|at| self.services.get(at)) else {
            return fail("there is no such service");
        };
        if service.access > self.access {
            return fail("this viewer may only look");
        }
        if encoding != "json" {
            return fail("only json is spoken here");
        }
        let request = match payload {
            [] => Ok(Value::Object(serde_json::Map::new())),
            text => serde_json::from_slice(text),
        };
        let request = match request {
            Ok(request) => request,
            Err(error) => return fail(&format!("the request cannot be read: {error}")),
        };
        let places = if service.stops { &self.stops } else { &self.asked };
        let Ok(place) = Arc::clone(places).try_acquire_owned() else {
            return fail("too much is asked at once; wait for the answers");
        };
        let (steering, queue) = (Arc::clone(&self.steering), Arc::clone(&self.queue));
        let name = service.name.clone();
        let run = move || {
            let answer = match steering.call(&name, request) {
                Ok(answer) => {
                    Out::Binary(writing::answer(number, call, answer.to_string().as_bytes()))
                }
                Err(why) => Out::Text(outgoing::call_failed(number, call, &why)),
            };
            queue.answer(answer);
            drop(place);
        };
        if service.stops {
            // Not behind others who wait for threads.
            if thread::Builder::new().name("view stop".into()).spawn(run).is_err() {
                fail("the system grants no thread");
            }
        } else {
            spawn_blocking(run);
        }
    }

    pub(crate) fn get_parameters(&self, names: Vec<String>, id: Option<String>) {
        let Some(place) = self.place(names.len()) else { return };
        let (steering, queue) = (Arc::clone(&self.steering), Arc::clone(&self.queue));
        spawn_blocking(move || {
            tell_parameters(&*steering, &queue, &names, id.as_deref());
            drop(place);
        });
    }

    pub(crate) fn set_parameters(&self, parameters: Vec<Parameter>, id: Option<String>) {
        if self.access < Access::Full {
            return self.refuse("this viewer may only look");
        }
        let Some(place) = self.place(parameters.len()) else { return };
        let (steering, queue) = (Arc::clone(&self.steering), Arc::clone(&self.queue));
        let hub = self.hub.clone();
        spawn_blocking(move || {
            let names: Vec<_> = parameters.iter().map(|one| one.name.clone()).collect();
            match steering.set_parameters(parameters) {
                Ok(()) => {
                    if let Ok(now) = steering.parameters(&names) {
                        hub.changed(&now);
                    }
                }
                Err(why) => {
                    let status = outgoing::status(outgoing::ERROR, &why, id.as_deref());
                    queue.answer(Out::Text(status));
                }
            }
            if id.is_some() {
                tell_parameters(&*steering, &queue, &names, id.as_deref());
            }
            drop(place);
        });
    }

    /// Passes a message on, in the order in which they came.
    pub(crate) fn publish(&mut self, topic: String, payload: &[u8]) {
        if self.access < Access::Full {
            return self.refuse("this viewer may only look");
        }
        let Ok(message) = serde_json::from_slice(payload) else {
            return self.refuse("a message is no JSON");
        };
        if self.passing.is_none() {
            match self.start_passing() {
                Ok(passing) => self.passing = Some(passing),
                Err(error) => return self.refuse(&format!("the system grants no thread: {error}")),
            }
        }
        let Some(passing) = &self.passing else { return };
        if let Err(TrySendError::Full((_, topic, _))) =
            passing.try_send((Instant::now(), topic, message))
        {
            self.refuse(&format!("a message on {topic} was left out: too many came at once"));
        }
    }

    fn start_passing(&self) -> std::io::Result<SyncSender<Passed>> {
        let (passing, passed) = sync_channel::<Passed>(WAITING);
        let (steering, queue) = (Arc::clone(&self.steering), Arc::clone(&self.queue));
        let pass = move || {
            for (came, topic, message) in passed {
                if came.elapsed() > TOO_OLD {
                    continue;
                }
                if let Err(why) = steering.publish(&topic, message) {
                    queue.answer(Out::Text(outgoing::status(outgoing::ERROR, &why, None)));
                }
            }
        };
        thread::Builder::new().name("view passing".into()).spawn(pass)?;
        Ok(passing)
    }

    pub(crate) fn play(&self, request: PlaybackRequest) {
        let Some(place) = self.place(0) else { return };
        let (steering, queue) = (Arc::clone(&self.steering), Arc::clone(&self.queue));
        spawn_blocking(move || {
            if let Some(playback) = steering.play(&request) {
                queue.answer(Out::Binary(writing::playback(&playback)));
            }
            drop(place);
        });
    }

    /// Room for one more thing that is asked for.
    fn place(&self, parameters: usize) -> Option<OwnedSemaphorePermit> {
        if parameters > AT_ONCE {
            self.refuse(&format!("{AT_ONCE} parameters at once are the most"));
            return None;
        }
        let place = Arc::clone(&self.asked).try_acquire_owned().ok();
        if place.is_none() {
            self.refuse("too much is asked at once; wait for the answers");
        }
        place
    }

    fn refuse(&self, why: &str) {
        self.queue.answer(Out::Text(outgoing::status(outgoing::ERROR, why, None)));
    }
}

fn tell_parameters(steering: &dyn Steering, queue: &Queue, names: &[String], id: Option<&str>) {
    queue.answer(Out::Text(match steering.parameters(names) {
        Ok(values) => outgoing::parameter_values(&values, id),
        Err(why) => outgoing::status(outgoing::ERROR, &why, id),
    }));
}
