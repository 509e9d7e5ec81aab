//! Breakaway: a body at rest is loaded at a constant force rate until it slides (thesis section
//! 3.6.2, figure 3.37).
//!
//! Two measures are in use, and they disagree about what the rate does:
//!
//! * the largest friction before the body has moved 2 cm, and the displacement at which it occurs.
//!   It falls with the rate: while the contact breaks away the body gains speed, and friction is
//!   already on the falling part of the Stribeck curve;
//! * the applied force when the velocity first exceeds a threshold. It holds the inertia force as
//!   well, and whether it rises or falls with the rate depends on the Stribeck velocity.

use friction_model::{Drive, Moment};
use serde::{Deserialize, Serialize};

use crate::settle::with_step;
use crate::thinned::Thinned;
use crate::{Contact, Evidence, Figure, TimeScales};

/// The load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BreakawaySettings {
    /// Mass m \[kg or kg m^2\].
    pub inertia: f64,
    /// Force rates \[N/s or N m/s\].
    pub rates: Vec<f64>,
    /// Force at the end of the ramp \[N or N m\], then held.
    pub limit: f64,
    /// The largest friction is looked for up to this displacement \[m or rad\].
    pub within: f64,
    /// Velocity that counts as sliding \[m/s or rad/s\].
    pub threshold: f64,
    /// Integration step \[s\]; found by step halving for each rate if left out.
    pub step: Option<f64>,
}

impl Default for BreakawaySettings {
    /// 1 kg; 0.05, 0.1 and 0.2 N/s up to 1.8 N; within 2 cm; 1 mm/s.
    fn default() -> Self {
        Self {
            inertia: 1.0,
            rates: vec![0.05, 0.1, 0.2],
            limit: 1.8,
            within: 0.02,
            threshold: 1e-3,
            step: None,
        }
    }
}

/// Breakaway of one model at one force rate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Breakaway {
    /// Force rate \[N/s or N m/s\].
    pub rate: f64,
    /// Largest friction up to the displacement `within` \[N or N m\].
    pub friction_max: f64,
    /// Displacement at which friction is largest \[m or rad\]; `None` where friction has no peak,
    /// because it does not fall by a thousandth of its largest value afterwards. Zero for models
    /// that hold without pre-sliding.
    pub displacement: Option<f64>,
    /// Applied force when the velocity first exceeds the threshold \[N or N m\]; `None` if it never
    /// does.
    pub applied_at_threshold: Option<f64>,
    /// The run up to the displacement `within`.
    pub course: BreakawayCourse,
    /// How well the figures are known.
    pub evidence: Evidence,
}

/// A record of the run with a point for every 300th of the load or of the displacement, thinned to
/// at most 500.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BreakawayCourse {
    /// Applied force \[N or N m\].
    pub applied: Vec<f64>,
    /// Displacement \[m or rad\].
    pub displacement: Vec<f64>,
    /// Velocity \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Friction \[N or N m\].
    pub friction: Vec<f64>,
}

/// Loads a body on `contact` at each of the rates.
#[must_use]
pub fn breakaway(contact: &Contact, settings: &BreakawaySettings) -> Vec<Breakaway> {
    let scales = TimeScales::of(contact);
    settings.rates.iter().map(|&rate| at_rate(contact, settings, &scales, rate)).collect()
}

fn at_rate(
    contact: &Contact,
    settings: &BreakawaySettings,
    scales: &TimeScales,
    rate: f64,
) -> Breakaway {
    // The velocity that the whole excess of a load a fifth above breakaway would give over the
    // whole displacement: twice what it comes to. So the first step is short of the limit of
    // stability, and the second is accurate.
    let load = settings.limit.min(1.2 * scales.highest_level);
    let excess = (load - scales.lowest_level).max(0.0);
    let fastest =
        (0.5 * excess * settings.within / settings.inertia).sqrt().max(settings.threshold);
    let first =
        scales.body(settings.inertia, fastest).min(1e-3 * load.max(0.1 * settings.limit) / rate);
    let (mut result, evidence) = with_step(
        settings.step,
        first,
        |step| run(contact, settings, rate, step),
        |result| {
            let Breakaway { friction_max, displacement, applied_at_threshold, .. } = *result;
            let scale = 1e-2 * settings.within;
            let displacement = displacement.map(|value| Figure { value, scale });
            let applied = applied_at_threshold.map(Figure::relative);
            [Figure::relative(friction_max)]
                .into_iter()
                .chain(displacement)
                .chain(applied)
                .collect()
        },
    );
    result.evidence = evidence;
    if contact.holding(rate).is_some() {
        // Breakaway is an event there; the body has moved by a fraction of the step it falls in.
        result.displacement = result.displacement.map(|_| 0.0);
    }
    result
}

/// A body that holds the limit for this long without moving will not move \[s\].
const PATIENCE: f64 = 10.0;

fn run(contact: &Contact, settings: &BreakawaySettings, rate: f64, step: f64) -> Breakaway {
    let applied = |at: &Moment<1>| (rate * at.time).min(settings.limit);
    let steps = ((settings.limit / rate + PATIENCE) / step).ceil() as usize;
    let mut body = contact.body(settings.inertia);
    let mut peak = Peak::default();
    let mut applied_at_threshold = None;
    let mut before = (0.0, 0.0);
    let mut record = Record {
        rows: Thinned::new(),
        last: None,
        force: settings.limit / 300.0,
        way: settings.within / 300.0,
    };
    for _ in 0..=steps {
        let at = *body.moment();
        let (load, near) = (applied(&at), at.position < settings.within);
        if near {
            let friction = body.friction(load);
            peak.take(at.position, friction);
            record.take([load, at.position, at.velocity, friction]);
        }
        if applied_at_threshold.is_none() && at.velocity > settings.threshold {
            let (velocity, load_before) = before;
            let share = (settings.threshold - velocity) / (at.velocity - velocity);
            applied_at_threshold = Some(load_before + share * (load - load_before));
        }
        if !near && applied_at_threshold.is_some() {
            break;
        }
        before = (at.velocity, load);
        body.advance(step, &|at| Drive { force: applied(at), rates: [0.0] });
    }
    let [applied, displacement, velocity, friction] = record.rows.columns();
    Breakaway {
        rate,
        friction_max: peak.friction,
        displacement: (peak.latest < 0.999 * peak.friction).then_some(peak.displacement),
        applied_at_threshold,
        course: BreakawayCourse { applied, displacement, velocity, friction },
        evidence: Evidence { step, change: None },
    }
}

/// The largest friction and where it was, between samples by the parabola through three of them.
#[derive(Debug, Default)]
struct Peak {
    friction: f64,
    displacement: f64,
    /// Friction of the last sample, and the two samples before the next.
    latest: f64,
    samples: [Option<(f64, f64)>; 2],
}

impl Peak {
    fn take(&mut self, x2: f64, f2: f64) {
        if f2 > self.friction {
            (self.friction, self.displacement) = (f2, x2);
        } else if let [Some((x0, f0)), Some((x1, f1))] = self.samples
            && f1 == self.friction
            && f0 < f1
            && f2 < f1
        {
            // The body has just passed the largest friction so far.
            let (rise, fall) = (f1 - f0, f1 - f2);
            let shift = 0.5 * (rise - fall) / (rise + fall);
            self.displacement = x1 + shift * if shift > 0.0 { x2 - x1 } else { x1 - x0 };
        }
        self.latest = f2;
        self.samples = [self.samples[1], Some((x2, f2))];
    }
}

/// Rows that differ enough from the last one to be seen.
struct Record {
    rows: Thinned<4>,
    last: Option<[f64; 4]>,
    force: f64,
    way: f64,
}

impl Record {
    fn take(&mut self, row: [f64; 4]) {
        let seen = self.last.is_none_or(|last| {
            (row[1] - last[1]).abs() >= self.way || (row[3] - last[3]).abs() >= self.force
        });
        if seen {
            self.rows.offer(row);
            self.last = Some(row);
        }
    }
}
