//! How the middlewares of ROS put on DDS what DDS does not say itself.
//!
//! - Requests and answers: Fast DDS and RustDDS name the request beside the data, in the sample's
//!   own header (RELATED_SAMPLE_IDENTITY); `rmw_cyclonedds` puts sixteen bytes in front of the
//!   data, a number of the client and a number of the request. Both use the same topics and types,
//!   so each request is read as its sender's middleware puts it, and answered likewise. Who that is
//!   stands in the first two bytes of the sender's identifier, or, where DDS Security has changed
//!   those, in what its participant said of itself.
//! - The hash of an endpoint's type stands in the endpoint's USER_DATA.
//!
//! The middleware asks about both where it is mended (feature `mended`); the published one speaks
//! as Fast DDS does, and says no hashes.

use std::{
    collections::BTreeSet,
    sync::{PoisonError, RwLock},
};

use rustdds::{DomainParticipantStatusEvent as Event, GUID};

use crate::security::{self, Prefix};

#[cfg(feature = "mended")]
mod mended;

/// What the names of topics with requests begin with.
pub(crate) const REQUESTS: &str = "rq/";
/// What the names of topics with answers begin with.
pub(crate) const ANSWERS: &str = "rr/";
/// What Cyclone DDS is called in identifiers.
const CYCLONE: [u8; 2] = [0x01, 0x10];
/// Participants that are remembered at most: strangers may make up any number of them.
const MOST: usize = 1000;

/// First half of the identifiers of a process's endpoints: all that is known of whom an answer goes
/// to, where its client is of Cyclone DDS.
pub(crate) type Process = [u8; 8];

/// That half of an identifier.
pub(crate) fn process(who: GUID) -> Process {
    let [a, b, c, d, e, f, g, h, ..] = who.to_bytes();
    [a, b, c, d, e, f, g, h]
}

/// The dialects of ROS.
pub(crate) struct Ros {
    /// The participants of Cyclone DDS that are there.
    cyclone: RwLock<BTreeSet<Prefix>>,
}

/// Those that this process speaks.
pub(crate) static ROS: Ros = Ros { cyclone: RwLock::new(BTreeSet::new()) };

impl Ros {
    /// Whether the process of an endpoint speaks as `rmw_cyclonedds` does.
    pub(crate) fn is_cyclone(&self, who: GUID) -> bool {
        let process = process(who);
        if process.starts_with(&CYCLONE) {
            return true;
        }
        let [a, b, c, d, e, f, g, h] = process;
        let known = self.cyclone.read().unwrap_or_else(PoisonError::into_inner);
        let next = known.range([a, b, c, d, e, f, g, h, 0, 0, 0, 0]..).next();
        next.is_some_and(|prefix| prefix.starts_with(&process))
    }

    /// Takes what the participant tells of others.
    pub(crate) fn take(&self, event: &Event) {
        let known = || self.cyclone.write().unwrap_or_else(PoisonError::into_inner);
        match event {
            Event::ParticipantDiscovered { dpd } if dpd.vendor_id.vendor_id == CYCLONE => {
                let mut known = known();
                if known.len() < MOST {
                    known.insert(security::prefix(dpd.guid.prefix));
                }
            }
            Event::ParticipantLost { id, .. } => {
                known().remove(&security::prefix(*id));
            }
            _ => {}
        }
    }
}
