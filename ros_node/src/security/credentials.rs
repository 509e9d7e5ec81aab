//! Looks at the files of an enclave before the middleware does, and says in sentences what is wrong
//! with them.

use std::{
    collections::BTreeSet,
    fs, io,
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};

use openssl::{
    asn1::{Asn1Time, Asn1TimeRef},
    error::ErrorStack,
    nid::Nid,
    pkcs7::{Pkcs7, Pkcs7Flags},
    pkey::{Id, PKey, PKeyRef, Public},
    stack::Stack,
    x509::{X509, X509NameRef, store::X509StoreBuilder},
};

use super::{
    calendar::to_text,
    permissions::{DocumentError, Grant, Rules, read_governance, read_permissions},
};

/// Days before the end in which it is told.
const SOON: i64 = 30;
const DAY: i64 = 86_400;

/// An enclave that can be used.
#[derive(Debug, Clone)]
pub struct Credentials {
    /// Whose they are, as in `CN=/rig_driver`.
    pub subject: String,
    /// When the first of certificate, authority and permissions ends, in seconds since 1970.
    pub ends: i64,
    /// What it may do.
    pub grant: Grant,
    /// What is not wrong, but worth a look, in sentences.
    pub notes: Vec<String>,
    rules: Vec<Rules>,
}

/// Why an enclave cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CredentialsError {
    /// A file cannot be read.
    #[error("{} cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file is not what it should be.
    #[error("{file} {fault}: {source}")]
    Malformed {
        /// The file.
        file: &'static str,
        /// What is wrong with it, as `is no certificate in PEM`.
        fault: &'static str,
        /// What the library says.
        source: ErrorStack,
    },
    /// A signed document that holds no text.
    #[error("{file} is no text")]
    NoText {
        /// The file.
        file: &'static str,
    },
    /// The library refuses a check.
    #[error(transparent)]
    Library(#[from] ErrorStack),
    /// A date in a certificate.
    #[error("a date in a certificate cannot be read: {0}")]
    Date(ErrorStack),
    /// The certificate is of another authority.
    #[error(
        "cert.pem of {subject} is not signed by identity_ca.cert.pem: it is of another keystore"
    )]
    OtherKeystore {
        /// Whose certificate it is.
        subject: String,
    },
    /// The key is of another certificate.
    #[error("key.pem is not the key of cert.pem")]
    OtherKey,
    /// A kind of key that the middleware does not use.
    #[error(
        "{file} has a key that this middleware does not use; expected one on the curve prime256v1"
    )]
    KindOfKey {
        /// The file.
        file: &'static str,
    },
    /// A document that its authority did not sign.
    #[error("{file} is not signed by permissions_ca.cert.pem, or was changed after it was signed")]
    NotSigned {
        /// The file.
        file: &'static str,
    },
    /// A document that says something else than it should.
    #[error("{file}: {source}")]
    Document {
        /// The file.
        file: &'static str,
        /// What is wrong with it.
        source: DocumentError,
    },
    /// Permissions of others.
    #[error("permissions.p7s grants nothing to {subject}")]
    NothingGranted {
        /// Whose certificate it is.
        subject: String,
    },
    /// Something counts later only.
    #[error("{file} counts from {} UTC, and it is {}: is the clock right?", to_text(*from), to_text(*now))]
    TooEarly {
        /// The file.
        file: &'static str,
        /// From when it counts, in seconds since 1970.
        from: i64,
        /// The time now.
        now: i64,
    },
    /// Something does not count any more.
    #[error("{file} expired on {} UTC: make a new keystore", to_text(*ended))]
    Expired {
        /// The file.
        file: &'static str,
        /// When it ended, in seconds since 1970.
        ended: i64,
    },
    /// They are for other domains.
    #[error(
        "it does not count in ROS domain {domain}: use one of its domains ({}), or make a keystore for this one",
        ranges(domains)
    )]
    OtherDomain {
        /// The domain that was asked for.
        domain: u16,
        /// Those in which they count, each with the first and the last of a range.
        domains: Vec<(u16, u16)>,
    },
}

/// Ranges of domains, in words.
fn ranges(domains: &[(u16, u16)]) -> String {
    let range = |(from, to): &(u16, u16)| {
        if from == to { from.to_string() } else { format!("{from} to {to}") }
    };
    domains.iter().map(range).collect::<Vec<_>>().join(", ")
}

/// Reads the files of an enclave's folder and holds them against each other and against the time.
///
/// # Errors
/// [`CredentialsError`]: which file, what was expected, what was found.
pub fn examine(folder: &Path, now: SystemTime) -> Result<Credentials, CredentialsError> {
    let now = now.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs().cast_signed());
    let read = |file: &str| {
        let path = folder.join(file);
        fs::read(&path).map_err(|source| CredentialsError::Read { path, source })
    };
    let certificate = |file: &'static str| {
        X509::from_pem(&read(file)?).map_err(malformed(file, "is no certificate in PEM"))
    };
    let (authority, identity) = (certificate("identity_ca.cert.pem")?, certificate("cert.pem")?);
    let subject = name_of(identity.subject_name());
    if !identity.verify(&*public(&authority, "identity_ca.cert.pem")?)? {
        return Err(CredentialsError::OtherKeystore { subject });
    }
    let mut ends = i64::MAX;
    for (file, of) in [("identity_ca.cert.pem", &authority), ("cert.pem", &identity)] {
        let (from, to) = (seconds(of.not_before())?, seconds(of.not_after())?);
        in_time(file, (from, to), now)?;
        ends = ends.min(to);
    }
    let certificate_ends = ends;
    let key = PKey::private_key_from_pem(&read("key.pem")?)
        .map_err(malformed("key.pem", "is no private key in PEM without a password"))?;
    let own = public(&identity, "cert.pem")?;
    if !own.public_eq(&key) {
        return Err(CredentialsError::OtherKey);
    }
    usable(&own, "cert.pem", true)?;

    let signer = certificate("permissions_ca.cert.pem")?;
    let signers = public(&signer, "permissions_ca.cert.pem")?;
    usable(&signers, "permissions_ca.cert.pem", false)?;
    let document = |file| move |source| CredentialsError::Document { file, source };
    let rules = read_governance(&content("governance.p7s", &read("governance.p7s")?, &signer)?)
        .map_err(document("governance.p7s"))?;
    let grants = read_permissions(&content("permissions.p7s", &read("permissions.p7s")?, &signer)?)
        .map_err(document("permissions.p7s"))?;
    let of_subject: Vec<&Grant> =
        grants.iter().filter(|grant| same_name(&grant.subject, &subject)).collect();
    let grant = of_subject
        .iter()
        .find(|grant| grant.valid.0 <= now && now < grant.valid.1)
        .or(of_subject.first())
        .ok_or_else(|| CredentialsError::NothingGranted { subject: subject.clone() })?;
    in_time("permissions.p7s", grant.valid, now)?;
    ends = ends.min(grant.valid.1);

    let mut notes = Vec::new();
    if grant.valid.1 > certificate_ends {
        notes.push(
            "its permissions outlive its certificate: nodes on RustDDS look at the dates of permissions only, so that it stays \
             in until those end"
                .to_owned(),
        );
    }
    if ends - now < SOON * DAY {
        notes.push(format!("it ends on {} UTC: make a new keystore before", to_text(ends)));
    }
    let mode = fs::metadata(folder.join("key.pem")).map_or(0, |data| data.permissions().mode());
    if mode & 0o077 != 0 {
        notes.push(format!(
            "key.pem may be read by other users (mode {:o}): `chmod 600 key.pem`",
            mode & 0o777
        ));
    }
    notes.extend(rules.iter().flat_map(|rule| rule.open.clone()).collect::<BTreeSet<_>>());
    if grant.allows_the_rest {
        notes.push("what its permissions do not name is allowed (default ALLOW)".to_owned());
    }
    Ok(Credentials { subject, ends, grant: (*grant).clone(), notes, rules })
}

impl Credentials {
    /// The same, if they count in that domain.
    ///
    /// # Errors
    /// [`CredentialsError::OtherDomain`] if not.
    pub fn for_domain(self, domain: u16) -> Result<Self, CredentialsError> {
        let within =
            |ranges: &[(u16, u16)]| ranges.iter().any(|(from, to)| (*from..=*to).contains(&domain));
        if !self.rules.iter().any(|rule| within(&rule.domains)) || !within(&self.grant.domains) {
            return Err(CredentialsError::OtherDomain { domain, domains: self.grant.domains });
        }
        Ok(self)
    }
}

fn in_time(file: &'static str, (from, to): (i64, i64), now: i64) -> Result<(), CredentialsError> {
    if now < from {
        return Err(CredentialsError::TooEarly { file, from, now });
    }
    if now >= to {
        return Err(CredentialsError::Expired { file, ended: to });
    }
    Ok(())
}

const fn malformed(
    file: &'static str,
    fault: &'static str,
) -> impl Fn(ErrorStack) -> CredentialsError + Copy {
    move |source| CredentialsError::Malformed { file, fault, source }
}

fn public(certificate: &X509, file: &'static str) -> Result<PKey<Public>, CredentialsError> {
    certificate.public_key().map_err(malformed(file, "has no readable key"))
}

/// Keys that RustDDS can use: the curve prime256v1, and for identities RSA of 2048 bits.
fn usable(key: &PKeyRef<Public>, file: &'static str, rsa: bool) -> Result<(), CredentialsError> {
    let curve = key.ec_key().ok().and_then(|key| key.group().curve_name());
    if curve == Some(Nid::X9_62_PRIME256V1) || (rsa && key.id() == Id::RSA && key.bits() == 2048) {
        return Ok(());
    }
    Err(CredentialsError::KindOfKey { file })
}

/// The text of a signed document, if that authority signed it.
fn content(
    file: &'static str,
    signed: &[u8],
    authority: &X509,
) -> Result<String, CredentialsError> {
    let broken = malformed(file, "is no signed document (S/MIME)");
    let (signature, text) = Pkcs7::from_smime(signed).map_err(broken)?;
    let mut authorities = Stack::new().map_err(broken)?;
    authorities.push(authority.clone()).map_err(broken)?;
    let nobody = X509StoreBuilder::new().map_err(broken)?.build();
    let mut content = Vec::new();
    // The authority is trusted because it lies in the enclave; certificates in the document are
    // not.
    let flags = Pkcs7Flags::NOVERIFY | Pkcs7Flags::NOINTERN | Pkcs7Flags::TEXT;
    signature
        .verify(&authorities, &nobody, text.as_deref(), Some(&mut content), flags)
        .map_err(|_| CredentialsError::NotSigned { file })?;
    String::from_utf8(content).map_err(|_| CredentialsError::NoText { file })
}

fn seconds(time: &Asn1TimeRef) -> Result<i64, CredentialsError> {
    let since = Asn1Time::from_unix(0).and_then(|epoch| epoch.diff(time));
    let since = since.map_err(CredentialsError::Date)?;
    Ok(i64::from(since.days) * DAY + i64::from(since.secs))
}

/// A name as permissions write it: its parts with commas between.
fn name_of(name: &X509NameRef) -> String {
    let parts = name.entries().filter_map(|entry| {
        let kind = entry.object().nid().short_name().ok()?;
        Some(format!("{kind}={}", entry.data().to_string().ok()?))
    });
    parts.collect::<Vec<_>>().join(",")
}

/// The order of the parts differs between programs.
fn same_name(one: &str, other: &str) -> bool {
    let parts =
        |name: &str| name.split(',').map(|part| part.trim().to_owned()).collect::<BTreeSet<_>>();
    parts(one) == parts(other)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{
        super::{
            keystore::{Authority, Order, make},
            permissions::read_policy,
            policy::policy,
        },
        *,
    };

    const NOW: i64 = 1_800_000_000;

    fn at(seconds: i64) -> SystemTime {
        UNIX_EPOCH + Duration::from_secs(seconds.cast_unsigned())
    }

    fn keystore(folder: &Path) {
        let policy = read_policy(&policy("/")).unwrap();
        make(&Order { folder, policy: &policy, domains: &[0, 7], now: NOW, days: 100 }).unwrap();
    }

    #[test]
    fn every_enclave_of_a_new_keystore_is_in_order() {
        let folder = tempfile::tempdir().unwrap();
        let keys = folder.path().join("keys");
        keystore(&keys);
        for name in [
            "rig_driver",
            "friction_observer",
            "controller",
            "experiment_runner",
            "live",
            "operator",
            "viewer",
        ] {
            let found = examine(&keys.join("enclaves").join(name), at(NOW)).unwrap();
            assert_eq!(found.subject, format!("CN=/{name}"));
            assert_eq!(found.notes, [""; 0], "{name}");
            assert_eq!(found.ends, NOW + 100 * DAY);
            assert!(found.clone().for_domain(7).is_ok());
            assert!(found.for_domain(1).unwrap_err().to_string().contains("ROS domain 1"));
        }
        let soon = examine(&keys.join("enclaves/viewer"), at(NOW + 90 * DAY)).unwrap();
        assert!(soon.notes[0].contains("it ends on"), "{:?}", soon.notes);
        let again = make(&Order {
            folder: &keys,
            policy: &Default::default(),
            domains: &[],
            now: NOW,
            days: 1,
        });
        assert!(again.unwrap_err().to_string().contains("there already"));
        let hidden = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(hidden, 1, "nothing unfinished is left");
        let mode = fs::metadata(keys.join("private/ca.key.pem")).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
    }

    /// Each file exchanged or changed: never taken, and the sentence names the file.
    #[test]
    fn what_does_not_go_together_is_refused_and_named() {
        let folder = tempfile::tempdir().unwrap();
        let (ours, theirs) = (folder.path().join("ours"), folder.path().join("theirs"));
        keystore(&ours);
        keystore(&theirs);
        let enclave = ours.join("enclaves/controller");
        let whole: Vec<_> = super::super::FILES
            .iter()
            .map(|file| (*file, fs::read(enclave.join(file)).unwrap()))
            .collect();
        let refused = |file: &str, content: &[u8], said: &str| {
            fs::write(enclave.join(file), content).unwrap();
            let error = examine(&enclave, at(NOW)).expect_err(file).to_string();
            assert!(error.contains(said), "{file}: {error}");
            let (_, good) = whole.iter().find(|(name, _)| *name == file).unwrap();
            fs::write(enclave.join(file), good).unwrap();
        };
        for (file, good) in &whole {
            refused(file, b"", file);
            refused(file, &good[..good.len() / 2], file);
            let foreign = fs::read(theirs.join("enclaves/controller").join(file)).unwrap();
            let said = match *file {
                "identity_ca.cert.pem" => "another keystore",
                "permissions_ca.cert.pem" => "not signed by",
                "cert.pem" => "another keystore",
                _ => file,
            };
            refused(file, &foreign, said);
        }
        let viewer = fs::read(ours.join("enclaves/viewer/permissions.p7s")).unwrap();
        refused("permissions.p7s", &viewer, "grants nothing to CN=/controller");
        let text = String::from_utf8(whole.last().unwrap().1.clone()).unwrap();
        refused(
            "permissions.p7s",
            text.replace("rt/motor_voltage", "rt/motor_voltagf").as_bytes(),
            "changed after",
        );
        assert!(examine(&enclave, at(NOW)).is_ok());
    }

    #[test]
    fn what_is_over_is_refused_and_permissions_that_outlive_the_certificate_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let authority = Authority::new(folder.path(), &[0], (0, NOW + 99 * DAY)).unwrap();
        let (past, present, future) =
            ((0, NOW - 1), (0, NOW + 50 * DAY), (NOW + 1, NOW + 50 * DAY));
        let rights = Default::default();
        for (name, certificate, permissions, said) in [
            ("/a", past, present, "cert.pem expired"),
            ("/b", present, past, "permissions.p7s expired"),
            ("/c", future, present, "is the clock right"),
            ("/d", present, future, "is the clock right"),
        ] {
            authority.enclave(name, &rights, certificate, permissions).unwrap();
            let enclave = folder.path().join("enclaves").join(&name[1..]);
            let error = examine(&enclave, at(NOW)).unwrap_err().to_string();
            assert!(error.contains(said), "{name}: {error}");
        }
        authority.enclave("/e", &rights, present, (0, NOW + 60 * DAY)).unwrap();
        let found = examine(&folder.path().join("enclaves/e"), at(NOW)).unwrap();
        assert!(found.notes[0].contains("outlive"), "{:?}", found.notes);
    }
}
