//! DDS Security as ROS 2 has it (SROS 2): who may join a domain, and who may write and read what
//! there.
//!
//! [`Wish`] is what the environment asks for. [`Wish::protection`] turns it into a [`Protection`],
//! or into an error: a program that was asked to be secured and cannot be does not start. It never
//! runs in the clear without having been told to.
//!
//! With the feature `security`:
//! - `credentials` looks at an enclave's files before the middleware does, and says what is wrong
//!   with them in sentences;
//! - `keystore` makes a keystore with its certificates, and `permissions` what each enclave may do,
//!   from a policy.
//!
//! [`policy`] is the policy for the laboratory's own graph; it is made from the table of
//! interfaces.

#[cfg(feature = "security")]
mod calendar;
#[cfg(feature = "security")]
pub mod credentials;
mod enclave;
mod error;
#[cfg(feature = "security")]
pub mod keystore;
mod others;
#[cfg(feature = "security")]
pub mod permissions;
pub mod policy;
mod wish;

pub use enclave::{Enclave, EnclaveNameError, FILES};
pub use error::SecurityError;
pub(crate) use others::prefix;
pub use others::{Other, Others, Prefix, Standing};
pub use wish::{Protection, Strategy, Wish};

use rustdds::DomainParticipantBuilder;

/// Whether this program was built with DDS Security.
pub const BUILT: bool = cfg!(feature = "security");

/// The participant under that protection.
pub(crate) fn protect(
    builder: DomainParticipantBuilder,
    domain: u16,
    protection: &Protection,
) -> Result<DomainParticipantBuilder, SecurityError> {
    match protection {
        Protection::Off(_) => Ok(builder),
        Protection::On(enclave) => secured(builder, domain, enclave),
    }
}

#[cfg(feature = "security")]
fn secured(
    builder: DomainParticipantBuilder,
    domain: u16,
    enclave: &Enclave,
) -> Result<DomainParticipantBuilder, SecurityError> {
    credentials::examine(&enclave.folder, std::time::SystemTime::now())
        .and_then(|credentials| credentials.for_domain(domain))
        .map_err(|source| SecurityError::Unusable {
            enclave: enclave.name.clone(),
            source: Box::new(source),
        })?;
    // The key is stored without a password, as ROS 2 does it: the folder's rights protect it.
    let files = rustdds::DomainParticipantSecurityConfigFiles::with_ros_default_names(
        &enclave.folder,
        String::new(),
    );
    Ok(builder.builtin_security(files))
}

/// Never reached: [`Wish::protection`] refuses where the feature is missing.
#[cfg(not(feature = "security"))]
fn secured(
    _: DomainParticipantBuilder,
    _: u16,
    _: &Enclave,
) -> Result<DomainParticipantBuilder, SecurityError> {
    Err(SecurityError::NotBuilt)
}
