//! The six services of parameters.

use std::{
    collections::BTreeSet,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use ::parameters::{Declaration, ParameterError, ParameterValue, Values};
use msgs::topics::Qos;
use ros2_client::{
    parameters::raw,
    rcl_interfaces::{
        DescribeParametersRequest, DescribeParametersResponse, GetParameterTypesRequest,
        GetParameterTypesResponse, GetParametersRequest, GetParametersResponse,
        ListParametersRequest, ListParametersResponse, ListParametersResult,
        SetParametersAtomicallyResponse, SetParametersRequest, SetParametersResponse,
    },
};

use super::{Change, ParameterStore, StoreError, events::Events, wire};
use crate::{RosNode, RosNodeError, types};

/// The parameter that every node has.
const USE_SIM_TIME: &str = "use_sim_time";

/// The running parameters of a node. Clones are the same parameters.
#[derive(Clone)]
pub struct Parameters(Arc<Inner>);

struct Inner {
    store: Mutex<ParameterStore>,
    events: Events,
}

impl Parameters {
    /// Declares the parameters of `node`, and those that every node has, `use_sim_time` and
    /// `start_type_description_service`; takes what the command line gives for
    /// them; offers the services and tells `/parameter_events`.
    ///
    /// `judge` sees all values, and which of them change, before they count; what it returns as an
    /// error is the reason that people read. It is called once before this function returns.
    ///
    /// # Errors
    /// [`RosNodeError::Parameter`] or [`RosNodeError::Parameters`] if what the command line gives
    /// cannot be; [`RosNodeError::Create`].
    pub fn declare(
        node: &RosNode,
        mut declared: Vec<Declaration>,
        mut judge: impl FnMut(&Values, &BTreeSet<String>) -> Result<(), ParameterError> + Send + 'static,
    ) -> Result<Self, RosNodeError> {
        if !declared.iter().any(|parameter| parameter.name() == USE_SIM_TIME) {
            declared.push(Declaration::boolean(USE_SIM_TIME, false, "Take the time from /clock"));
        }
        if !declared.iter().any(|parameter| parameter.name() == types::WANTED) {
            let what = "Offer the service ~/get_type_description";
            declared.push(Declaration::boolean(types::WANTED, true, what).read_only());
        }
        let name = node.identity().qualified();
        let given = node.arguments().overrides(&name);
        let clock = node.clock().clone();
        let for_judge = clock.clone();
        let store = ParameterStore::new(
            declared,
            &given,
            Box::new(move |values, changed| {
                judge(values, changed)?;
                for_judge.simulate(values.boolean(USE_SIM_TIME));
                Ok(())
            }),
        )
        .map_err(|error| match error {
            StoreError::Together(reason) => {
                RosNodeError::Parameters { node: name.clone(), reason: reason.to_string() }
            }
            StoreError::Value { name: parameter, error } => RosNodeError::Parameter {
                node: name.clone(),
                value: given.get(&parameter).map(|value| format!("{value:?}")).unwrap_or_default(),
                name: parameter,
                reason: error.to_string(),
            },
        })?;
        for (unknown, nearest) in store.undeclared(&given) {
            let meant = nearest.map(|known| format!("; is {known} meant?")).unwrap_or_default();
            node.logger().warn(&format!(
                "the parameter {unknown} was given, but {name} has none of that name{meant}"
            ));
        }
        let shown = clock.clone();
        node.subscribe_on("/clock", Qos::DEFAULT, move |message: msgs::rosgraph_msgs::Clock| {
            shown.show(message.clock.to_nanos());
        })?;
        let new = store.values().iter();
        let new = new.map(|(name, value)| raw_parameter(name, value.clone())).collect();
        let events = Events::begin(node, name, new)?;
        let parameters = Self(Arc::new(Inner { store: Mutex::new(store), events }));
        parameters.serve(node)?;
        Ok(parameters)
    }

    /// What every node of ROS 2 has and nothing else, with the six services, so that whoever
    /// asks all nodes for their parameters need not wait for this one. They answer for as long as
    /// the node is there.
    ///
    /// # Errors
    /// As for [`declare`](Self::declare).
    pub fn usual(node: &RosNode) -> Result<Self, RosNodeError> {
        Self::declare(node, Vec::new(), |_, _| Ok(()))
    }

    /// The value of a parameter, if there is one of that name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<ParameterValue> {
        self.0.store().values().get(name).cloned()
    }

    /// All values now.
    #[must_use]
    pub fn values(&self) -> Values {
        self.0.store().values().clone()
    }

    /// Sets all of `changes` or none, and tells it.
    ///
    /// # Errors
    /// [`ParameterError`]; its text is for people.
    pub fn set(&self, changes: &[Change]) -> Result<(), ParameterError> {
        self.0.store().set(changes)?;
        let changed = changes.iter().map(|c| raw_parameter(&c.name, c.value.clone())).collect();
        self.0.events.tell_changed(changed);
        Ok(())
    }

    fn serve(&self, node: &RosNode) -> Result<(), RosNodeError> {
        let package = "rcl_interfaces";
        let this = self.clone();
        node.raw_serve(
            "~/list_parameters",
            package,
            "ListParameters",
            move |asked: ListParametersRequest| {
                let (names, prefixes) = this.0.store().list(&asked.prefixes, asked.depth);
                ListParametersResponse { result: ListParametersResult { names, prefixes } }
            },
        )?;
        let this = self.clone();
        node.raw_serve(
            "~/get_parameters",
            package,
            "GetParameters",
            move |asked: GetParametersRequest| {
                let store = this.0.store();
                GetParametersResponse {
                    values: asked.names.iter().map(|name| store.raw(name)).collect(),
                }
            },
        )?;
        let this = self.clone();
        node.raw_serve(
            "~/get_parameter_types",
            package,
            "GetParameterTypes",
            move |asked: GetParameterTypesRequest| {
                let store = this.0.store();
                GetParameterTypesResponse {
                    values: asked.names.iter().map(|name| store.kind(name)).collect(),
                }
            },
        )?;
        let this = self.clone();
        node.raw_serve(
            "~/describe_parameters",
            package,
            "DescribeParameters",
            move |asked: DescribeParametersRequest| {
                let store = this.0.store();
                DescribeParametersResponse {
                    values: asked.names.iter().map(|name| store.describe(name)).collect(),
                }
            },
        )?;
        let this = self.clone();
        node.raw_serve(
            "~/set_parameters",
            package,
            "SetParameters",
            move |asked: SetParametersRequest| {
                let results = changes(asked)
                    .into_iter()
                    .map(|change| set_result(this.set(&[change])))
                    .collect();
                SetParametersResponse { results }
            },
        )?;
        let this = self.clone();
        node.raw_serve(
            "~/set_parameters_atomically",
            package,
            "SetParametersAtomically",
            move |asked: SetParametersRequest| SetParametersAtomicallyResponse {
                result: set_result(this.set(&changes(asked))),
            },
        )
    }
}

impl Inner {
    fn store(&self) -> MutexGuard<'_, ParameterStore> {
        self.store.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn raw_parameter(name: &str, value: ParameterValue) -> raw::Parameter {
    raw::Parameter { name: name.to_owned(), value: wire::to_raw(value) }
}

fn set_result(result: Result<(), ParameterError>) -> raw::SetParametersResult {
    result.map_err(|error| error.to_string()).into()
}

fn changes(asked: SetParametersRequest) -> Vec<Change> {
    asked
        .parameter
        .into_iter()
        .map(|parameter| Change { name: parameter.name, value: wire::from_raw(parameter.value) })
        .collect()
}
