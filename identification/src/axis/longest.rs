//! The longest stretch of a recording in words, for an error about too little.

use recording::Recording;

/// The longest of several stretches, and its file where several were joined. A short one is left
/// out, so that an error is about the longest. None where there is but one.
pub(super) fn longest(recording: &Recording) -> Option<String> {
    let stretches = &recording.stretches;
    let count = stretches.len();
    let (place, found) = stretches
        .iter()
        .enumerate()
        .max_by_key(|(place, stretch)| (stretch.samples.len(), count - place))?;
    let seconds = recording.time_step * found.samples.len().saturating_sub(1) as f64;
    let (of_file, zero) = match &found.file {
        Some((file, zero)) => (format!(" of {}", file.display()), *zero),
        None => (String::new(), 0.0),
    };
    let (start, end) = (found.start - zero, found.start - zero + seconds);
    (count > 1).then(|| {
        format!(
            "stretch {} of {count}, the longest, {start:.3} s to {end:.3} s{of_file}: ",
            place + 1
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::table::{Columns, read};

    #[test]
    fn the_file_of_the_longest_stretch_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let of = |name: &str, samples: u32| {
            let row = |k: u32| format!("{},{k},1\n", f64::from(k) * 0.01);
            let path = folder.path().join(name);
            let rows: String = (0..samples).map(row).collect();
            std::fs::write(&path, format!("t,q,tau\n{rows}")).unwrap();
            read(&path, &Columns::default(), 0.05).unwrap()
        };
        assert_eq!(longest(&of("a.csv", 20)), None);
        let all = recording::joined(vec![of("a.csv", 20), of("b.csv", 31), of("c.csv", 9)]);
        let said = longest(&all.unwrap().unwrap()).unwrap();
        let expected = "stretch 2 of 3, the longest, 0.000 s to 0.300 s of ";
        assert!(said.starts_with(expected) && said.ends_with("b.csv: "), "{said}");
    }
}
