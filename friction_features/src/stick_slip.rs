//! Stick-slip: a mass on a spring whose end is pulled at constant speed (thesis section 3.5.1,
//! figure 3.7).
//!
//! ```text
//! m x'' = K (v0 t - x) - F
//! ```
//!
//! While the mass sticks the spring is stretched; at breakaway friction falls to its kinetic level
//! and the mass jumps ahead until the spring is slack enough for it to stick again. Between two
//! levels `F_s > F_c` without memory (`v_s -> 0`) the cycle is known in closed form, with
//! `a = (F_s - F_c) / K` and `w = sqrt(K / m)`:
//!
//! ```text
//! t_slip = (2 pi - 2 atan(a w / v0)) / w,   t_stick = 2 (F_s - F_c) / (K v0),   v_peak = v0 + sqrt(a^2 w^2 + v0^2)
//! ```

use serde::{Deserialize, Serialize};

use crate::settle::with_step;
use crate::thinned::Thinned;
use crate::{Contact, Evidence, Figure, TimeScales};
use friction_model::{Drive, Moment};

/// The rig.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StickSlipSettings {
    /// Mass m \[kg or kg m^2\].
    pub inertia: f64,
    /// Stiffness K of the spring \[N/m or N m/rad\].
    pub stiffness: f64,
    /// Speed v0 of the spring's end \[m/s or rad/s\].
    pub speed: f64,
    /// Duration \[s\], from rest with the spring slack.
    pub duration: f64,
    /// Statistics are taken after this time \[s\].
    pub settling: f64,
    /// Integration step \[s\]; found by step halving if left out.
    pub step: Option<f64>,
}

impl Default for StickSlipSettings {
    /// The thesis's: 1 kg, 2 N/m, 0.1 m/s; 60 s of which the first 18 s do not count.
    fn default() -> Self {
        Self {
            inertia: 1.0,
            stiffness: 2.0,
            speed: 0.1,
            duration: 60.0,
            settling: 18.0,
            step: None,
        }
    }
}

/// What the mass ends up doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// It follows the spring's end at constant speed.
    Smooth,
    /// Its speed swings, but it does not stay at rest.
    Vibration,
    /// It rests and jumps in turns.
    StickSlip,
}

/// Stick-slip of one model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StickSlip {
    /// What the mass ends up doing.
    pub motion: Motion,
    /// Mean time between two jumps \[s\]; `None` if there are not two.
    pub period: Option<f64>,
    /// Share of a period in which the mass is slower than a tenth of the spring's end. A harmonic
    /// vibration that just comes to rest has 0.144.
    pub share_of_rest: Option<f64>,
    /// Largest force of the spring \[N or N m\].
    pub spring_max: f64,
    /// Smallest force of the spring \[N or N m\].
    pub spring_min: f64,
    /// Largest velocity of the mass \[m/s or rad/s\].
    pub velocity_max: f64,
    /// Largest friction \[N or N m\].
    pub friction_max: f64,
    /// The whole run.
    pub course: StickSlipCourse,
    /// How well the figures are known.
    pub evidence: Evidence,
}

/// A thinned record of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StickSlipCourse {
    /// Time \[s\].
    pub time: Vec<f64>,
    /// Force of the spring \[N or N m\].
    pub spring: Vec<f64>,
    /// Friction \[N or N m\].
    pub friction: Vec<f64>,
    /// Velocity of the mass \[m/s or rad/s\].
    pub velocity: Vec<f64>,
}

/// A velocity swing below this share of `v0` is no vibration.
const SMOOTH: f64 = 0.01;

/// More rest than this share of a period is sticking: the 0.144 of a harmonic vibration that
/// touches zero, and a margin.
const STICKING: f64 = 0.2;

/// Pulls a mass over `contact` by a spring.
#[must_use]
pub fn stick_slip(contact: &Contact, settings: &StickSlipSettings) -> StickSlip {
    let StickSlipSettings { inertia, stiffness, speed, duration, .. } = *settings;
    let scales = TimeScales::of(contact);
    // The peak velocity of the closed form, and a fraction of the rig's own oscillation; a small
    // one where sticking is an event at the end of a step.
    let omega = (stiffness / inertia).sqrt();
    let a = (scales.highest_level - scales.lowest_level) / stiffness;
    let fastest = speed + (a * omega).hypot(speed);
    let fraction = if contact.holding(0.0).is_some() { 2.5e-4 } else { 1.25e-2 };
    let first = scales.body(inertia, fastest).min(fraction / omega).min(duration);
    let force = |at: &Moment<1>| stiffness * (speed * at.time - at.position);
    let (mut result, evidence) = with_step(
        settings.step,
        first,
        |step| run(contact, settings, step, &force),
        |result| {
            let period = result.period.map(Figure::relative);
            [result.spring_max, result.spring_min, result.velocity_max, result.friction_max]
                .map(Figure::relative)
                .into_iter()
                .chain(period)
                .collect()
        },
    );
    result.evidence = evidence;
    result
}

fn run(
    contact: &Contact,
    settings: &StickSlipSettings,
    step: f64,
    force: &dyn Fn(&Moment<1>) -> f64,
) -> StickSlip {
    let StickSlipSettings { inertia, speed, duration, settling, .. } = *settings;
    let steps = (duration / step).ceil() as usize;
    let h = duration / steps as f64;
    let mut body = contact.body(inertia);
    let mut course = Thinned::new();
    let mut spring = Range::default();
    let mut velocity = Range::default();
    let mut friction = Range::default();
    let mut jumps = Jumps::new(speed);
    for k in 0..=steps {
        let at = *body.moment();
        let applied = force(&at);
        let opposing = body.friction(applied);
        course.offer([at.time, applied, opposing, at.velocity]);
        if k as f64 * h >= settling {
            spring.take(applied);
            velocity.take(at.velocity);
            friction.take(opposing);
            jumps.take(at.time, at.velocity, h);
        }
        body.advance(h, &|at| Drive { force: force(at), rates: [0.0] });
    }
    let period = jumps.period();
    let share_of_rest = jumps.share_of_rest();
    let motion = if velocity.max - velocity.min < SMOOTH * speed {
        Motion::Smooth
    } else if share_of_rest.is_some_and(|share| share > STICKING) {
        Motion::StickSlip
    } else {
        Motion::Vibration
    };
    let smooth = motion == Motion::Smooth;
    let [time, spring_course, friction_course, velocity_course] = course.columns();
    StickSlip {
        motion,
        period: period.filter(|_| !smooth),
        share_of_rest: share_of_rest.filter(|_| !smooth),
        spring_max: spring.max,
        spring_min: spring.min,
        velocity_max: velocity.max,
        friction_max: friction.max,
        course: StickSlipCourse {
            time,
            spring: spring_course,
            friction: friction_course,
            velocity: velocity_course,
        },
        evidence: Evidence { step, change: None },
    }
}

/// Smallest and largest of a row of numbers.
struct Range {
    min: f64,
    max: f64,
}

impl Default for Range {
    fn default() -> Self {
        Self { min: f64::INFINITY, max: f64::NEG_INFINITY }
    }
}

impl Range {
    fn take(&mut self, value: f64) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
    }
}

/// Times at which the velocity rises through `v0`, each after a fall below `v0 / 2`.
struct Jumps {
    speed: f64,
    armed: bool,
    before: Option<f64>,
    /// First and last such time \[s\], and the number of them.
    first: f64,
    last: f64,
    count: u32,
    /// Time at rest since the first jump, and up to the last one \[s\].
    rest: f64,
    rest_at_last: f64,
}

impl Jumps {
    const fn new(speed: f64) -> Self {
        Self {
            speed,
            armed: false,
            before: None,
            first: 0.0,
            last: 0.0,
            count: 0,
            rest: 0.0,
            rest_at_last: 0.0,
        }
    }

    fn take(&mut self, time: f64, velocity: f64, h: f64) {
        if velocity < 0.5 * self.speed {
            self.armed = true;
        }
        if let Some(before) = self.before
            && self.armed
            && before < self.speed
            && velocity >= self.speed
        {
            let at = time - h * (velocity - self.speed) / (velocity - before);
            if self.count == 0 {
                self.first = at;
                self.rest = 0.0;
            }
            (self.last, self.rest_at_last) = (at, self.rest);
            self.count += 1;
            self.armed = false;
        }
        if velocity.abs() < 0.1 * self.speed {
            self.rest += h;
        }
        self.before = Some(velocity);
    }

    fn period(&self) -> Option<f64> {
        (self.count >= 2).then(|| (self.last - self.first) / f64::from(self.count - 1))
    }

    fn share_of_rest(&self) -> Option<f64> {
        (self.count >= 2).then(|| self.rest_at_last / (self.last - self.first))
    }
}
