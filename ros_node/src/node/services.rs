//! Services and actions of a node, and clients of others.

use std::sync::{Arc, PoisonError};

use msgs::topics::Qos;
use msgs::{RosAction, RosService, descriptions};
use ros2_client::{Message, ServiceMapping, ServiceTypeName};

use super::{RosNode, parse, profile, with};
use crate::apart::Apart;
use crate::service::Service;
use crate::{ActionHandler, ActionServer, Named, RosNodeError, ServiceClient, action};

impl RosNode {
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
        self.types.uses(descriptions::service::<S>());
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
        self.types.uses(descriptions::service::<S>());
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
        match descriptions::action::<A>() {
            Ok(described) => described.into_iter().for_each(|one| self.types.uses(Ok(one))),
            Err(error) => self.types.uses(Err(error)),
        }
        self.types.uses_named("action_msgs/srv/CancelGoal");
        self.types.uses_named("action_msgs/msg/GoalStatusArray");
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
        self.types.uses_named(&format!("{package}/srv/{kind}"));
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
        self.types.uses(descriptions::service::<S>());
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
        self.types.uses_named(&format!("{package}/srv/{kind}"));
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
}
