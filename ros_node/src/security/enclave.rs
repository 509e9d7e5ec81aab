//! An enclave: the folder of a keystore with one program's identity and what it may do.

use std::path::{Path, PathBuf};

/// The files that an enclave needs, as ROS 2 names them.
pub const FILES: [&str; 6] = [
    "identity_ca.cert.pem",
    "cert.pem",
    "key.pem",
    "permissions_ca.cert.pem",
    "governance.p7s",
    "permissions.p7s",
];
/// A list of revoked certificates. The middleware does not read it.
pub(super) const REVOKED: &str = "crl.pem";

/// One program's identity in a keystore.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Enclave {
    /// Its name, as in `/rig_driver`.
    pub name: String,
    /// Its folder.
    pub folder: PathBuf,
}

/// A text that names no enclave.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{name}` is no enclave; expected a slash and letters, digits and underscores, as in /rig_driver"
)]
pub struct EnclaveNameError {
    /// What came.
    pub name: String,
}

impl Enclave {
    /// The enclave of that name in a keystore; nothing is looked at yet.
    ///
    /// # Errors
    /// [`EnclaveNameError`] for a name that is none.
    pub fn of(keystore: &Path, name: &str) -> Result<Self, EnclaveNameError> {
        let parts = name.strip_prefix('/').unwrap_or_default();
        let is_part = |part: &str| {
            !part.is_empty()
                && part.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
        };
        if name != "/" && !parts.split('/').all(is_part) {
            return Err(EnclaveNameError { name: name.to_owned() });
        }
        let folder = keystore.join("enclaves");
        let folder = if parts.is_empty() { folder } else { folder.join(parts) };
        Ok(Self { name: name.to_owned(), folder })
    }

    /// The first file that it lacks, or the folder itself.
    pub(super) fn lacks(&self) -> Option<PathBuf> {
        if !self.folder.is_dir() {
            return Some(self.folder.clone());
        }
        FILES.iter().map(|file| self.folder.join(file)).find(|file| !file.is_file())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_enclave_is_a_folder_below_the_keystore_and_nothing_else() {
        let keystore = Path::new("/keys");
        assert_eq!(Enclave::of(keystore, "/").unwrap().folder, Path::new("/keys/enclaves"));
        assert_eq!(
            Enclave::of(keystore, "/lab/rig").unwrap().folder,
            Path::new("/keys/enclaves/lab/rig")
        );
        for wrong in ["", "rig", "/rig/", "//rig", "/../private", "/a b", "/a/./b"] {
            assert!(
                Enclave::of(keystore, wrong).unwrap_err().to_string().contains("as in /rig_driver"),
                "{wrong}"
            );
        }
    }
}
