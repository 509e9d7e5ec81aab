//! `frictionlab security`: keystores of DDS Security (SROS 2).

use std::path::PathBuf;

use work::BadInput;
use work::saying::print;

/// Say who may join, command and read: keystores (SROS 2)
///
/// `init` makes a keystore with an enclave for each node, for `live`, for an operator and for
/// viewers; `check` looks at one and shows who may do what; `policy` prints the policy behind it,
/// to change it for `init --policy` or `ros2 security`. Programs are secured with
/// ROS_SECURITY_ENABLE=true ROS_SECURITY_STRATEGY=Enforce ROS_SECURITY_KEYSTORE=DIR;
/// docs/how-to/secure-the-network.md says what that holds.
#[derive(Debug, clap::Args)]
pub struct SecurityArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, clap::Subcommand)]
enum What {
    /// Make a keystore
    Init(InitArgs),
    /// Look at a keystore: certificates, signatures, dates, rights. Ends with exit code 1 if
    /// something is broken
    Check(CheckArgs),
    /// Print the policy for the laboratory's graph
    Policy(PolicyArgs),
}

#[derive(Debug, clap::Args)]
struct InitArgs {
    /// The folder to be made
    dir: PathBuf,
    /// Another policy of SROS 2 than the laboratory's own
    #[arg(long, value_name = "FILE", conflicts_with = "namespace")]
    policy: Option<PathBuf>,
    /// Namespace of the nodes
    #[arg(long, value_name = "NAME", default_value = "/")]
    namespace: String,
    /// ROS domain in which the keystore counts, 0 to 232; may be given several times.
    /// ROS_DOMAIN_ID, or 0, if left out
    #[arg(long, value_name = "ID", value_parser = clap::value_parser!(u16).range(0..=232))]
    domain: Vec<u16>,
    /// How long it counts [days]; then a new one is made, never the old one prolonged
    #[arg(long, default_value = "365", value_parser = clap::value_parser!(u32).range(1..=36500))]
    days: u32,
}

#[derive(Debug, clap::Args)]
struct CheckArgs {
    /// The keystore; ROS_SECURITY_KEYSTORE if left out
    dir: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
struct PolicyArgs {
    /// Namespace of the nodes
    #[arg(long, value_name = "NAME", default_value = "/")]
    namespace: String,
}

/// Runs it.
///
/// # Errors
/// [`BadInput`], or a plain error if a keystore cannot be made or is broken.
pub fn execute(args: &SecurityArgs) -> anyhow::Result<()> {
    match &args.what {
        What::Init(args) => init(args),
        What::Check(args) => check(args),
        What::Policy(args) => {
            print(&ros_node::security::policy::policy(&namespace(&args.namespace)?))
        }
    }
}

fn namespace(given: &str) -> Result<String, BadInput> {
    let name = format!("/{}", given.trim_matches('/'));
    let is_part = |part: &str| {
        part.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && part.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
    };
    if name == "/" || name[1..].split('/').all(is_part) {
        return Ok(name);
    }
    Err(BadInput(format!(
        "`{given}` is no namespace; expected letters, digits and underscores, as in /axis_1"
    )))
}

#[cfg(not(feature = "security"))]
fn init(args: &InitArgs) -> anyhow::Result<()> {
    let _ = (&args.dir, &args.policy, &args.domain, args.days, namespace(&args.namespace)?);
    Err(not_built())
}

#[cfg(not(feature = "security"))]
fn check(args: &CheckArgs) -> anyhow::Result<()> {
    let _ = &args.dir;
    Err(not_built())
}

#[cfg(not(feature = "security"))]
fn not_built() -> anyhow::Error {
    BadInput(
        "this frictionlab was built without DDS Security: build it with `--features security` (Debian: apt-get install libssl-dev), or make \
         the keystore with `ros2 security` and the policy that `frictionlab security policy` prints (docs/how-to/secure-the-network.md)"
            .to_owned(),
    )
    .into()
}

#[cfg(feature = "security")]
fn init(args: &InitArgs) -> anyhow::Result<()> {
    use anyhow::Context;
    use ros_node::security::{keystore, permissions, policy};

    let text = match &args.policy {
        Some(file) => std::fs::read_to_string(file).map_err(|error| {
            BadInput(format!("the policy {} cannot be read: {error}", file.display()))
        })?,
        None => policy::policy(&namespace(&args.namespace)?),
    };
    let policy = permissions::read_policy(&text).map_err(|error| BadInput(error.to_string()))?;
    let domains = match args.domain.as_slice() {
        [] => {
            vec![ros_node::Discovery::from_environment()?.domain]
        }
        given => given.to_vec(),
    };
    let now = std::time::SystemTime::now();
    let since = now
        .duration_since(std::time::SystemTime::UNIX_EPOCH)
        .context("the clock is before 1970")?;
    let order = keystore::Order {
        folder: &args.dir,
        policy: &policy,
        domains: &domains,
        now: since.as_secs().cast_signed(),
        days: args.days,
    };
    keystore::make(&order)?;
    let shown = crate::security::table(&crate::security::look(&args.dir, now)?, now);
    let folder = std::path::absolute(&args.dir).unwrap_or_else(|_| args.dir.clone());
    print(&format!(
        "{shown}\nFor every program: export ROS_SECURITY_ENABLE=true ROS_SECURITY_STRATEGY=Enforce ROS_SECURITY_KEYSTORE={}\n\
         Give each machine the enclaves of its programs only, and keep private/ where nobody else reads it.\n",
        folder.display()
    ))
}

#[cfg(feature = "security")]
fn check(args: &CheckArgs) -> anyhow::Result<()> {
    let from_environment = || {
        std::env::var_os("ROS_SECURITY_KEYSTORE").filter(|dir| !dir.is_empty()).map(PathBuf::from)
    };
    let dir = args.dir.clone().or_else(from_environment).ok_or_else(|| {
        BadInput("no keystore is named: give its folder, or set ROS_SECURITY_KEYSTORE".to_owned())
    })?;
    let now = std::time::SystemTime::now();
    let enclaves = crate::security::look(&dir, now)?;
    print(&crate::security::table(&enclaves, now))?;
    anyhow::ensure!(!enclaves.is_empty(), "{} has no enclave", dir.display());
    let broken: Vec<&str> = enclaves
        .iter()
        .filter(|enclave| enclave.found.is_err())
        .map(|enclave| enclave.name.as_str())
        .collect();
    anyhow::ensure!(broken.is_empty(), "broken: {}", broken.join(", "));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::namespace;

    #[test]
    fn a_namespace_is_made_absolute_or_refused() {
        assert_eq!(namespace("/").unwrap(), "/");
        assert_eq!(namespace("axis_1").unwrap(), "/axis_1");
        assert_eq!(namespace("/lab/axis_1/").unwrap(), "/lab/axis_1");
        for wrong in ["a b", "a//b", "<x>", "1a", "a\"b"] {
            assert!(namespace(wrong).unwrap_err().0.contains("/axis_1"), "{wrong}");
        }
    }
}
