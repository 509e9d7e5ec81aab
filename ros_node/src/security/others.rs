//! The other participants of a domain, and how they stand with this one.

use std::{
    collections::BTreeMap,
    sync::{Mutex, PoisonError},
};

use rustdds::DomainParticipantStatusEvent as Event;

/// First twelve bytes of a participant's identifier.
pub type Prefix = [u8; 12];

/// Participants that are kept at most: strangers may make up any number of them.
const MOST: usize = 1000;

/// How another participant stands with a secured one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It proved who it is, and its permissions are signed by the same authority.
    Authenticated,
    /// It is being asked.
    Authenticating,
    /// It could not prove who it is, or has no valid permissions: nothing of it counts.
    Refused,
}

/// What is known of another participant.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Other {
    /// What it calls itself; empty where it says nothing. Nobody proves this name.
    pub name: String,
    /// Whether it offers to prove who it is; only a process in the clear is told of those who do
    /// not.
    pub offers_security: bool,
    /// How it stands, if this process is secured and the middleware told.
    pub standing: Option<Standing>,
}

/// The other participants, as far as the middleware told of them.
#[derive(Debug, Default)]
pub struct Others(Mutex<BTreeMap<Prefix, Other>>);

impl Others {
    /// Takes an event of the participant.
    pub(crate) fn take(&self, event: &Event) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut change = |who: Prefix, change: &dyn Fn(&mut Other)| {
            if known.contains_key(&who) || known.len() < MOST {
                change(known.entry(who).or_default());
            }
        };
        match event {
            Event::ParticipantDiscovered { dpd } => change(prefix(dpd.guid.prefix), &|other| {
                other.name = dpd.entity_name.clone().unwrap_or_default();
                #[cfg(feature = "security")]
                {
                    other.offers_security = dpd.supports_security;
                }
            }),
            #[cfg(feature = "security")]
            Event::Authentication { participant, status } => {
                change(prefix(participant), &|other| {
                    other.offers_security = true;
                    other.standing = Some(standing(&format!("{status:?}")));
                })
            }
            Event::ParticipantLost { id, .. } => _ = known.remove(&prefix(id)),
            _ => {}
        }
    }

    /// Each of them.
    #[must_use]
    pub fn known(&self) -> BTreeMap<Prefix, Other> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// RustDDS does not export the type of the status, only what it prints.
#[cfg(feature = "security")]
fn standing(status: &str) -> Standing {
    match status {
        "Authenticated" => Standing::Authenticated,
        "Authenticating" => Standing::Authenticating,
        _ => Standing::Refused,
    }
}

/// RustDDS does not export the type of the prefix.
pub(crate) fn prefix(of: impl AsRef<[u8]>) -> Prefix {
    of.as_ref().try_into().unwrap_or_default()
}
