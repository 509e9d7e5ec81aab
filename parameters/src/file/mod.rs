//! Parameter files: YAML that names nodes and their parameters, as `rcl_yaml_param_parser` reads
//! it.
//!
//! ```yaml
//! /axis_1/controller:        # or axis_1: {controller: ...}, controller, /**, /*/controller
//!   ros__parameters:
//!     mode: velocity
//!     lag: {k_p: 1.5}        # the parameter lag.k_p
//! ```
//!
//! Types follow the text, as in rcl: `yes` and `On` are booleans, `0x10` and `010` are 16 and 8,
//! `1e3` and `.nan` are doubles, and what is quoted is a string. All elements of a list have one
//! type; lists in lists and aliases are refused.
//!
//! [`Parameters`] reads a file, [`Writer`] writes one with a comment behind each value.

mod reader;
mod writer;

use std::collections::BTreeMap;

pub use reader::parse_value;
pub use writer::{Writer, number, scalar, word};

use crate::{Declaration, ParameterError, ParameterValue, nearest};

const PARAMETERS: &str = "ros__parameters";

/// Parameters that every node of ROS has.
pub const EVERY_NODES: [&str; 2] = ["use_sim_time", "start_type_description_service"];

/// What is wrong in a file, in a sentence with the line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FileError(String);

/// Parameters for the nodes whose name fits a pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeParameters {
    /// Absolute name of a node, in which `*` stands for one part of the name and `**` for any
    /// number of them.
    pub pattern: String,
    /// The values by name; names in maps are joined by dots.
    pub values: BTreeMap<String, ParameterValue>,
}

impl NodeParameters {
    /// Whether the node of that absolute name is meant.
    #[must_use]
    pub fn is_for(&self, node: &str) -> bool {
        let parts = |text: &'_ str| text.split('/').skip(1).map(str::to_owned).collect::<Vec<_>>();
        fits(&parts(&self.pattern), &parts(node))
    }
}

fn fits(pattern: &[String], name: &[String]) -> bool {
    match (pattern.split_first(), name.split_first()) {
        (None, None) => true,
        (Some((first, rest)), _) if first == "**" => {
            (0..=name.len()).any(|taken| name.get(taken..).is_some_and(|left| fits(rest, left)))
        }
        (Some((first, rest)), Some((part, left))) => {
            (first == "*" || first == part) && fits(rest, left)
        }
        _ => false,
    }
}

/// What a file says, or several in their order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parameters(Vec<NodeParameters>);

impl Parameters {
    /// Reads a file's text.
    ///
    /// # Errors
    /// [`FileError`] with the line.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let mut all = Self::default();
        reader::parse(text).map_err(FileError)?.into_iter().for_each(|given| all.give(given));
        Ok(all)
    }

    /// Adds values to those that the same pattern has already, as rcl does: a pattern keeps the
    /// place at which it was first met.
    pub fn give(&mut self, given: NodeParameters) {
        match self.0.iter_mut().find(|known| known.pattern == given.pattern) {
            Some(known) => known.values.extend(given.values),
            None => self.0.push(given),
        }
    }

    /// Each pattern with its values, in the order in which they count.
    #[must_use]
    pub fn nodes(&self) -> &[NodeParameters] {
        &self.0
    }

    /// Puts what `earlier` say before these: these count above them.
    pub fn put_before(&mut self, earlier: Vec<NodeParameters>) {
        let later = std::mem::replace(&mut self.0, earlier);
        self.0.extend(later);
    }

    /// Whether a pattern names the node of that absolute name; `/**`, which means all nodes, names
    /// none.
    #[must_use]
    pub fn names(&self, node: &str) -> bool {
        self.0.iter().any(|given| given.pattern != "/**" && given.is_for(node))
    }

    /// What is given for the node of that absolute name.
    #[must_use]
    pub fn of_node(&self, node: &str) -> BTreeMap<String, ParameterValue> {
        let of = self.0.iter().filter(|given| given.is_for(node));
        of.flat_map(|given| given.values.clone()).collect()
    }

    /// What is given for the node of that absolute name, each value as its declaration takes it. Of
    /// what is meant for all nodes (`/**`), what this one does not have is left out, and so are the
    /// parameters that every node has ([`EVERY_NODES`]).
    ///
    /// # Errors
    /// [`ParameterError`] for a value that is not taken, and for a name that the node does not have,
    /// with the nearest that it has.
    pub fn taken_by(
        &self,
        node: &str,
        declared: &[Declaration],
    ) -> Result<BTreeMap<String, ParameterValue>, ParameterError> {
        let mut taken = BTreeMap::new();
        for given in self.0.iter().filter(|given| given.is_for(node)) {
            for (name, value) in &given.values {
                match declared.iter().find(|one| one.name() == name) {
                    Some(one) => _ = taken.insert(name.clone(), one.accept(value)?),
                    None if given.pattern == "/**" || EVERY_NODES.contains(&&**name) => {}
                    None => {
                        let known = declared.iter().map(Declaration::name);
                        let nearest = nearest(name, known).map(str::to_owned);
                        return Err(ParameterError::Unknown { name: name.clone(), nearest });
                    }
                }
            }
        }
        Ok(taken)
    }
}

#[cfg(test)]
mod tests {
    use ParameterValue as V;

    use super::*;

    #[test]
    fn a_file_names_nodes_in_every_way_rcl_knows() {
        let text = "\
# comment
/**:
  ros__parameters: {use_sim_time: false}
axis_1:
  controller:
    ros__parameters:
      lag:
        k_p: 1.5
      gains: [1.0, 2.0]
/axis_2/controller:
  ros__parameters:
    mode: position
'/*/observer':
  ros__parameters: {model: lugre}
";
        let found = Parameters::parse(text).unwrap().0;
        let patterns: Vec<_> = found.iter().map(|node| node.pattern.as_str()).collect();
        assert_eq!(patterns, ["/**", "/axis_1/controller", "/axis_2/controller", "/*/observer"]);
        assert_eq!(found[1].values["lag.k_p"], V::Double(1.5));
        assert_eq!(found[1].values["gains"], V::DoubleArray(vec![1.0, 2.0]));
        assert!(found[0].is_for("/controller") && found[0].is_for("/a/b/c"));
        assert!(found[1].is_for("/axis_1/controller") && !found[1].is_for("/controller"));
        assert!(
            found[3].is_for("/axis_1/observer")
                && !found[3].is_for("/observer")
                && !found[3].is_for("/a/b/observer")
        );
    }

    #[test]
    fn a_file_with_a_mistake_says_in_which_line() {
        for (text, said) in [
            ("", "nothing"),
            ("a: 1", "line 1"),
            ("ros__parameters: {a: 1}", "line 1"),
            ("/n:\n  ros__parameters:\n    a:\n", "line 3"),
            ("/n:\n  ros__parameters:\n    a: [1, x]\n", "line 3"),
            ("/n:\n  x: 1\n", "line 2"),
            ("/n m:\n  ros__parameters: {a: 1}\n", "line 1"),
            ("/n:\n  ros__parameters: {a: 1}\n---\nb: 1\n", "line"),
        ] {
            let message = Parameters::parse(text).unwrap_err().to_string();
            assert!(message.contains(said), "{text:?}: {message}");
        }
        let deep = format!("{}1{}", "{a: ".repeat(5000), "}".repeat(5000));
        assert!(Parameters::parse(&deep).is_err());
    }
}
