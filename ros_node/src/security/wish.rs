//! Whether and how a program is to be secured, from the environment as ROS 2 reads it, but never
//! silently without.

use std::{env, path::PathBuf};

use super::{BUILT, Enclave, SecurityError, enclave::REVOKED};
use crate::environment::EnvironmentError;

/// What happens where a keystore or an enclave is missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strategy {
    /// The program does not start.
    Enforce,
    /// The program runs in the clear and says so.
    #[default]
    Permissive,
}

/// What the environment asks for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Wish {
    /// `ROS_SECURITY_ENABLE`.
    pub enabled: bool,
    /// `ROS_SECURITY_STRATEGY`.
    pub strategy: Strategy,
    /// `ROS_SECURITY_KEYSTORE`.
    pub keystore: Option<PathBuf>,
    /// `ROS_SECURITY_ENCLAVE_OVERRIDE`: the enclave, whatever the command line says.
    pub enclave: Option<String>,
}

/// How a participant is on the network.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Protection {
    /// In the clear; what is to be said of it if that is not what was asked for.
    Off(Option<String>),
    /// Secured, as that enclave.
    On(Enclave),
}

impl Protection {
    /// The enclave, if it is secured.
    #[must_use]
    pub const fn enclave(&self) -> Option<&Enclave> {
        match self {
            Self::On(enclave) => Some(enclave),
            Self::Off(_) => None,
        }
    }

    /// What is to be said: that it was asked for security and runs without.
    #[must_use]
    pub fn warning(&self) -> Option<&str> {
        match self {
            Self::Off(warning) => warning.as_deref(),
            Self::On(_) => None,
        }
    }
}

impl Wish {
    /// Reads `ROS_SECURITY_ENABLE`, `ROS_SECURITY_STRATEGY`, `ROS_SECURITY_KEYSTORE` and
    /// `ROS_SECURITY_ENCLAVE_OVERRIDE`.
    ///
    /// # Errors
    /// [`EnvironmentError`]: a value that ROS would take for "no", though somebody meant
    /// "yes", is refused here.
    pub fn from_environment() -> Result<Self, EnvironmentError> {
        let read = |name| env::var_os(name).map(|value| value.to_string_lossy().into_owned());
        Self::from_values(
            read("ROS_SECURITY_ENABLE").as_deref(),
            read("ROS_SECURITY_STRATEGY").as_deref(),
            read("ROS_SECURITY_KEYSTORE").as_deref(),
            read("ROS_SECURITY_ENCLAVE_OVERRIDE").as_deref(),
        )
    }

    /// Like [`from_environment`](Self::from_environment), from values that stand for the four
    /// variables in their order.
    ///
    /// # Errors
    /// [`EnvironmentError`].
    pub fn from_values(
        enable: Option<&str>,
        strategy: Option<&str>,
        keystore: Option<&str>,
        enclave: Option<&str>,
    ) -> Result<Self, EnvironmentError> {
        let wrong = |name, expected, value: &str| {
            Err(EnvironmentError { name, expected, value: value.to_owned() })
        };
        let enabled = match enable {
            None | Some("" | "false") => false,
            Some("true") => true,
            Some(value) => {
                return wrong("ROS_SECURITY_ENABLE", "`true` or `false`, in small letters", value);
            }
        };
        let strategy = match strategy {
            None | Some("" | "Permissive") => Strategy::Permissive,
            Some("Enforce") => Strategy::Enforce,
            Some(value) => {
                return wrong("ROS_SECURITY_STRATEGY", "`Enforce` or `Permissive`", value);
            }
        };
        let given =
            |value: Option<&str>| value.filter(|value| !value.is_empty()).map(str::to_owned);
        Ok(Self {
            enabled,
            strategy,
            keystore: given(keystore).map(PathBuf::from),
            enclave: given(enclave),
        })
    }

    /// How a program with that enclave on its command line is to be on the network.
    ///
    /// # Errors
    /// [`SecurityError`] where security is asked for and cannot be had: the program lacks
    /// it; keystore or enclave are missing and the strategy is to enforce; the enclave's name is
    /// none; it has a list of revoked certificates, which nobody would read.
    pub fn protection(&self, enclave: Option<&str>) -> Result<Protection, SecurityError> {
        self.protection_if(BUILT, enclave)
    }

    fn protection_if(
        &self,
        built: bool,
        enclave: Option<&str>,
    ) -> Result<Protection, SecurityError> {
        if !self.enabled {
            return Ok(Protection::Off(None));
        }
        if !built {
            return Err(SecurityError::NotBuilt);
        }
        let Some(keystore) = &self.keystore else {
            return self.without(SecurityError::NoKeystore);
        };
        let name = self.enclave.as_deref().or(enclave).unwrap_or("/");
        let enclave = Enclave::of(keystore, name)?;
        if let Some(lacking) = enclave.lacks() {
            let (enclave, keystore) = (enclave.name, keystore.clone());
            return self.without(SecurityError::Lacks { enclave, keystore, lacking });
        }
        if enclave.folder.join(REVOKED).exists() {
            return Err(SecurityError::Revoked { list: enclave.folder.join(REVOKED) });
        }
        Ok(Protection::On(enclave))
    }

    /// What is missing ends the program or is said, as the strategy is.
    fn without(&self, lacking: SecurityError) -> Result<Protection, SecurityError> {
        match self.strategy {
            Strategy::Enforce => Err(lacking),
            Strategy::Permissive => Ok(Protection::Off(Some(format!(
                "runs WITHOUT security, in the clear, though ROS_SECURITY_ENABLE is true: {lacking}; ROS_SECURITY_STRATEGY=Enforce \
                 would not have started it"
            )))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::FILES, *};

    fn wish(strategy: &str, keystore: Option<&str>) -> Wish {
        Wish::from_values(Some("true"), Some(strategy), keystore, None).unwrap()
    }

    #[test]
    fn security_is_on_for_true_exactly_and_what_only_looks_like_it_is_refused() {
        for off in [None, Some(""), Some("false")] {
            let wish = Wish::from_values(off, Some("Enforce"), None, None).unwrap();
            assert_eq!(wish.protection(None).unwrap(), Protection::Off(None));
        }
        for unclear in ["True", "TRUE", "1", "yes", " true"] {
            let error = Wish::from_values(Some(unclear), None, None, None).unwrap_err();
            assert!(error.to_string().contains("ROS_SECURITY_ENABLE"), "{error}");
        }
        let error =
            Wish::from_values(Some("true"), Some("enforce"), None, None).unwrap_err().to_string();
        assert!(error.contains("`Enforce` or `Permissive`"), "{error}");
    }

    /// Whatever the strategy: somebody who asks for security gets it from this program, or nothing.
    #[test]
    fn a_program_built_without_refuses() {
        for strategy in ["Enforce", "Permissive"] {
            let error = wish(strategy, Some("/keys")).protection_if(false, None).unwrap_err();
            assert!(error.to_string().contains("--features security"), "{error}");
        }
    }

    #[test]
    fn what_is_missing_ends_the_program_or_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let enclave = folder.path().join("enclaves/rig_driver");
        let lacks = |keystore, what: &str| {
            let look = |strategy| wish(strategy, keystore).protection_if(true, Some("/rig_driver"));
            let error = look("Enforce").unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
            let protection = look("Permissive").unwrap();
            let warning = protection.warning().expect("it is said");
            assert!(warning.contains("WITHOUT security") && warning.contains(what), "{warning}");
        };
        lacks(None, "ROS_SECURITY_KEYSTORE");
        lacks(Some("/no/such/keystore"), "/no/such/keystore/enclaves/rig_driver");
        std::fs::create_dir_all(&enclave).unwrap();
        for file in FILES {
            lacks(folder.path().to_str(), file);
            std::fs::write(enclave.join(file), "").unwrap();
        }
    }

    #[test]
    fn an_enclave_that_is_whole_is_taken_and_the_override_counts_above_the_command_line() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["rig_driver", "other"] {
            let enclave = folder.path().join("enclaves").join(name);
            std::fs::create_dir_all(&enclave).unwrap();
            FILES.iter().for_each(|file| std::fs::write(enclave.join(file), "").unwrap());
        }
        let mut wish = wish("Enforce", folder.path().to_str());
        let name = |wish: &Wish| {
            wish.protection_if(true, Some("/rig_driver")).unwrap().enclave().unwrap().name.clone()
        };
        assert_eq!(name(&wish), "/rig_driver");
        wish.enclave = Some("/other".into());
        assert_eq!(name(&wish), "/other");
        wish.enclave = Some("/../private".into());
        assert!(wish.protection_if(true, None).unwrap_err().to_string().contains("no enclave"));
        wish.enclave = Some("/other".into());
        std::fs::write(folder.path().join("enclaves/other/crl.pem"), "").unwrap();
        let error = wish.protection_if(true, None).unwrap_err().to_string();
        assert!(error.contains("crl.pem"), "{error}");
    }
}
