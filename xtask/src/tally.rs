//! What came of the tests: how many passed, and which did not run and why.

use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, BufRead, Write};

/// Counts of a run of `cargo test`.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Tally {
    passed: u32,
    failed: u32,
    /// Tests that did not run, by their reason.
    ignored: BTreeMap<String, u32>,
}

impl Tally {
    /// Passes on what a run of tests prints, and counts.
    ///
    /// # Errors
    /// What it prints cannot be read or passed on.
    pub fn hear(&mut self, said: impl BufRead, on: &mut impl Write) -> io::Result<()> {
        for line in said.split(b'\n') {
            let line = line?;
            on.write_all(&line)?;
            on.write_all(b"\n")?;
            self.count(&String::from_utf8_lossy(&line));
        }
        Ok(())
    }

    /// Says and counts that a whole part did not run, and why.
    pub fn leave_out(&mut self, what: &str) {
        println!("SKIPPED: {what}");
        *self.ignored.entry(what.to_owned()).or_default() += 1;
    }

    /// Adds what was counted apart.
    pub fn add(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        for (reason, times) in other.ignored {
            *self.ignored.entry(reason).or_default() += times;
        }
    }

    fn count(&mut self, line: &str) {
        if let Some(counts) = line.strip_prefix("test result: ") {
            let of = |what: &str| {
                let before = counts.split([';', '.']).find_map(|part| part.strip_suffix(what));
                before.and_then(|number| number.trim().parse::<u32>().ok()).unwrap_or(0)
            };
            self.passed += of(" passed");
            self.failed += of(" failed");
        } else if line.starts_with("test ")
            && let Some((_, reason)) = line.split_once(" ... ignored")
        {
            let reason = reason.trim_start_matches(", ").trim();
            let reason = if reason.is_empty() { "no reason is given" } else { reason };
            *self.ignored.entry(reason.to_owned()).or_default() += 1;
        }
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ignored: u32 = self.ignored.values().sum();
        write!(f, "{} passed, {} failed, {ignored} ignored", self.passed, self.failed)?;
        self.ignored.iter().try_for_each(|(reason, times)| write!(f, "\n  {times:>3}  {reason}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passed_and_ignored_tests_are_counted_with_their_reasons() {
        let said = "\
running 4 tests
test a ... ok
test b ... ignored, no Chromium: install it
test c ... ignored, no Chromium: install it
test d ... ignored

test result: ok. 1 passed; 0 failed; 3 ignored; 0 measured; 0 filtered out; finished in 0.00s

test result: FAILED. 20 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out; finished in 1.00s
";
        let (mut tally, mut on) = (Tally::default(), Vec::new());
        tally.hear(said.as_bytes(), &mut on).unwrap();
        assert_eq!(String::from_utf8(on).unwrap(), said);
        assert_eq!(
            tally.to_string(),
            "21 passed, 2 failed, 3 ignored\n    2  no Chromium: install it\n    1  no reason is given"
        );
    }
}
