//! What stands at the head of every file: who wrote it, from what, and what it costs.

use crate::cost::Cost;
use crate::{Facts, Given, Release, Target, Version};

/// How a format marks comments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Comments {
    /// `<!-- ... -->`
    Xml,
    /// `# ...`
    Hash,
    /// `/* ... */`
    C,
}

impl Comments {
    /// The lines as one comment. What would end it is broken up.
    pub(crate) fn around(self, lines: &[String]) -> String {
        let clean = |line: &String| {
            let line = line.replace(char::is_control, " ");
            match self {
                Self::Xml => line.replace("--", "- -"),
                Self::C => line.replace("*/", "* /").replace("/*", "/ *"),
                Self::Hash => line,
            }
        };
        let lines: Vec<String> = lines.iter().map(clean).collect();
        match self {
            Self::Xml => format!("<!--\n  {}\n-->\n", lines.join("\n  ")),
            Self::Hash => lines.iter().map(|line| format!("# {line}\n")).collect(),
            Self::C => format!("/*\n * {}\n */\n", lines.join("\n * ")),
        }
    }
}

/// The lines of the head.
pub(crate) fn lines(
    given: &Given,
    (target, version, release): (Target, Version, &Release),
    cost: &Cost,
    lost: &[String],
    accepted: &[String],
    joint: &str,
) -> Vec<String> {
    let Facts { title, .. } = *target.facts();
    let mut lines = vec![
        format!(
            "Friction of the joint {joint} for {title} {version}, written by frictionlab {}.",
            env!("CARGO_PKG_VERSION")
        ),
        format!(
            "From {}, SHA-256 {}; model {}.",
            given.source.name,
            given.source.sha256,
            given.model.name()
        ),
    ];
    lines.extend(given.source.first.clone());
    lines.push(format!("Range: {}.", given.speeds.told(given.axis)));
    match lost {
        [] => lines.push("It holds all of the identified friction.".to_owned()),
        lost => {
            lines.push("It cannot hold".to_owned());
            lines.extend(lost.iter().map(|what| format!("  - {what}")));
        }
    }
    lines.push("Torque error that this costs, by both models along the same motion:".to_owned());
    lines.extend(cost.told(&given.speeds, given.axis).map(|line| format!("  - {line}")));
    for (name, why) in &given.taken {
        lines.push(format!("{name} was {why}."));
    }
    lines.extend(accepted.iter().map(|what| format!("ACCEPTED ALTHOUGH {what}.")));
    lines.extend(release.beware.iter().map(|what| format!("Beware: {what}.")));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_ends_a_comment_early() {
        let hostile = ["a --> b -- c".to_owned(), "d */ e /* f".to_owned(), "g\nh".to_owned()];
        let xml = Comments::Xml.around(&hostile);
        assert_eq!(xml.matches("--").count(), 2, "{xml}");
        let c = Comments::C.around(&hostile);
        assert_eq!((c.matches("*/").count(), c.matches("/*").count()), (1, 1), "{c}");
        let hash = Comments::Hash.around(&hostile);
        assert!(hash.lines().all(|line| line.starts_with("# ")), "{hash}");
    }
}
