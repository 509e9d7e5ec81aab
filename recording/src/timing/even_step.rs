//! The one step of times that must be even throughout.

use std::path::Path;

use super::{NEEDED, median, rounded};
use crate::RecordingError;

/// The sampling period of `time` \[s\], if every step is within `tolerance` (a fraction) of the
/// median step.
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
    let usual = median(&steps);
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
