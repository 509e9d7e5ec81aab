//! What a serial line has carried and lost.

use rig_protocol::Rejections;

/// What the line has carried and lost so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LinkStatistics {
    /// Measurements that came.
    pub measurements: u64,
    /// Cycles whose measurement never came.
    pub gaps: u64,
    /// Measurements that came twice or out of order, and were left out.
    pub repeated: u64,
    /// Measurements that found the queue full.
    pub dropped: u64,
    /// Measurements that were not used because a newer one was there.
    pub skipped: u64,
    /// Frames thrown away in the present session, by reason.
    pub rejections: Rejections,
    /// Frames thrown away in earlier sessions.
    pub rejected_before: u64,
    /// Commands sent.
    pub commands: u64,
    /// Commands that the system's buffer had no room for.
    pub not_sent: u64,
    /// Messages that the device refused: stale, repeated, or while it was not active.
    pub commands_refused: u64,
    /// Frames of somebody else that the device heard: of another session, or of another version.
    pub foreign: u64,
    /// Measurements of another session than ours.
    pub others: u64,
    /// Times that the port was opened again after it was gone.
    pub reconnects: u64,
    /// Restarts of the device that were seen.
    pub restarts: u64,
    /// Longest time between a measurement's arrival and its use \[us\].
    pub longest_age_us: u64,
}
