//! Targets and versions as somebody names them.

use crate::{Refusal, Release, Target, Version};

/// The target of that name.
///
/// # Errors
/// [`Refusal::Target`] with all names.
pub fn target(name: &str) -> Result<Target, Refusal> {
    Target::named(name).ok_or_else(|| Refusal::Target { name: name.to_owned() })
}

/// What is true of a version of a target.
///
/// # Errors
/// [`Refusal::Version`] with the versions that are known.
pub fn release(target: Target, version: Version) -> Result<&'static Release, Refusal> {
    let (first, last) = target.known();
    target.release(version).ok_or(Refusal::Version { target, version, first, last })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_refused_with_what_is() {
        let said = target("mujoko").unwrap_err().to_string();
        assert!(said.contains("`mujoko`") && said.contains("mjcf, "), "{said}");
        for (text, part) in [("4.1", "newest known"), ("1.50", "2.0 to 4.0"), ("5", "4.0")] {
            let said = release(Target::Mjcf, text.parse().unwrap()).unwrap_err().to_string();
            assert!(said.contains(part), "{said}");
        }
    }
}
