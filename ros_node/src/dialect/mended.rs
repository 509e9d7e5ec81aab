//! What the mended middleware asks about its topics.

use std::sync::PoisonError;

use msgs::type_hashes;
use rustdds::{Dialect, GUID, RepresentationIdentifier, Said, SampleIdentity};

use super::{ANSWERS, REQUESTS, Ros, process};

/// Length of what stands in front of the requests and answers of Cyclone DDS \[bytes\].
const FRONT: usize = 16;

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
    use super::super::{CYCLONE, ROS};
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
