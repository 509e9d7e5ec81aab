//! Drift: whether a body that rests under a load creeps away when the load oscillates below
//! breakaway (thesis section 3.6.1, figure 3.27).
//!
//! The force rises beyond breakaway, so that the body slides; it falls well below the kinetic level
//! and rests there; then it oscillates in triangles about its mean. Real contacts deflect and come
//! back. A model whose bristles always yield a little, LuGre's, moves on with every cycle.
//!
//! Bristles without damping (Dahl, Armstrong-Helouvry) let the body ring on them for the whole run,
//! excited by every corner of the triangles. Its position at the end of a cycle then depends on the
//! phase of that ringing. The drift per cycle is therefore taken between weighted means, in which
//! the ringing all but vanishes.

use std::f64::consts::PI;

use friction_model::{Drive, Moment};
use serde::{Deserialize, Serialize};

use crate::settle::with_step;
use crate::thinned::Thinned;
use crate::{Contact, Evidence, Figure, TimeScales};

/// The force on the body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NonDriftSettings {
    /// Mass m \[kg or kg m^2\].
    pub inertia: f64,
    /// Force at the end of the ramp \[N or N m\], beyond breakaway.
    pub push: f64,
    /// Duration of the ramp \[s\].
    pub ramp: f64,
    /// Duration of the fall from `push` to `hold` \[s\].
    pub fall: f64,
    /// Force at which the body comes to rest, and mean of the triangles \[N or N m\]; below the
    /// kinetic level.
    pub hold: f64,
    /// Time at which the triangles start \[s\].
    pub start: f64,
    /// Amplitude of the triangles \[N or N m\].
    pub amplitude: f64,
    /// Their period \[s\].
    pub period: f64,
    /// Their number; 15 if it is less.
    pub cycles: u32,
    /// Integration step \[s\]; found by step halving if left out.
    pub step: Option<f64>,
}

impl Default for NonDriftSettings {
    /// 1 kg; 0 to 2 N in 1 s, down to 0.4 N in 10 ms, held to 6 s, then 40 triangles of 0.2 N about
    /// 0.4 N with 0.5 s.
    fn default() -> Self {
        Self {
            inertia: 1.0,
            push: 2.0,
            ramp: 1.0,
            fall: 0.01,
            hold: 0.4,
            start: 6.0,
            amplitude: 0.2,
            period: 0.5,
            cycles: 40,
            step: None,
        }
    }
}

impl NonDriftSettings {
    /// The applied force at `time` \[N or N m\]. Each triangle goes up first.
    #[must_use]
    pub fn force(&self, time: f64) -> f64 {
        if time <= self.ramp {
            self.push * time / self.ramp
        } else if time <= self.ramp + self.fall {
            self.push + (self.hold - self.push) * (time - self.ramp) / self.fall
        } else if time <= self.start {
            self.hold
        } else {
            let phase = ((time - self.start) / self.period).fract();
            // 0 -> 1 -> -1 -> 0 over a period.
            let triangle = 1.0 - (4.0 * (phase + 0.25).fract() - 2.0).abs();
            self.hold + self.amplitude * triangle
        }
    }
}

/// Drift of one model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NonDrift {
    /// Displacement from the end of the first cycle to the end of the last \[m or rad\]. Damped
    /// bristles creep for the first cycles until they have reached their closed loop, undamped ones
    /// ring: neither is drift.
    pub drift: f64,
    /// Mean displacement per cycle near the end \[m or rad\]: between the mean positions of the
    /// last five cycles and of the five that end ten cycles earlier, each weighted with half a
    /// squared sine.
    pub drift_per_cycle: f64,
    /// Range of the position in the last cycle \[m or rad\]: what the contact gives way and takes
    /// back.
    pub swing: f64,
    /// Position at the end of each cycle relative to the start of the triangles \[m or rad\].
    pub cycle_ends: Vec<f64>,
    /// The run from the start of the triangles on.
    pub course: NonDriftCourse,
    /// How well the figures are known.
    pub evidence: Evidence,
}

/// A thinned record of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NonDriftCourse {
    /// Time since the start of the triangles \[s\].
    pub time: Vec<f64>,
    /// Applied force \[N or N m\].
    pub force: Vec<f64>,
    /// Position relative to the start of the triangles \[m or rad\].
    pub position: Vec<f64>,
}

/// Cycles between the two means of the drift per cycle.
const APART: u32 = 10;

/// Cycles in each of them.
const AVERAGED: u32 = 5;

/// A mean over a window, weighted with a squared sine that is zero at both ends (Hann's window).
#[derive(Default)]
struct Mean {
    weighted: f64,
    weights: f64,
}

impl Mean {
    /// Takes the position at `phase` of the window, from 0 to 1; not outside.
    fn take(&mut self, phase: f64, position: f64) {
        if (0.0..=1.0).contains(&phase) {
            let weight = (PI * phase).sin().powi(2);
            self.weighted += weight * position;
            self.weights += weight;
        }
    }

    fn value(&self) -> f64 {
        self.weighted / self.weights
    }
}

/// Loads a body on `contact` and shakes it.
#[must_use]
pub fn non_drift(contact: &Contact, settings: &NonDriftSettings) -> NonDrift {
    let scales = TimeScales::of(contact);
    // The push accelerates for at most the ramp and the fall.
    let excess = (settings.push - scales.lowest_level).max(0.0);
    let fastest = 0.5 * excess * settings.ramp / settings.inertia;
    let first =
        scales.body(settings.inertia, fastest.max(f64::MIN_POSITIVE)).min(0.002 * settings.period);
    let (mut result, evidence) = with_step(
        settings.step,
        first,
        |step| run(contact, settings, step),
        |result| {
            let NonDrift { drift, drift_per_cycle, swing, .. } = *result;
            // Where nothing drifts, rounding must not count: a millionth of the swing is no drift.
            vec![
                Figure { value: drift, scale: 1e-2 * swing },
                Figure { value: drift_per_cycle, scale: 1e-4 * swing },
                Figure::relative(swing),
            ]
        },
    );
    result.evidence = evidence;
    result
}

fn run(contact: &Contact, settings: &NonDriftSettings, step: f64) -> NonDrift {
    // Steps end where the force bends: at the end of the ramp, of the fall, and of every quarter of
    // a triangle.
    let mut body = contact.body(settings.inertia);
    let drive = |at: &Moment<1>| Drive { force: settings.force(at.time), rates: [0.0] };
    let mut go = |duration: f64, each: &mut dyn FnMut(&Moment<1>)| {
        let steps = (duration / step).ceil().max(1.0);
        for _ in 0..steps as usize {
            body.advance(duration / steps, &drive);
            each(body.moment());
        }
        *body.moment()
    };
    let NonDriftSettings { ramp, fall, start, period, .. } = *settings;
    go(ramp, &mut |_| {});
    go(fall, &mut |_| {});
    let origin = go(start - ramp - fall, &mut |_| {});
    let mut course = Thinned::new();
    course.offer([0.0, settings.hold, 0.0]);
    let mut cycle_ends = Vec::new();
    let mut swing = 0.0;
    let cycles = settings.cycles.max(APART + AVERAGED);
    let (mut earlier, mut latest) = (Mean::default(), Mean::default());
    for _ in 0..cycles {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut end = 0.0;
        for _ in 0..4 {
            let at = go(0.25 * period, &mut |at| {
                let position = at.position - origin.position;
                (low, high) = (low.min(position), high.max(position));
                let to_go = f64::from(cycles) - (at.time - origin.time) / period;
                latest.take(1.0 - to_go / f64::from(AVERAGED), position);
                earlier.take(1.0 - (to_go - f64::from(APART)) / f64::from(AVERAGED), position);
                course.offer([at.time - origin.time, settings.force(at.time), position]);
            });
            end = at.position - origin.position;
        }
        cycle_ends.push(end);
        swing = high - low;
    }
    let last = cycle_ends.last().copied().unwrap_or(0.0);
    let first = cycle_ends.first().copied().unwrap_or(0.0);
    let [time, force, position] = course.columns();
    NonDrift {
        drift: last - first,
        drift_per_cycle: (latest.value() - earlier.value()) / f64::from(APART),
        swing,
        cycle_ends,
        course: NonDriftCourse { time, force, position },
        evidence: Evidence { step, change: None },
    }
}
