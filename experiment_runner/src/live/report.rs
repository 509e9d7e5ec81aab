//! What a live run comes to.

use std::{fmt, sync::atomic::Ordering};

use ros_node::timing::{Percentiles, Timing};

use super::{Counters, LiveOptions, control::Done, publishing::Published};
use crate::bag::BagSummary;

/// What a live run came to. Displayed, it is what a person wants to read at the end.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveReport {
    /// How regular the loop was.
    pub timing: Timing,
    /// What the control thread was told about its priority.
    pub priority: String,
    /// Cycles that were published, all six topics of each.
    pub published: u64,
    /// Cycles that were not, because the queue was full or the middleware refused.
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
        options: &LiveOptions,
        control: Done,
        published: Published,
        bag: BagSummary,
        counters: &Counters,
    ) -> Self {
        Self {
            timing: control.timing,
            priority: control.priority,
            published: published.cycles,
            not_published: counters.not_published.load(Ordering::Relaxed) + published.failed,
            first_refusal: published.first_failure,
            not_recorded: counters.not_recorded.load(Ordering::Relaxed),
            bag,
            interrupted: control.stopped && options.duration.is_some(),
        }
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
        writeln!(f, "  {} cycles, {} started a whole period late", self.timing.cycles, self.timing.overruns)?;
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
