//! All targets with their versions, for people.

use std::fmt::Write;

use simulator_export::{Facts, Holds, Target};
use strum::VariantArray;

/// Every target, each version at which it changed, and what it can hold.
#[must_use]
pub fn list() -> String {
    let mut text = String::new();
    for target in Target::VARIANTS {
        let Facts { title, releases, newest, .. } = target.facts();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{target}  {title}");
        for (release, next) in releases.iter().zip(releases.iter().skip(1).map(Some).chain([None]))
        {
            let versions = match next {
                Some(next) => format!("{} to before {}", release.since, next.since),
                None if release.since == *newest => format!("{newest}"),
                None => format!("{} to {newest}", release.since),
            };
            let said = match release.holds {
                Holds::Nothing(why) => format!("refused: {why}"),
                _ => release.said.to_owned(),
            };
            let _ = writeln!(text, "  {versions:<18} {said}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_and_version_is_listed() {
        let text = list();
        for target in Target::VARIANTS {
            assert!(text.contains(&format!("{target}  ")), "{text}");
        }
        assert!(text.contains("  3.7 to before 3.12 dcmotor"), "{text}");
    }
}
