//! The files in `fixtures/` are made by SciPy, h5py, NumPy and pyarrow.

use std::path::{Path, PathBuf};

use proptest::prelude::*;

use super::*;
use crate::table::{self, Columns};

const FILES: [&str; 14] = [
    "v5.mat",
    "v7.mat",
    "v73.mat",
    "a.npz",
    "c.npz",
    "r.npy",
    "snappy.parquet",
    "zstd.parquet",
    "brotli.parquet",
    "lz4.parquet",
    "none.parquet",
    "half.npz",
    "half.parquet",
    "half.h5",
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
    for name in FILES.into_iter().filter(|name| !name.starts_with("half")) {
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
fn numbers_of_two_bytes_are_read() {
    for name in FILES.into_iter().filter(|name| name.starts_with("half")) {
        let found = table::read(&fixture(name), &Columns::default(), 0.05)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(found.samples(), 40, "{name}");
        for (k, (q, tau)) in found.position.unwrap().iter().zip(&found.force).enumerate() {
            assert_eq!((*q, *tau), (k as f64 / 16.0, k as f64 / -8.0), "{name} at {k}");
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

/// An array of NumPy, as bytes.
fn array(kind: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {kind}, 'fortran_order': False, 'shape': ({shape}), }}");
    let mut array = b"\x93NUMPY\x01\x00".to_vec();
    array.extend_from_slice(&(header.len() as u16).to_le_bytes());
    array.extend_from_slice(header.as_bytes());
    array.extend_from_slice(data);
    array
}

fn written(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Six joints with limits and gains: more vectors have six numbers than there are samples.
#[test]
fn the_length_of_the_time_is_that_of_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let mut add = |name: &str, shape: &str, numbers: usize| {
        let values = (0..numbers).flat_map(|k| (0.01 * k as f64).to_le_bytes());
        let bytes = array("'<f8'", shape, &values.collect::<Vec<u8>>());
        archive
            .start_file(format!("{name}.npy"), zip::write::SimpleFileOptions::default())
            .unwrap();
        std::io::Write::write_all(&mut archive, &bytes).unwrap();
    };
    for name in ["qmax", "qmin", "kp", "kd", "ki"] {
        add(name, "6,", 6);
    }
    for (name, shape, numbers) in
        [("t", "40,", 40), ("q", "40, 6", 240), ("tau", "40, 6", 240), ("dh", "6, 4", 24)]
    {
        add(name, shape, numbers);
    }
    let bytes = archive.finish().unwrap().into_inner();
    let path = written(folder.path(), "x.npz", &bytes);
    let found = table::read(&path, &of_joint(Some("2")), 0.05).unwrap();
    assert_eq!((found.samples(), found.force[1]), (40, 0.08));
}

/// Nanoseconds that NumPy says are times were scaled once more by the unit in the name.
#[test]
fn times_that_the_file_says_are_times_are_seconds_whatever_their_name() {
    let folder = tempfile::tempdir().unwrap();
    let kinds = "[('t_ns', '<M8[ns]'), ('q', '<f8'), ('tau', '<f8')]";
    let mut rows = Vec::new();
    for k in 0..40i64 {
        let time = if k == 0 { i64::MIN } else { 1_709_294_400_000_000_000 + k * 2_000_000_000 };
        rows.extend_from_slice(&time.to_le_bytes());
        rows.extend_from_slice(&(k as f64).to_le_bytes());
        rows.extend_from_slice(&1f64.to_le_bytes());
    }
    let path = written(folder.path(), "x.npy", &array(kinds, "40,", &rows));
    let found = table::read(&path, &Columns::default(), 0.05).unwrap();
    assert!((found.time_step - 2.0).abs() < 1e-9, "{}", found.time_step);
    assert_eq!((found.samples(), found.irregularities.blank), (39, 1));
}

/// A counter of microseconds became negative halfway, and its times ran backwards.
#[test]
fn unsigned_numbers_of_parquet_have_no_sign() {
    use ::parquet::column::writer::ColumnWriter;
    use ::parquet::file::writer::SerializedFileWriter;

    let folder = tempfile::tempdir().unwrap();
    for (kind, name, step) in [
        ("INT32 {} (INTEGER(32,false))", "t_us", 1000),
        ("INT32 {} (UINT_32)", "t_us", 1000),
        ("INT64 {} (TIMESTAMP_MICROS)", "t_ms", 1_000_000),
        ("INT64 {} (TIMESTAMP(NANOS,true))", "__index_level_0__", 1_000_000_000),
    ] {
        let time = kind.replace("{}", name);
        let schema =
            format!("message m {{ required {time}; required double q; required double tau; }}");
        let schema = ::parquet::schema::parser::parse_message_type(&schema).unwrap();
        let mut bytes = Vec::new();
        let mut file =
            SerializedFileWriter::new(&mut bytes, std::sync::Arc::new(schema), Default::default())
                .unwrap();
        let mut group = file.next_row_group().unwrap();
        while let Some(mut column) = group.next_column().unwrap() {
            match column.untyped() {
                ColumnWriter::Int32ColumnWriter(writer) => {
                    let values: Vec<i32> =
                        (0..40).map(|k| (i32::MAX - 20_000).wrapping_add(k * step)).collect();
                    writer.write_batch(&values, None, None).unwrap();
                }
                ColumnWriter::Int64ColumnWriter(writer) => {
                    let values: Vec<i64> =
                        (0..40).map(|k| 1_709_294_400_000 + k * i64::from(step)).collect();
                    writer.write_batch(&values, None, None).unwrap();
                }
                ColumnWriter::DoubleColumnWriter(writer) => {
                    let values: Vec<f64> = (0..40).map(f64::from).collect();
                    writer.write_batch(&values, None, None).unwrap();
                }
                _ => unreachable!("the schema has no other type"),
            }
            column.close().unwrap();
        }
        group.close().unwrap();
        file.close().unwrap();
        let path = written(folder.path(), "x.parquet", &bytes);
        let found = table::read(&path, &Columns::default(), 0.05).unwrap();
        let due = if name == "t_us" { 1e-3 } else { 1.0 };
        assert!((found.time_step - due).abs() < 1e-9, "{kind}: {}", found.time_step);
    }
}

/// Degrees that an attribute tells were taken for radians.
#[test]
fn units_in_attributes_of_hdf5_are_heard() {
    let folder = tempfile::tempdir().unwrap();
    let mut builder = hdf5_pure::FileBuilder::new();
    let values = |factor: f64| (0..40).map(|k| factor * f64::from(k)).collect::<Vec<f64>>();
    for (name, factor, unit) in [
        ("t", 1.0, "milliseconds since 2024-03-01"),
        ("q", 180.0, "deg"),
        ("tau_mNm", 1000.0, "Nm"),
    ] {
        builder
            .create_dataset(name)
            .with_f64_data(&values(factor))
            .set_attr("units", hdf5_pure::AttrValue::String(unit.into()));
    }
    let path = written(folder.path(), "x.h5", &builder.finish().unwrap());
    let found = table::read(&path, &Columns::default(), 0.05).unwrap();
    assert!((found.time_step - 1e-3).abs() < 1e-12);
    assert!((found.position.unwrap()[1] - std::f64::consts::PI).abs() < 1e-12);
    // A unit in the name itself comes first.
    assert_eq!(found.force[3], 3.0);
}

#[test]
fn what_of_an_array_is_not_read_is_named() {
    let nested = "[('t', '<f8'), ('arm', [('q', '<f8'), ('tau', '<f8')])]";
    let said = read(Path::new("x.npy"), Form::Npy, &array(nested, "3,", &[0; 72])).unwrap_err();
    assert!(said.to_string().contains("field `arm` has fields of its own"), "{said}");
    let folder = tempfile::tempdir().unwrap();
    let kinds = "[('t', '<f8'), ('q', '<f8'), ('tau', 'S8')]";
    let path = written(folder.path(), "x.npy", &array(kinds, "3,", &[0; 72]));
    let said = table::read(&path, &Columns::default(), 0.05).unwrap_err().to_string();
    assert!(said.contains("`tau` is left out: it holds no numbers"), "{said}");
}

#[test]
fn what_is_no_recording_says_how_it_becomes_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), "x.csv.gz", b"\x1f\x8b\x08\0\0\0\0\0");
    let said = table::read(&path, &Columns::default(), 0.05).unwrap_err();
    assert!(said.is_bad_input() && said.to_string().contains("gunzip"), "{said}");
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

#[test]
fn what_is_not_what_its_name_promises_is_called_so() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        table::read(&path, &Columns::default(), 0.05)
    };
    for (name, form) in [("a.mat", "MATLAB"), ("a.npz", "NumPy"), ("A.H5", "HDF5")] {
        let said = read(name, b"\xff\x01\x02\x00t").unwrap_err().to_string();
        assert!(said.contains(form) && said.contains("does not begin as one"), "{said}");
    }
    // A line that is no text is named in a file that is to be text, and text is read.
    let said = read("a.csv", b"t,q,tau\n0,1,\xff\x01\n").unwrap_err().to_string();
    assert!(said.contains("line 2"), "{said}");
    let rows: String = (0..200).map(|k| format!("{},{k},1\n", f64::from(k) * 0.01)).collect();
    let found = read("ascii.mat", format!("t,q,tau\n{rows}").as_bytes()).unwrap();
    assert_eq!(found.samples(), 200);
}
