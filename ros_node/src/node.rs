//! A node that answers and leaves cleanly.

use std::{
    future::Future,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU8, Ordering},
    },
    thread,
    time::{Duration, Instant, SystemTime},
};

use futures::StreamExt;
use msgs::{
    RosAction, RosMessage, RosService,
    topics::{Qos, Topic},
};
use ros2_client::{
    Message, MessageInfo, MessageTypeName, Name, Node, NodeName, NodeOptions, ServiceMapping,
    ServiceTypeName,
    builtin_topics::ros_discovery,
    qos::{Durability, History, QosProfile, WhenFull},
};
use rustdds::TopicKind;
use tokio::task::JoinHandle;

use crate::{
    ActionHandler, ActionServer, Graph, Logger, Named, NodeClock, NodeIdentity, Publisher,
    RosNodeError, ServiceClient, action,
    apart::Apart,
    graph::{self, ParticipantId, ParticipantNodes},
    logger,
    one_writer::WriterId,
    participant::Shared,
    rmw,
    service::Service,
    twins::Twins,
};

/// How long a leaving node waits for its background work.
const LEAVING: Duration = Duration::from_secs(1);
/// Shortest time between two warnings of one subscription.
const WARNINGS: Duration = Duration::from_secs(1);

/// The client library's node, while it is there.
type Slot = Arc<Mutex<Option<Node>>>;

/// A node of the ROS graph. Dropped, it takes its name off the graph.
pub struct RosNode {
    identity: NodeIdentity,
    clock: NodeClock,
    logger: Logger,
    /// `None` only while it is being dropped.
    node: Slot,
    tasks: Mutex<Vec<JoinHandle<()>>>,
    /// What has a thread of its own.
    apart: Mutex<Vec<Apart>>,
    /// When it began \[ns since the epoch\].
    began: u64,
    shared: Arc<Shared>,
}

impl RosNode {
    pub(crate) fn start(shared: Arc<Shared>, name: &str) -> Result<Self, RosNodeError> {
        let error =
            |detail: String| RosNodeError::Create { what: format!("the node /{name}"), detail };
        let arguments = &shared.arguments;
        let identity =
            arguments.remaps.node(name, arguments.namespace.as_deref().unwrap_or("/"))?;
        let node_name =
            NodeName::new(&identity.namespace, &identity.name).map_err(|e| error(e.to_string()))?;
        // Without a spinner: it would listen to `/clock` with a type that is not the clock's, and
        // only serves the client's own parameters, in whose place stand those of this crate.
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let mut node =
            shared.context.new_node(node_name, options).map_err(|e| error(e.to_string()))?;
        let rosout = (!arguments.rosout_disabled).then(|| logger::rosout(&mut node));
        let rosout = rosout.transpose().map_err(|detail| RosNodeError::Create {
            what: "a publisher on /rosout".into(),
            detail,
        })?;
        let clock = NodeClock::default();
        let logger = Logger::new(
            identity.logger(),
            arguments.level_of(&identity.logger()),
            !arguments.terminal_disabled,
            clock.clone(),
            rosout,
        );
        let began = u64::try_from(since_epoch().as_nanos()).unwrap_or(u64::MAX);
        if shared.open.swap(false, Ordering::Relaxed) {
            logger.warn(
                "ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET: anybody on the network can command this process's nodes; LOCALHOST keeps them to this machine",
            );
        }
        if !shared.rmw_is_told.swap(true, Ordering::Relaxed) {
            match rmw::said() {
                None => {}
                Some(rmw::Said::Fine(said)) => logger.debug(&said),
                Some(rmw::Said::Warning(said)) => logger.warn(&said),
            }
        }
        let (node, tasks, apart) =
            (Arc::new(Mutex::new(Some(node))), Mutex::default(), Mutex::default());
        Ok(Self { identity, clock, logger, node, tasks, apart, began, shared })
    }

    /// Name of the node, without its namespace.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.identity.name
    }

    /// Name and namespace.
    #[must_use]
    pub fn identity(&self) -> &NodeIdentity {
        &self.identity
    }

    /// The node's log.
    #[must_use]
    pub fn logger(&self) -> &Logger {
        &self.logger
    }

    /// The node's time.
    #[must_use]
    pub fn clock(&self) -> &NodeClock {
        &self.clock
    }

    /// What the command line gives for a parameter of this node.
    #[must_use]
    pub fn given(&self, parameter: &str) -> Option<crate::ParameterValue> {
        self.arguments().overrides(&self.identity.qualified()).remove(parameter)
    }

    /// Names of all parameters that the command line gives to this node.
    #[must_use]
    pub fn given_names(&self) -> Vec<String> {
        self.arguments().overrides(&self.identity.qualified()).into_keys().collect()
    }

    /// State in which the managed node of this process's life before ended; zero in the first.
    pub(crate) fn last_phase(&self) -> Arc<AtomicU8> {
        let mut all = self.shared.last_phases.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(all.entry(self.identity.qualified()).or_default())
    }

    /// What the command line says.
    pub(crate) fn arguments(&self) -> &crate::Arguments {
        &self.shared.arguments
    }

    /// The absolute name of a topic or service that the code calls `name`: relative names lie in
    /// the node's namespace, then the command line's remappings apply.
    ///
    /// # Errors
    /// [`RosNodeError::Name`] if it is none.
    pub fn resolve(&self, named: Named, name: &str) -> Result<String, RosNodeError> {
        self.shared.arguments.remaps.resolve(&self.identity, named, name)
    }

    /// A publisher on a topic, with the topic's quality of service. The topic lies in the node's
    /// namespace.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn publisher<M: RosMessage + Message>(
        &self,
        topic: &Topic<M>,
    ) -> Result<Publisher<M>, RosNodeError> {
        self.publisher_on(topic.name_in_namespace(), topic.qos)
    }

    /// A publisher on the topic that the code calls `name`.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn publisher_on<M: RosMessage + Message>(
        &self,
        name: &str,
        qos: Qos,
    ) -> Result<Publisher<M>, RosNodeError> {
        self.raw_publisher(name, M::DEFINITION.package, M::DEFINITION.name, qos)
    }

    /// A publisher of a type that is only known to the client library.
    pub(crate) fn raw_publisher<M: Message>(
        &self,
        name: &str,
        package: &str,
        kind: &str,
        qos: Qos,
    ) -> Result<Publisher<M>, RosNodeError> {
        let absolute = self.resolve(Named::Topic, name)?;
        let publisher = self.with_node("a publisher", &absolute, |node| {
            let qos = profile(qos);
            let topic = node
                .create_topic(&parse(&absolute)?, MessageTypeName::new(package, kind), &qos)
                .map_err(|e| e.to_string())?;
            node.create_publisher(&topic, Some(qos)).map_err(|e| e.to_string())
        })?;
        self.shared.lagging.publishes(&absolute, &self.logger);
        Ok(Publisher::new(absolute, publisher))
    }

    /// Calls `take` with every message on the topic, on a background thread: it should be short and
    /// may not panic. What is no message of the type is counted and told in the log. The
    /// subscription is best effort, so that any publisher fits and no repeat delays what is newer;
    /// `transient_local` topics are read reliably.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn subscribe<M: RosMessage + Message + Send + Sync + 'static>(
        &self,
        topic: &Topic<M>,
        take: impl FnMut(M) + Send + 'static,
    ) -> Result<(), RosNodeError> {
        self.subscribe_on(topic.name_in_namespace(), topic.qos, take)
    }

    /// Like [`subscribe`](Self::subscribe), and tells who sent each message and how long ago.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn subscribe_from<M: RosMessage + Message + Send + Sync + 'static>(
        &self,
        topic: &Topic<M>,
        take: impl FnMut(M, Sent) + Send + 'static,
    ) -> Result<(), RosNodeError> {
        self.listen(topic.name_in_namespace(), topic.qos, take)
    }

    /// Like [`subscribe`](Self::subscribe), on the topic that the code calls `name`.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn subscribe_on<M: RosMessage + Message + Send + Sync + 'static>(
        &self,
        name: &str,
        qos: Qos,
        mut take: impl FnMut(M) + Send + 'static,
    ) -> Result<(), RosNodeError> {
        self.listen(name, qos, move |message, _| take(message))
    }

    fn listen<M: RosMessage + Message + Send + Sync + 'static>(
        &self,
        name: &str,
        qos: Qos,
        mut take: impl FnMut(M, Sent) + Send + 'static,
    ) -> Result<(), RosNodeError> {
        let absolute = self.resolve(Named::Topic, name)?;
        let subscription = self.with_node("a subscription", &absolute, |node| {
            let qos = subscriber_profile(qos);
            let kind = MessageTypeName::new(M::DEFINITION.package, M::DEFINITION.name);
            let topic =
                node.create_topic(&parse(&absolute)?, kind, &qos).map_err(|e| e.to_string())?;
            node.create_subscription::<M>(&topic, Some(qos)).map_err(|e| e.to_string())
        })?;
        let logger = self.logger.clone();
        self.spawn(async move {
            let mut stream = std::pin::pin!(subscription.async_stream());
            let (mut refused, mut told) = (0u64, None::<Instant>);
            while let Some(next) = stream.next().await {
                match next {
                    Ok((message, info)) => take(message, Sent::read(&info)),
                    Err(error) => {
                        refused += 1;
                        if told.is_none_or(|told| told.elapsed() >= WARNINGS) {
                            told = Some(Instant::now());
                            logger.warn(&format!(
                                "{refused} messages on {absolute} were no {} and were dropped, the last one because: {error:?}",
                                M::type_name()
                            ));
                        }
                    }
                }
            }
        });
        Ok(())
    }

    /// Listens to who else is there. What is heard arrives over the next seconds, this node's own
    /// participant included.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn watch_graph(&self) -> Result<Graph, RosNodeError> {
        let graph = Graph::default();
        self.watch_into(&graph)?;
        Ok(graph)
    }

    /// The participant's own view of who is there: from the first call on it is kept, once for all
    /// its nodes, for as long as this node is there.
    pub(crate) fn graph(&self) -> Result<Graph, RosNodeError> {
        let graph = &self.shared.graph;
        if !self.shared.graph_is_watched.swap(true, Ordering::AcqRel) {
            self.watch_into(graph)?;
        }
        Ok(graph.clone())
    }

    /// Another node of this one's name in another participant, in a sentence.
    ///
    /// It is told by [`lifecycle::Lifecycle`](crate::lifecycle::Lifecycle) too, which keeps the
    /// later one of two from working.
    #[must_use]
    pub fn twin(&self) -> Option<String> {
        self.twins().ok()?.found().map(|twin| twin.to_string())
    }

    /// Subscribers of this node's topics that do not keep up now. Each loses what it does not fetch
    /// in time; the log says who it is.
    #[must_use]
    pub fn lagging_readers(&self) -> u64 {
        self.shared.lagging.count(&self.logger)
    }

    /// This process's participant.
    #[must_use]
    pub fn participant(&self) -> ParticipantId {
        self.shared.context.participant_entities_info().gid().to_bytes16()
    }

    /// Looks for other nodes of this name.
    pub(crate) fn twins(&self) -> Result<Twins, RosNodeError> {
        Ok(Twins {
            graph: self.graph()?,
            name: self.identity.qualified(),
            own: self.participant(),
            began: self.began,
        })
    }

    fn watch_into(&self, graph: &Graph) -> Result<(), RosNodeError> {
        // Many participants tell of themselves at the same moment.
        let qos = profile(Qos { depth: 100, transient_local: true });
        let participant = self.shared.context.domain_participant();
        let subscription = self.with_node("a subscription", graph::TOPIC, |node| {
            let topic = participant
                .create_topic(
                    graph::TOPIC.to_owned(),
                    graph::TYPE.to_owned(),
                    &ros_discovery::QOS_PUB,
                    TopicKind::NoKey,
                )
                .map_err(|e| e.to_string())?;
            node.create_subscription::<ParticipantNodes>(&topic, Some(qos))
                .map_err(|e| e.to_string())
        })?;
        let heard = graph.clone();
        self.spawn(async move {
            let mut stream = std::pin::pin!(subscription.async_stream());
            while let Some(next) = stream.next().await {
                // What cannot be read is of another version of ROS: that participant stays unknown.
                if let Ok((told, info)) = next {
                    heard.take(told, sent_ns(&info));
                }
            }
        });
        Ok(())
    }

    /// Answers a service that the code calls `name`, on a background thread.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn serve<S: RosService>(
        &self,
        name: &str,
        answer: impl FnMut(S::Request) -> S::Response + Send + 'static,
    ) -> Result<(), RosNodeError>
    where
        S::Request: Message + Sync,
        S::Response: Message + Sync,
    {
        self.raw_serve::<S::Request, S::Response>(name, S::PACKAGE, S::NAME, answer)
    }

    /// Like [`serve`](Self::serve), on a thread of its own with an endpoint of its own: no other
    /// callback, warning or slow client keeps it. For what must be answered whatever the rest of
    /// the node does. `answer` must not wait for what the rest of the node holds.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses, [`RosNodeError::Runtime`] if the system
    /// grants no thread.
    pub fn serve_apart<S: RosService>(
        &self,
        name: &str,
        answer: impl FnMut(S::Request) -> S::Response + Send + 'static,
    ) -> Result<(), RosNodeError>
    where
        S::Request: Message + Sync,
        S::Response: Message + Sync,
    {
        let service = self.service::<S::Request, S::Response>(name, S::PACKAGE, S::NAME)?;
        let apart = Apart::start("service apart", async move { service.run(answer).await })
            .map_err(RosNodeError::Runtime)?;
        self.apart.lock().unwrap_or_else(PoisonError::into_inner).push(apart);
        Ok(())
    }

    /// Offers an action that the code calls `name`; its goals go to `handler`.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware or the system refuses.
    pub fn serve_action<A: RosAction>(
        &self,
        name: &str,
        handler: impl ActionHandler<A>,
    ) -> Result<ActionServer, RosNodeError> {
        let absolute = self.resolve(Named::Service, name)?;
        let (hearers, runtime) =
            (Arc::clone(&self.shared.hearers), self.shared.runtime.handle().clone());
        let answers = action::Answers::new(&absolute, self.logger.clone(), hearers, runtime);
        self.with_node("an action", &absolute, |node| {
            action::serve::<A>(node, &parse(&absolute)?, answers, handler)
        })
    }

    /// Answers a service whose types are only known to the client library.
    pub(crate) fn raw_serve<Q, A>(
        &self,
        name: &str,
        package: &str,
        kind: &str,
        mut answer: impl FnMut(Q) -> A + Send + 'static,
    ) -> Result<(), RosNodeError>
    where
        Q: Message + Clone + Send + Sync + 'static,
        A: Message + Send + Sync + 'static,
    {
        let service = self.service::<Q, A>(name, package, kind)?;
        let answer = move |request| tokio::task::block_in_place(|| answer(request));
        self.spawn(async move { service.run(answer).await });
        Ok(())
    }

    fn service<Q, A>(
        &self,
        name: &str,
        package: &str,
        kind: &str,
    ) -> Result<Service<Q, A>, RosNodeError>
    where
        Q: Message + Clone + Send + Sync + 'static,
        A: Message + Send + Sync + 'static,
    {
        let absolute = self.resolve(Named::Service, name)?;
        let server = self.with_node("a service", &absolute, |node| {
            let qos = profile(Qos::DEFAULT);
            node.create_server::<Q, A>(
                ServiceMapping::Enhanced,
                &parse(&absolute)?,
                &ServiceTypeName::new(package, kind),
                qos.clone(),
                qos,
            )
            .map_err(|e| e.to_string())
        })?;
        let hearers = Arc::clone(&self.shared.hearers);
        Ok(Service::new(absolute, server, hearers, self.logger.clone()))
    }

    /// A client of the service that the code calls `name`.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn client<S: RosService>(
        &self,
        name: &str,
    ) -> Result<ServiceClient<S::Request, S::Response>, RosNodeError>
    where
        S::Request: Message + Sync,
        S::Response: Message + Sync,
    {
        self.raw_client(name, S::PACKAGE, S::NAME)
    }

    /// A client of a service whose types are only known to the client library.
    pub(crate) fn raw_client<Q, A>(
        &self,
        name: &str,
        package: &str,
        kind: &str,
    ) -> Result<ServiceClient<Q, A>, RosNodeError>
    where
        Q: Message + Clone + Send + Sync + 'static,
        A: Message + Send + Sync + 'static,
    {
        let absolute = self.resolve(Named::Service, name)?;
        let (node, name, kind) =
            (Arc::clone(&self.node), absolute.clone(), ServiceTypeName::new(package, kind));
        let make = move |mapping| {
            with(&node, "a client", &name, |node| {
                let qos = profile(Qos::DEFAULT);
                node.create_client::<Q, A>(mapping, &parse(&name)?, &kind, qos.clone(), qos)
                    .map_err(|e| e.to_string())
            })
        };
        ServiceClient::new(absolute, Arc::clone(&self.shared), Box::new(make))
    }

    fn with_node<T>(
        &self,
        what: &str,
        name: &str,
        make: impl FnOnce(&mut Node) -> Result<T, String>,
    ) -> Result<T, RosNodeError> {
        with(&self.node, what, name, make)
    }

    pub(crate) fn spawn(&self, task: impl Future<Output = ()> + Send + 'static) {
        let handle = self.shared.runtime.spawn(task);
        self.tasks.lock().unwrap_or_else(PoisonError::into_inner).push(handle);
    }
}

impl Drop for RosNode {
    fn drop(&mut self) {
        // What runs in the background holds readers and writers: it goes first, then the node takes
        // its name off the graph.
        let tasks = std::mem::take(&mut *self.tasks.lock().unwrap_or_else(PoisonError::into_inner));
        tasks.iter().for_each(JoinHandle::abort);
        let mut apart =
            std::mem::take(&mut *self.apart.lock().unwrap_or_else(PoisonError::into_inner));
        apart.iter_mut().for_each(Apart::end);
        // Not by the runtime's clock: it stands still if all of its threads are stuck.
        let began = Instant::now();
        while !tasks.iter().all(JoinHandle::is_finished) && began.elapsed() < LEAVING {
            thread::sleep(Duration::from_millis(1));
        }
        apart.into_iter().for_each(|apart| apart.join(LEAVING));
        self.shared.lagging.leaves(&self.logger);
        self.logger.leave();
        drop(self.node.lock().unwrap_or_else(PoisonError::into_inner).take());
    }
}

/// Makes something of a node that is not leaving.
fn with<T>(
    node: &Slot,
    what: &str,
    name: &str,
    make: impl FnOnce(&mut Node) -> Result<T, String>,
) -> Result<T, RosNodeError> {
    let error = |detail: String| RosNodeError::Create { what: format!("{what} on {name}"), detail };
    let mut node = node.lock().unwrap_or_else(PoisonError::into_inner);
    make(node.as_mut().ok_or_else(|| error("the node is leaving".into()))?).map_err(error)
}

/// Who sent a message, and when.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sent {
    /// Who. It is what the message says: see [`one_writer`](crate::one_writer) for how far that is
    /// to be believed.
    pub writer: WriterId,
    /// How long ago, by the system's clocks on both sides; zero if its publisher did not say, or by
    /// a clock that is ahead.
    pub age: Duration,
}

impl Sent {
    fn read(info: &MessageInfo) -> Self {
        let sent = sent_ns(info).map(Duration::from_nanos);
        let age = sent.map_or(Duration::ZERO, |sent| since_epoch().saturating_sub(sent));
        Self { writer: WriterId(info.publisher_gid().to_bytes16()), age }
    }
}

/// When a message was sent, by its publisher's clock \[ns since the epoch\].
fn sent_ns(info: &MessageInfo) -> Option<u64> {
    info.source_timestamp().and_then(|sent| u64::try_from(sent.to_nanos()).ok())
}

fn since_epoch() -> Duration {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default()
}

fn parse(name: &str) -> Result<Name, String> {
    Name::parse(name).map_err(|e| e.to_string())
}

fn profile(qos: Qos) -> QosProfile {
    let durability =
        if qos.transient_local { Durability::TransientLocal } else { Durability::Volatile };
    // A reader that does not keep up may cost the publishing thread a moment, not a tenth of a
    // second as by default.
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Wait(Duration::from_millis(5)))
        .durability(durability)
        .history(History::KeepLast { depth: qos.depth as usize })
}

fn subscriber_profile(qos: Qos) -> QosProfile {
    if qos.transient_local {
        return profile(qos);
    }
    QosProfile::publisher_default()
        .reliability_best_effort()
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth: qos.depth as usize })
}
