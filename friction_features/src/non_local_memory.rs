//! Hysteresis with non-local memory: whether a contact in pre-sliding closes its inner loops,
//! forgets them once closed (wiping-out), and gives loops between the same displacements the same
//! shape wherever they lie (congruency).
//!
//! The displacement is prescribed at constant speed between the turns
//!
//! ```text
//! 1, -0.5, 0.5, -0.1, 0.5, 0.8     times the amplitude
//! ```
//!
//! so that `0.5 -> -0.1 -> 0.5` is an inner loop. The speed must be the same everywhere: a change
//! of the damping force would look like a gap.
//!
//! * Closure gap: force at the second arrival at 0.5 minus that at the first, over the height of
//!   the loop (force at 0.5 minus force at -0.1).
//! * Wiping-out error: force at 0.8 minus the force there when the inner loop is left out
//!   (`1, -0.5, 0.8`).
//! * Congruency error: the loop between -0.1 and 0.3 is entered once on a rising outer branch and
//!   once on a falling one; the two rising legs may differ by a constant alone. The error is what
//!   else they differ by, over the height of a leg.

use friction_model::ModelName;
use serde::{Deserialize, Serialize};

use crate::settle::with_step;
use crate::thinned::Thinned;
use crate::{Contact, Evidence, Figure, TimeScales};

/// The displacement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NonLocalMemorySettings {
    /// Displacement A_1 of the first turn \[m or rad\]; where the virgin curve reaches `level` if
    /// left out.
    pub amplitude: Option<f64>,
    /// Share of the static level that the first turn reaches: nonlinear, but short of sliding.
    pub level: f64,
    /// Time for a displacement of A_1 \[s\].
    pub duration: f64,
    /// Integration step \[s\], found by step halving if left out. A tenth of `duration` is divided
    /// into equal steps of at most this size.
    pub step: Option<f64>,
}

impl NonLocalMemorySettings {
    /// The amplitudes with which the thesis's chapter 3 sets have been compared; the rule for
    /// models without one.
    #[must_use]
    pub fn chapter_3(name: ModelName) -> Self {
        let amplitude = match name {
            ModelName::LuGre | ModelName::ElastoPlastic => Some(2.4e-5),
            ModelName::Gms => Some(3e-3),
            ModelName::Xiong => Some(3e-5),
            ModelName::Proposed => Some(6e-4),
            _ => None,
        };
        Self { amplitude, ..Self::default() }
    }
}

impl Default for NonLocalMemorySettings {
    /// 10 s per amplitude; the first turn at 95 % of the static level, where the inner loop of an
    /// elasto-plastic contact is no longer elastic.
    fn default() -> Self {
        Self { amplitude: None, level: 0.95, duration: 10.0, step: None }
    }
}

/// Memory of one model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NonLocalMemory {
    /// Displacement A_1 of the first turn \[m or rad\].
    pub amplitude: f64,
    /// Force at each turn and at the end \[N or N m\].
    pub tips: [f64; 6],
    /// Force at the first arrival at 0.5 minus force at -0.1 \[N or N m\].
    pub loop_height: f64,
    /// Work that the inner loop takes up, `0.5 -> -0.1 -> 0.5` \[J\].
    pub loop_work: f64,
    /// How much the two legs of the inner loop differ by more than a constant, over its height.
    /// Zero if the contact is elastic there, apart from its damping: then neither a gap nor an
    /// error can show, and their absence says nothing.
    pub loop_opening: f64,
    /// Closure gap over the height of the loop.
    pub closure_gap: f64,
    /// Wiping-out error \[N or N m\].
    pub wiping_out_error: f64,
    /// Congruency error over the height of a leg.
    pub congruency_error: f64,
    /// How far apart the congruent loops lie, their mean distance in force \[N or N m\].
    pub congruency_distance: f64,
    /// Force along the turns.
    pub course: NonLocalMemoryCourse,
    /// How well the figures are known.
    pub evidence: Evidence,
}

/// A thinned record of the path with the inner loop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NonLocalMemoryCourse {
    /// Displacement \[m or rad\].
    pub displacement: Vec<f64>,
    /// Friction \[N or N m\].
    pub friction: Vec<f64>,
}

/// Turns in tenths of the amplitude.
const WITH_LOOP: [i32; 6] = [10, -5, 5, -1, 5, 8];
const WITHOUT_LOOP: [i32; 3] = [10, -5, 8];
/// The legs to compare are the fifth and the eighth.
const CONGRUENT: [i32; 8] = [10, -8, 3, -1, 3, 10, -1, 3];

/// Moves `contact` through nested loops. `None` for models without pre-sliding: they have no
/// displacement to remember.
#[must_use]
pub fn non_local_memory(
    contact: &Contact,
    settings: &NonLocalMemorySettings,
) -> Option<NonLocalMemory> {
    let scales = TimeScales::of(contact);
    if scales.stiffness <= 0.0 || scales.highest_level <= 0.0 {
        return None;
    }
    let amplitude = match settings.amplitude {
        Some(amplitude) => amplitude,
        None => reach(contact, &scales, settings)?,
    };
    let speed = amplitude / settings.duration;
    // The slow motion resolves whatever happens along the path into a thousand parts.
    let first = (0.5 * scales.prescribed(speed)).min(1e-3 * settings.duration);
    let (mut result, evidence) = with_step(
        settings.step,
        first,
        |step| run(contact, amplitude, settings.duration, step),
        |result| {
            let relative = |value| Figure { value, scale: 0.01 };
            let force =
                Figure { value: result.wiping_out_error, scale: 0.01 * result.loop_height.abs() };
            vec![
                Figure::relative(result.loop_height),
                relative(result.closure_gap),
                relative(result.congruency_error),
                force,
            ]
        },
    );
    result.evidence = evidence;
    Some(result)
}

/// Displacement at which the slowly loaded contact first carries `level` of its static friction.
fn reach(contact: &Contact, scales: &TimeScales, settings: &NonLocalMemorySettings) -> Option<f64> {
    let target = settings.level * scales.highest_level;
    let elastic = target / scales.stiffness;
    let speed = elastic / settings.duration;
    let dt = (0.5 * scales.prescribed(speed)).min(1e-3 * settings.duration);
    let mut motion = contact.prescribed();
    let mut before = motion.force(speed);
    // A thousand times the elastic deflection is no pre-sliding any more.
    let steps = (1000.0 * settings.duration / dt).min(1e7) as u32;
    for k in 0..steps {
        let force = motion.step([speed; 3], dt);
        if force >= target {
            return Some(speed * dt * (f64::from(k) + (target - before) / (force - before)));
        }
        before = force;
    }
    None
}

fn run(contact: &Contact, amplitude: f64, duration: f64, step: f64) -> NonLocalMemory {
    let pace = Pace::new(amplitude, duration, step);
    let mut course = Thinned::new();
    let mut tips = [0.0; 6];
    let mut loop_work = 0.0;
    let (mut down, mut up) = (Vec::new(), Vec::new());
    let mut before = (0.0, 0.0);
    pace.along(contact, &WITH_LOOP, &mut |leg, displacement, force| {
        tips[leg] = force;
        if leg == 3 || leg == 4 {
            loop_work += 0.5 * (force + before.1) * (displacement - before.0);
            if leg == 3 { &mut down } else { &mut up }.push(force);
        }
        before = (displacement, force);
        course.offer([displacement, force]);
    });
    let mut without = 0.0;
    pace.along(contact, &WITHOUT_LOOP, &mut |_, _, force| without = force);
    let (mut rising, mut falling) = (Vec::new(), Vec::new());
    pace.along(contact, &CONGRUENT, &mut |leg, _, force| match leg {
        4 => rising.push(force),
        7 => falling.push(force),
        _ => {}
    });
    let [_, _, at_first, at_turn, at_second, at_end] = tips;
    let loop_height = at_first - at_turn;
    let spread = |distances: &mut dyn Iterator<Item = f64>| {
        let (low, high) =
            distances.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
        high - low
    };
    let distances = || rising.iter().zip(&falling).map(|(a, b)| b - a);
    let leg_height =
        rising.last().zip(rising.first()).map_or(f64::NAN, |(last, first)| last - first);
    let [displacement, friction] = course.columns();
    NonLocalMemory {
        amplitude,
        tips,
        loop_height,
        loop_work,
        loop_opening: spread(&mut up.iter().rev().zip(&down).map(|(u, d)| u - d)) / loop_height,
        closure_gap: (at_second - at_first) / loop_height,
        wiping_out_error: at_end - without,
        congruency_error: spread(&mut distances()) / leg_height,
        congruency_distance: distances().sum::<f64>() / rising.len() as f64,
        course: NonLocalMemoryCourse { displacement, friction },
        evidence: Evidence { step, change: None },
    }
}

/// Constant speed between turns that are multiples of a tenth of the amplitude.
struct Pace {
    speed: f64,
    dt: f64,
    /// Steps for a tenth of the amplitude.
    steps: u32,
    tenth: f64,
}

impl Pace {
    fn new(amplitude: f64, duration: f64, step: f64) -> Self {
        // An even division that rounding does not make one step longer.
        let steps = (0.1 * duration / step - 1e-9).ceil().max(1.0);
        Self {
            speed: amplitude / duration,
            dt: 0.1 * duration / steps,
            steps: steps as u32,
            tenth: 0.1 * amplitude,
        }
    }

    /// Calls `each` with the number of the leg, the displacement and the force, at the start of
    /// each leg and after every step.
    fn along(&self, contact: &Contact, turns: &[i32], each: &mut dyn FnMut(usize, f64, f64)) {
        let mut motion = contact.prescribed();
        let mut here = 0;
        for (leg, &turn) in turns.iter().enumerate() {
            let velocity = self.speed * f64::from((turn - here).signum());
            let steps = self.steps * turn.abs_diff(here);
            for k in 0..=steps {
                let force = if k == 0 {
                    motion.force(velocity)
                } else {
                    motion.step([velocity; 3], self.dt)
                };
                let travel = f64::from(turn - here) * f64::from(k) / f64::from(steps);
                each(leg, self.tenth * (f64::from(here) + travel), force);
            }
            here = turn;
        }
    }
}
