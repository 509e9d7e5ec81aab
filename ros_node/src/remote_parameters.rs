//! Parameters of another node.

use std::{collections::BTreeMap, time::Duration};

use ros2_client::{
    parameters::raw,
    rcl_interfaces::{
        GetParametersRequest, GetParametersResponse, SetParametersAtomicallyResponse,
        SetParametersRequest,
    },
};

use ::parameters::ParameterValue;

use crate::parameters::wire;
use crate::{RosNode, RosNodeError, ServiceClient};

/// Reads and sets the parameters of a node that may run anywhere.
pub struct RemoteParameters {
    node: String,
    get: ServiceClient<GetParametersRequest, GetParametersResponse>,
    set: ServiceClient<SetParametersRequest, SetParametersAtomicallyResponse>,
}

impl RemoteParameters {
    /// Of the node that `this` node calls `name`.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn new(this: &RosNode, name: &str) -> Result<Self, RosNodeError> {
        let package = "rcl_interfaces";
        Ok(Self {
            node: name.to_owned(),
            get: this.raw_client(&format!("{name}/get_parameters"), package, "GetParameters")?,
            set: this.raw_client(
                &format!("{name}/set_parameters_atomically"),
                package,
                "SetParametersAtomically",
            )?,
        })
    }

    /// Values of those of `names` that the node has.
    ///
    /// # Errors
    /// [`RosNodeError::NoAnswer`].
    pub fn get(
        &self,
        names: &[String],
        patience: Duration,
    ) -> Result<BTreeMap<String, ParameterValue>, RosNodeError> {
        let request = GetParametersRequest { names: names.to_vec() };
        let answer = self.get.call_until_answered(&request, patience)?;
        let values = names.iter().cloned().zip(answer.values.into_iter().map(wire::from_raw));
        Ok(values.filter(|(_, value)| *value != ParameterValue::NotSet).collect())
    }

    /// Sets all of `values` or none.
    ///
    /// # Errors
    /// [`RosNodeError::Refused`] with the node's reason; [`RosNodeError::NoAnswer`].
    pub fn set(
        &self,
        values: &BTreeMap<String, ParameterValue>,
        patience: Duration,
    ) -> Result<(), RosNodeError> {
        let raw = |(name, value): (&String, &ParameterValue)| raw::Parameter {
            name: name.clone(),
            value: wire::to_raw(value.clone()),
        };
        let request = SetParametersRequest { parameter: values.iter().map(raw).collect() };
        // Setting the same values twice comes to the same.
        let answer = self.set.call_until_answered(&request, patience)?;
        if answer.result.successful {
            Ok(())
        } else {
            Err(RosNodeError::Refused {
                node: self.node.clone(),
                what: "the parameters",
                reason: answer.result.reason,
            })
        }
    }
}
