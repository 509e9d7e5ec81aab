//! The files in `fixtures/` are made by SciPy, h5py, NumPy and pyarrow.

use std::path::{Path, PathBuf};

use proptest::prelude::*;

use super::*;
use crate::table::{self, Columns};

const FILES: [&str; 9] = [
    "v5.mat",
    "v7.mat",
    "v73.mat",
    "a.npz",
    "c.npz",
    "r.npy",
    "snappy.parquet",
    "zstd.parquet",
    "none.parquet",
];

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(fixture(name)).unwrap()
}

fn of_joint(joint: Option<&str>) -> Columns {
    let mut columns = Columns::default();
    columns.layout.joint = joint.map(str::to_owned);
    columns
}

#[test]
fn every_form_gives_the_same_recording() {
    for name in FILES {
        let several = !(name.ends_with("parquet") || name.ends_with("npy"));
        let joint = several.then_some("1");
        let found = table::read(&fixture(name), &of_joint(joint), 0.05)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!((found.time_step - 0.01).abs() < 1e-9, "{name}: {}", found.time_step);
        assert_eq!(found.samples(), 40, "{name}");
        let position = found.position.unwrap();
        for (k, (q, tau)) in position.iter().zip(&found.force).enumerate() {
            let due = 0.02 * k as f64;
            // The torque of one row is missing in Parquet.
            let near = if name.ends_with("parquet") && k == 7 { 1e-3 } else { 1e-6 };
            assert!((q - due).abs() < 1e-9 && (tau - due.cos()).abs() < near, "{name} at {k}");
        }
        assert_eq!(found.irregularities.blank, usize::from(name.ends_with("parquet")), "{name}");
        if several {
            let said = table::read(&fixture(name), &of_joint(None), 0.05).unwrap_err().to_string();
            assert!(said.contains("0, 1, 2"), "{name}: {said}");
            let said = table::read(&fixture(name), &of_joint(Some("4")), 0.05).unwrap_err();
            assert!(said.to_string().contains("no joint `4`"), "{name}: {said}");
        }
    }
}

#[test]
fn columns_of_structures_are_found_by_their_whole_name() {
    let columns = Columns {
        position: Some("data.q[2]".parse().unwrap()),
        force: Some("data.tau[0]:2".parse().unwrap()),
        ..Columns::default()
    };
    let found = table::read(&fixture("v5.mat"), &columns, 0.05).unwrap();
    assert!((found.position.unwrap()[10] - 0.3).abs() < 1e-12);
    assert!((found.force[10] - 2.0 * 0.1f64.cos()).abs() < 1e-12);
}

#[test]
fn a_file_that_is_cut_off_is_an_error_that_says_how_to_save_it() {
    for name in FILES {
        let whole = bytes(name);
        let form = form_of(&whole);
        let said = read(Path::new(name), form, &whole[..whole.len() / 3]).unwrap_err();
        let said = said.to_string();
        assert!(said.contains(name) && said.contains("save it anew"), "{said}");
    }
}

#[test]
fn sizes_that_are_not_true_take_no_memory() {
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999, 7), }";
    let mut array = b"\x93NUMPY\x01\x00".to_vec();
    array.extend_from_slice(&(header.len() as u16).to_le_bytes());
    array.extend_from_slice(header.as_bytes());
    let said = read(Path::new("x.npy"), Form::Npy, &array).unwrap_err().to_string();
    assert!(said.contains("cut off"), "{said}");
    // A matrix of MATLAB that speaks of four thousand millions of rows.
    let mut file = bytes("v5.mat");
    let rows = file.windows(8).position(|part| part == [1, 0, 0, 0, 40, 0, 0, 0]);
    let at = rows.unwrap();
    file[at..at + 8].copy_from_slice(&[0xff; 8]);
    let said = read(Path::new("x.mat"), Form::Matlab, &file).unwrap_err().to_string();
    assert!(said.contains("more than"), "{said}");
}

#[test]
fn a_file_without_vectors_says_what_was_left_out() {
    let header = "{'descr': '<U3', 'fortran_order': False, 'shape': (2,), }";
    let mut array = b"\x93NUMPY\x01\x00".to_vec();
    array.extend_from_slice(&(header.len() as u16).to_le_bytes());
    array.extend_from_slice(header.as_bytes());
    array.extend_from_slice(&[0; 24]);
    let said = read(Path::new("x.npy"), Form::Npy, &array).unwrap_err().to_string();
    assert!(said.contains("no vector") && said.contains("no numbers"), "{said}");
}

proptest! {
    #[test]
    fn damaged_files_never_panic(
        which in 0..FILES.len(),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        end in any::<prop::sample::Index>(),
        cut in any::<bool>(),
    ) {
        let mut file = bytes(FILES[which]);
        for (at, value) in changes {
            let at = at.index(file.len());
            file[at] = value;
        }
        if cut {
            file.truncate(end.index(file.len()));
        }
        let form = form_of(&file);
        if form != Form::Text {
            let _ = read(Path::new("x"), form, &file);
        }
    }
}
