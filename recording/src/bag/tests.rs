//! Bags there and back, and everything that can be wrong with one.

use std::{collections::BTreeMap, fs, path::Path};

use msgs::{
    cdr,
    friction_msgs::{ExperimentStatus, MotorVoltage},
    sensor_msgs::JointState,
    std_msgs::Header,
};
use proptest::prelude::*;

use super::*;

const START: u64 = 1_600_000_000_000_000_000;

fn voltage(index: u64) -> (u64, MotorVoltage) {
    let stamp = START + index * 1_000_000;
    (stamp, MotorVoltage { header: Header::at(stamp), voltage: index as f64 * 0.25 })
}

fn write_bag(dir: &Path, messages: u64, options: BagOptions) -> BagSummary {
    let mut bag = BagWriter::create(dir, options).unwrap();
    bag.metadata("run", BTreeMap::from([("seed".into(), "7".into())])).unwrap();
    for index in 0..messages {
        let (stamp, message) = voltage(index);
        bag.write("/motor_voltage", stamp, &message).unwrap();
    }
    bag.attach("parameters.yaml", "application/yaml", b"friction_observer: {}").unwrap();
    bag.finish().unwrap()
}

#[test]
fn what_wwritten_as_is_read() {
    for compression in [Compression::None, Compression::Lz4, Compression::Zstd] {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("run_bag");
        let options = BagOptions { compression, chunk_size: 2_000, ..BagOptions::default() };
        let summary = write_bag(&dir, 500, options);
        assert_eq!(summary.messages, 500);
        assert!((summary.duration - 0.499).abs() < 1e-9, "{}", summary.duration);
        assert_eq!(summary.file, dir.join("run_bag_0.mcap"));
        assert_eq!(summary.bytes, fs::metadata(&summary.file).unwrap().len());

        for path in [&dir, &summary.file] {
            let bag = BagReader::open(path).unwrap();
            let topic = TopicInfo {
                name: "/motor_voltage".into(),
                type_name: "friction_msgs/msg/MotorVoltage".into(),
                count: 500,
            };
            assert_eq!(bag.topics(), [topic]);
            let messages = bag.messages::<MotorVoltage>("/motor_voltage").unwrap();
            assert_eq!(messages, (0..500).map(voltage).collect::<Vec<_>>());
            assert_eq!(bag.metadata("run").unwrap().unwrap()["seed"], "7");
            assert_eq!(bag.metadata("nothing").unwrap(), None);
            assert_eq!(
                bag.attachment("parameters.yaml").unwrap().unwrap(),
                b"friction_observer: {}"
            );
            assert_eq!(bag.attachment("nothing").unwrap(), None);
        }
    }
}

#[test]
fn a_file_packed_by_zstd_as_a_whole_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    let file = write_bag(&dir, 500, BagOptions::default()).file;
    let packed = zstd::stream::encode_all(&fs::read(&file).unwrap()[..], 3).unwrap();
    let packed_file = file.with_extension("mcap.zstd");
    fs::write(&packed_file, packed).unwrap();
    // Beside the unpacked one it is not read twice, and without it it is.
    for remove in [false, true] {
        if remove {
            fs::remove_file(&file).unwrap();
        }
        assert!(crate::is_bag(&packed_file) && crate::is_bag(&dir));
        for path in [&dir, &packed_file] {
            let bag = BagReader::open(path).unwrap();
            let messages = bag.messages::<MotorVoltage>("/motor_voltage").unwrap();
            assert_eq!(messages.len(), 500);
            assert_eq!(bag.metadata("run").unwrap().unwrap()["seed"], "7");
            assert!(bag.attachment("parameters.yaml").unwrap().is_some());
        }
    }
    fs::write(&packed_file, zstd::stream::encode_all(&b"no bag"[..], 3).unwrap()).unwrap();
    assert!(matches!(BagReader::open(&packed_file), Err(BagError::NotMcap { .. })));
    fs::write(&packed_file, b"\x28\xb5\x2f\xfdno zstd").unwrap();
    let said = BagReader::open(&packed_file).unwrap_err().to_string();
    assert!(said.contains("unpacked"), "{said}");
}

#[test]
fn messages_come_in_order_of_time() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    let mut bag = BagWriter::create(&dir, BagOptions::default()).unwrap();
    for index in [3, 1, 2] {
        let (stamp, message) = voltage(index);
        bag.write("/motor_voltage", stamp, &message).unwrap();
    }
    bag.finish().unwrap();
    let messages =
        BagReader::open(&dir).unwrap().messages::<MotorVoltage>("/motor_voltage").unwrap();
    assert_eq!(messages, [voltage(1), voltage(2), voltage(3)]);
}

#[test]
fn messages_encoded_elsewhere_are_numbered_by_their_makers() {
    let folder = tempfile::tempdir().unwrap();
    let mut bag = BagWriter::create(&folder.path().join("bag"), BagOptions::default()).unwrap();
    let handle = bag.topic::<MotorVoltage>("/motor_voltage").unwrap();
    let (stamp, message) = voltage(0);
    bag.write_cdr(handle, stamp, 41, &cdr::encode(&message).unwrap()).unwrap();
    let (stamp, message) = voltage(1);
    bag.write("/motor_voltage", stamp, &message).unwrap();
    let summary = bag.finish().unwrap();
    let bytes = fs::read(&summary.file).unwrap();
    let sequences: Vec<u32> = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(|message| message.unwrap().sequence)
        .collect();
    assert_eq!(sequences, [41, 42]);
}

#[test]
fn channels_are_as_rosbag2_writes_them() {
    let folder = tempfile::tempdir().unwrap();
    let mut bag = BagWriter::create(&folder.path().join("bag"), BagOptions::default()).unwrap();
    bag.write("/experiment_status", 5, &ExperimentStatus::default()).unwrap();
    bag.write("/joint_states", 6, &JointState::default()).unwrap();
    let summary = bag.finish().unwrap();
    let bytes = fs::read(&summary.file).unwrap();
    let index = mcap::Summary::read(&bytes).unwrap().unwrap();
    let channel =
        |topic: &str| index.channels.values().find(|channel| channel.topic == topic).unwrap();
    let status = channel("/experiment_status");
    let schema = status.schema.as_ref().unwrap();
    assert_eq!(schema.name, "friction_msgs/msg/ExperimentStatus");
    assert_eq!(schema.encoding, "ros2msg");
    assert!(String::from_utf8_lossy(&schema.data).contains("\nMSG: builtin_interfaces/Time\n"));
    assert_eq!(status.message_encoding, "cdr");
    let profiles = &status.metadata["offered_qos_profiles"];
    assert!(
        profiles.contains("durability: transient_local\n") && profiles.contains("depth: 1\n"),
        "{profiles}"
    );
    let profiles = &channel("/joint_states").metadata["offered_qos_profiles"];
    assert!(
        profiles.contains("durability: volatile\n") && profiles.contains("depth: 100\n"),
        "{profiles}"
    );
}

#[test]
fn description_has_the_form_of_rosbag2() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    write_bag(&dir, 3, BagOptions::default());
    let yaml = fs::read_to_string(dir.join("metadata.yaml")).unwrap();
    for line in [
        "  version: 9\n",
        "  storage_identifier: mcap\n",
        "    nanoseconds: 2000000\n",
        "    nanoseconds_since_epoch: 1600000000000000000\n",
        "  message_count: 3\n",
        "      name: /motor_voltage\n",
        "      type: friction_msgs/msg/MotorVoltage\n",
        "      serialization_format: cdr\n",
        "bag_0.mcap\n",
        "  ros_distro: kilted\n",
    ] {
        assert!(yaml.contains(line), "{line:?} is missing in\n{yaml}");
    }
}

#[test]
fn a_dropped_writer_leaves_a_bag_that_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    let mut bag = BagWriter::create(&dir, BagOptions::default()).unwrap();
    for index in 0..100 {
        let (stamp, message) = voltage(index);
        bag.write("/motor_voltage", stamp, &message).unwrap();
    }
    drop(bag);
    let messages =
        BagReader::open(&dir).unwrap().messages::<MotorVoltage>("/motor_voltage").unwrap();
    assert_eq!(messages.len(), 100);
}

#[test]
fn what_was_flushed_outlives_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("bag");
    let mut bag = BagWriter::create(&dir, BagOptions::default()).unwrap();
    for index in 0..100 {
        let (stamp, message) = voltage(index);
        bag.write("/motor_voltage", stamp, &message).unwrap();
        if index == 59 {
            bag.flush().unwrap();
        }
    }
    // What another program sees now is what a kill would leave.
    let bytes = fs::read(dir.join("bag_0.mcap")).unwrap();
    let stream =
        mcap::MessageStream::new_with_options(&bytes, mcap::read::Options::IgnoreEndMagic.into())
            .unwrap();
    assert_eq!(stream.flatten().count(), 60);
    let error = BagReader::open(&dir).unwrap_err();
    assert!(matches!(error, BagError::Damaged { .. }), "{error}");
    assert!(error.to_string().contains("bag_0.mcap is cut off or damaged"), "{error}");
    drop(bag);
}

#[test]
fn a_folder_that_holds_something_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("precious.txt"), "mine").unwrap();
    let error = BagWriter::create(folder.path(), BagOptions::default()).err().unwrap();
    assert!(matches!(error, BagError::NotEmpty { .. }), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_place_that_cannot_be_a_folder_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let error = BagWriter::create(&file.join("bag"), BagOptions::default()).err().unwrap();
    assert!(matches!(error, BagError::Write { .. }), "{error}");
    assert!(matches!(
        BagWriter::create(Path::new("/"), BagOptions::default()),
        Err(BagError::Name { .. })
    ));
}

#[test]
fn a_topic_keeps_its_type() {
    let folder = tempfile::tempdir().unwrap();
    let mut bag = BagWriter::create(&folder.path().join("bag"), BagOptions::default()).unwrap();
    bag.write("/motor_voltage", 1, &MotorVoltage::default()).unwrap();
    let error = bag.write("/motor_voltage", 2, &JointState::default()).unwrap_err();
    assert!(matches!(error, BagError::TopicType { .. }), "{error}");
}

#[test]
fn each_kind_of_bad_bag_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.mcap");
    assert!(matches!(BagReader::open(&path), Err(BagError::Read { .. })));
    assert!(matches!(BagReader::open(folder.path()), Err(BagError::NoMcap { .. })));
    fs::write(&path, "").unwrap();
    assert!(matches!(BagReader::open(&path), Err(BagError::Empty { .. })));
    fs::write(&path, "t_s,position").unwrap();
    assert!(matches!(BagReader::open(&path), Err(BagError::NotMcap { .. })));
    fs::write(&path, mcap::MAGIC).unwrap();
    assert!(matches!(BagReader::open(&path), Err(BagError::Damaged { .. })));

    let dir = folder.path().join("bag");
    write_bag(&dir, 3, BagOptions::default());
    let bag = BagReader::open(&dir).unwrap();
    let error = bag.messages::<MotorVoltage>("/voltage").unwrap_err();
    assert!(error.to_string().contains("has no topic /voltage; it has: /motor_voltage"), "{error}");
    let error = bag.messages::<JointState>("/motor_voltage").unwrap_err();
    assert!(matches!(error, BagError::ReadType { .. }), "{error}");
}

#[test]
fn a_cut_bag_is_an_error_at_every_length() {
    let folder = tempfile::tempdir().unwrap();
    let summary = write_bag(&folder.path().join("bag"), 20, BagOptions::default());
    let whole = fs::read(&summary.file).unwrap();
    let cut = folder.path().join("cut.mcap");
    for length in 0..whole.len() {
        fs::write(&cut, &whole[..length]).unwrap();
        let error = BagReader::open(&cut)
            .err()
            .unwrap_or_else(|| panic!("{length} bytes were taken for a bag"));
        assert!(error.to_string().contains("cut.mcap"), "{error}");
    }
}

proptest! {
    #[test]
    fn a_damaged_bag_is_an_error_or_fewer_messages_but_never_a_panic(
        place in any::<prop::sample::Index>(),
        value in any::<u8>(),
        tail in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let summary = write_bag(&folder.path().join("bag"), 20, BagOptions::default());
        let mut bytes = fs::read(&summary.file).unwrap();
        // Half of the blows fall on the index at the end, where the lengths and offsets are.
        let from = if tail { bytes.len() - bytes.len() / 3 } else { 0 };
        let place = from + place.index(bytes.len() - from);
        bytes[place] = value;
        fs::write(&summary.file, &bytes).unwrap();
        if let Ok(bag) = BagReader::open(&summary.file) {
            let _ = bag.messages::<MotorVoltage>("/motor_voltage");
            let _ = bag.metadata("run");
            let _ = bag.attachment("parameters.yaml");
        }
    }
}
