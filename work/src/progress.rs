//! The progress of long work: a bar in a terminal, a line now and then elsewhere.

use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// How long it is silent where there is no terminal.
const BETWEEN: Duration = Duration::from_secs(10);

/// A bar whose words have a line of their own.
const IN_WORDS: &str =
    "{bar:28.cyan/blue} {percent:>3} %  {pos}/{len} s of rig time  at most {eta} left\n{wide_msg}";

/// Whether each stage is said as it begins.
static VERBOSE: AtomicBool = AtomicBool::new(false);

/// Lets every progress of this program that is not quiet say each stage as it begins.
pub fn set_verbose(verbose: bool) {
    VERBOSE.store(verbose, Ordering::Relaxed);
}

/// Progress of long work, counted in seconds of rig time or in pieces.
#[derive(Debug, Clone)]
pub struct Progress {
    bar: ProgressBar,
    /// Where there is no terminal: when the last line was printed.
    lines: Option<Arc<Mutex<Instant>>>,
    quiet: bool,
}

impl Progress {
    /// A bar over `rig_seconds` in the terminal, or nothing at all if `quiet`. Where standard error
    /// is no terminal a line is printed every ten seconds.
    #[must_use]
    pub fn new(rig_seconds: f64, quiet: bool) -> Self {
        Self::counting(rig_seconds.ceil() as u64, "s of rig time", quiet)
    }

    /// The same for work that has much to say: its words have a line of their own, and the time that
    /// is left is the most that it may be.
    #[must_use]
    pub fn in_words(rig_seconds: f64, quiet: bool) -> Self {
        let progress = Self::counting(rig_seconds.ceil() as u64, "s of rig time", quiet);
        if let Ok(style) = ProgressStyle::with_template(IN_WORDS) {
            progress.bar.set_style(style.progress_chars("━╸─"));
        }
        progress
    }

    /// A bar over `length` of `what`.
    #[must_use]
    pub fn counting(length: u64, what: &str, quiet: bool) -> Self {
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(length), target);
        let style = &format!(
            "{{msg:34!}} {{bar:28.cyan/blue}} {{percent:>3}} %  {{pos}}/{{len}} {what}  {{eta}} left"
        );
        // A template that does not parse would leave indicatif's plain bar; a test keeps it
        // parsing.
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style.progress_chars("━╸─"));
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        let lines =
            (!quiet && !io::stderr().is_terminal()).then(|| Arc::new(Mutex::new(Instant::now())));
        Self { bar, lines, quiet }
    }

    /// Says what is being done now.
    pub fn stage(&self, message: impl Into<String>) {
        let message = message.into();
        if !self.quiet && VERBOSE.load(Ordering::Relaxed) && message != self.bar.message() {
            self.line(&message);
        }
        self.bar.set_message(message);
        self.tell();
    }

    /// Says how much there is to do, once that is known.
    pub fn expect(&self, length: u64) {
        self.bar.set_length(length);
    }

    /// Adds `rig_seconds` done.
    pub fn advance(&self, rig_seconds: f64) {
        self.bar.inc(rig_seconds.round() as u64);
        self.tell();
    }

    /// Prints a line where there is no terminal, if the last one is long ago.
    fn tell(&self) {
        let Some(lines) = &self.lines else { return };
        // Whoever panicked had nothing half done.
        let mut last = lines.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() >= BETWEEN {
            *last = Instant::now();
            eprintln!("{}", said(&self.message(), self.fraction(), self.bar.elapsed()));
        }
    }

    /// What is being done now.
    #[must_use]
    pub fn message(&self) -> String {
        self.bar.message()
    }

    /// How much is done, in what is counted.
    #[must_use]
    pub fn position(&self) -> f64 {
        self.bar.position() as f64
    }

    /// How much is done, 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        let length = self.bar.length().unwrap_or(0).max(1);
        (self.bar.position() as f64 / length as f64).min(1.0)
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Prints a line above the bar.
    pub fn line(&self, text: &str) {
        self.bar.suspend(|| eprintln!("{text}"));
    }
}

/// A line of progress, with the time that is left if it goes on like this.
fn said(message: &str, fraction: f64, elapsed: Duration) -> String {
    let percent = 100.0 * fraction;
    let stage = if message.is_empty() { String::new() } else { format!("{message}: ") };
    if fraction < 0.01 {
        return format!("{stage}{percent:.0} %");
    }
    let left = elapsed.as_secs_f64() * (1.0 - fraction) / fraction;
    format!("{stage}{percent:.0} %, {} left", about(left))
}

/// A length of time as a person says it: `about 2 h 10 min`.
#[must_use]
pub fn about(seconds: f64) -> String {
    let seconds = seconds.max(0.0);
    let minutes = (seconds / 60.0).round() as u64;
    match minutes {
        _ if seconds < 99.5 => format!("about {seconds:.0} s"),
        ..100 => format!("about {minutes} min"),
        _ => match (minutes / 60, minutes % 60) {
            (hours, 0) => format!("about {hours} h"),
            (hours, minutes) => format!("about {hours} h {minutes} min"),
        },
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
        assert!(ProgressStyle::with_template(IN_WORDS).is_ok());
    }

    #[test]
    fn a_length_of_time_is_said_as_a_person_would() {
        for (seconds, text) in [
            (0.2, "about 0 s"),
            (59.6, "about 60 s"),
            (120.0, "about 2 min"),
            (5700.0, "about 95 min"),
            (7800.0, "about 2 h 10 min"),
            (25_200.0, "about 7 h"),
        ] {
            assert_eq!(about(seconds), text);
        }
    }

    #[test]
    fn a_line_of_progress_says_the_stage_the_share_and_the_time_left() {
        let said = |fraction| said("friction: set 1 of 2", fraction, Duration::from_secs(60));
        assert_eq!(said(0.25), "friction: set 1 of 2: 25 %, about 3 min left");
        assert_eq!(said(0.0), "friction: set 1 of 2: 0 %");
    }
}
