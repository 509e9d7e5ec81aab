//! Frictional lag: friction at changing speed follows the Stribeck curve late, so that force
//! against velocity is a loop (thesis section 4.6.4; Hess and Soom 1990).
//!
//! The velocity is `v = mean - amplitude cos(w t)`, always forward. The area of the loop is
//! `int F dv` over a period: positive when friction is higher while the speed grows than while it
//! falls, as measured contacts show it. The viscous term contributes nothing. A loop that crosses
//! itself is wide in one direction at low and in the other at high speed.
//!
//! For a level that relaxes with the time constant `tau` (Xiong, the proposed model) the answer is
//! exact: with `g_1` the first cosine coefficient of `g(v(t))` the area is
//! `pi amplitude g_1 w tau / (1 + (w tau)^2)`.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::settle::with_step;
use crate::{Contact, Evidence, Figure, TimeScales};

/// The motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FrictionalLagSettings {
    /// Mean velocity \[m/s or rad/s\].
    pub mean: f64,
    /// Amplitude of the velocity \[m/s or rad/s\], below the mean.
    pub amplitude: f64,
    /// Angular frequencies w \[rad/s\].
    pub frequencies: Vec<f64>,
    /// Number of periods, of which the last counts.
    pub periods: u32,
    /// Integration step \[s\]; found by step halving for each frequency if left out.
    pub step: Option<f64>,
}

impl Default for FrictionalLagSettings {
    /// The test bed's: 1 - 0.95 cos(w t) rad/s at 1, 2, 5 and 10 rad/s, the last of four periods.
    fn default() -> Self {
        Self {
            mean: 1.0,
            amplitude: 0.95,
            frequencies: vec![1.0, 2.0, 5.0, 10.0],
            periods: 4,
            step: None,
        }
    }
}

impl FrictionalLagSettings {
    /// For the parameters of the thesis's chapter 3: 0.02 (1 - 0.95 cos 2t) m/s.
    #[must_use]
    pub fn chapter_3() -> Self {
        Self { mean: 0.02, amplitude: 0.019, frequencies: vec![2.0], ..Self::default() }
    }
}

/// Frictional lag of one model at one frequency. Exactly zero for a model whose force depends on
/// the velocity alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrictionalLag {
    /// Angular frequency \[rad/s\].
    pub frequency: f64,
    /// Area of the loop \[W\], force times velocity.
    pub area: f64,
    /// Largest excess of the friction while the speed grows over that at the same speed while it
    /// falls \[N or N m\].
    pub widest: f64,
    /// Smallest such excess \[N or N m\]: negative where the loop runs backwards; of another sign
    /// than `widest` if it crosses itself.
    pub narrowest: f64,
    /// The last period.
    pub course: FrictionalLagCourse,
    /// How well the figures are known.
    pub evidence: Evidence,
}

/// A thinned record of the last period.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrictionalLagCourse {
    /// Velocity \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Friction at that velocity while the speed grows \[N or N m\].
    pub growing: Vec<f64>,
    /// Friction at that velocity while the speed falls \[N or N m\].
    pub falling: Vec<f64>,
}

/// Moves `contact` forward at changing speed.
#[must_use]
pub fn frictional_lag(contact: &Contact, settings: &FrictionalLagSettings) -> Vec<FrictionalLag> {
    let scales = TimeScales::of(contact);
    settings
        .frequencies
        .iter()
        .map(|&omega| at_frequency(contact, settings, &scales, omega))
        .collect()
}

fn at_frequency(
    contact: &Contact,
    settings: &FrictionalLagSettings,
    scales: &TimeScales,
    omega: f64,
) -> FrictionalLag {
    let fastest = settings.mean + settings.amplitude;
    let first = scales.prescribed(fastest).min(TAU / omega / 2000.0);
    let level = scales.highest_level.max(contact.steady_state(fastest).abs());
    let (mut result, evidence) = with_step(
        settings.step,
        first,
        |step| run(contact, settings, omega, step),
        |result| {
            let width = |value| Figure { value, scale: 1e-4 * level };
            vec![
                Figure { value: result.area, scale: 1e-4 * level * settings.amplitude },
                width(result.widest),
                width(result.narrowest),
            ]
        },
    );
    result.evidence = evidence;
    result
}

fn run(
    contact: &Contact,
    settings: &FrictionalLagSettings,
    omega: f64,
    step: f64,
) -> FrictionalLag {
    let half = (PI / omega / step).ceil() as usize;
    let steps = 2 * half;
    let dt = TAU / omega / steps as f64;
    // Velocity after `k` half steps. Taken from the first half period for both, so that the two
    // branches meet the same numbers.
    let velocity = |k: usize| {
        let phase = PI * (k.min(2 * steps - k)) as f64 / steps as f64;
        settings.mean - settings.amplitude * phase.cos()
    };
    let mut motion = contact.prescribed();
    let mut friction = Vec::with_capacity(steps + 1);
    friction.push(motion.force(velocity(0)));
    for _ in 0..settings.periods.max(1) {
        let last = friction.pop();
        friction.clear();
        friction.extend(last);
        for k in 0..steps {
            friction
                .push(motion.step([velocity(2 * k), velocity(2 * k + 1), velocity(2 * k + 2)], dt));
        }
    }
    // At the turns both branches have the same velocity but the force is one: no width there.
    let (mut area, mut widest, mut narrowest) = (0.0, 0.0f64, 0.0f64);
    for k in 1..half {
        let width = friction[k] - friction[steps - k];
        area += width * settings.amplitude * omega * (omega * dt * k as f64).sin() * dt;
        (widest, narrowest) = (widest.max(width), narrowest.min(width));
    }
    let stride = half.div_ceil(400);
    let [mut at, mut growing, mut falling] = [const { Vec::new() }; 3];
    for k in (0..=half).step_by(stride) {
        at.push(velocity(2 * k));
        growing.push(friction[k]);
        falling.push(friction[steps - k]);
    }
    FrictionalLag {
        frequency: omega,
        area,
        widest,
        narrowest,
        course: FrictionalLagCourse { velocity: at, growing, falling },
        evidence: Evidence { step: dt, change: None },
    }
}
