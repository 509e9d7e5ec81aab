//! What a live run comes to.

use std::fmt;

use ros_node::timing::{Percentiles, Timing};

use super::publishing::Published;
use recording::bag::BagSummary;

/// What a live run came to. Displayed, it is what a person wants to read at the end.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveReport {
    /// How regular the loop was.
    pub timing: Timing,
    /// What the control thread was told about its priority.
    pub priority: String,
    /// Cycles whose measurement was published.
    pub published: u64,
    /// Messages of all topics that were not, because a queue was full or the middleware refused.
    pub not_published: u64,
    /// What the middleware said at its first refusal.
    pub first_refusal: Option<String>,
    /// Cycles that are missing in the bag, because the queue was full.
    pub not_recorded: u64,
    /// The bag.
    pub bag: BagSummary,
    /// Stopped before the time that was asked for.
    pub interrupted: bool,
}

impl LiveReport {
    pub(super) fn new(
        timing: Timing,
        priority: String,
        published: Published,
        bag: BagSummary,
        not_recorded: u64,
    ) -> Self {
        let timing = Timing { cycles: timing.cycles + not_recorded, ..timing };
        Self {
            timing,
            priority,
            published: published.cycles,
            not_published: published.lost,
            first_refusal: published.first_failure,
            not_recorded,
            bag,
            interrupted: false,
        }
    }
}

impl LiveReport {
    /// The same for programs; docs/reference/json.md explains its keys.
    #[must_use]
    pub fn document(&self) -> serde_json::Value {
        let percentiles = |p: &Percentiles| serde_json::json!({"p50": p.p50, "p99": p.p99, "p99_9": p.p999, "max": p.max});
        serde_json::json!({
            "format": "frictionlab-live",
            "format_version": 1,
            "cycles": self.timing.cycles,
            "overruns": self.timing.overruns,
            "period_us": percentiles(&self.timing.period),
            "execution_us": percentiles(&self.timing.execution),
            "priority": self.priority,
            "published": self.published,
            "not_published": self.not_published,
            "not_recorded": self.not_recorded,
            "bag": self.bag.dir.display().to_string(),
            "messages": self.bag.messages,
            "duration_s": self.bag.duration,
            "interrupted": self.interrupted,
        })
    }
}

impl fmt::Display for LiveReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut row = |name: &str, p: &Percentiles| {
            writeln!(
                f,
                "  {name:<10} p50 {:8.1} us   p99 {:8.1} us   p99.9 {:8.1} us   max {:8.1} us",
                p.p50, p.p99, p.p999, p.max
            )
        };
        row("period", &self.timing.period)?;
        row("execution", &self.timing.execution)?;
        writeln!(
            f,
            "  {} cycles, {} started a whole period late",
            self.timing.cycles, self.timing.overruns
        )?;
        writeln!(
            f,
            "  published {} cycles ({} lost), recorded {} ({} lost)",
            self.published,
            self.not_published,
            self.timing.cycles - self.not_recorded,
            self.not_recorded
        )?;
        if let Some(refusal) = &self.first_refusal {
            writeln!(f, "  first refusal: {refusal}")?;
        }
        write!(
            f,
            "  bag {}: {} messages, {:.3} s, {:.1} MB",
            self.bag.dir.display(),
            self.bag.messages,
            self.bag.duration,
            self.bag.bytes as f64 * 1e-6
        )
    }
}
