//! Friction of a position-controlled axis from its stiction limit cycle: it rests, lets go, slides,
//! and rests again.
//!
//! Where only the motor voltage is recorded, friction comes out in volts: the voltage that holds it
//! in balance at rest. [`segment()`] finds rest and sliding in a quantised angle, [`breakaways`] the
//! voltage at which the axis let go, [`slip_friction()`] what holds while it slides.

pub mod segment;
pub mod slip_friction;

use serde::Serialize;

use crate::IdentError;
use crate::estimate::{Estimate, Interval, IntervalMethod, Verdict};
use crate::parameter_id::ParameterId;
use crate::statistics::{Quartiles, rank_of_95, sorted};
pub use segment::{Phase, PhaseKind, segment};
pub use slip_friction::{SlipFriction, SlipOptions, slip_friction};

/// A recording of one axis, evenly sampled; the channels have one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StictionRecording<'a> {
    /// Sampling period \[s\].
    pub time_step: f64,
    /// Angle of the axis \[rad\], quantised.
    pub angle: &'a [f64],
    /// One count of the encoder \[rad\].
    pub resolution: f64,
    /// Voltage on the motor \[V\].
    pub voltage: &'a [f64],
    /// Angle of a pendulum that the axis carries \[rad\], zero where it pushes the axis nowhere.
    pub pendulum: Option<&'a [f64]>,
}

impl StictionRecording<'_> {
    /// Samples.
    pub fn samples(&self) -> usize {
        self.angle.len()
    }

    /// Checks lengths and numbers.
    ///
    /// # Errors
    /// [`IdentError`] with what is wrong.
    pub fn check(&self) -> Result<(), IdentError> {
        if !(self.time_step > 0.0 && self.time_step.is_finite()) {
            return Err(IdentError::TimeStep(self.time_step));
        }
        if !(self.resolution > 0.0 && self.resolution.is_finite()) {
            return Err(IdentError::Resolution(self.resolution));
        }
        let expected = self.voltage.len();
        let channels = [
            ("the angle", Some(self.angle)),
            ("the pendulum", self.pendulum),
            ("the voltage", Some(self.voltage)),
        ];
        for (channel, values) in
            channels.into_iter().filter_map(|(name, values)| Some((name, values?)))
        {
            if values.len() != expected {
                return Err(IdentError::UnequalLengths { channel, found: values.len(), expected });
            }
            if let Some((index, &value)) =
                values.iter().enumerate().find(|(_, value)| !crate::finite::usable(**value))
            {
                return Err(IdentError::NotFinite { channel, index, value });
            }
        }
        Ok(())
    }
}

/// An axis that let go.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Breakaway {
    /// Sample of the first count of motion.
    pub index: usize,
    /// Direction of the motion, 1 or -1.
    pub direction: f64,
    /// How long it had rested \[s\].
    pub rest: f64,
    /// Greatest voltage towards the motion, from the last stretch of rest to the first count of
    /// motion \[V\].
    pub voltage: f64,
    /// Greatest voltage towards the motion that it withstood earlier in the same rest \[V\]; may be
    /// negative.
    pub withstood: f64,
}

/// How breakaways are read off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BreakawayOptions {
    /// Rest shorter than this does not count \[s\].
    pub shortest_rest: f64,
    /// The voltage is looked for this long before the first count \[s\]: the time it takes to turn
    /// by one count.
    pub look_back: f64,
}

impl Default for BreakawayOptions {
    /// 40 ms of rest, 30 ms back.
    fn default() -> Self {
        Self { shortest_rest: 0.04, look_back: 0.03 }
    }
}

/// The breakaways between `phases`, which [`segment()`] found in the same recording.
pub fn breakaways(
    recording: &StictionRecording,
    phases: &[Phase],
    options: &BreakawayOptions,
) -> Vec<Breakaway> {
    let look = (options.look_back / recording.time_step).round() as usize;
    let mut found = Vec::new();
    for pair in phases.windows(2) {
        let (stick, slip) = (pair[0], pair[1]);
        let PhaseKind::Slip { direction } = slip.kind else { continue };
        let rest = (stick.end - stick.start) as f64 * recording.time_step;
        if stick.kind != PhaseKind::Stick || rest < options.shortest_rest {
            continue;
        }
        let greatest = |range: std::ops::Range<usize>| {
            let values = recording.voltage.get(range).unwrap_or(&[]);
            values.iter().map(|u| u * direction).fold(f64::NEG_INFINITY, f64::max)
        };
        let from = slip.start.saturating_sub(look).max(stick.start);
        let voltage = greatest(from..slip.start + 1);
        let withstood = greatest(stick.start..from);
        if voltage.is_finite() {
            found.push(Breakaway { index: slip.start, direction, rest, voltage, withstood });
        }
    }
    found
}

/// The median of repeated voltages with the 95 % interval of the median that their ranks give,
/// whatever their distribution (David and Nagaraja 2003, Order Statistics, section 7.1). Below six
/// values no ranks enclose 95 %: the verdict says so.
pub fn median(id: ParameterId, values: &[f64], remedy: &'static str) -> Option<Estimate> {
    let middle = Quartiles::of(values)?.median;
    let sorted = sorted(values.iter().copied());
    let n = sorted.len();
    let interval = rank_of_95(n).and_then(|k| {
        Some(Interval {
            low: *sorted.get(k)?,
            high: *sorted.get(n - 1 - k)?,
            method: IntervalMethod::Ranks,
        })
    });
    let verdict = match interval {
        Some(interval) if interval.low > 0.0 => Verdict::Identified,
        _ => Verdict::NotIdentifiable { doubt: crate::Doubt::Unrepeated, remedy },
    };
    Some(Estimate { id, unit: "V", value: middle, standard_error: None, interval, verdict })
}
