//! Files that are no recordings, or none that is read: told by how they begin, so that the error can
//! say how they become one.

/// What a file is, and how it becomes a table that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Foreign {
    /// In words.
    pub form: &'static str,
    /// How it becomes a table.
    pub convert: &'static str,
}

const fn of(form: &'static str, convert: &'static str) -> Option<Foreign> {
    Some(Foreign { form, convert })
}

/// The form of a file that is not read; none where it may be one that is.
pub(super) fn foreign(bytes: &[u8]) -> Option<Foreign> {
    const AS_TEXT: &str = "as text, with one header line and one line a sample";
    // The names in a zip archive stand at its end.
    let end = bytes.get(bytes.len().saturating_sub(1 << 16)..).unwrap_or_default();
    let holds = |part: &[u8]| end.windows(part.len()).any(|window| window == part);
    match bytes {
        [0x1f, 0x8b, ..] => of("a file compressed by gzip", "unpacked by gunzip"),
        [0x28, 0xb5, 0x2f, 0xfd, ..] => {
            of("a file compressed by zstd", "unpacked by unzstd; a bag is given by its folder")
        }
        [b'B', b'Z', b'h', b'1'..=b'9', ..] => {
            of("a file compressed by bzip2", "unpacked by bunzip2")
        }
        [0xfd, b'7', b'z', b'X', b'Z', 0, ..] => of("a file compressed by xz", "unpacked by unxz"),
        [b'P', b'K', 3, 4, ..] if holds(b"xl/") => {
            of("a workbook of Excel", "as CSV, from the menu of the spreadsheet")
        }
        [0xd0, 0xcf, 0x11, 0xe0, ..] => {
            of("a workbook of old Excel", "as CSV, from the menu of the spreadsheet")
        }
        [b'P', b'K', 3, 4, ..] if !holds(b".npy") => of("a zip archive", "unpacked by unzip"),
        [b'A', b'R', b'R', b'O', b'W', b'1', ..] => of(
            "a Feather file",
            "in Python: pandas.read_feather(FILE).to_parquet('recording.parquet')",
        ),
        [0x80, 2..=5, ..] => of(
            "a pickle of Python",
            "in Python: numpy.savez('recording.npz', t=t, q=q, tau=tau), or to_parquet of pandas",
        ),
        [b'#', b'R', b'O', b'S', b'B', b'A', b'G', ..] => {
            of("a bag of ROS 1", "as a bag of ROS 2, by rosbags-convert")
        }
        [b'S', b'Q', b'L', b'i', b't', b'e', ..] => {
            of("a database of SQLite", "under a name that ends in .db3 if it is a bag")
        }
        [b'T', b'D', b'S', b'm', ..] => of("a TDMS file of LabVIEW", AS_TEXT),
        [b'U', b'L', b'o', b'g', ..] => of("a flight log (ULog)", AS_TEXT),
        [b'M', b'D', b'F', ..] => of("a measurement data file (MDF)", AS_TEXT),
        [b'{', rest @ ..] if matches!(rest.trim_ascii_start(), [b'"', ..]) => of(
            "a JSON file",
            "as text, with one header line and one line a sample, unless it is the log of a servo",
        ),
        _ if matlab_4(bytes) => of(
            "a MATLAB file of version 4",
            "in MATLAB by save -v7, in Python by savemat with format='5'",
        ),
        _ => None,
    }
}

/// Version 4 begins with the type, rows, columns, whether there is an imaginary part, and the length
/// of the name of its first matrix.
fn matlab_4(bytes: &[u8]) -> bool {
    let word = |at: usize| -> Option<u32> {
        Some(u32::from_le_bytes(bytes.get(4 * at..4 * at + 4)?.try_into().ok()?))
    };
    let [Some(kind), Some(rows), Some(columns), Some(imaginary), Some(name)] =
        [0, 1, 2, 3, 4].map(word)
    else {
        return false;
    };
    let ends = (name as usize).checked_add(19).and_then(|end| bytes.get(end));
    kind < 60
        && rows > 0
        && columns > 0
        && imaginary < 2
        && (2..64).contains(&name)
        && ends == Some(&0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_read_is_told_by_how_it_begins() {
        for (bytes, part) in [
            (&b"\x1f\x8b\x08\x00"[..], "gunzip"),
            (b"PK\x03\x04....[Content_Types].xml...xl/workbook.xml", "CSV"),
            (b"PK\x03\x04....run.csv", "unzip"),
            (b"\x80\x05\x95....", "numpy.savez"),
            (b"#ROSBAG V2.0\n", "rosbags-convert"),
            (b"{\n  \"mass\": 0.5", "log of a servo"),
            (b"ARROW1\0\0", "to_parquet"),
            (b"\0\0\0\0\x01\0\0\0\x09\0\0\0\0\0\0\0\x02\0\0\0t\0........", "-v7"),
        ] {
            assert!(foreign(bytes).is_some_and(|found| found.convert.contains(part)), "{part}");
        }
        for bytes in [&b""[..], b"t,q,tau\n", b"PK\x03\x04....t.npy....", b"# t q tau\n", b"\0"] {
            assert_eq!(foreign(bytes), None, "{bytes:?}");
        }
    }
}
