//! Bags that were cut off or damaged: nothing whole is lost, the original is kept, nothing panics.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use msgs::friction_msgs::{ExperimentStatus, MotorVoltage};
use msgs::std_msgs::Header;
use proptest::prelude::*;

use super::*;

const MESSAGES: u64 = 60;

/// A folder in memory where there is one: thousands of bags are brought to the disk here.
fn folder() -> tempfile::TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap()
}

fn stamp(index: u64) -> u64 {
    1_600_000_000_000_000_000 + index * 1_000_000
}

/// A bag of several chunks with a status among the voltages, an attachment in the middle and
/// metadata.
fn write(dir: &Path, compression: Compression) -> PathBuf {
    let options = BagOptions { compression, ..BagOptions::default() };
    let mut bag = BagWriter::create(dir, options).unwrap();
    bag.metadata("run", BTreeMap::from([("seed".into(), "7".into())])).unwrap();
    bag.topic::<MotorVoltage>("/motor_voltage").unwrap();
    bag.topic::<ExperimentStatus>("/experiment_status").unwrap();
    for index in 0..MESSAGES {
        let message = MotorVoltage { header: Header::at(stamp(index)), voltage: index as f64 };
        bag.write("/motor_voltage", stamp(index), &message).unwrap();
        if index == 31 {
            let status = ExperimentStatus { stage: "half".into(), ..Default::default() };
            bag.write("/experiment_status", stamp(index), &status).unwrap();
            bag.attach("parameters.yaml", "application/yaml", b"friction_observer: {}").unwrap();
        }
        if index % 10 == 9 {
            bag.flush().unwrap();
        }
    }
    bag.finish().unwrap().file
}

/// The whole file's chunks: where each stands with its index, and the log times in it.
fn chunks(bytes: &[u8]) -> Vec<(Range<usize>, BTreeSet<u64>)> {
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    summary
        .chunk_indexes
        .iter()
        .map(|index| {
            let start = index.chunk_start_offset as usize;
            let times = summary
                .stream_chunk(bytes, index)
                .unwrap()
                .map(|message| message.unwrap())
                .filter(|message| message.channel.topic == "/motor_voltage")
                .map(|message| message.log_time)
                .collect();
            (start..start + index.chunk_length as usize, times)
        })
        .collect()
}

/// Recovers the bytes; log times of the voltages, if anything could be done.
fn recovered(folder: &Path, bytes: &[u8]) -> Option<BTreeSet<u64>> {
    let dir = folder.join("cut");
    if dir.exists() {
        fs::remove_dir_all(&dir).unwrap();
    }
    fs::create_dir(&dir).unwrap();
    let file = dir.join("cut_0.mcap");
    fs::write(&file, bytes).unwrap();
    let result = recover(&dir);
    match &result {
        Ok(Recovery::Recovered { original, bag, .. }) => {
            assert_eq!(fs::read(original).unwrap(), bytes, "the original is kept");
            assert_eq!(bag.file, file);
            assert!(dir.join("metadata.yaml").is_file());
        }
        Ok(Recovery::Whole) => panic!("without metadata.yaml it is not whole"),
        Err(_) => {
            assert_eq!(fs::read(&file).unwrap(), bytes, "the original is as it was");
            assert_eq!(fs::read_dir(&dir).unwrap().count(), 1, "nothing else is left");
            return None;
        }
    }
    let bag = BagReader::open(&dir).unwrap();
    assert_eq!(recover(&dir).unwrap(), Recovery::Whole, "once is enough");
    // Where its definition was damaged, the topic is another.
    let messages = bag.messages::<MotorVoltage>("/motor_voltage").unwrap_or_default();
    for (time, message) in &messages {
        assert_eq!(
            (message.header.stamp.to_nanos(), stamp(message.voltage as u64)),
            (*time, *time)
        );
    }
    Some(messages.into_iter().map(|(time, _)| time).collect())
}

#[test]
fn a_cut_bag_gives_every_chunk_before_the_cut() {
    for compression in [Compression::None, Compression::Zstd] {
        let folder = folder();
        let file = write(&folder.path().join("bag"), compression);
        let bytes = fs::read(&file).unwrap();
        let chunks = chunks(&bytes);
        assert!(chunks.len() >= 6, "{}", chunks.len());
        for length in (0..bytes.len()).step_by(7) {
            let found = recovered(folder.path(), &bytes[..length]);
            assert_eq!(found.is_some(), length >= mcap::MAGIC.len(), "{length}");
            let expected: BTreeSet<u64> = chunks
                .iter()
                .filter(|(place, _)| place.end <= length)
                .flat_map(|(_, times)| times.iter().copied())
                .collect();
            assert_eq!(found.unwrap_or_default(), expected, "cut at {length} of {}", bytes.len());
        }
    }
}

#[test]
fn attachments_metadata_and_quality_of_service_survive() {
    let folder = folder();
    let dir = folder.path().join("bag");
    let file = write(&dir, Compression::Zstd);
    let description = fs::read_to_string(dir.join("metadata.yaml")).unwrap();
    let bytes = fs::read(&file).unwrap();
    // Without its index and description, as after a kill.
    let end = chunks(&bytes).last().unwrap().0.end;
    fs::write(&file, &bytes[..end]).unwrap();
    fs::remove_file(dir.join("metadata.yaml")).unwrap();
    assert!(is_cut(&dir));
    let Recovery::Recovered { bag, original, .. } = recover(&dir).unwrap() else {
        panic!("it was cut")
    };
    assert!(!is_cut(&dir));
    assert_eq!(bag.messages, MESSAGES + 1);
    assert_eq!(original, dir.join("bag_0.mcap.damaged"));
    assert_eq!(fs::read_to_string(dir.join("metadata.yaml")).unwrap(), description);
    let bag = BagReader::open(&dir).unwrap();
    assert_eq!(bag.attachment("parameters.yaml").unwrap().unwrap(), b"friction_observer: {}");
    assert_eq!(bag.metadata("run").unwrap().unwrap()["seed"], "7");
    assert_eq!(bag.messages::<ExperimentStatus>("/experiment_status").unwrap()[0].1.stage, "half");
}

#[test]
fn a_bag_that_is_being_written_is_left_alone_and_offered_once_it_is_cut() {
    let folder = folder();
    let dir = folder.path().join("live-1/bag");
    let mut bag = BagWriter::create(&dir, BagOptions::default()).unwrap();
    bag.write("/motor_voltage", 1, &MotorVoltage::default()).unwrap();
    bag.flush().unwrap();
    assert!(matches!(recover(&dir), Err(BagError::InUse { .. })));
    assert_eq!(cut_bags(folder.path()), Vec::<PathBuf>::new());
    let cut = folder.path().join("live-2/bag");
    fs::create_dir_all(&cut).unwrap();
    fs::copy(dir.join("bag_0.mcap"), cut.join("bag_0.mcap")).unwrap();
    assert_eq!(cut_bags(folder.path()), [cut]);
    drop(bag);
}

#[test]
fn what_is_no_bag_is_refused() {
    let folder = folder();
    assert!(matches!(recover(folder.path()), Err(BagError::NoMcap { .. })));
    assert!(matches!(recover(&folder.path().join("nowhere")), Err(BagError::Read { .. })));
    fs::write(folder.path().join("a.mcap"), "t_s,position").unwrap();
    assert!(matches!(recover(folder.path()), Err(BagError::NotMcap { .. })));
    fs::write(folder.path().join("b.mcap"), "").unwrap();
    assert!(matches!(recover(folder.path()), Err(BagError::SeveralFiles { files: 2, .. })));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

/// The index behind a chunk, its first byte damaged to that of a message: it read as one, of the
/// same channel and time, with a content that was none, and the whole topic was lost.
#[test]
fn a_damaged_index_is_no_message() {
    for compression in [Compression::None, Compression::Zstd] {
        let folder = folder();
        let whole = fs::read(write(&folder.path().join("bag"), compression)).unwrap();
        let everything: BTreeSet<u64> = (0..MESSAGES).map(stamp).collect();
        for (place, _) in chunks(&whole) {
            let mut bytes = whole.clone();
            assert_eq!(bytes[place.end], mcap::records::op::MESSAGE_INDEX);
            bytes[place.end] = mcap::records::op::MESSAGE;
            assert_eq!(recovered(folder.path(), &bytes), Some(everything.clone()), "{place:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 192, ..ProptestConfig::default() })]

    #[test]
    fn damage_costs_the_chunk_it_falls_on_and_no_other(
        blows in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        keep in prop::option::of(any::<prop::sample::Index>()),
        packed in any::<bool>(),
    ) {
        let folder = folder();
        let compression = if packed { Compression::Zstd } else { Compression::None };
        let whole = fs::read(write(&folder.path().join("bag"), compression)).unwrap();
        let chunks = chunks(&whole);
        let first_magic = mcap::MAGIC.len();
        let length = keep.map_or(whole.len(), |at| first_magic + at.index(whole.len() - first_magic));
        let mut bytes = whole[..length].to_vec();
        // Behind the first bytes: without those nobody knows that it is a bag.
        if length > first_magic {
            for (place, value) in &blows {
                bytes[first_magic + place.index(length - first_magic)] = *value;
            }
        }
        let changed = |range: &Range<usize>| range.end > length || bytes[range.clone()] != whole[range.clone()];
        let Some(found) = recovered(folder.path(), &bytes) else { panic!("it is a bag by its first bytes") };
        // The first chunk defines the channels; with it they are gone, unless the index at the end
        // has them.
        if !changed(&chunks[0].0) {
            for (place, times) in chunks.iter().filter(|(place, _)| !changed(place)) {
                prop_assert!(times.is_subset(&found), "the chunk at {place:?} is whole, but was not found");
            }
        }
        let everything: BTreeSet<u64> = (0..MESSAGES).map(stamp).collect();
        prop_assert!(found.is_subset(&everything), "nothing is invented");
    }

    #[test]
    fn anything_behind_the_first_bytes_is_survived(body in prop::collection::vec(any::<u8>(), 0..400)) {
        let folder = folder();
        let bytes = [mcap::MAGIC, &body].concat();
        prop_assert_eq!(recovered(folder.path(), &bytes), Some(BTreeSet::new()));
    }
}

/// Puts `new` in the place of `old` in every chunk that holds it, which is not packed; with the
/// checksum of what it says now if `sealed`.
fn exchange(bytes: &mut [u8], old: &[u8], new: &[u8], sealed: bool) -> usize {
    assert_eq!(old.len(), new.len());
    let mut exchanged = 0;
    for (place, _) in chunks(bytes) {
        let chunk = &mut bytes[place];
        let Some(at) = chunk.windows(old.len()).position(|window| window == old) else { continue };
        chunk[at..at + old.len()].copy_from_slice(new);
        exchanged += 1;
        if sealed {
            // Opcode, length, two times and the length unpacked; then the checksum, the packing's
            // name and what is packed.
            let name = u32::from_le_bytes(chunk[37..41].try_into().unwrap()) as usize;
            let checksum = crc32(&chunk[41 + name + 8..]);
            chunk[33..37].copy_from_slice(&checksum.to_le_bytes());
        }
    }
    exchanged
}

/// The checksum of MCAP: CRC-32 as in Ethernet.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

#[test]
fn a_wrong_checksum_is_told_although_the_bag_is_described() {
    let folder = folder();
    let dir = folder.path().join("bag");
    let file = write(&dir, Compression::None);
    assert_eq!(recover(&dir).unwrap(), Recovery::Whole);
    let mut bytes = fs::read(&file).unwrap();
    let (place, lost) = chunks(&bytes)[2].clone();
    // In the last message of the chunk, so that every record can still be read.
    bytes[place.end - 2] ^= 1;
    fs::write(&file, &bytes).unwrap();
    let read = BagReader::open(&dir).unwrap().messages::<MotorVoltage>("/motor_voltage");
    assert!(
        matches!(read, Err(BagError::Damaged { .. })),
        "what a wrong checksum vouches for is not read"
    );
    let Recovery::Recovered { bag, lost_chunks, lost_bytes, .. } = recover(&dir).unwrap() else {
        panic!("a chunk is damaged")
    };
    assert_eq!(lost_chunks, 1);
    assert!(lost_bytes >= place.len() as u64);
    assert_eq!(bag.messages, MESSAGES + 1 - lost.len() as u64);
    assert_eq!(recover(&dir).unwrap(), Recovery::Whole);
}

#[test]
fn a_damaged_definition_is_told_and_mended_by_its_hash() {
    let (old, new) = (b"float64 voltage", b"float64 vo\x01tage");
    for sealed in [true, false] {
        let folder = folder();
        let dir = folder.path().join("bag");
        let file = write(&dir, Compression::None);
        let mut bytes = fs::read(&file).unwrap();
        assert!(exchange(&mut bytes, old, new, sealed) > 0);
        fs::write(&file, &bytes).unwrap();
        let Recovery::Recovered { bag, mended_definitions, lost_definitions, lost_chunks, .. } =
            recover(&dir).unwrap()
        else {
            panic!("a definition is damaged")
        };
        assert!(lost_definitions.is_empty());
        if sealed {
            assert_eq!((mended_definitions, lost_chunks), (vec!["/motor_voltage".to_owned()], 0));
            assert_eq!(bag.messages, MESSAGES + 1);
        } else {
            assert!(lost_chunks > 0);
        }
        let read =
            BagReader::open(&dir).unwrap().messages::<MotorVoltage>("/motor_voltage").unwrap();
        assert!(!read.is_empty());
        assert_eq!(recover(&dir).unwrap(), Recovery::Whole);
    }
}

#[test]
fn a_cut_bag_that_was_packed_gives_what_can_be_unpacked() {
    for ending in ["mcap.zstd", "mcap.zst"] {
        let folder = folder();
        let dir = folder.path().join("bag");
        let file = write(&dir, Compression::None);
        let packed = file.with_extension(ending);
        // In blocks, as of a longer file.
        let mut encoder = zstd::stream::Encoder::new(Vec::new(), 3).unwrap();
        for block in fs::read(&file).unwrap().chunks(1000) {
            encoder.write_all(block).unwrap();
            encoder.flush().unwrap();
        }
        let bytes = encoder.finish().unwrap();
        fs::remove_file(&file).unwrap();
        fs::write(&packed, &bytes).unwrap();
        assert_eq!(recover(&packed).unwrap(), Recovery::Whole, "{ending}");
        let cut = &bytes[..bytes.len() * 2 / 3];
        fs::write(&packed, cut).unwrap();
        let Recovery::Recovered { original, bag, .. } = recover(&dir).unwrap() else {
            panic!("{ending}: it was cut")
        };
        assert_eq!((fs::read(original).unwrap(), bag.file), (cut.to_vec(), file.clone()));
        let found = BagReader::open(&dir).unwrap();
        assert!(!found.messages::<MotorVoltage>("/motor_voltage").unwrap().is_empty());
        assert_eq!(recover(&dir).unwrap(), Recovery::Whole, "once is enough");
        let left: Vec<_> = fs::read_dir(&dir).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left.len(), 3, "{left:?}");
        // The file that is there is not written over.
        fs::write(&packed, cut).unwrap();
        assert!(matches!(recover(&packed), Err(BagError::Write { .. })));
        assert_eq!(fs::read(&packed).unwrap(), cut);
        fs::remove_file(&file).unwrap();
        fs::write(&packed, &cut[..20]).unwrap();
        let said = recover(&packed).unwrap_err().to_string();
        assert!(said.contains("nothing of it can be unpacked"), "{said}");
    }
}
