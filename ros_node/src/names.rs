//! Names of nodes, topics and services: what is allowed, and how a name becomes absolute.
//!
//! The rules are those of <https://design.ros2.org/articles/topic_and_service_names.html>.

use crate::RosNodeError;

/// A node's name and namespace.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeIdentity {
    /// Name without namespace, as in `controller`.
    pub name: String,
    /// Namespace, `/` or a path such as `/axis_1`.
    pub namespace: String,
}

impl NodeIdentity {
    /// A node of that name in that namespace.
    ///
    /// # Errors
    /// [`RosNodeError::Name`] says which of the two is none and why.
    pub fn new(name: &str, namespace: &str) -> Result<Self, RosNodeError> {
        if !is_token(name) {
            return Err(RosNodeError::Name {
                what: "a node",
                name: name.to_owned(),
                expected: "letters, digits and underscores, not beginning with a digit",
            });
        }
        let namespace = if namespace.is_empty() { "/" } else { namespace };
        let absolute =
            if namespace.starts_with('/') { namespace.to_owned() } else { format!("/{namespace}") };
        if absolute != "/" && !is_absolute(&absolute) {
            return Err(RosNodeError::Name {
                what: "a namespace",
                name: namespace.to_owned(),
                expected: "slashes with letters, digits and underscores between, as in /axis_1",
            });
        }
        Ok(Self { name: name.to_owned(), namespace: absolute })
    }

    /// Namespace and name in one, as in `/axis_1/controller`.
    #[must_use]
    pub fn qualified(&self) -> String {
        join(&self.namespace, &self.name)
    }

    /// The name as loggers spell it: dots in place of slashes, as in `axis_1.controller`.
    #[must_use]
    pub fn logger(&self) -> String {
        self.qualified().trim_start_matches('/').replace('/', ".")
    }

    /// The absolute name of `name` as this node says it: `/x` stays, `x` lies in the namespace,
    /// `~/x` below the node; `{node}`, `{ns}` and `{namespace}` are replaced.
    ///
    /// # Errors
    /// [`RosNodeError::Name`] if no name comes out.
    pub fn expand(&self, name: &str) -> Result<String, RosNodeError> {
        let text = name
            .replace("{node}", &self.name)
            .replace("{ns}", self.namespace.trim_start_matches('/'))
            .replace("{namespace}", self.namespace.trim_start_matches('/'));
        let absolute = if let Some(rest) = text.strip_prefix("~/") {
            join(&self.qualified(), rest)
        } else if text == "~" {
            self.qualified()
        } else if text.starts_with('/') {
            text
        } else {
            join(&self.namespace, &text)
        };
        if is_absolute(&absolute) {
            Ok(absolute)
        } else {
            Err(RosNodeError::Name {
                what: "a topic or service",
                name: name.to_owned(),
                expected: "letters, digits and single underscores with slashes between; `~/` stands for the node",
            })
        }
    }
}

/// `name` below `namespace`.
fn join(namespace: &str, name: &str) -> String {
    format!("{}/{name}", namespace.trim_end_matches('/'))
}

/// Letters, digits and underscores, the first no digit.
pub(crate) fn is_token(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// A slash and tokens with slashes between, without doubled underscores.
fn is_absolute(text: &str) -> bool {
    text.strip_prefix('/')
        .is_some_and(|rest| rest.split('/').all(|token| is_token(token) && !token.contains("__")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table "Examples" of the design article.
    #[test]
    fn names_expand_as_the_design_article_says() {
        let node = |namespace: &str, name: &str| NodeIdentity::new(name, namespace).unwrap();
        let (root, ns) = (node("/", "my_node"), node("/my_ns", "my_node"));
        for (name, in_root, in_ns) in [
            ("ping", "/ping", "/my_ns/ping"),
            ("/ping", "/ping", "/ping"),
            ("~", "/my_node", "/my_ns/my_node"),
            ("~/ping", "/my_node/ping", "/my_ns/my_node/ping"),
            ("{node}/ping", "/my_node/ping", "/my_ns/my_node/ping"),
        ] {
            assert_eq!(root.expand(name).unwrap(), in_root);
            assert_eq!(ns.expand(name).unwrap(), in_ns);
        }
    }

    #[test]
    fn what_is_no_name_is_refused_by_name() {
        let node = NodeIdentity::new("n", "axis_1").unwrap();
        assert_eq!(node.namespace, "/axis_1");
        assert_eq!((node.qualified(), node.logger()), ("/axis_1/n".into(), "axis_1.n".into()));
        for name in ["", "a b", "a//b", "a/", "1a", "a__b", "~a", "{x}", "/"] {
            let said = node.expand(name).unwrap_err().to_string();
            assert!(said.contains(&format!("`{name}`")), "{said}");
        }
        assert!(NodeIdentity::new("my-node", "/").is_err());
        assert!(NodeIdentity::new("n", "/a/").is_err());
    }
}
