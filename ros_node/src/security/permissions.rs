//! Permissions and governance of DDS Security: written from a policy of SROS 2, and read back.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
};

use roxmltree::{Document, Node};

use super::calendar::{from_text, to_text};

/// Topics of DDS that an enclave may write and read, with `*` for any text.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Rights {
    /// Those it may write.
    pub publish: BTreeSet<String>,
    /// Those it may read.
    pub subscribe: BTreeSet<String>,
}

/// A text that is no policy of SROS 2.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PolicyError {
    /// No XML.
    #[error("the policy is no XML: {0}")]
    Xml(#[from] roxmltree::Error),
    /// An enclave without a path.
    #[error("line {line}: an enclave without a path")]
    NoPath {
        /// Its line.
        line: u32,
    },
    /// Something else than allowed or denied.
    #[error("line {line}: `{found}`; expected ALLOW or DENY")]
    Qualifier {
        /// Its line.
        line: u32,
        /// What stands there.
        found: String,
    },
    /// A right that there is not.
    #[error(
        "line {line}: `{list} {right}`; expected topics publish or subscribe, services request or reply, actions call or execute"
    )]
    Right {
        /// Its line.
        line: u32,
        /// What it is about.
        list: String,
        /// The right.
        right: String,
    },
    /// Nobody in it.
    #[error("the policy names no enclave; expected <policy><enclaves><enclave path=\"/name\">")]
    Empty,
}

/// A text that is no document of permissions or governance.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// No XML.
    #[error("the {what} is no XML: {source}")]
    Xml {
        /// Which document.
        what: &'static str,
        /// What is wrong with it.
        source: roxmltree::Error,
    },
    /// A grant that is nobody's.
    #[error("a grant without subject_name")]
    NoSubject,
    /// A time that is none.
    #[error("`{text}` is no time for {name}; expected as in 2026-01-31T00:00:00")]
    Time {
        /// Which.
        name: &'static str,
        /// What stands there.
        text: String,
    },
}

/// What each enclave of a policy is allowed and denied, by its name.
pub type Policy = BTreeMap<String, (Rights, Rights)>;

/// Reads a policy of SROS 2 (version 0.2.0).
///
/// # Errors
/// [`PolicyError`] with what is not understood, and its line.
pub fn read_policy(text: &str) -> Result<Policy, PolicyError> {
    let document = Document::parse(text)?;
    let at = |node: Node| document.text_pos_at(node.range().start).row;
    let mut policy = Policy::new();
    for enclave in document.descendants().filter(|node| node.has_tag_name("enclave")) {
        let name =
            enclave.attribute("path").ok_or_else(|| PolicyError::NoPath { line: at(enclave) })?;
        let (allowed, denied) = policy.entry(name.to_owned()).or_default();
        for profile in enclave.descendants().filter(|node| node.has_tag_name("profile")) {
            let (namespace, node) =
                (profile.attribute("ns").unwrap_or("/"), profile.attribute("node").unwrap_or(""));
            for list in profile.children().filter(Node::is_element) {
                let names: Vec<String> = list
                    .children()
                    .filter(Node::is_element)
                    .map(|item| full_name(namespace, node, item.text().unwrap_or("").trim()))
                    .collect();
                for attribute in list.attributes() {
                    let rights = match attribute.value() {
                        "ALLOW" => &mut *allowed,
                        "DENY" => &mut *denied,
                        other => {
                            let found = other.to_owned();
                            return Err(PolicyError::Qualifier { line: at(list), found });
                        }
                    };
                    for name in &names {
                        let (kind, right) = (list.tag_name().name(), attribute.name());
                        rights.add(kind, right, name).ok_or_else(|| PolicyError::Right {
                            line: at(list),
                            list: kind.to_owned(),
                            right: right.to_owned(),
                        })?;
                    }
                }
            }
        }
    }
    if policy.is_empty() {
        return Err(PolicyError::Empty);
    }
    Ok(policy)
}

/// An absolute name of ROS.
fn full_name(namespace: &str, node: &str, name: &str) -> String {
    let namespace = namespace.trim_end_matches('/');
    match name.strip_prefix('~') {
        Some(own) => format!("{namespace}/{node}{own}"),
        None if name.starts_with('/') => name.to_owned(),
        None => format!("{namespace}/{name}"),
    }
}

impl Rights {
    /// Adds what ROS needs for that, as topics of DDS; `None` if there is no such right.
    fn add(&mut self, list: &str, what: &str, name: &str) -> Option<()> {
        let asks = |service: String| (format!("rq{service}Request"), format!("rr{service}Reply"));
        let goals = ["send_goal", "cancel_goal", "get_result"]
            .map(|part| asks(format!("{name}/_action/{part}")));
        let tells = ["feedback", "status"].map(|part| format!("rt{name}/_action/{part}"));
        match (list, what) {
            ("topics", "publish") => _ = self.publish.insert(format!("rt{name}")),
            ("topics", "subscribe") => _ = self.subscribe.insert(format!("rt{name}")),
            ("services", "request") => self.ask([asks(name.to_owned())]),
            ("services", "reply") => self.answer([asks(name.to_owned())]),
            ("actions", "call") => {
                self.ask(goals);
                self.subscribe.extend(tells);
            }
            ("actions", "execute") => {
                self.answer(goals);
                self.publish.extend(tells);
            }
            _ => return None,
        }
        Some(())
    }

    fn ask<const N: usize>(&mut self, services: [(String, String); N]) {
        for (request, reply) in services {
            self.publish.insert(request);
            self.subscribe.insert(reply);
        }
    }

    fn answer<const N: usize>(&mut self, services: [(String, String); N]) {
        for (request, reply) in services {
            self.subscribe.insert(request);
            self.publish.insert(reply);
        }
    }

    fn is_empty(&self) -> bool {
        self.publish.is_empty() && self.subscribe.is_empty()
    }
}

/// Text that means itself in XML.
fn plain(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<dds xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
     xsi:noNamespaceSchemaLocation=\"http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_";

fn domain_list(domains: &[u16], indent: &str) -> String {
    domains.iter().fold(format!("{indent}<domains>\n"), |text, id| {
        text + &format!("{indent}  <id>{id}</id>\n")
    }) + &format!("{indent}</domains>\n")
}

/// The permissions of an enclave, valid from one time to another, in seconds since 1970.
#[must_use]
pub fn permissions(
    enclave: &str,
    (allowed, denied): &(Rights, Rights),
    valid: (i64, i64),
    domains: &[u16],
) -> String {
    let name = plain(enclave);
    // Everybody takes part in the graph.
    let mut allowed = allowed.clone();
    allowed.publish.insert("ros_discovery_info".to_owned());
    allowed.subscribe.insert("ros_discovery_info".to_owned());
    let mut text = format!(
        "{HEAD}permissions.xsd\">\n  <permissions>\n    <grant name=\"{name}\">\n      <subject_name>CN={name}</subject_name>\n      <validity>\n        \
         <not_before>{}</not_before>\n        <not_after>{}</not_after>\n      </validity>\n",
        to_text(valid.0),
        to_text(valid.1)
    );
    for (rule, rights) in [("deny_rule", denied), ("allow_rule", &allowed)] {
        if rights.is_empty() {
            continue;
        }
        let _ = write!(text, "      <{rule}>\n{}", domain_list(domains, "        "));
        for (what, topics) in [("publish", &rights.publish), ("subscribe", &rights.subscribe)] {
            if topics.is_empty() {
                continue;
            }
            let _ = writeln!(text, "        <{what}>\n          <topics>");
            for topic in topics {
                let _ = writeln!(text, "            <topic>{}</topic>", plain(topic));
            }
            let _ = writeln!(text, "          </topics>\n        </{what}>");
        }
        let _ = writeln!(text, "      </{rule}>");
    }
    text + "      <default>DENY</default>\n    </grant>\n  </permissions>\n</dds>\n"
}

/// The rules of the domains: nobody unauthenticated, everything encrypted, and each message with a
/// code of its own for each reader, so that a reader of a topic cannot write in its writer's name.
#[must_use]
pub fn governance(domains: &[u16]) -> String {
    format!(
        "{HEAD}governance.xsd\">\n  <domain_access_rules>\n    <domain_rule>\n{}\
         \x20     <allow_unauthenticated_participants>false</allow_unauthenticated_participants>\n\
         \x20     <enable_join_access_control>true</enable_join_access_control>\n\
         \x20     <discovery_protection_kind>ENCRYPT</discovery_protection_kind>\n\
         \x20     <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>\n\
         \x20     <rtps_protection_kind>SIGN</rtps_protection_kind>\n\
         \x20     <topic_access_rules>\n        <topic_rule>\n          <topic_expression>*</topic_expression>\n\
         \x20         <enable_discovery_protection>true</enable_discovery_protection>\n\
         \x20         <enable_liveliness_protection>true</enable_liveliness_protection>\n\
         \x20         <enable_read_access_control>true</enable_read_access_control>\n\
         \x20         <enable_write_access_control>true</enable_write_access_control>\n\
         \x20         <metadata_protection_kind>ENCRYPT_WITH_ORIGIN_AUTHENTICATION</metadata_protection_kind>\n\
         \x20         <data_protection_kind>NONE</data_protection_kind>\n\
         \x20       </topic_rule>\n      </topic_access_rules>\n    </domain_rule>\n  </domain_access_rules>\n</dds>\n",
        domain_list(domains, "      ")
    )
}

/// What a document of permissions grants one subject.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Grant {
    /// Its name, as in `CN=/rig_driver`.
    pub subject: String,
    /// From when to when, in seconds since 1970.
    pub valid: (i64, i64),
    /// Domains, each with the first and the last of a range.
    pub domains: Vec<(u16, u16)>,
    /// What is allowed, in all domains together.
    pub allowed: Rights,
    /// Whether what no rule names is allowed.
    pub allows_the_rest: bool,
}

/// Reads the grants of a document.
///
/// # Errors
/// [`DocumentError`] with what is not understood.
pub fn read_permissions(text: &str) -> Result<Vec<Grant>, DocumentError> {
    let document = parsed("document of permissions", text)?;
    document.descendants().filter(|node| node.has_tag_name("grant")).map(read_grant).collect()
}

fn parsed<'a>(what: &'static str, text: &'a str) -> Result<Document<'a>, DocumentError> {
    Document::parse(text).map_err(|source| DocumentError::Xml { what, source })
}

fn text_of<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    node.descendants().find(|below| below.has_tag_name(name))?.text().map(str::trim)
}

fn read_grant(grant: Node) -> Result<Grant, DocumentError> {
    let time = |name: &'static str| {
        let text = text_of(grant, name).unwrap_or_default();
        from_text(text).ok_or_else(|| DocumentError::Time { name, text: text.to_owned() })
    };
    let mut rights = Rights::default();
    let mut domains = Vec::new();
    for rule in grant.children().filter(|node| node.has_tag_name("allow_rule")) {
        domains.extend(read_domains(rule));
        for (what, into) in [("publish", &mut rights.publish), ("subscribe", &mut rights.subscribe)]
        {
            let lists = rule.children().filter(|node| node.has_tag_name(what));
            let topics =
                lists.flat_map(|list| list.descendants()).filter(|node| node.has_tag_name("topic"));
            into.extend(
                topics.filter_map(|topic| topic.text()).map(|topic| topic.trim().to_owned()),
            );
        }
    }
    Ok(Grant {
        subject: text_of(grant, "subject_name").ok_or(DocumentError::NoSubject)?.to_owned(),
        valid: (time("not_before")?, time("not_after")?),
        domains,
        allowed: rights,
        allows_the_rest: text_of(grant, "default") == Some("ALLOW"),
    })
}

fn read_domains(rule: Node) -> Vec<(u16, u16)> {
    let Some(domains) = rule.children().find(|node| node.has_tag_name("domains")) else {
        return Vec::new();
    };
    let number = |text: Option<&str>| text.and_then(|text| text.trim().parse().ok());
    domains
        .children()
        .filter_map(|node| match node.tag_name().name() {
            "id" => number(node.text()).map(|id| (id, id)),
            "id_range" => Some((
                number(text_of(node, "min")).unwrap_or(0),
                number(text_of(node, "max")).unwrap_or(u16::MAX),
            )),
            _ => None,
        })
        .collect()
}

/// What a governance document says of a domain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rules {
    /// Domains, each with the first and the last of a range.
    pub domains: Vec<(u16, u16)>,
    /// What of it leaves the domain open, in sentences.
    pub open: Vec<String>,
}

/// Reads the rules of a governance document.
///
/// # Errors
/// [`DocumentError`] with what is not understood.
pub fn read_governance(text: &str) -> Result<Vec<Rules>, DocumentError> {
    let document = parsed("governance", text)?;
    let rules = document.descendants().filter(|node| node.has_tag_name("domain_rule"));
    Ok(rules.map(|rule| Rules { domains: read_domains(rule), open: open(rule) }).collect())
}

fn open(rule: Node) -> Vec<String> {
    let is = |node: Node, name: &str, value: &str| {
        text_of(node, name).is_some_and(|text| text.eq_ignore_ascii_case(value))
    };
    let mut open = Vec::new();
    if !is(rule, "allow_unauthenticated_participants", "false") {
        open.push(
            "participants that prove nothing may join (allow_unauthenticated_participants)"
                .to_owned(),
        );
    }
    if !is(rule, "enable_join_access_control", "true") {
        open.push(
            "joining is not checked against permissions (enable_join_access_control)".to_owned(),
        );
    }
    for topic in rule.descendants().filter(|node| node.has_tag_name("topic_rule")) {
        let name = text_of(topic, "topic_expression").unwrap_or("?");
        for (what, say) in
            [("enable_write_access_control", "written"), ("enable_read_access_control", "read")]
        {
            if !is(topic, what, "true") {
                open.push(format!("topics `{name}` may be {say} by everybody who joined ({what})"));
            }
        }
        if is(topic, "metadata_protection_kind", "NONE")
            && is(topic, "data_protection_kind", "NONE")
        {
            open.push(format!(
                "topics `{name}` travel in the clear (metadata_protection_kind, data_protection_kind)"
            ));
        } else if !text_of(topic, "metadata_protection_kind")
            .is_some_and(|kind| kind.ends_with("WITH_ORIGIN_AUTHENTICATION"))
        {
            open.push(format!(
                "whoever may read topics `{name}` can also write in their writer's name (metadata_protection_kind without _WITH_ORIGIN_AUTHENTICATION)"
            ));
        }
    }
    open
}

/// Whether a pattern of permissions, with `*` for any text and `?` for any character, fits a topic.
#[must_use]
pub fn fits(pattern: &str, topic: &str) -> bool {
    match pattern.chars().next() {
        None => topic.is_empty(),
        Some('*') => {
            let rest = &pattern[1..];
            topic
                .char_indices()
                .map(|(at, _)| at)
                .chain([topic.len()])
                .any(|at| fits(rest, &topic[at..]))
        }
        Some(first) => {
            let mut left = topic.chars();
            left.next().is_some_and(|found| first == '?' || first == found)
                && fits(&pattern[first.len_utf8()..], left.as_str())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_policy_becomes_topics_of_dds_as_sros_makes_them() {
        let text = r#"<policy version="0.2.0"><enclaves><enclave path="/a"><profiles><profile ns="/lab" node="n">
            <topics publish="ALLOW" subscribe="ALLOW"><topic>x</topic></topics>
            <topics publish="DENY"><topic>/y</topic></topics>
            <services reply="ALLOW"><service>~/s</service></services>
            <services request="ALLOW"><service>/t</service></services>
            <actions call="ALLOW"><action>go</action></actions>
            </profile></profiles></enclave></enclaves></policy>"#;
        let policy = read_policy(text).unwrap();
        let (allowed, denied) = &policy["/a"];
        for topic in
            ["rt/lab/x", "rr/lab/n/sReply", "rq/tRequest", "rq/lab/go/_action/send_goalRequest"]
        {
            assert!(allowed.publish.contains(topic), "{topic}: {allowed:?}");
        }
        for topic in [
            "rt/lab/x",
            "rq/lab/n/sRequest",
            "rr/tReply",
            "rt/lab/go/_action/feedback",
            "rr/lab/go/_action/get_resultReply",
        ] {
            assert!(allowed.subscribe.contains(topic), "{topic}: {allowed:?}");
        }
        assert!(denied.publish.contains("rt/y") && denied.subscribe.is_empty());
        let written = permissions("/a", &policy["/a"], (0, 86_400), &[0, 7]);
        let grant = &read_permissions(&written).unwrap()[0];
        assert_eq!((grant.subject.as_str(), grant.valid), ("CN=/a", (0, 86_400)));
        assert_eq!(grant.domains, [(0, 0), (7, 7)]);
        assert!(grant.allowed.publish.contains("ros_discovery_info") && !grant.allows_the_rest);
        assert!(
            grant.allowed.publish.is_superset(&allowed.publish)
                && !grant.allowed.publish.contains("rt/y")
        );
    }

    #[test]
    fn what_is_no_policy_is_refused_with_its_place() {
        for (text, said) in [
            ("<policy>", "no XML"),
            ("<policy/>", "no enclave"),
            ("<p><enclave/></p>", "without a path"),
            (
                "<p><enclave path='/a'><profile><topics publish='MAYBE'/></profile></enclave></p>",
                "MAYBE",
            ),
            (
                "<p><enclave path='/a'><profile><topics call='ALLOW'><topic>x</topic></topics></profile></enclave></p>",
                "topics call",
            ),
        ] {
            let error = read_policy(text).unwrap_err().to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
    }

    #[test]
    fn our_own_governance_leaves_nothing_open_and_a_lax_one_is_told() {
        let ours = governance(&[3]);
        let rules = read_governance(&ours).unwrap();
        assert_eq!(rules, [Rules { domains: vec![(3, 3)], open: Vec::new() }]);
        let lax = ours
            .replace("participants>false", "participants>true")
            .replace("_WITH_ORIGIN_AUTHENTICATION", "")
            .replace("write_access_control>true", "write_access_control>false");
        let open = read_governance(&lax).unwrap()[0].open.join("; ");
        assert!(
            open.contains("prove nothing")
                && open.contains("writer's name")
                && open.contains("written by everybody"),
            "{open}"
        );
    }

    #[test]
    fn patterns_fit_as_in_a_file_system_without_folders() {
        assert!(
            fits("*", "")
                && fits("rt/*", "rt/a/b")
                && fits("r?/x", "rt/x")
                && fits("rq/*Request", "rq/a/bRequest")
        );
        assert!(!fits("rt/", "rt/a") && !fits("?", "") && !fits("rt/*b", "rt/a"));
    }
}
