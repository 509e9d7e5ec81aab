//! The voltage at which an axis at rest begins to move.

use serde::Serialize;

use crate::conditioning::Conditioned;

/// One start of motion out of rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Breakaway {
    /// When, since the recording's first sample \[s\].
    pub time: f64,
    /// Voltage at the last moment of rest \[V\].
    pub voltage: f64,
    /// Direction of the motion that followed, 1 or -1.
    pub direction: f64,
}

/// How long the axis must have rested \[s\].
const REST: f64 = 0.1;
/// Fastest change of the voltage that counts as slow \[V/s\]: a step would overshoot the deadband.
const SLOW: f64 = 3.0;

/// All starts of motion in a recording whose force is the voltage: at least .1 s below a hundredth of the largest speed while the voltage changes by less
/// than 3 V/s, then at once beyond five hundredths.
pub fn breakaways(recording: &Conditioned) -> Vec<Breakaway> {
    let Conditioned { velocity, force, time_step, first, .. } = recording;
    let fastest = velocity.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    let (still, moving) = (0.01 * fastest, 0.05 * fastest);
    let rest = (REST / time_step).ceil() as usize;
    let mut found = Vec::new();
    // First sample of the present rest, and the last sample at which it was still.
    let mut since: Option<(usize, usize)> = None;
    for (k, v) in velocity.iter().enumerate() {
        if v.abs() < still {
            since = Some(since.map_or((k, k), |(start, _)| (start, k)));
        } else if v.abs() > moving {
            if let Some((start, last)) = since.take().filter(|(start, last)| last - start >= rest) {
                let span = rest.min(last - start);
                let (Some(&now), Some(&before)) = (force.get(last), force.get(last - span)) else { continue };
                let slow = (now - before).abs() / (span as f64 * time_step) < SLOW;
                let direction = v.signum();
                if slow && now * direction > 0.0 && k - last < rest {
                    let time = (first + last) as f64 * time_step;
                    found.push(Breakaway { time, voltage: now, direction });
                }
                let _ = start;
            }
        }
    }
    found
}
