//! The progress bar: what is being done, how far it is, how long it will take.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Progress of long work, counted in seconds of rig time or in pieces.
#[derive(Debug, Clone)]
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar over `rig_seconds` in the terminal, or nothing at all if `quiet`. Where the output is no terminal nothing is drawn.
    #[must_use]
    pub fn new(rig_seconds: f64, quiet: bool) -> Self {
        Self::counting(rig_seconds.ceil() as u64, "s of rig time", quiet)
    }

    /// A bar over `length` of `what`.
    #[must_use]
    pub fn counting(length: u64, what: &str, quiet: bool) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(length), target);
        let style = &format!(
            "{{msg:34!}} {{bar:28.cyan/blue}} {{percent:>3}} %  {{pos}}/{{len}} {what}  {{eta}} left"
        );
        // A template that does not parse would leave indicatif's plain bar; a test keeps it parsing.
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style.progress_chars("━╸─"));
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    /// Says what is being done now.
    pub fn stage(&self, message: impl Into<String>) {
        self.0.set_message(message.into());
    }

    /// Says how much there is to do, once that is known.
    pub fn expect(&self, length: u64) {
        self.0.set_length(length);
    }

    /// Adds `rig_seconds` done.
    pub fn advance(&self, rig_seconds: f64) {
        self.0.inc(rig_seconds.round() as u64);
    }

    /// What is being done now.
    #[must_use]
    pub fn message(&self) -> String {
        self.0.message()
    }

    /// How much is done, in what is counted.
    #[must_use]
    pub fn position(&self) -> f64 {
        self.0.position() as f64
    }

    /// How much is done, 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        let length = self.0.length().unwrap_or(0).max(1);
        (self.0.position() as f64 / length as f64).min(1.0)
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }

    /// Prints a line above the bar.
    pub fn line(&self, text: &str) {
        self.0.suspend(|| eprintln!("{text}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_parses_and_counts() {
        let progress = Progress::new(30.0, true);
        progress.stage("testing");
        progress.advance(15.0);
        assert_eq!((progress.position(), progress.fraction()), (15.0, 0.5));
        assert_eq!(progress.message(), "testing");
        progress.finish();
    }
}
