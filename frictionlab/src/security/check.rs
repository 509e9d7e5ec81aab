//! Looks at every enclave of a keystore and says who may do what.

use std::{
    fmt::Write as _,
    fs, io,
    path::{Path, PathBuf},
    time::SystemTime,
};

use ros_node::security::{
    credentials::{self, Credentials, CredentialsError},
    permissions::{Grant, fits},
};

/// An enclave, and what is wrong with it if something is.
#[derive(Debug)]
pub struct Enclave {
    /// Its name, as in `/rig_driver`.
    pub name: String,
    /// Its files, or why they cannot be used.
    pub found: Result<Credentials, CredentialsError>,
}

/// A folder that is no keystore, or cannot be looked into.
#[derive(Debug, thiserror::Error)]
#[error("{} is no keystore: {}: {source}", keystore.display(), enclaves.display())]
pub struct NoKeystore {
    /// The folder.
    pub keystore: PathBuf,
    /// Where its enclaves would be.
    pub enclaves: PathBuf,
    /// What the system says of that.
    pub source: io::Error,
}

impl NoKeystore {
    /// Whether whoever named the folder can mend it.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        files::is_of_the_path(&self.source)
    }
}

/// What one may do in the laboratory, and the topic of DDS that it takes to write for it; any
/// namespace may stand before.
const DEEDS: [(&str, &str, &str); 7] = [
    ("voltage", "rt", "motor_voltage"),
    ("reference", "rt", "reference"),
    ("states", "rq", "rig_driver/change_stateRequest"),
    ("parameters", "rq", "rig_driver/set_parametersRequest"),
    ("clear", "rq", "rig_driver/clear_faultRequest"),
    ("experiments", "rq", "experiment_runner/run_experiment/_action/send_goalRequest"),
    ("stop", "rq", "rig_driver/emergency_stopRequest"),
];

/// Every enclave below a keystore, in the order of their names.
///
/// # Errors
/// [`NoKeystore`] for a folder that is none.
pub fn look(keystore: &Path, now: SystemTime) -> Result<Vec<Enclave>, NoKeystore> {
    let folder = keystore.join("enclaves");
    let mut folders = Vec::new();
    gather(&folder, &mut folders).map_err(|source| NoKeystore {
        keystore: keystore.to_owned(),
        enclaves: folder.clone(),
        source,
    })?;
    folders.sort();
    let enclaves = folders.into_iter().map(|path| {
        let name = path.strip_prefix(&folder).unwrap_or(&path).display().to_string();
        Enclave { name: format!("/{name}"), found: credentials::examine(&path, now) }
    });
    Ok(enclaves.collect())
}

fn gather(folder: &Path, into: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            if path.join("cert.pem").exists() || path.join("key.pem").exists() {
                into.push(path.clone());
            }
            gather(&path, into)?;
        }
    }
    Ok(())
}

fn may(grant: &Grant, prefix: &str, name: &str) -> bool {
    let plain = format!("{prefix}/{name}");
    let in_a_namespace = |pattern: &String| {
        pattern.starts_with(&format!("{prefix}/")) && pattern.ends_with(&format!("/{name}"))
    };
    let mut patterns = grant.allowed.publish.iter();
    grant.allows_the_rest
        || patterns.any(|pattern| fits(pattern, &plain) || in_a_namespace(pattern))
}

/// What was found, for people: who may do what, then what is wrong or worth a look.
#[must_use]
pub fn table(enclaves: &[Enclave], now: SystemTime) -> String {
    let now =
        now.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_secs().cast_signed());
    let widest =
        enclaves.iter().map(|enclave| enclave.name.len()).max().unwrap_or(0).max("enclave".len());
    let mut text = format!("{:widest$}  days left", "enclave");
    for (deed, ..) in DEEDS {
        let _ = write!(text, "  {deed}");
    }
    text.push('\n');
    for enclave in enclaves {
        let _ = write!(text, "{:widest$}", enclave.name);
        match &enclave.found {
            Err(_) => text.push_str("  BROKEN"),
            Ok(found) => {
                let _ = write!(text, "  {:>9}", (found.ends - now).div_euclid(86_400));
                for (deed, prefix, name) in DEEDS {
                    let mark = if may(&found.grant, prefix, name) { "yes" } else { "-" };
                    let _ = write!(text, "  {mark:>width$}", width = deed.len());
                }
            }
        }
        text.push('\n');
    }
    for enclave in enclaves {
        match &enclave.found {
            Err(error) => _ = writeln!(text, "{}: {error}", enclave.name),
            Ok(found) => {
                found.notes.iter().for_each(|note| _ = writeln!(text, "{}: {note}", enclave.name))
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use ros_node::security::{
        keystore::{Order, make},
        permissions::read_policy,
        policy::policy,
    };

    use super::*;

    #[test]
    fn the_table_says_who_may_do_what_and_what_is_broken() {
        let folder = tempfile::tempdir().unwrap();
        let keys = folder.path().join("keys");
        let policy = read_policy(&policy("/axis_1")).unwrap();
        make(&Order {
            folder: &keys,
            policy: &policy,
            domains: &[0],
            now: 1_800_000_000,
            days: 100,
        })
        .unwrap();
        fs::write(keys.join("enclaves/live/key.pem"), "").unwrap();
        let now = SystemTime::UNIX_EPOCH + Duration::from_secs(1_800_000_000);
        let shown = table(&look(&keys, now).unwrap(), now);
        let of = |name: &str| {
            let line = shown
                .lines()
                .find(|line| line.starts_with(name))
                .unwrap_or_else(|| panic!("{name}: {shown}"));
            line.split_whitespace().skip(1).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(of("/controller"), ["100", "yes", "-", "-", "-", "-", "-", "-"]);
        assert_eq!(of("/operator"), ["100", "-", "yes", "yes", "yes", "yes", "yes", "yes"]);
        assert_eq!(of("/viewer"), ["100", "-", "-", "-", "-", "-", "-", "yes"]);
        assert_eq!(of("/live"), ["BROKEN"]);
        assert!(shown.contains("/live: key.pem is no private key"), "{shown}");
        assert!(look(folder.path(), now).unwrap_err().to_string().contains("is no keystore"));
    }
}
