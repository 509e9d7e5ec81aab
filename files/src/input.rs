//! Files that are read whole, up to a limit: a device without an end or a file that grows must not
//! fill the memory.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Largest protocol, calibration, drive or parameter file \[bytes\].
pub const LARGEST_TEXT: u64 = 1 << 20;
/// Largest recording that is read whole, a CSV file \[bytes\].
pub const LARGEST_TABLE: u64 = 1 << 30;

/// A protocol, calibration, drive or parameter file.
///
/// # Errors
/// What the system says; [`io::ErrorKind::FileTooLarge`] above [`LARGEST_TEXT`].
pub fn text(path: &Path) -> io::Result<String> {
    let bytes = whole(File::open(path)?, LARGEST_TEXT)?;
    String::from_utf8(bytes)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is no text in UTF-8"))
}

/// A CSV file.
///
/// # Errors
/// What the system says; [`io::ErrorKind::FileTooLarge`] above [`LARGEST_TABLE`].
pub fn table(path: &Path) -> io::Result<Vec<u8>> {
    whole(File::open(path)?, LARGEST_TABLE)
}

/// As much as there was when it was opened, for a file; everything for a pipe; at most `most`.
fn whole(file: File, most: u64) -> io::Result<Vec<u8>> {
    let known = Some(file.metadata()?).filter(std::fs::Metadata::is_file).map(|file| file.len());
    let too_large = || {
        let kibibytes = most >> 10;
        let message = format!("it is longer than the {kibibytes} KiB that such a file may have");
        io::Error::new(io::ErrorKind::FileTooLarge, message)
    };
    if known.is_some_and(|length| length > most) {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    // Files of /proc say that they are empty.
    let limit = known.filter(|length| *length > 0).unwrap_or(most + 1);
    file.take(limit).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large()) } else { Ok(bytes) }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn an_endless_pipe_and_a_long_file_are_refused_with_the_limit() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("endless");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let end = pipe.clone();
        // It writes until nobody reads any more.
        let writer = std::thread::spawn(move || {
            let mut end = std::fs::OpenOptions::new().write(true).open(end).unwrap();
            while end.write_all(&[0; 4096]).is_ok() {}
        });
        let error = text(&pipe).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::FileTooLarge);
        assert!(error.to_string().contains("1024 KiB"), "{error}");
        writer.join().unwrap();
        let long = tempfile::NamedTempFile::new().unwrap();
        // Sparse: it takes no room on the disk.
        long.as_file().set_len(LARGEST_TABLE + 1).unwrap();
        assert_eq!(text(long.path()).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        assert_eq!(table(long.path()).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    }

    #[test]
    fn a_file_that_grows_is_read_as_it_was() {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(b"0123").unwrap();
        let opened = File::open(file.path()).unwrap();
        let writer = std::thread::spawn(move || {
            for _ in 0..1000 {
                file.write_all(&[b'x'; 4096]).unwrap();
            }
        });
        let read = whole(opened, LARGEST_TABLE).unwrap();
        writer.join().unwrap();
        assert!(read.starts_with(b"0123") && read.len() <= 4 + 1000 * 4096);
        assert_eq!(text(Path::new("/proc/self/comm")).unwrap().lines().count(), 1);
    }
}
