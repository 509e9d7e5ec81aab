//! Whether this process and the others on the domain are secured.

use ros_node::{
    Discovery, EnvironmentError,
    security::{BUILT, Protection, Standing, Strategy, Wish},
};

use super::{Finding, heard::Heard};

/// The enclave as which the doctor listens, unless the environment names another.
pub(super) const ENCLAVE: &str = "/viewer";

/// What the environment asks for, and whether it can be had.
pub(super) fn environment(discovery: Option<&Discovery>) -> Finding {
    const NAME: &str = "ROS_SECURITY_ENABLE";
    let wish = match Wish::from_environment() {
        Ok(wish) => wish,
        Err(EnvironmentError { name, expected, value }) => {
            return Finding::broken(
                name,
                format!("it is `{value}`: no program starts"),
                format!("set it to {expected}, or unset it"),
            );
        }
    };
    if !wish.enabled {
        return Finding::fine(
            NAME,
            "not true: nodes are in the clear, and every program that reaches the domain may command them",
        );
    }
    match wish.protection(Some(ENCLAVE)) {
        Err(error) => Finding::broken(
            NAME,
            error.to_string(),
            if BUILT {
                "`frictionlab security init DIR` makes a keystore"
            } else {
                "build it with `--features security`"
            },
        ),
        Ok(Protection::Off(warning)) => Finding::look(
            NAME,
            warning.unwrap_or_default(),
            "`frictionlab security init DIR` makes a keystore; `export ROS_SECURITY_STRATEGY=Enforce` starts nothing without",
        ),
        Ok(Protection::On(enclave)) => secured(&enclave, wish.strategy, discovery),
    }
}

#[cfg(feature = "security")]
fn secured(
    enclave: &ros_node::security::Enclave,
    strategy: Strategy,
    discovery: Option<&Discovery>,
) -> Finding {
    let found =
        ros_node::security::credentials::examine(&enclave.folder, std::time::SystemTime::now());
    let domain = discovery.map_or(0, |discovery| discovery.domain);
    match found.and_then(|found| found.for_domain(domain)) {
        Err(error) => Finding::broken(
            "ROS_SECURITY_KEYSTORE",
            format!("the enclave {}: {error}", enclave.name),
            "`frictionlab security check` looks at all enclaves",
        ),
        Ok(found) if strategy == Strategy::Permissive => Finding::look(
            "ROS_SECURITY_STRATEGY",
            format!(
                "{} is in order, but a program whose enclave is missing runs in the clear",
                found.subject
            ),
            "`export ROS_SECURITY_STRATEGY=Enforce`",
        ),
        Ok(found) if !found.notes.is_empty() => Finding::look(
            "ROS_SECURITY_KEYSTORE",
            format!("{}: {}", enclave.name, found.notes.join("; ")),
            "see docs/how-to/secure-the-network.md",
        ),
        Ok(found) => {
            Finding::fine("ROS_SECURITY_KEYSTORE", format!("secured as {}", found.subject))
        }
    }
}

/// Never reached: without the feature nothing is secured.
#[cfg(not(feature = "security"))]
fn secured(enclave: &ros_node::security::Enclave, _: Strategy, _: Option<&Discovery>) -> Finding {
    Finding::fine("ROS_SECURITY_KEYSTORE", enclave.name.clone())
}

/// The other participants: who is authenticated, who is not. Nothing where the doctor itself is in
/// the clear.
pub(super) fn others(heard: &Heard) -> Vec<Finding> {
    if !heard.secured {
        return Vec::new();
    }
    let mut findings = Vec::new();
    for (prefix, other) in &heard.participants {
        let mut nodes: Vec<&str> = heard
            .nodes
            .iter()
            .filter(|node| node.participant[..12] == prefix[..])
            .map(|node| node.name.as_str())
            .collect();
        nodes.dedup();
        let id: String = prefix.iter().map(|byte| format!("{byte:02x}")).collect();
        let who = if nodes.is_empty() {
            format!("participant {id}")
        } else {
            format!("{} (participant {id})", nodes.join(", "))
        };
        findings.push(match other.standing {
            Some(Standing::Authenticated) => Finding::fine(who, "authenticated"),
            Some(Standing::Authenticating) => Finding::look(
                who,
                "has not proved who it is within three seconds",
                "start the doctor again; if it stays so, look at its certificate: `frictionlab security check`",
            ),
            Some(Standing::Refused) => Finding::look(
                who,
                "could not prove who it is: another keystore, expired, or without permissions; nothing of it is heard",
                "end it, or give it an enclave of this keystore",
            ),
            None if other.offers_security => Finding::look(
                who,
                "offers security, but is not authenticated here: another keystore, or it has just come",
                "start the doctor again; if it stays so, compare the keystores",
            ),
            None => Finding::look(
                who,
                "in the clear: nothing of it is heard by the secured nodes",
                "end it, or start it with ROS_SECURITY_ENABLE=true",
            ),
        });
    }
    let authenticated = heard
        .participants
        .values()
        .filter(|other| other.standing == Some(Standing::Authenticated))
        .count();
    findings.insert(
        0,
        Finding::fine(
            "authenticated participants",
            format!("{authenticated} of {}", heard.participants.len()),
        )
        .with("authenticated", authenticated as f64, "")
        .with("participants", heard.participants.len() as f64, ""),
    );
    findings
}

#[cfg(test)]
mod tests {
    use ros_node::{SeenNode, security::Other};

    use super::*;
    use crate::doctor::Verdict;

    #[test]
    fn each_participant_is_told_by_how_it_stands() {
        let other =
            |standing, offers_security| Other { standing, offers_security, ..Other::default() };
        let mut participant = [1; 16];
        participant[12..].copy_from_slice(&[0, 0, 1, 0xc1]);
        let heard = Heard {
            secured: true,
            nodes: vec![SeenNode { name: "/rig_driver".into(), participant }],
            participants: [
                ([1; 12], other(Some(Standing::Authenticated), true)),
                ([2; 12], other(Some(Standing::Refused), true)),
                ([3; 12], other(None, false)),
            ]
            .into(),
            ..Heard::default()
        };
        let found = others(&heard);
        let verdicts: Vec<Verdict> = found.iter().map(|finding| finding.verdict).collect();
        assert_eq!(
            verdicts,
            [Verdict::Fine, Verdict::Fine, Verdict::LookAtThis, Verdict::LookAtThis]
        );
        assert_eq!(found[0].found, "1 of 3");
        assert!(found[1].subject.starts_with("/rig_driver"));
        assert!(found[3].found.starts_with("in the clear"));
        assert!(others(&Heard { secured: false, ..heard }).is_empty());
    }
}
