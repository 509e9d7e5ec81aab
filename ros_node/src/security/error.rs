//! Why security that is asked for cannot be had.

use std::path::PathBuf;

#[cfg(feature = "security")]
use super::credentials::CredentialsError;
use super::enclave::EnclaveNameError;

/// Security that is asked for and cannot be had.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SecurityError {
    /// The program lacks it.
    #[error(
        "this program was built without DDS Security: take one built with `--features security`, or unset \
         ROS_SECURITY_ENABLE to run in the clear"
    )]
    NotBuilt,
    /// No keystore is named.
    #[error(
        "ROS_SECURITY_KEYSTORE names no keystore: set it to the folder of one, or make one first"
    )]
    NoKeystore,
    /// The enclave's name is none.
    #[error(transparent)]
    EnclaveName(#[from] EnclaveNameError),
    /// A folder or file of the enclave is missing.
    #[error(
        "the enclave {enclave} of the keystore {} lacks {}; --enclave behind --ros-args chooses another enclave",
        keystore.display(), lacking.display()
    )]
    Lacks {
        /// Name of the enclave.
        enclave: String,
        /// Folder of the keystore.
        keystore: PathBuf,
        /// What is missing.
        lacking: PathBuf,
    },
    /// There is a list of revoked certificates, which nobody would read.
    #[error(
        "{} lists revoked certificates, and this middleware does not read it: make a new keystore, so that the old certificates \
         are nobody's, and remove the list",
        list.display()
    )]
    Revoked {
        /// The list.
        list: PathBuf,
    },
    /// The enclave's files cannot be used.
    #[cfg(feature = "security")]
    #[error("the enclave {enclave}: {source}")]
    Unusable {
        /// Name of the enclave.
        enclave: String,
        /// What is wrong with them.
        source: Box<CredentialsError>,
    },
}
