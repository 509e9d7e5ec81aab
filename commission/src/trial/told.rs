//! What was told of the structure, beside what is there.

use std::fmt;

use machine_rig::Machine;
use serde::{Deserialize, Serialize};

use super::truth::{Truth, load};
use crate::structure::{Finding, Structure};

/// A part of the structure.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, strum::Display, strum::VariantArray,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Part {
    /// One direction is stickier.
    Direction,
    /// A load that hangs.
    Gravity,
    /// A cable.
    Spring,
    /// Waves that come again with the turn.
    Ripple,
    /// Play.
    Play,
}

/// What was told of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It is there.
    There,
    /// It is not.
    NotThere,
    /// It cannot be told.
    Unknown,
}

/// A part, what is there and what was told.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Told {
    /// Which.
    pub part: Part,
    /// Its true size \[V\], zero where it is not there; of play its width \[rad\].
    pub truth: f64,
    /// What was told.
    pub verdict: Verdict,
    /// Whether the interval holds the truth, or what it is said to be below does; none where nothing
    /// was said of its size.
    pub holds: Option<bool>,
}

/// All parts of a machine.
pub(super) fn told(machine: &Machine, truth: &Truth, found: &Structure) -> Vec<Told> {
    let volts = machine.motor.volts_per_newton_metre();
    let scale = machine.position_scale;
    let of = |part: Part, finding: &Finding, truth: f64| {
        let (verdict, holds) = match finding {
            Finding::There { size } => (Verdict::There, Some(size.holds(truth))),
            Finding::Likely { .. } => (Verdict::There, None),
            Finding::NotThere { below } => (Verdict::NotThere, Some(truth.abs() <= *below)),
            Finding::Unknown { .. } => (Verdict::Unknown, None),
        };
        Told { part, truth, verdict, holds }
    };
    let mut all = Vec::new();
    let play = machine.backlash.map_or(0.0, |play| play.width);
    all.push(of(Part::Play, &found.play, play));
    let strongest =
        machine.forces.ripple.iter().map(|wave| volts * wave.torque).fold(0.0, f64::max);
    let verdict = match (found.ripple.is_empty(), found.ripple_looked_for) {
        (false, _) => Verdict::There,
        (true, Some(_)) => Verdict::NotThere,
        (true, None) => Verdict::Unknown,
    };
    all.push(Told { part: Part::Ripple, truth: strongest, verdict, holds: None });
    // What hangs over wrong counts is no sine of the told place.
    let hangs = machine.forces.gravity.is_some_and(|gravity| gravity.torque > 0.0);
    if hangs && (scale - 1.0).abs() > 1e-9 {
        return all;
    }
    let there = load(machine);
    let sine = there.map_or(0.0, |load| load.sine.hypot(load.cosine));
    all.push(of(Part::Gravity, &found.gravity, sine));
    all.push(of(Part::Spring, &found.spring, there.map_or(0.0, |load| load.slope)));
    // It is a share of the friction, which depends on the speed and on how warm the machine is.
    let share = super::truth::turned(machine) * machine.stickier;
    let levels = (0.9 * truth.f_c, truth.f_s.max(truth.f_c) / 0.9);
    let (a, b) = (share * levels.0, share * levels.1);
    let mut direction = of(Part::Direction, &found.direction, share * truth.f_c);
    if let Finding::There { size } = &found.direction {
        let below = size.high.is_none_or(|high| high >= a.min(b));
        direction.holds = Some(below && size.low.is_none_or(|low| low <= a.max(b)));
    }
    all.push(direction);
    all
}

/// What was told of a part on all machines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PartTable {
    /// Which.
    pub part: Part,
    /// Machines that have it, and on how many of these it was told to be there.
    pub there: (usize, usize),
    /// Machines that have it not, and on how many of these it was told to be there.
    pub absent: (usize, usize),
    /// Intervals and bounds that were told, and those that hold the truth.
    pub held: (usize, usize),
}

/// All parts.
pub(super) fn parts<'a>(told: impl Iterator<Item = &'a Told> + Clone) -> Vec<PartTable> {
    let one = |part: &Part| {
        let of = |there: bool| {
            let all = || told.clone().filter(move |t| t.part == *part && (t.truth != 0.0) == there);
            (all().count(), all().filter(|t| t.verdict == Verdict::There).count())
        };
        let holds = || told.clone().filter(|t| t.part == *part).filter_map(|t| t.holds);
        PartTable {
            part: *part,
            there: of(true),
            absent: of(false),
            held: (holds().count(), holds().filter(|holds| *holds).count()),
        }
    };
    <Part as strum::VariantArray>::VARIANTS.iter().map(one).collect()
}

impl fmt::Display for PartTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { part, there, absent, held } = self;
        let name = format!("{part} is told");
        write!(f, "{name:<28}on {} of {} that have it", there.1, there.0)?;
        write!(f, ", {} of {} that do not", absent.1, absent.0)?;
        if held.0 > 0 {
            write!(f, "; {} of {} sizes hold", held.1, held.0)?;
        }
        Ok(())
    }
}
