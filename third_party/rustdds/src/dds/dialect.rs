// frictionlab: this file is not of RustDDS 0.15.1.
//! What stands above DDS and goes over the same topics in more than one way.

use bytes::Bytes;

use crate::{
  dds::with_key::WriteOptions,
  serialization::RepresentationIdentifier,
  structure::{guid::GUID, rpc::SampleIdentity},
};

/// How the endpoints of a participant describe themselves to others, and how requests and answers are put for those who put them otherwise.
///
/// One is given to a participant by
/// [`DomainParticipantBuilder::dialect`](crate::DomainParticipantBuilder::dialect).
pub trait Dialect: Send + Sync {
  /// What stands in USER_DATA of the readers and writers of a topic.
  fn user_data(&self, topic_name: &str, type_name: &str) -> Vec<u8>;

  /// Whether what is read and written on that topic goes through [`Self::heard`] and [`Self::said`].
  fn translates(&self, topic_name: &str) -> bool;

  /// A sample that a writer sent: its identity as a request and the length of what stands in front of the data. `None` leaves it as it is.
  fn heard(
    &self,
    topic_name: &str,
    writer: GUID,
    representation: RepresentationIdentifier,
    value: &[u8],
  ) -> Option<(SampleIdentity, usize)>;

  /// How the data that answers a request is written.
  fn said(&self, request: SampleIdentity) -> Said;
}

/// How an answer is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Said {
  /// What stands in front of its data; little endian.
  pub front: Option<[u8; 16]>,
  /// The only reader that it is for, if only one shall have it.
  pub only_to: Option<GUID>,
}

/// The dialect of one topic.
pub(crate) type Speaks = Option<&'static dyn Dialect>;

/// The value of a sample as it is written, and how.
pub(crate) fn say(
  dialect: Speaks,
  mut options: WriteOptions,
  mut value: Bytes,
) -> (WriteOptions, Bytes) {
  if let Some((dialect, request)) = dialect.zip(options.related_sample_identity()) {
    let said = dialect.said(request);
    if let Some(front) = said.front {
      value = [&front[..], &value[..]].concat().into();
    }
    if let Some(reader) = said.only_to {
      options = options.only_to(reader);
    }
  }
  (options, value)
}
