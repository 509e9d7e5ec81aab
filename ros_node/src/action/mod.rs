//! Actions: requests that take their time, tell how far they are and can be cancelled.
//!
//! [`ActionServer`] does what rcl's does, on ros2-client's endpoints: a goal's result is kept for
//! whoever asks for it, as often as it is asked, in any order of asking and finishing; feedback
//! goes on while a goal is being cancelled; a cancel request is answered with the codes of
//! `action_msgs/srv/CancelGoal`.

mod answers;
mod goals;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use msgs::RosAction;
use ros2_client::{
    ActionTypeName, Name, Node, RmwRequestId, ServiceMapping, WriteError,
    action::{ActionServerQosPolicies, CancelGoalResponse, GetResultResponse, SendGoalResponse},
    action_msgs::CancelGoalRequest,
    builtin_interfaces::Time,
    qos::{Durability, History, QosProfile, WhenFull},
};
use rustdds::mio1::{Events, Interest, Poll, Token, Waker, event::Source};

pub use ros2_client::action::{GoalEndStatus as GoalEnd, GoalId};

pub(crate) use answers::Answers;
use answers::Service;
use goals::{Goals, Wanted};

/// How long a server sleeps at most when nothing comes.
const LONGEST_SLEEP: Duration = Duration::from_millis(500);
const WAKE: Token = Token(3);

/// Quality of service of services, as rcl has it: reliable, ten requests wait.
fn service_qos() -> QosProfile {
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Wait(Duration::from_millis(100)))
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth: 10 })
}

/// What a node does about the goals of an action.
pub trait ActionHandler<A: RosAction>: Send + Sync + 'static {
    /// A new goal, accepted already. Whoever keeps `goal` finishes it; this call must return at
    /// once, so long work needs a thread of its own.
    fn start(&self, request: A::Goal, goal: Goal<A>);

    /// Somebody asks to cancel the goal, which is not finished. Whether it will be; if so, whoever
    /// keeps the goal finishes it soon.
    fn cancel(&self, id: GoalId) -> bool;
}

type Server<A> = ros2_client::ActionServer<
    <A as RosAction>::Goal,
    <A as RosAction>::Result,
    <A as RosAction>::Feedback,
>;

struct Shared<A: RosAction> {
    server: Server<A>,
    goals: Mutex<Goals<A::Result>>,
    answers: Arc<Answers>,
}

impl<A: RosAction> Shared<A> {
    fn goals(&self) -> MutexGuard<'_, Goals<A::Result>> {
        // Every change of a goal is one step: what a panicked thread left is whole.
        self.goals.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn publish_statuses(&self) {
        let statuses = self.goals().statuses();
        // Whoever misses a status still has the answers of the services.
        let _ = self.server.send_goal_statuses(statuses);
    }

    fn finish(self: &Arc<Self>, id: GoalId, end: GoalEnd, result: A::Result) {
        let waiting = self.goals().finish(id, end, result);
        self.publish_statuses();
        for (to, response) in waiting {
            self.send_result(to, response);
        }
    }

    /// Answers a request of a client, which may be gone: then nobody waits for this.
    fn answer(
        self: &Arc<Self>,
        service: Service,
        to: RmwRequestId,
        send: impl FnOnce(&Server<A>) -> Result<(), WriteError<()>> + Send + 'static,
    ) {
        let this = Arc::clone(self);
        self.answers.send(service, to, move || send(&this.server));
    }

    fn send_result(self: &Arc<Self>, to: RmwRequestId, response: GetResultResponse<A::Result>) {
        self.answer(Service::GetResult, to, move |server| server.send_result(to, response));
    }
}

/// A goal that is being worked on. Dropped unfinished, as by a panic, it is aborted.
pub struct Goal<A: RosAction> {
    id: GoalId,
    shared: Arc<Shared<A>>,
    finished: bool,
}

impl<A: RosAction> Goal<A> {
    /// Which goal.
    #[must_use]
    pub const fn id(&self) -> GoalId {
        self.id
    }

    /// Tells how far it is.
    pub fn feedback(&self, feedback: A::Feedback) {
        // Feedback is news: what does not get through is soon followed by the next.
        let _ = self.shared.server.send_feedback(self.id, feedback);
    }

    /// Ends it.
    pub fn finish(mut self, end: GoalEnd, result: A::Result) {
        self.finished = true;
        self.shared.finish(self.id, end, result);
    }
}

impl<A: RosAction> Drop for Goal<A> {
    fn drop(&mut self) {
        if !self.finished {
            self.shared.finish(self.id, GoalEnd::Aborted, A::Result::default());
        }
    }
}

/// An action that is offered. Dropped, it takes no more goals; those at work are the handler's to
/// end.
pub struct ActionServer {
    stop: Arc<AtomicBool>,
    waker: Waker,
    thread: Option<JoinHandle<()>>,
    answers: Arc<Answers>,
}

impl Drop for ActionServer {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        let _ = self.waker.wake();
        if let Some(thread) = self.thread.take() {
            // A panic of it was told when it happened.
            let _ = thread.join();
        }
        self.answers.give_up();
    }
}

/// Offers the action `name`.
///
/// # Errors
/// What the middleware or the system says if it refuses.
pub(crate) fn serve<A: RosAction>(
    node: &mut Node,
    name: &Name,
    answers: Arc<Answers>,
    handler: impl ActionHandler<A>,
) -> Result<ActionServer, String> {
    let io = |e: std::io::Error| e.to_string();
    let status_publisher = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Wait(Duration::from_millis(5)))
        .durability(Durability::TransientLocal)
        .history(History::KeepLast { depth: 1 });
    let mut server: Server<A> = node
        .create_action_server(
            ServiceMapping::Enhanced,
            name,
            &ActionTypeName::new(A::PACKAGE, A::NAME),
            ActionServerQosPolicies {
                goal_service: service_qos(),
                result_service: service_qos(),
                cancel_service: service_qos(),
                feedback_publisher: service_qos(),
                status_publisher,
            },
        )
        .map_err(|e| e.to_string())?;
    let poll = Poll::new().map_err(io)?;
    let registry = poll.registry();
    server.goal_server().register(registry, Token(0), Interest::READABLE).map_err(io)?;
    server.cancel_server().register(registry, Token(1), Interest::READABLE).map_err(io)?;
    server.result_server().register(registry, Token(2), Interest::READABLE).map_err(io)?;
    let waker = Waker::new(registry, WAKE).map_err(io)?;
    let shared = Arc::new(Shared::<A> {
        server,
        goals: Mutex::new(Goals::new()),
        answers: Arc::clone(&answers),
    });
    let stop = Arc::new(AtomicBool::new(false));
    let serving = Serving { shared, handler, stop: Arc::clone(&stop) };
    let thread = thread::Builder::new()
        .name("action".into())
        .spawn(move || serving.run(poll))
        .map_err(io)?;
    Ok(ActionServer { stop, waker, thread: Some(thread), answers })
}

struct Serving<A: RosAction, H> {
    shared: Arc<Shared<A>>,
    handler: H,
    stop: Arc<AtomicBool>,
}

impl<A: RosAction, H: ActionHandler<A>> Serving<A, H> {
    fn run(self, mut poll: Poll) {
        let mut events = Events::with_capacity(8);
        while !self.stop.load(Ordering::Relaxed) {
            // An error is a signal that came between; the queues are looked at in any case.
            let _ = poll.poll(&mut events, Some(LONGEST_SLEEP));
            self.take_goals();
            self.take_cancels();
            self.take_result_requests();
        }
    }

    fn take_goals(&self) {
        while let Some((to, request)) = next(|| self.shared.server.receive_goal()) {
            let (id, now) = (request.goal_id, Time::now());
            let accepted = self.shared.goals().accept(id, now);
            let response = SendGoalResponse { accepted, stamp: now };
            self.shared.answer(Service::SendGoal, to, move |server| {
                server.send_goal_response(to, response)
            });
            if accepted {
                self.shared.publish_statuses();
                let shared = Arc::clone(&self.shared);
                self.handler.start(request.goal, Goal { id, shared, finished: false });
            }
        }
    }

    fn take_cancels(&self) {
        while let Some((to, request)) = next(|| self.shared.server.receive_cancel_request()) {
            let Some(wanted) = wanted(&request) else { continue };
            let matching = self.shared.goals().matching(&wanted);
            let granted: Vec<GoalId> =
                matching.into_iter().filter(|&id| self.handler.cancel(id)).collect();
            let response: CancelGoalResponse = self.shared.goals().cancel(&wanted, &granted);
            self.shared.publish_statuses();
            self.shared.answer(Service::CancelGoal, to, move |server| {
                server.send_cancel_response(to, response)
            });
        }
    }

    fn take_result_requests(&self) {
        while let Some((to, request)) = next(|| self.shared.server.receive_result_request()) {
            let response = self.shared.goals().result(request.goal_id, to);
            if let Some(response) = response {
                self.shared.send_result(to, response);
            }
        }
    }
}

/// The next request that can be read, passing over a few that cannot.
fn next<T>(receive: impl Fn() -> ros2_client::ReadResult<Option<T>>) -> Option<T> {
    (0..16).find_map(|_| receive().transpose().map(Result::ok)).flatten()
}

/// What a cancel request asks for; its fields are private to ros2-client, so it goes through its
/// bytes.
fn wanted(request: &CancelGoalRequest) -> Option<Wanted> {
    let bytes = cdr_encoding::to_vec::<_, byteorder::LittleEndian>(request).ok()?;
    cdr_encoding::from_bytes::<Wanted, byteorder::LittleEndian>(&bytes)
        .ok()
        .map(|(wanted, _)| wanted)
}
