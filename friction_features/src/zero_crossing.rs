//! Reversal: what friction does while the velocity passes through zero (thesis section 3.6.2,
//! figure 3.36a).
//!
//! The contact slides backward steadily, then the velocity rises at constant acceleration to the
//! same speed forward. Static models change sign at once. Contacts with bristles unload and load
//! them first. Without damping the force follows the displacement alone, so the way from the turn
//! to forward sliding is the same at every acceleration (Dahl: `F_c ln 2 / sigma0` to zero force).
//! Damped bristles carry `sigma v` besides, which establishes the forward force the earlier the
//! faster the reversal, and may overshoot it.

use serde::{Deserialize, Serialize};

use crate::settle::with_step;
use crate::thinned::Thinned;
use crate::{Contact, Evidence, Figure, TimeScales};

/// The motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ZeroCrossingSettings {
    /// Speed before and after \[m/s or rad/s\].
    pub speed: f64,
    /// Accelerations \[m/s^2 or rad/s^2\].
    pub accelerations: Vec<f64>,
    /// Time at constant speed before and after the ramp \[s\].
    pub hold: f64,
    /// Forward friction counts as established at this share of the kinetic level.
    pub level: f64,
    /// Integration step \[s\]; found by step halving for each acceleration if left out.
    pub step: Option<f64>,
}

impl Default for ZeroCrossingSettings {
    /// From -0.05 to 0.05 m/s at 0.1 and at 1 m/s^2, held for 2 s before and after; established at
    /// 90 %.
    fn default() -> Self {
        Self { speed: 0.05, accelerations: vec![0.1, 1.0], hold: 2.0, level: 0.9, step: None }
    }
}

/// Reversal of one model at one acceleration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ZeroCrossing {
    /// Acceleration \[m/s^2 or rad/s^2\].
    pub acceleration: f64,
    /// Friction at the instant at which the velocity is zero \[N or N m\]: what the bristles still
    /// hold.
    pub friction_at_turn: f64,
    /// Displacement from the turn to where friction is zero \[m or rad\]; negative if that is
    /// before the turn, `None` if it never is.
    pub displacement_to_zero: Option<f64>,
    /// Displacement from the turn to where friction without its viscous part reaches the level of
    /// forward sliding \[m or rad\]; `None` if it never does, or if the model has no such level.
    pub displacement_to_sliding: Option<f64>,
    /// Time from the turn to there \[s\].
    pub time_to_sliding: Option<f64>,
    /// Largest friction after the turn \[N or N m\].
    pub friction_max: f64,
    /// Largest rate of change of the friction in the whole run \[N/s or N m/s\]; `None` if it grows
    /// without bound as the step shrinks: a jump.
    pub steepest: Option<f64>,
    /// From the start of the ramp on.
    pub course: ZeroCrossingCourse,
    /// How well the figures are known.
    pub evidence: Evidence,
}

/// A thinned record of the reversal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ZeroCrossingCourse {
    /// Time since the turn \[s\].
    pub time: Vec<f64>,
    /// Displacement since the turn \[m or rad\].
    pub displacement: Vec<f64>,
    /// Velocity \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Friction \[N or N m\].
    pub friction: Vec<f64>,
}

/// Reverses `contact` at each of the accelerations.
#[must_use]
pub fn zero_crossing(contact: &Contact, settings: &ZeroCrossingSettings) -> Vec<ZeroCrossing> {
    let scales = TimeScales::of(contact);
    settings
        .accelerations
        .iter()
        .map(|&acceleration| {
            let ramp = settings.speed / acceleration;
            let first = (0.5 * scales.prescribed(settings.speed)).min(1e-3 * ramp);
            let level = (scales.lowest_level > 0.0).then_some(settings.level * scales.lowest_level);
            let go = |step| run(contact, settings, acceleration, level, step);
            let scale = 1e-2 * settings.speed * ramp;
            let (mut result, evidence) = with_step(settings.step, first, go, |result| {
                let way = |value: Option<f64>| value.map(|value| Figure { value, scale });
                let force = |value| Figure { value, scale: 1e-2 * scales.highest_level };
                [force(result.friction_at_turn), force(result.friction_max)]
                    .into_iter()
                    .chain(way(result.displacement_to_zero))
                    .chain(way(result.displacement_to_sliding))
                    .collect()
            });
            let finer = go(0.5 * evidence.step).steepest;
            let bounded = |a: f64, b: f64| (b - a).abs() < 0.2 * a;
            result.steepest =
                result.steepest.zip(finer).filter(|&(a, b)| bounded(a, b)).map(|(_, b)| b);
            if contact.holding(0.0).is_some() {
                // The jump lies somewhere in the step that begins at the turn.
                result.displacement_to_zero = Some(0.0);
                result.displacement_to_sliding = Some(0.0);
                result.time_to_sliding = Some(0.0);
            }
            result.evidence = evidence;
            result
        })
        .collect()
}

fn run(
    contact: &Contact,
    settings: &ZeroCrossingSettings,
    acceleration: f64,
    level: Option<f64>,
    step: f64,
) -> ZeroCrossing {
    let &ZeroCrossingSettings { speed, hold, .. } = settings;
    let ramp = speed / acceleration;
    let half = (ramp / step).ceil();
    let dt = ramp / half;
    let holding = (hold / dt).ceil() as usize;
    let half = half as usize;
    // Time, velocity and displacement since the turn, `k` half steps after the ramp's start.
    let at = |k: usize| {
        let time = 0.5 * dt * (k as f64 - 2.0 * half as f64);
        let within = time.clamp(-ramp, ramp);
        let beyond = time - within;
        (time, acceleration * within, 0.5 * acceleration * within * within + speed * beyond.abs())
    };
    let mut motion = contact.prescribed();
    for _ in 0..holding {
        motion.step([-speed; 3], dt);
    }
    let mut course = Thinned::new();
    let mut before = motion.force(-speed);
    course.offer([at(0).0, at(0).2, -speed, before]);
    let mut friction_at_turn = before;
    let (mut zero, mut sliding) = (None, None);
    let mut friction_max = f64::NEG_INFINITY;
    let mut steepest = 0.0f64;
    for k in 0..2 * half + holding {
        let velocities = [at(2 * k).1, at(2 * k + 1).1, at(2 * k + 2).1];
        let force = motion.step(velocities, dt);
        let (time, velocity, displacement) = at(2 * k + 2);
        steepest = steepest.max((force - before).abs() / dt);
        // The crossing lies between the samples in proportion to the force.
        let crossing = |share: f64| {
            let (time_before, _, displacement_before) = at(2 * k);
            let place = displacement_before + share * (displacement - displacement_before);
            (place.copysign(time), time_before + share * dt)
        };
        if zero.is_none() && before < 0.0 && force >= 0.0 {
            zero = Some(crossing(-before / (force - before)));
        }
        let (slid_before, slid) =
            (before - contact.viscous(velocities[0]), force - contact.viscous(velocity));
        if let Some(level) = level
            && sliding.is_none()
            && slid_before < level
            && slid >= level
        {
            sliding = Some(crossing((level - slid_before) / (slid - slid_before)));
        }
        if k + 1 == half {
            friction_at_turn = force;
        }
        if k >= half {
            friction_max = friction_max.max(force);
        }
        course.offer([time, displacement, velocity, force]);
        before = force;
    }
    let [time, displacement, velocity, friction] = course.columns();
    ZeroCrossing {
        acceleration,
        friction_at_turn,
        displacement_to_zero: zero.map(|(place, _)| place),
        displacement_to_sliding: sliding.map(|(place, _)| place),
        time_to_sliding: sliding.map(|(_, time)| time),
        friction_max,
        steepest: Some(steepest),
        course: ZeroCrossingCourse { time, displacement, velocity, friction },
        evidence: Evidence { step: dt, change: None },
    }
}
