//! `cargo xtask audit`: licences, bans and sources of every dependency, judged by `deny.toml`.
//!
//! Where cargo-deny is installed it judges, the advisory database included if that can be reached.
//! Building it takes longer than this project's tests may, so elsewhere the same file is read here:
//! the licence expressions by the crate `spdx`, which cargo-deny stands on too.

use std::{
    collections::BTreeSet,
    env, fs,
    path::Path,
    process::{Command, Stdio},
};

use anyhow::{Context, bail, ensure};
use serde::Deserialize;
use spdx::{Expression, Licensee};

/// Arguments of `cargo xtask audit`.
#[derive(Debug, clap::Args)]
pub struct Audit {
    /// Judge without cargo-deny, also where it is installed
    #[arg(long)]
    plain: bool,
}

/// The parts of `deny.toml` that are judged here.
#[derive(Debug, Deserialize)]
struct Rules {
    licenses: Licences,
    bans: Bans,
    sources: Sources,
}

#[derive(Debug, Deserialize)]
struct Licences {
    allow: Vec<String>,
    #[serde(default)]
    exceptions: Vec<Exception>,
}

/// Licences that one dependency alone may have.
#[derive(Debug, Deserialize)]
struct Exception {
    #[serde(rename = "crate")]
    name: String,
    allow: Vec<String>,
}

#[derive(Debug, Deserialize)]
struct Bans {
    deny: Vec<Banned>,
}

#[derive(Debug, Deserialize)]
struct Banned {
    name: String,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Sources {
    allow_registry: Vec<String>,
}

/// What `cargo metadata` tells of the dependencies.
#[derive(Debug, Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Debug, Deserialize)]
struct Package {
    name: String,
    version: String,
    /// None for the packages of this workspace.
    source: Option<String>,
    license: Option<String>,
}

impl Audit {
    /// Judges.
    ///
    /// # Errors
    /// Every dependency that may not be there, with the reason.
    pub fn run(&self) -> anyhow::Result<()> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask stands in the workspace")?;
        if !self.plain
            && cargo(root).args(["deny", "--version"]).output().is_ok_and(|o| o.status.success())
        {
            return by_cargo_deny(root);
        }
        let text = fs::read_to_string(root.join("deny.toml")).context("cannot read deny.toml")?;
        let rules: Rules = toml::from_str(&text).context("deny.toml is not as expected")?;
        let packages = dependencies(root)?;
        let complaints = judge(&rules, &packages)?;
        ensure!(
            complaints.is_empty(),
            "{} dependencies may not be there:\n{}",
            complaints.len(),
            complaints.join("\n")
        );
        println!(
            "{} dependencies: licences, bans and sources are as deny.toml has them. Advisories were not looked up: that takes cargo-deny \
             (cargo install cargo-deny) and its database.",
            packages.len()
        );
        Ok(())
    }
}

fn cargo(root: &Path) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root).stdin(Stdio::null());
    command
}

fn by_cargo_deny(root: &Path) -> anyhow::Result<()> {
    let check =
        |what: &[&str]| cargo(root).args(["deny", "--all-features", "check"]).args(what).status();
    let status = check(&["licenses", "bans", "sources"]).context("cargo deny does not start")?;
    ensure!(status.success(), "cargo deny refuses a dependency");
    if cargo(root)
        .args(["deny", "fetch", "db"])
        .output()
        .is_ok_and(|fetched| fetched.status.success())
    {
        let status = check(&["advisories"]).context("cargo deny does not start")?;
        ensure!(status.success(), "cargo deny knows an advisory against a dependency");
    } else {
        println!("SKIPPED: the advisories, because their database cannot be reached from here");
    }
    Ok(())
}

/// What the programs of this platform are built from, with every feature.
fn dependencies(root: &Path) -> anyhow::Result<Vec<Package>> {
    let host = Command::new("rustc").arg("-vV").output().context("rustc does not start")?;
    let host = String::from_utf8_lossy(&host.stdout).into_owned();
    let host =
        host.lines().find_map(|line| line.strip_prefix("host: ")).context("rustc names no host")?;
    let output = cargo(root)
        .args([
            "metadata",
            "--format-version",
            "1",
            "--all-features",
            "--locked",
            "--filter-platform",
            host,
        ])
        .output()
        .context("cargo metadata does not start")?;
    if !output.status.success() {
        bail!("cargo metadata: {}", String::from_utf8_lossy(&output.stderr));
    }
    let metadata: Metadata =
        serde_json::from_slice(&output.stdout).context("cargo metadata is not as expected")?;
    Ok(metadata.packages.into_iter().filter(|package| package.source.is_some()).collect())
}

/// A sentence for each dependency that may not be there.
fn judge(rules: &Rules, packages: &[Package]) -> anyhow::Result<Vec<String>> {
    let licences = |names: &[String]| {
        let one = |name: &String| {
            Licensee::parse(name)
                .with_context(|| format!("deny.toml allows `{name}`, which is no licence"))
        };
        names.iter().map(one).collect::<anyhow::Result<Vec<_>>>()
    };
    let for_all = licences(&rules.licenses.allow)?;
    let banned: BTreeSet<&str> =
        rules.bans.deny.iter().map(|banned| banned.name.as_str()).collect();
    let mut complaints = Vec::new();
    for Package { name, version, source, license } in packages {
        let mut allowed = for_all.clone();
        for exception in
            rules.licenses.exceptions.iter().filter(|exception| exception.name == *name)
        {
            allowed.extend(licences(&exception.allow)?);
        }
        let mut complain = |why: String| complaints.push(format!("{name} {version}: {why}"));
        if banned.contains(name.as_str()) {
            complain("banned by deny.toml".to_owned());
        }
        let source = source.as_deref().unwrap_or_default();
        let registry = source.strip_prefix("registry+").unwrap_or_default();
        if !rules.sources.allow_registry.iter().any(|allowed| allowed == registry) {
            complain(format!("comes from {source}, which deny.toml does not allow"));
        }
        match license.as_deref() {
            None => complain("says no licence".to_owned()),
            // Old manifests write `MIT/Apache-2.0` for a choice.
            Some(text) => match Expression::parse_mode(text, spdx::ParseMode::LAX) {
                Err(error) => {
                    complain(format!("its licence `{text}` cannot be read: {}", error.reason))
                }
                Ok(licence)
                    if licence.evaluate(|asked| allowed.iter().any(|a| a.satisfies(asked))) => {}
                Ok(_) => complain(format!(
                    "its licence `{text}` is not among those that deny.toml allows"
                )),
            },
        }
    }
    Ok(complaints)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CRATES_IO: &str = "registry+https://github.com/rust-lang/crates.io-index";

    fn rules() -> Rules {
        toml::from_str(include_str!("../../deny.toml")).unwrap()
    }

    fn complaints(name: &str, source: &str, license: Option<&str>) -> Vec<String> {
        let package = Package {
            name: name.into(),
            version: "1.0.0".into(),
            source: Some(source.into()),
            license: license.map(Into::into),
        };
        judge(&rules(), &[package]).unwrap()
    }

    #[test]
    fn usual_licences_pass_in_every_spelling() {
        for license in
            ["MIT", "MIT OR Apache-2.0", "MIT/Apache-2.0", "(MIT OR GPL-3.0) AND Unicode-3.0"]
        {
            assert_eq!(complaints("serde", CRATES_IO, Some(license)), [""; 0], "{license}");
        }
    }

    #[test]
    fn an_exception_is_for_one_dependency() {
        assert_eq!(complaints("x509-certificate", CRATES_IO, Some("MPL-2.0")), [""; 0]);
        assert_eq!(complaints("other", CRATES_IO, Some("MPL-2.0")).len(), 1);
    }

    #[test]
    fn what_may_not_be_there_is_named_with_its_reason() {
        for (name, source, license, said) in [
            ("net2", CRATES_IO, Some("MIT"), "banned"),
            ("other", CRATES_IO, Some("GPL-3.0-only"), "GPL-3.0-only"),
            ("other", CRATES_IO, Some("MIT AND AGPL-3.0-only"), "AGPL-3.0-only"),
            ("other", CRATES_IO, Some("whatever I like"), "cannot be read"),
            ("other", CRATES_IO, None, "says no licence"),
            ("other", "git+https://example.org/other", Some("MIT"), "example.org"),
            ("other", "registry+https://example.org/index", Some("MIT"), "example.org"),
        ] {
            let complaints = complaints(name, source, license);
            assert!(
                complaints.len() == 1 && complaints[0].contains(said),
                "{name}: {complaints:?}"
            );
        }
    }
}
