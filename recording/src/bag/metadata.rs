//! The description of a bag, `metadata.yaml`, in version 9 of rosbag2.

use std::collections::BTreeMap;

use msgs::topics::Qos;
use serde::Serialize;
use serde_json::Value;

/// Version of the form.
const VERSION: u32 = 9;
/// The distribution whose rosbag2 writes this form.
const ROS_DISTRO: &str = "kilted";
/// What rosbag2 takes for "for ever".
const FOREVER: Period = Period { sec: 9_223_372_036, nsec: 854_775_807 };
/// Starting time of a bag without messages, as rosbag2 has it.
const NO_START: u64 = i64::MAX as u64;

/// One topic's part of the description.
#[derive(Debug)]
pub(super) struct TopicEntry {
    pub(super) name: String,
    pub(super) type_name: String,
    pub(super) type_hash: String,
    /// The quality of service it is offered with, as rosbag2 words it.
    pub(super) profiles: Value,
    pub(super) count: u64,
}

/// The entry of a topic without messages, from what its channel says in `offered_qos_profiles` and
/// `topic_type_hash`.
pub(super) fn entry_of(
    name: &str,
    type_name: &str,
    about: &BTreeMap<String, String>,
) -> TopicEntry {
    let said = about
        .get("offered_qos_profiles")
        .and_then(|text| serde_saphyr::from_str::<Value>(text).ok());
    let usual = || serde_json::to_value([Profile::from(Qos::DEFAULT)]).unwrap_or_default();
    TopicEntry {
        name: name.to_owned(),
        type_name: type_name.to_owned(),
        type_hash: about.get("topic_type_hash").cloned().unwrap_or_default(),
        profiles: said.filter(Value::is_array).unwrap_or_else(usual),
        count: 0,
    }
}

/// First and last time of the messages [ns since the epoch]; `None` for a bag without any.
pub(super) type Span = Option<(u64, u64)>;

/// The text of `metadata.yaml` for a bag of one file.
pub(super) fn metadata_yaml(
    file: &str,
    topics: &[TopicEntry],
    span: Span,
) -> Result<String, serde_saphyr::ser::Error> {
    let (start, duration) = span.map_or((NO_START, 0), |(start, end)| (start, end - start));
    let start = Start { nanoseconds_since_epoch: start };
    let duration = Duration { nanoseconds: duration };
    let message_count = topics.iter().map(|topic| topic.count).sum();
    serde_saphyr::to_string(&Document {
        rosbag2_bagfile_information: Information {
            version: VERSION,
            storage_identifier: "mcap",
            duration,
            starting_time: start,
            message_count,
            topics_with_message_count: topics
                .iter()
                .map(|topic| TopicWithCount {
                    topic_metadata: TopicMetadata {
                        name: &topic.name,
                        r#type: &topic.type_name,
                        serialization_format: "cdr",
                        offered_qos_profiles: &topic.profiles,
                        type_description_hash: &topic.type_hash,
                    },
                    message_count: topic.count,
                })
                .collect(),
            compression_format: "",
            compression_mode: "",
            relative_file_paths: vec![file],
            files: vec![File { path: file, starting_time: start, duration, message_count }],
            custom_data: None,
            ros_distro: ROS_DISTRO,
        },
    })
}

/// The YAML that rosbag2 keeps with each MCAP channel under `offered_qos_profiles`.
pub(super) fn qos_yaml(qos: Qos) -> Result<String, serde_saphyr::ser::Error> {
    serde_saphyr::to_string(&vec![Profile::from(qos)])
}

#[derive(Serialize)]
struct Document<'a> {
    rosbag2_bagfile_information: Information<'a>,
}

#[derive(Serialize)]
struct Information<'a> {
    version: u32,
    storage_identifier: &'a str,
    duration: Duration,
    starting_time: Start,
    message_count: u64,
    topics_with_message_count: Vec<TopicWithCount<'a>>,
    compression_format: &'a str,
    compression_mode: &'a str,
    relative_file_paths: Vec<&'a str>,
    files: Vec<File<'a>>,
    custom_data: Option<()>,
    ros_distro: &'a str,
}

#[derive(Clone, Copy, Serialize)]
struct Start {
    nanoseconds_since_epoch: u64,
}

#[derive(Clone, Copy, Serialize)]
struct Duration {
    nanoseconds: u64,
}

#[derive(Serialize)]
struct TopicWithCount<'a> {
    topic_metadata: TopicMetadata<'a>,
    message_count: u64,
}

#[derive(Serialize)]
struct TopicMetadata<'a> {
    name: &'a str,
    r#type: &'a str,
    serialization_format: &'a str,
    offered_qos_profiles: &'a Value,
    type_description_hash: &'a str,
}

#[derive(Serialize)]
struct File<'a> {
    path: &'a str,
    starting_time: Start,
    duration: Duration,
    message_count: u64,
}

#[derive(Serialize)]
struct Profile {
    history: &'static str,
    depth: u32,
    reliability: &'static str,
    durability: &'static str,
    deadline: Period,
    lifespan: Period,
    liveliness: &'static str,
    liveliness_lease_duration: Period,
    avoid_ros_namespace_conventions: bool,
}

#[derive(Clone, Copy, Serialize)]
struct Period {
    sec: u64,
    nsec: u64,
}

impl From<Qos> for Profile {
    fn from(qos: Qos) -> Self {
        Self {
            history: "keep_last",
            depth: qos.depth,
            reliability: "reliable",
            durability: if qos.transient_local { "transient_local" } else { "volatile" },
            deadline: FOREVER,
            lifespan: FOREVER,
            liveliness: "automatic",
            liveliness_lease_duration: FOREVER,
            avoid_ros_namespace_conventions: false,
        }
    }
}
