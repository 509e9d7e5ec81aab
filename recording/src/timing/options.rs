//! Times and rates on the command line.

/// A text that is no rate to which samples can be brought.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("expected a rate in Hz above zero, as in 100")]
pub struct RateError;

/// The rate of the option `--resample` \[Hz\].
///
/// # Errors
/// [`RateError`] says what was expected.
pub fn rate(text: &str) -> Result<f64, RateError> {
    text.trim().parse::<f64>().ok().filter(|rate| *rate > 0.0 && rate.is_finite()).ok_or(RateError)
}

/// A text that is no time from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("expected a time in seconds above zero, as in 0.001")]
pub struct PeriodError;

/// The period of the option `--period` \[s\].
///
/// # Errors
/// [`PeriodError`] says what was expected.
pub fn period(text: &str) -> Result<f64, PeriodError> {
    let period = text.trim().parse::<f64>().ok();
    period.filter(|period| *period > 0.0 && period.is_finite()).ok_or(PeriodError)
}

/// A text that is no tolerance of the time steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("expected a fraction of the usual time step from 0 to 0.5, as in 0.05")]
pub struct ToleranceError;

/// The tolerance on the command line.
///
/// # Errors
/// [`ToleranceError`] says what was expected.
pub fn tolerance(text: &str) -> Result<f64, ToleranceError> {
    match text.trim().parse::<f64>() {
        Ok(value) if (0.0..=0.5).contains(&value) => Ok(value),
        _ => Err(ToleranceError),
    }
}
