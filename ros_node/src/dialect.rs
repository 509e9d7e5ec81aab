//! How the middlewares of ROS put on DDS what DDS does not say itself.
//!
//! - Requests and answers: Fast DDS and RustDDS name the request beside the data, in the sample's
//!   own header (RELATED_SAMPLE_IDENTITY); `rmw_cyclonedds` puts sixteen bytes in front of the
//!   data, a number of the client and a number of the request. Both use the same topics and types,
//!   so each request is read as its sender's middleware puts it, and answered likewise. Who that is
//!   stands in the first two bytes of the sender's identifier, or, where DDS Security has changed
//!   those, in what its participant said of itself.
//! - The hash of an endpoint's type stands in the endpoint's USER_DATA.

use std::{
    collections::BTreeSet,
    sync::{PoisonError, RwLock},
};

use msgs::type_hashes;
use rustdds::{
    Dialect, DomainParticipantStatusEvent as Event, GUID, RepresentationIdentifier, Said,
    SampleIdentity,
};

use crate::security::{self, Prefix};

/// What the names of topics with requests begin with.
pub(crate) const REQUESTS: &str = "rq/";
/// What the names of topics with answers begin with.
pub(crate) const ANSWERS: &str = "rr/";
/// What Cyclone DDS is called in identifiers.
const CYCLONE: [u8; 2] = [0x01, 0x10];
/// Length of what stands in front of its requests and answers [bytes].
const FRONT: usize = 16;
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

impl Dialect for Ros {
    /// The hash as ROS writes it; where it is unknown, something in which nobody finds one.
    fn user_data(&self, _: &str, type_name: &str) -> Vec<u8> {
        match type_hashes::of_dds(type_name) {
            Some(hash) => format!("typehash={hash};").into_bytes(),
            None => b"vendor=frictionlab;".to_vec(),
        }
    }

    fn translates(&self, topic_name: &str) -> bool {
        topic_name.starts_with(REQUESTS) || topic_name.starts_with(ANSWERS)
    }

    fn heard(
        &self,
        topic_name: &str,
        writer: GUID,
        representation: RepresentationIdentifier,
        value: &[u8],
    ) -> Option<(SampleIdentity, usize)> {
        // Answers are read by the clients, which ask in the one way or the other.
        if !topic_name.starts_with(REQUESTS) || !self.is_cyclone(writer) {
            return None;
        }
        let Some(front) = value.first_chunk::<FRONT>() else {
            // Too short for a request: nothing of it is left to be understood.
            return Some((
                SampleIdentity { writer_guid: writer, ..Default::default() },
                value.len(),
            ));
        };
        let (mut client, mut number) = ([0; 8], [0; 8]);
        client.copy_from_slice(&front[..8]);
        number.copy_from_slice(&front[8..]);
        if representation == RepresentationIdentifier::CDR_BE {
            client.reverse();
            number.reverse();
        }
        let mut identity = [0; 16];
        identity[..8].copy_from_slice(&process(writer));
        identity[8..].copy_from_slice(&client);
        let request = SampleIdentity {
            writer_guid: GUID::from_bytes(identity),
            sequence_number: i64::from_le_bytes(number).into(),
        };
        Some((request, FRONT))
    }

    fn said(&self, request: SampleIdentity) -> Said {
        let client = request.writer_guid;
        if self.is_cyclone(client) {
            let mut front = [0; FRONT];
            front[..8].copy_from_slice(&client.to_bytes()[8..]);
            front[8..].copy_from_slice(&i64::from(request.sequence_number).to_le_bytes());
            return Said { front: Some(front), only_to: None };
        }
        // All clients of a service hear all answers. One of Cyclone DDS takes what is for others
        // apart too, and complains where it cannot.
        let others = !self.cyclone.read().unwrap_or_else(PoisonError::into_inner).is_empty();
        let is_known = client.entity_id.entity_kind.is_reader();
        Said { front: None, only_to: (others && is_known).then_some(client) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LITTLE: RepresentationIdentifier = RepresentationIdentifier::CDR_LE;
    const BIG: RepresentationIdentifier = RepresentationIdentifier::CDR_BE;

    fn guid(vendor: [u8; 2]) -> GUID {
        GUID::from_bytes([vendor[0], vendor[1], 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 3])
    }

    fn request(client: [u8; 8], number: [u8; 8]) -> Vec<u8> {
        [&client[..], &number[..], b"data"].concat()
    }

    #[test]
    fn a_request_of_cyclone_is_answered_with_what_stood_in_front_of_it() {
        let client = [0xf7, 1, 2, 3, 4, 5, 6, 0x04];
        let value = request(client, 300i64.to_le_bytes());
        let (id, front) = ROS.heard("rq/pingRequest", guid(CYCLONE), LITTLE, &value).unwrap();
        assert_eq!(&value[front..], b"data");
        assert_eq!(
            (process(id.writer_guid), i64::from(id.sequence_number)),
            (process(guid(CYCLONE)), 300)
        );
        assert_eq!(ROS.said(id).front.unwrap()[..], value[..front]);
        // A machine of the other byte order asks; the answer is little endian, as all of ours.
        let swapped = request([0x04, 6, 5, 4, 3, 2, 1, 0xf7], 300i64.to_be_bytes());
        assert_eq!(ROS.heard("rq/pingRequest", guid(CYCLONE), BIG, &swapped), Some((id, FRONT)));
    }

    #[test]
    fn others_and_other_topics_are_left_as_they_are() {
        let value = request([1; 8], [2; 8]);
        for vendor in [[0x01, 0x0f], [0x01, 0x12], [0, 0]] {
            assert_eq!(ROS.heard("rq/pingRequest", guid(vendor), LITTLE, &value), None);
            let to = SampleIdentity { writer_guid: guid(vendor), sequence_number: 1.into() };
            assert_eq!(ROS.said(to), Said::default());
        }
        assert_eq!(ROS.heard("rr/pingReply", guid(CYCLONE), LITTLE, &value), None);
        assert!(!ROS.translates("rt/joint_states"));
    }

    #[test]
    fn of_a_request_that_is_too_short_nothing_is_left() {
        for length in 0..FRONT {
            let value = vec![1; length];
            let heard = ROS.heard("rq/pingRequest", guid(CYCLONE), LITTLE, &value);
            assert_eq!(heard.map(|(_, front)| front), Some(length));
        }
    }

    #[test]
    fn hashes_stand_where_ros_looks_for_them_and_what_is_unknown_looks_like_none() {
        let told = |name: &str| String::from_utf8(ROS.user_data("rt/x", name)).unwrap();
        assert!(told("friction_msgs::msg::dds_::Reference_").starts_with("typehash=RIHS01_"));
        assert!(!told("somebody::msg::dds_::Else_").contains("typehash"));
    }
}
