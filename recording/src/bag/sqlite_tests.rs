//! Bags in SQLite; `fixtures/humble` is one that `rosbags` wrote.

use std::path::{Path, PathBuf};

use msgs::sensor_msgs::JointState;
use proptest::prelude::*;

use super::{BagError, BagReader};

fn fixture() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/humble")
}

fn checked(path: &Path) {
    let bag = BagReader::open(path).unwrap();
    assert_eq!(bag.topics()[0].name, "/joint_states");
    assert_eq!((bag.topics()[0].count, bag.span()), (20, Some((1_000_000, 20_000_000))));
    let states = bag.messages::<JointState>("/joint_states").unwrap();
    assert_eq!(states.len(), 20);
    let (time, state) = &states[2];
    assert_eq!((*time, state.name.join(" ")), (3_000_000, "elbow wrist".to_owned()));
    assert_eq!((state.position[1], state.velocity[0], state.effort[1]), (4.0, 0.2, -2.0));
}

#[test]
fn a_bag_of_humble_is_read_as_a_folder_and_as_a_file() {
    checked(&fixture());
    checked(&fixture().join("humble.db3"));
}

#[test]
fn a_database_packed_by_zstd_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(fixture().join("humble.db3")).unwrap();
    let packed = zstd::stream::encode_all(&bytes[..], 3).unwrap();
    let path = folder.path().join("humble.db3.zstd");
    std::fs::write(&path, packed).unwrap();
    checked(&path);
    checked(folder.path());
    std::fs::write(&path, zstd::stream::encode_all(&[7; 99][..], 3).unwrap()).unwrap();
    assert!(matches!(BagReader::open(&path), Err(BagError::Database { .. })));
}

#[test]
fn what_is_no_database_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.db3");
    std::fs::write(&path, "no database").unwrap();
    let said = BagReader::open(&path).unwrap_err().to_string();
    assert!(said.contains("x.db3") && said.contains("no SQLite"), "{said}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn damaged_databases_never_panic(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20),
        end in any::<prop::sample::Index>(),
        cut in any::<bool>(),
    ) {
        let mut bytes = std::fs::read(fixture().join("humble.db3")).unwrap();
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if cut {
            bytes.truncate(end.index(bytes.len()));
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.db3");
        std::fs::write(&path, bytes).unwrap();
        if let Ok(bag) = BagReader::open(&path) {
            let _ = bag.messages::<JointState>("/joint_states");
        }
    }
}
