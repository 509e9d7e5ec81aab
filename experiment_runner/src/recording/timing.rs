//! Are the samples evenly spaced?

use std::path::Path;

use super::RecordingError;

/// The sampling period of `time` \[s\], if every step is within `tolerance` (a fraction) of the median step.
///
/// `place` says where sample `i` stands, as in `line 17`.
///
/// # Errors
/// [`RecordingError::TooShort`], [`RecordingError::TimeOrder`], [`RecordingError::Uneven`].
pub fn even_step(
    path: &Path,
    time: &[f64],
    tolerance: f64,
    place: impl Fn(usize) -> String,
) -> Result<f64, RecordingError> {
    const NEEDED: usize = 3;
    let n = time.len();
    if n < NEEDED {
        return Err(RecordingError::TooShort { path: path.into(), found: n, needed: NEEDED });
    }
    let steps: Vec<_> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if let Some(index) = steps.iter().position(|&step| step <= 0.0) {
        return Err(RecordingError::TimeOrder {
            path: path.into(),
            place: place(index + 1),
            before: time[index],
            time: time[index + 1],
        });
    }
    let mut sorted = steps.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted[sorted.len() / 2];
    if let Some(index) = steps.iter().position(|step| (step - usual).abs() > tolerance * usual) {
        return Err(RecordingError::Uneven {
            path: path.into(),
            place: place(index + 1),
            step: rounded(steps[index]),
            usual: rounded(usual),
            percent: rounded(100.0 * tolerance),
        });
    }
    // The mean does not suffer from the rounding of the single times.
    Ok((time[n - 1] - time[0]) / (n - 1) as f64)
}

/// Six significant digits, for messages.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(time: &[f64]) -> Result<f64, RecordingError> {
        even_step(Path::new("x.csv"), time, 0.05, |index| format!("line {}", index + 2))
    }

    #[test]
    fn rounding_of_printed_times_is_averaged_out() {
        let time: Vec<_> = (0..1000).map(|i| (i as f64 * 0.012345 * 1e3).round() / 1e3).collect();
        let even = even_step(Path::new("x.csv"), &time, 0.1, |_| String::new()).unwrap();
        assert!((even - 0.012345).abs() < 1e-6);
    }

    #[test]
    fn gaps_and_reversals_are_placed() {
        let gap = step(&[0.0, 0.1, 0.2, 0.4, 0.5]).unwrap_err().to_string();
        assert!(gap.contains("line 5") && gap.contains("0.2 s") && gap.contains("5 %"), "{gap}");
        let back = step(&[0.0, 0.1, 0.2, 0.15, 0.3]).unwrap_err().to_string();
        assert!(back.contains("line 5") && back.contains("0.15"), "{back}");
        assert!(matches!(step(&[0.0, 0.1, 0.1]), Err(RecordingError::TimeOrder { .. })));
        assert!(matches!(step(&[0.0, 0.1]), Err(RecordingError::TooShort { found: 2, .. })));
    }
}
