//! Remapping: other names for nodes, topics and services than those in the code.
//!
//! A rule is `[NODE:]FROM:=TO` (<https://design.ros2.org/articles/static_remapping.html>). `FROM`
//! is `__node` or `__name`, `__ns`, or the name of a topic or service, with `rostopic://` or
//! `rosservice://` before it to mean one of them only. The first rule that fits wins. Wildcards and
//! back references of the article are refused, as rcl has none either.

use crate::{NodeIdentity, RosNodeError, names::is_token};

/// What a rule is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    NodeName,
    Namespace,
    Topic,
    Service,
    TopicOrService,
}

impl Kind {
    /// Whether both sides of the rule `text` are names that such a rule may have.
    fn require_names(self, text: &str, from: &str, to: &str) -> Result<(), RemapError> {
        let named = |source| RemapError::Name { text: text.to_owned(), source: Box::new(source) };
        match self {
            Self::NodeName => NodeIdentity::new(to, "/").map(drop).map_err(named),
            Self::Namespace if !to.starts_with('/') => {
                Err(RemapError::Namespace { text: text.to_owned() })
            }
            Self::Namespace => NodeIdentity::new("n", to).map(drop).map_err(named),
            Self::Topic | Self::Service | Self::TopicOrService => {
                let probe = NodeIdentity { name: "n".into(), namespace: "/".into() };
                for side in [from, to] {
                    if side.contains(['*', '\\']) {
                        return Err(RemapError::Wildcard { text: text.to_owned() });
                    }
                    probe.expand(side).map_err(named)?;
                }
                Ok(())
            }
        }
    }
}

/// One rule.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RemapRule {
    /// Only for the node of that name.
    node: Option<String>,
    kind: Kind,
    from: String,
    to: String,
}

/// A text that is no remapping rule.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RemapError {
    /// There is no `:=`.
    #[error("`{text}` is no remapping; expected FROM:=TO, as in joint_states:=/arm/joint_states")]
    NoRule {
        /// What came.
        text: String,
    },
    /// What stands before `://` says neither topic nor service.
    #[error("`{scheme}://` in `{text}` is unknown; there are rostopic:// and rosservice://")]
    Scheme {
        /// What stands there.
        scheme: String,
        /// The rule.
        text: String,
    },
    /// The node that the rule is for cannot have that name.
    #[error("`{node}` in the remapping `{text}` is no name of a node")]
    Node {
        /// The name.
        node: String,
        /// The rule.
        text: String,
    },
    /// A namespace without its slash.
    #[error("the namespace in `{text}` must begin with a slash, as in __ns:=/axis_1")]
    Namespace {
        /// The rule.
        text: String,
    },
    /// Wildcards, which rcl does not understand either.
    #[error("wildcards in remappings, as in `{text}`, are not understood; write the whole name")]
    Wildcard {
        /// The rule.
        text: String,
    },
    /// One of its sides is no name.
    #[error("in the remapping `{text}`: {source}")]
    Name {
        /// The rule.
        text: String,
        /// What is wrong with the name.
        source: Box<RosNodeError>,
    },
}

impl RemapRule {
    /// Reads a rule.
    ///
    /// # Errors
    /// [`RemapError`] says what is wrong with it.
    pub fn parse(text: &str) -> Result<Self, RemapError> {
        let text_of = || text.to_owned();
        let (left, to) =
            text.split_once(":=").ok_or_else(|| RemapError::NoRule { text: text_of() })?;
        let (left, scheme) = match left.split_once("://") {
            Some((before, from)) => {
                let (node, scheme) = match before.rsplit_once(':') {
                    Some((node, scheme)) => (Some(node), scheme),
                    None => (None, before),
                };
                let kind = match scheme {
                    "rostopic" => Kind::Topic,
                    "rosservice" => Kind::Service,
                    other => {
                        let scheme = other.to_owned();
                        return Err(RemapError::Scheme { scheme, text: text_of() });
                    }
                };
                ((node, from), Some(kind))
            }
            None => match left.split_once(':') {
                Some((node, from)) => ((Some(node), from), None),
                None => ((None, left), None),
            },
        };
        let (node, from) = left;
        if let Some(node) = node
            && !is_token(node)
        {
            return Err(RemapError::Node { node: node.to_owned(), text: text_of() });
        }
        let kind = match (from, scheme) {
            ("__node" | "__name", None) => Kind::NodeName,
            ("__ns", None) => Kind::Namespace,
            (_, scheme) => scheme.unwrap_or(Kind::TopicOrService),
        };
        kind.require_names(text, from, to)?;
        Ok(Self { node: node.map(str::to_owned), kind, from: from.to_owned(), to: to.to_owned() })
    }

    fn is_for(&self, node: &str) -> bool {
        self.node.as_deref().is_none_or(|only| only == node)
    }
}

/// The rules of a process, in their order.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Remaps(Vec<RemapRule>);

/// What a name is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Named {
    /// A topic.
    Topic,
    /// A service, or an action.
    Service,
}

impl Remaps {
    /// Adds a rule behind the others.
    pub fn push(&mut self, rule: RemapRule) {
        self.0.push(rule);
    }

    /// Name and namespace of the node that the code calls `name` in `namespace`. A rule for one
    /// node is looked up under the code's name for `__node`, and under the new name for everything
    /// else.
    ///
    /// # Errors
    /// [`RosNodeError::Name`] if the code's own names are none.
    pub fn node(&self, name: &str, namespace: &str) -> Result<NodeIdentity, RosNodeError> {
        let first = |kind: Kind, node: &str| {
            self.0
                .iter()
                .find(|rule| rule.kind == kind && rule.is_for(node))
                .map(|rule| rule.to.clone())
        };
        let name = first(Kind::NodeName, name).unwrap_or_else(|| name.to_owned());
        let namespace = first(Kind::Namespace, &name).unwrap_or_else(|| namespace.to_owned());
        NodeIdentity::new(&name, &namespace)
    }

    /// The absolute name that `node` has for the topic or service `name`.
    ///
    /// # Errors
    /// [`RosNodeError::Name`] if `name` is none.
    pub fn resolve(
        &self,
        node: &NodeIdentity,
        named: Named,
        name: &str,
    ) -> Result<String, RosNodeError> {
        let absolute = node.expand(name)?;
        for rule in &self.0 {
            let fits = match rule.kind {
                Kind::TopicOrService => true,
                Kind::Topic => named == Named::Topic,
                Kind::Service => named == Named::Service,
                Kind::NodeName | Kind::Namespace => false,
            };
            if fits && rule.is_for(&node.name) && node.expand(&rule.from)? == absolute {
                return node.expand(&rule.to);
            }
        }
        Ok(absolute)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn remaps(rules: &[&str]) -> Remaps {
        let mut remaps = Remaps::default();
        rules.iter().for_each(|rule| remaps.push(RemapRule::parse(rule).unwrap()));
        remaps
    }

    /// As in rcl's `test_remap.cpp`: a global rule, a rule of another node, the first of several,
    /// relative and private names.
    #[test]
    fn topics_and_services_are_remapped_as_rcl_does_it() {
        let node = NodeIdentity::new("NodeName", "/ns").unwrap();
        for (rules, named, name, expected) in [
            (&["/foo/bar:=/bar/foo"][..], Named::Topic, "/foo/bar", "/bar/foo"),
            (&["foo:=bar"], Named::Topic, "/ns/foo", "/ns/bar"),
            (&["/foo/bar:=bar"], Named::Topic, "/foo/bar", "/ns/bar"),
            (&["NodeName:/foo:=/bar"], Named::Service, "/foo", "/bar"),
            (&["Other:/foo:=/bar"], Named::Topic, "/foo", "/foo"),
            (&["/a:=/b", "/a:=/c"], Named::Topic, "/a", "/b"),
            (&["/a:=/b", "/b:=/c"], Named::Topic, "/a", "/b"),
            (&["rostopic:///a:=/b"], Named::Service, "/a", "/a"),
            (&["NodeName:rosservice://~/a:=/b"], Named::Service, "~/a", "/b"),
            (&["~/a:=~/b"], Named::Topic, "/ns/NodeName/a", "/ns/NodeName/b"),
        ] {
            assert_eq!(remaps(rules).resolve(&node, named, name).unwrap(), expected, "{rules:?}");
        }
    }

    #[test]
    fn nodes_get_names_and_namespaces() {
        let get = |rules: &[&str]| remaps(rules).node("controller", "/").unwrap().qualified();
        assert_eq!(get(&[]), "/controller");
        assert_eq!(get(&["__node:=b", "__ns:=/a"]), "/a/b");
        assert_eq!(get(&["__name:=b"]), "/b");
        assert_eq!(get(&["controller:__node:=b", "b:__ns:=/a"]), "/a/b");
        assert_eq!(get(&["other:__node:=b", "other:__ns:=/a"]), "/controller");
    }

    #[test]
    fn a_bad_rule_is_refused_with_a_sentence() {
        for rule in [
            "a",
            "a:=",
            ":=b",
            "__ns:=a",
            "__node:=a/b",
            "a:=b c",
            "x-y:a:=b",
            "ftp://a:=b",
            "a/*:=b",
        ] {
            assert!(RemapRule::parse(rule).unwrap_err().to_string().len() > 20, "{rule}");
        }
    }
}
