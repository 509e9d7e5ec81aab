//! Makes a keystore as `ros2 security` lays it out: `public/` for everybody, `private/` for whoever
//! signs, `enclaves/` with a folder for each program.
//!
//! Everything in it ends at the same time: permissions outlive no certificate. A keystore that ends
//! is replaced by a new one with a new authority, never prolonged: the middleware does not look at
//! the dates of other participants' certificates, but a certificate of another authority is
//! nobody's.

use std::{
    fs::{self, DirBuilder, OpenOptions},
    io::{self, Write},
    os::unix::fs::{DirBuilderExt, OpenOptionsExt, symlink},
    path::{Path, PathBuf},
};

use openssl::{
    asn1::Asn1Time,
    bn::{BigNum, MsbOption},
    ec::{EcGroup, EcKey},
    error::ErrorStack,
    hash::MessageDigest,
    nid::Nid,
    pkcs7::{Pkcs7, Pkcs7Flags},
    pkey::{PKey, Private},
    stack::Stack,
    x509::{X509, X509Builder, X509NameBuilder, extension::BasicConstraints},
};

use super::{
    Enclave, EnclaveNameError,
    permissions::{Policy, Rights, governance, permissions},
};

/// Common name of the authority.
const AUTHORITY: &str = "frictionlabCA";
/// Certificates count a while before they are made, for machines whose clocks are late.
const EARLIER: i64 = 3600;

/// A keystore that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum KeystoreError {
    /// The folder is there.
    #[error("{0} is there already; name another folder, or remove it if nobody uses it any more")]
    Exists(PathBuf),
    /// A name in the policy.
    #[error("in the policy: {0}")]
    Name(#[from] EnclaveNameError),
    /// A file.
    #[error("{0} cannot be written: {1}")]
    Write(PathBuf, io::Error),
    /// The library of keys and certificates.
    #[error("a certificate cannot be made: {0}")]
    Certificate(#[from] ErrorStack),
}

impl KeystoreError {
    /// Whether whoever asked for it can mend it: another folder, another policy.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Exists(_) | Self::Name(_) => true,
            Self::Write(_, source) => names_another_place(source.kind()),
            Self::Certificate(_) => false,
        }
    }
}

/// Whether another folder would do.
const fn names_another_place(kind: io::ErrorKind) -> bool {
    matches!(
        kind,
        io::ErrorKind::NotFound
            | io::ErrorKind::PermissionDenied
            | io::ErrorKind::AlreadyExists
            | io::ErrorKind::NotADirectory
            | io::ErrorKind::IsADirectory
            | io::ErrorKind::InvalidFilename
            | io::ErrorKind::ReadOnlyFilesystem
    )
}

/// What a keystore is made of.
#[derive(Debug, Clone)]
pub struct Order<'a> {
    /// Where; must not be there.
    pub folder: &'a Path,
    /// Its enclaves with what they may do.
    pub policy: &'a Policy,
    /// Domains in which it counts.
    pub domains: &'a [u16],
    /// The time now, in seconds since 1970.
    pub now: i64,
    /// How long it counts \[days\].
    pub days: u32,
}

/// Makes it; all at once or not at all.
///
/// # Errors
/// [`KeystoreError`].
pub fn make(order: &Order) -> Result<(), KeystoreError> {
    if order.folder.exists() {
        return Err(KeystoreError::Exists(order.folder.to_owned()));
    }
    let name = order.folder.file_name().unwrap_or_default().to_string_lossy();
    let unfinished = order.folder.with_file_name(format!(".{name}.{}", std::process::id()));
    let valid = (order.now - EARLIER, order.now + i64::from(order.days) * 86_400);
    let made = Authority::new(&unfinished, order.domains, valid).and_then(|authority| {
        for (enclave, rights) in order.policy {
            authority.enclave(enclave, rights, valid, valid)?;
        }
        fs::rename(&unfinished, order.folder)
            .map_err(|error| KeystoreError::Write(order.folder.to_owned(), error))
    });
    if made.is_err() {
        let _ = fs::remove_dir_all(&unfinished);
    }
    made
}

/// Who signs: a keystore whose authority's key is at hand.
pub struct Authority {
    folder: PathBuf,
    domains: Vec<u16>,
    key: PKey<Private>,
    certificate: X509,
}

impl Authority {
    /// A new authority, valid from one time to another, in a new folder.
    ///
    /// # Errors
    /// [`KeystoreError`].
    pub fn new(folder: &Path, domains: &[u16], valid: (i64, i64)) -> Result<Self, KeystoreError> {
        let (key, certificate) = identity(AUTHORITY, valid, None)?;
        for part in ["public", "private", "enclaves"] {
            private_folder(&folder.join(part))?;
        }
        let authority =
            Self { folder: folder.to_owned(), domains: domains.to_vec(), key, certificate };
        write(&folder.join("public/ca.cert.pem"), &authority.certificate.to_pem()?)?;
        write(&folder.join("private/ca.key.pem"), &authority.key.private_key_to_pem_pkcs8()?)?;
        for role in ["identity_ca", "permissions_ca"] {
            for (part, kind) in [("public", "cert"), ("private", "key")] {
                let link = folder.join(format!("{part}/{role}.{kind}.pem"));
                symlink(format!("ca.{kind}.pem"), &link)
                    .map_err(|error| KeystoreError::Write(link, error))?;
            }
        }
        let rules = governance(&authority.domains);
        write(&folder.join("enclaves/governance.xml"), rules.as_bytes())?;
        write(&folder.join("enclaves/governance.p7s"), &authority.sign(&rules)?)?;
        Ok(authority)
    }

    /// An enclave, with the times in which its certificate and its permissions count.
    ///
    /// # Errors
    /// [`KeystoreError`].
    pub fn enclave(
        &self,
        name: &str,
        rights: &(Rights, Rights),
        certificate_valid: (i64, i64),
        permissions_valid: (i64, i64),
    ) -> Result<(), KeystoreError> {
        let folder = Enclave::of(&self.folder, name)?.folder;
        private_folder(&folder)?;
        let (key, certificate) = identity(name, certificate_valid, Some(self))?;
        let granted = permissions(name, rights, permissions_valid, &self.domains);
        let authority = self.certificate.to_pem()?;
        let governance = fs::read(self.folder.join("enclaves/governance.p7s"))
            .map_err(|error| KeystoreError::Write(folder.clone(), error))?;
        // Copies, not links: an enclave is whole when it is carried to its machine.
        for (file, content) in [
            ("key.pem", key.private_key_to_pem_pkcs8()?),
            ("cert.pem", certificate.to_pem()?),
            ("identity_ca.cert.pem", authority.clone()),
            ("permissions_ca.cert.pem", authority),
            ("governance.p7s", governance),
            ("permissions.p7s", self.sign(&granted)?),
            ("permissions.xml", granted.into_bytes()),
        ] {
            write(&folder.join(file), &content)?;
        }
        Ok(())
    }

    /// A document with its signature, as S/MIME.
    fn sign(&self, text: &str) -> Result<Vec<u8>, ErrorStack> {
        let flags = Pkcs7Flags::TEXT | Pkcs7Flags::DETACHED | Pkcs7Flags::STREAM;
        let others = Stack::new()?;
        let signed = Pkcs7::sign(&self.certificate, &self.key, &others, text.as_bytes(), flags)?;
        signed.to_smime(text.as_bytes(), flags)
    }
}

/// A key on the curve prime256v1, the only one that both RustDDS and the others read, and its
/// certificate, signed by the authority or by itself.
fn identity(
    name: &str,
    valid: (i64, i64),
    authority: Option<&Authority>,
) -> Result<(PKey<Private>, X509), ErrorStack> {
    let curve = EcGroup::from_curve_name(Nid::X9_62_PRIME256V1)?;
    let key = PKey::from_ec_key(EcKey::generate(&curve)?)?;
    let mut subject = X509NameBuilder::new()?;
    subject.append_entry_by_nid(Nid::COMMONNAME, name)?;
    let subject = subject.build();
    let mut builder = X509Builder::new()?;
    builder.set_version(2)?;
    let mut serial = BigNum::new()?;
    serial.rand(127, MsbOption::MAYBE_ZERO, false)?;
    let serial = serial.to_asn1_integer()?;
    builder.set_serial_number(&serial)?;
    builder.set_subject_name(&subject)?;
    builder.set_issuer_name(
        authority.map_or(&subject, |authority| authority.certificate.subject_name()),
    )?;
    builder.set_pubkey(&key)?;
    let (from, to) = (Asn1Time::from_unix(valid.0)?, Asn1Time::from_unix(valid.1)?);
    builder.set_not_before(&from)?;
    builder.set_not_after(&to)?;
    let mut constraints = BasicConstraints::new();
    if authority.is_none() {
        constraints.critical().ca().pathlen(1);
    }
    builder.append_extension(constraints.build()?)?;
    builder.sign(authority.map_or(&key, |authority| &authority.key), MessageDigest::sha256())?;
    Ok((key, builder.build()))
}

fn private_folder(folder: &Path) -> Result<(), KeystoreError> {
    DirBuilder::new()
        .recursive(true)
        .mode(0o700)
        .create(folder)
        .map_err(|error| KeystoreError::Write(folder.to_owned(), error))
}

fn write(path: &Path, content: &[u8]) -> Result<(), KeystoreError> {
    let written = OpenOptions::new().write(true).create_new(true).mode(0o600).open(path);
    written
        .and_then(|mut file| file.write_all(content))
        .map_err(|error| KeystoreError::Write(path.to_owned(), error))
}
