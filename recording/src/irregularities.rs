//! What was uneven about the times of a recording, in numbers and in words.

use std::fmt::Write;

use serde::Serialize;

use super::remarks::Remarks;
use super::sheet::Dialect;

/// What was done to uneven samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Resampled {
    /// The new rate \[Hz\].
    pub rate: f64,
    /// Mean rate of the samples \[Hz\].
    pub mean_rate: f64,
    /// Where the anti-alias low-pass ends \[Hz\]; none where there is none.
    pub low_pass: Option<f64>,
    /// Standard deviation of noise afterwards, as a fraction of what it was, where it was white
    /// from sample to sample.
    pub noise: f64,
}

impl Resampled {
    /// In words.
    fn describe(&self) -> String {
        let Self { rate, mean_rate, low_pass, noise } = self;
        let filter = low_pass.map_or_else(
            || "no low-pass".to_owned(),
            |end| format!("a zero-phase anti-alias low-pass that ends at {end} Hz"),
        );
        format!(
            "uneven samples, {mean_rate} Hz in the mean, were brought to {rate} Hz along straight lines, with {filter}: \
             noise that was white becomes {noise:.2} times as large, and neighbours share it"
        )
    }
}

/// What was uneven about the times of a recording, and what was done about it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Irregularities {
    /// Decimals are written with a comma.
    pub decimal_comma: bool,
    /// The column names were taken from a remark above the numbers.
    pub names_in_remark: bool,
    /// Rows of a table without a value where one is needed (empty or NaN), left out.
    pub blank: usize,
    /// Uneven samples were brought to a rate that was asked for.
    pub resampled: Option<Resampled>,
    /// Samples dropped because they have the time of the one before.
    pub repeated: usize,
    /// Samples that came late or early, read between their neighbours instead.
    pub moved: usize,
    /// Missing samples, one or two at a time, filled in between their neighbours.
    pub filled: usize,
    /// Samples that came between two others where one is usual.
    pub dropped: usize,
    /// Gaps at which the recording was split.
    pub gaps: usize,
    /// Samples missing in them.
    pub missing: usize,
    /// Pauses of more than half a second: one run ends there, the next begins.
    pub pauses: usize,
    /// Lasting changes of the rate without a pause.
    pub rate_changes: usize,
    /// Stretches that are left.
    pub stretches: usize,
    /// Stretches too short to be used.
    pub too_short: usize,
    /// Samples in them.
    pub too_short_samples: usize,
    /// Stretches at another rate than most samples have, where one rate is needed.
    pub other_rate: usize,
    /// Samples in them.
    pub other_rate_samples: usize,
    /// What is to be said of the values.
    #[serde(skip_serializing_if = "Remarks::is_empty")]
    pub remarks: Remarks,
}

impl Irregularities {
    /// With what is to be said of the table that it was read from.
    #[must_use]
    pub(super) const fn written_as(self, blank: usize, dialect: Dialect) -> Self {
        let Dialect { decimal_comma, names_in_remark, .. } = dialect;
        Self { blank, decimal_comma, names_in_remark, ..self }
    }

    /// With the messages of a bag that were left out, having no number where one is needed.
    #[must_use]
    pub(super) const fn without(self, blank: usize) -> Self {
        Self { blank, ..self }
    }

    /// With what is to be said of the values.
    #[must_use]
    pub(super) const fn remarking(self, remarks: Remarks) -> Self {
        Self { remarks, ..self }
    }

    /// What was uneven about two recordings that are taken for one.
    #[must_use]
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            decimal_comma: self.decimal_comma || other.decimal_comma,
            names_in_remark: self.names_in_remark || other.names_in_remark,
            resampled: self.resampled.or(other.resampled),
            blank: self.blank + other.blank,
            repeated: self.repeated + other.repeated,
            moved: self.moved + other.moved,
            filled: self.filled + other.filled,
            dropped: self.dropped + other.dropped,
            gaps: self.gaps + other.gaps,
            missing: self.missing + other.missing,
            pauses: self.pauses + other.pauses,
            rate_changes: self.rate_changes + other.rate_changes,
            stretches: self.stretches + other.stretches,
            too_short: self.too_short + other.too_short,
            too_short_samples: self.too_short_samples + other.too_short_samples,
            other_rate: self.other_rate + other.other_rate,
            other_rate_samples: self.other_rate_samples + other.other_rate_samples,
            remarks: self.remarks.and(other.remarks),
        }
    }

    /// Counts a stretch that is too short.
    pub(super) fn leave_out(&mut self, samples: usize) {
        self.too_short += 1;
        self.too_short_samples += samples;
    }

    /// In words, as in `3 gaps, 12 samples missing; split into 4 stretches`; none where nothing is
    /// to be said: pauses between runs are as they should be. Remarks on the values follow.
    #[must_use]
    pub fn describe(&self) -> Option<String> {
        let mut parts: Vec<String> = Vec::new();
        if self.decimal_comma {
            parts.push("decimals are read with a comma".to_owned());
        }
        if self.names_in_remark {
            parts
                .push("the column names are those of the last remark above the numbers".to_owned());
        }
        if self.blank > 0 {
            let verb = if self.blank == 1 { "was" } else { "were" };
            let rows = count(self.blank, "row");
            parts.push(format!("{rows} without a value (empty or NaN) {verb} left out"));
        }
        if let Some(resampled) = self.resampled {
            parts.push(resampled.describe());
        }
        if self.repeated > 0 {
            parts.push(format!("{} dropped", count(self.repeated, "repeated sample")));
        }
        if self.moved > 0 {
            let came = count(self.moved, "sample");
            parts.push(format!(
                "{came} came late or early and {} between the neighbours",
                read(self.moved)
            ));
        }
        if self.filled > 0 {
            let were = if self.filled == 1 { "was" } else { "were" };
            parts.push(format!(
                "{} {were} filled in between the neighbours",
                count(self.filled, "missing sample")
            ));
        }
        if self.dropped > 0 {
            parts.push(format!("{} between two others dropped", count(self.dropped, "sample")));
        }
        let mut cuts = String::new();
        if self.gaps > 0 {
            // Writing to a string cannot fail.
            let _ = write!(
                cuts,
                "{}, {} missing",
                count(self.gaps, "gap"),
                count(self.missing, "sample")
            );
        }
        if self.rate_changes > 0 {
            let comma = if cuts.is_empty() { "" } else { "; " };
            let _ =
                write!(cuts, "{comma}{}", count(self.rate_changes, "change of the sampling rate"));
        }
        if !cuts.is_empty() {
            let _ = write!(cuts, "; split into {}", count(self.split_into(), "stretch"));
            parts.push(cuts);
        }
        if self.too_short > 0 {
            let what = count(self.too_short, "stretch");
            let samples = count(self.too_short_samples, "sample");
            parts.push(format!("{what} too short to be used, with {samples}, left out"));
        }
        if self.other_rate > 0 {
            let what = count(self.other_rate, "stretch");
            let samples = count(self.other_rate_samples, "sample");
            parts.push(format!(
                "{what} at another rate than most samples have, with {samples}, left out"
            ));
        }
        let uneven = (!parts.is_empty()).then(|| parts.join("; "));
        let said: Vec<String> = uneven.into_iter().chain(self.remarks.sentences()).collect();
        (!said.is_empty()).then(|| format!("{}.", said.join(". ")))
    }

    /// What puts every number in doubt that comes from the recording, in sentences.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        self.remarks.doubts().into_iter().map(|said| format!("{said}.")).collect()
    }

    /// Stretches that the cuts made, used or not.
    const fn split_into(&self) -> usize {
        self.stretches + self.too_short + self.other_rate
    }
}

fn read(samples: usize) -> &'static str {
    if samples == 1 { "was read" } else { "were read" }
}

/// `1 gap`, `2 gaps`.
fn count(number: usize, what: &str) -> String {
    match (number, what) {
        (1, _) => format!("1 {what}"),
        (_, "stretch") => format!("{number} stretches"),
        (_, "change of the sampling rate") => format!("{number} changes of the sampling rate"),
        _ => format!("{number} {what}s"),
    }
}
