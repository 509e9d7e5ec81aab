//! Parameters of another node.

use std::{collections::BTreeMap, time::Duration};

use ros2_client::{
    parameters::raw,
    rcl_interfaces::{
        DescribeParametersRequest, DescribeParametersResponse, GetParametersRequest,
        GetParametersResponse, ListParametersRequest, ListParametersResponse,
        SetParametersAtomicallyResponse, SetParametersRequest,
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
    list: ServiceClient<ListParametersRequest, ListParametersResponse>,
    describe: ServiceClient<DescribeParametersRequest, DescribeParametersResponse>,
}

/// What a node says of one of its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Described {
    /// Its name.
    pub name: String,
    /// What it is, with its unit in brackets at the end.
    pub description: String,
    /// What else it must be, in words.
    pub constraints: String,
    /// It cannot be changed while the node runs.
    pub read_only: bool,
    /// Lowest and highest value, where there are such.
    pub range: Option<(f64, f64)>,
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
            list: this.raw_client(&format!("{name}/list_parameters"), package, "ListParameters")?,
            describe: this.raw_client(
                &format!("{name}/describe_parameters"),
                package,
                "DescribeParameters",
            )?,
        })
    }

    /// What the node says of each of its parameters.
    ///
    /// # Errors
    /// [`RosNodeError::NoAnswer`].
    pub fn describe(&self, patience: Duration) -> Result<Vec<Described>, RosNodeError> {
        let all = ListParametersRequest { prefixes: Vec::new(), depth: 0 };
        let names = self.list.call_until_answered(&all, patience)?.result.names;
        let request = DescribeParametersRequest { names };
        let answer = self.describe.call_until_answered(&request, patience)?;
        Ok(answer.values.into_iter().map(described).collect())
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

fn described(one: raw::ParameterDescriptor) -> Described {
    let double = one.floating_point_range.first().map(|range| (range.from_value, range.to_value));
    let integer = one.integer_range.first();
    let integer = integer.map(|range| (range.from_value as f64, range.to_value as f64));
    Described {
        name: one.name,
        description: one.description,
        constraints: one.additional_constraints,
        read_only: one.read_only,
        range: double.or(integer),
    }
}
