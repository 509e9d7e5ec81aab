//! Structure: what beside friction depends on the place and the direction.
//!
//! A block goes over the same places both ways. What is the same in both is the load that depends on
//! the place; half their difference is friction. All blocks together are fitted by a load that hangs
//! (`a sin q + b cos q`), a cable (`k q`) and waves that come again with the turn, each of which has
//! to predict the blocks that were kept back better than the simpler one does.

mod fit;
mod waves;

use std::f64::consts::TAU;

use controller::Load;
use serde::{Deserialize, Serialize};

use self::fit::{Column, Fitted};
use crate::Ranged;
use crate::drive::Drive;
use crate::friction::{Curve, PARTS, Trail};

/// The richer structure has to predict better by this share.
const CLEARLY: f64 = 0.05;
/// Parts that are taken together where the load is smooth.
const TOGETHER: usize = 8;
/// Places from which on a load that hangs is told from a spring, and both from each other \[rad\].
const BENDS: f64 = 2.5;
/// What is below this share of the friction is no matter.
const MATTERS: f64 = 0.005;
/// What may be as large as this share of the friction is not said to be absent.
const UNSURE: f64 = 0.1;
/// No size is known better than this share of it: gain and time constant of the drive are in it.
const KNOWN: f64 = 0.02;
/// Waves that are told, at most.
const WAVES: usize = 3;
/// A wave or a load has to be so many half widths of its interval: each is the best of several that
/// were looked at.
const STANDS_OUT: f64 = 2.0;
/// No voltage that depends on place or direction is known better than this share of the friction: at
/// the beginning of a way some of the turn before it is left in the loop.
const SETTLED: f64 = 0.008;

/// What was found of one of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "verdict")]
pub enum Finding {
    /// It is there.
    There {
        /// How large it is.
        size: Ranged,
    },
    /// It is there by how the drive answers; how large it is is not told.
    Likely {
        /// By what.
        why: String,
    },
    /// It is not there.
    NotThere {
        /// What it is below, with 95 % certainty.
        below: f64,
    },
    /// It cannot be told.
    Unknown {
        /// Why not.
        why: String,
    },
}

/// A wave that comes again with the turn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Wave {
    /// Waves a turn.
    pub per_turn: f64,
    /// Its size \[V\].
    pub size: Ranged,
}

/// What was found of all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Structure {
    /// By how much one direction takes more voltage than the mean of both \[V\].
    pub direction: Finding,
    /// A load that hangs: its size \[V\].
    pub gravity: Finding,
    /// A spring: its stiffness [V/rad].
    pub spring: Finding,
    /// Waves, the strongest first.
    pub ripple: Vec<Wave>,
    /// Waves that were looked for, from and to so many a turn.
    pub ripple_looked_for: Option<(f64, f64)>,
    /// Play behind the encoder.
    pub play: Finding,
    /// What of it the controller can feed forward; places are the rig's own count.
    pub load: Option<Load>,
    /// Places that the blocks covered \[rad\].
    pub covered: f64,
    /// Root mean square of what is missed on the blocks that were kept back, without a load and with
    /// it \[V\].
    pub errors: (f64, f64),
}

/// Size and half its interval of a load that hangs and of a spring, where they are there.
type Sizes = (Option<(f64, f64)>, Option<(f64, f64)>);

/// A candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Nothing,
    Spring,
    Gravity,
    Both,
}

impl Kind {
    /// Its columns, of blocks of which that is the fastest [rad/s].
    fn columns(self, fastest: f64) -> Vec<Column> {
        let (sine, cosine) = (Column::Sine(1.0), Column::Cosine(1.0));
        let mut columns = vec![Column::One, Column::Speed(fastest)];
        columns.extend(match self {
            Self::Nothing => vec![],
            Self::Spring => vec![Column::Place],
            Self::Gravity => vec![sine, cosine],
            Self::Both => vec![sine, cosine, Column::Place],
        });
        columns
    }

    /// Size of the load that hangs and half its interval, and of the spring.
    fn sizes(self, fitted: &Fitted, (covered, friction): (f64, f64)) -> Sizes {
        let least = SETTLED * friction;
        let wave = |column: usize| {
            let (size, half) = fitted.wave(column);
            (size, half.hypot(least))
        };
        let spring = |column: usize| {
            let least = least / covered.max(f64::MIN_POSITIVE);
            (fitted.values[column], fitted.half(column).hypot(least))
        };
        match self {
            Self::Nothing => (None, None),
            Self::Spring => (None, Some(spring(2))),
            Self::Gravity => (Some(wave(2)), None),
            Self::Both => (Some(wave(2)), Some(spring(4))),
        }
    }

    /// Whether each part of it is clear of nothing and large enough to matter beside `friction` \[V\];
    /// a spring pulls back, over a part of a turn alone it may be a load that hangs upwards.
    fn is_clear(self, fitted: &Fitted, covered: f64, friction: f64) -> bool {
        let least = MATTERS * friction;
        let (gravity, spring) = self.sizes(fitted, (covered, friction));
        gravity.is_none_or(|(size, half)| size > (STANDS_OUT * half).max(least))
            && spring.is_none_or(|(stiffness, half)| {
                let size = if covered < BENDS { stiffness.abs() } else { stiffness };
                size * covered > (STANDS_OUT * half * covered).max(least)
            })
    }
}

/// What the trails say, those that were `held_back` apart.
#[must_use]
pub fn structure(trails: &[Trail], held_back: &[Trail], curve: &Curve, drive: &Drive) -> Structure {
    let friction = curve.f_c.value;
    let smooth: Vec<Trail> = trails.iter().map(together).collect();
    let smooth: Vec<&Trail> = smooth.iter().collect();
    let kept: Vec<Trail> = held_back.iter().map(together).collect();
    let kept: Vec<&Trail> = kept.iter().collect();
    let covered = covered(trails);
    let play = play(drive);
    let fastest = trails.iter().map(|trail| trail.velocity).fold(f64::MIN_POSITIVE, f64::max);
    let Some(plain) = Fitted::of(&smooth, &Kind::Nothing.columns(fastest), false) else {
        let why = format!("only {} blocks told of their places", trails.len());
        let unknown = || Finding::Unknown { why: why.clone() };
        return Structure {
            direction: unknown(),
            gravity: unknown(),
            spring: unknown(),
            ripple: Vec::new(),
            ripple_looked_for: None,
            play,
            load: None,
            covered,
            errors: (f64::NAN, f64::NAN),
        };
    };
    let able: &[Kind] = if covered >= TAU {
        &[Kind::Spring, Kind::Gravity, Kind::Both]
    } else if covered >= BENDS {
        &[Kind::Spring, Kind::Gravity]
    } else {
        &[Kind::Spring]
    };
    let missed = |fitted: &Fitted| if kept.is_empty() { 0.0 } else { fitted.missed(&kept, false) };
    let first = missed(&plain);
    let mut chosen = (Kind::Nothing, plain.clone(), first);
    let fitted: Vec<(Kind, Fitted)> = able
        .iter()
        .filter_map(|kind| Some((*kind, Fitted::of(&smooth, &kind.columns(fastest), false)?)))
        .collect();
    for (kind, fitted) in &fitted {
        let now = missed(fitted);
        let better = kept.is_empty() || now < (1.0 - CLEARLY).powi(2) * chosen.2;
        if better && kind.is_clear(fitted, covered, friction) {
            chosen = (*kind, fitted.clone(), now);
        }
    }
    let (kind, chosen, last) = chosen;
    let told = |parts: fn(Sizes) -> Option<(f64, f64)>| {
        let told = (covered, friction);
        let there = parts(kind.sizes(&chosen, told));
        // Where it was not chosen: of the richest that was looked at.
        let looked = fitted.iter().rev().find_map(|(kind, fitted)| parts(kind.sizes(fitted, told)));
        (there, looked)
    };
    let load = (kind != Kind::Nothing).then(|| {
        let value = |column: Column| {
            let place = kind.columns(fastest).iter().position(|one| *one == column);
            place.map_or(0.0, |place| chosen.values[place])
        };
        Load {
            offset: value(Column::One),
            sine: value(Column::Sine(1.0)),
            cosine: value(Column::Cosine(1.0)),
            slope: value(Column::Place),
        }
    });
    let bare: Vec<Trail> = trails.iter().map(|trail| chosen.less(trail)).collect();
    let bare_kept: Vec<Trail> = held_back.iter().map(|trail| chosen.less(trail)).collect();
    let (ripple, looked_for) = ripple(bare, bare_kept, friction, drive.encoder_step);
    let short = || {
        format!(
            "the blocks went over {covered:.2} rad only, where a load that hangs and a spring look alike"
        )
    };
    let gravity = told(|parts| parts.0);
    let spring = told(|parts| parts.1);
    Structure {
        direction: {
            let one = (chosen.values[0], chosen.half(0).hypot(SETTLED * friction));
            direction((kind, covered), one, spring.1, friction)
        },
        gravity: found(gravity.0, gravity.1, friction, short),
        spring: if covered < BENDS && kind == Kind::Spring {
            Finding::Unknown {
                why: format!(
                    "a load that rises by {:.3} V/rad is there; {}",
                    chosen.values[1],
                    short()
                ),
            }
        } else {
            found(spring.0, spring.1.map(|s| (s.0 * covered, s.1 * covered)), friction, short)
        },
        ripple,
        ripple_looked_for: looked_for,
        play,
        load,
        covered,
        errors: (first.sqrt(), last.sqrt()),
    }
}

/// What is told of the directions: a load that is the same everywhere looks the same, as a spring does
/// that was `looked` for and may be there all the same, slack somewhere in the middle of the places.
fn direction(
    (kind, covered): (Kind, f64),
    one: (f64, f64),
    looked: Option<(f64, f64)>,
    friction: f64,
) -> Finding {
    let unknown = |why: &str| Finding::Unknown { why: why.to_owned() };
    let slack = "a spring whose slack place is not known looks the same";
    if matches!(kind, Kind::Spring | Kind::Both) {
        return unknown(slack);
    }
    if covered < BENDS {
        return unknown("the blocks went over a part of a turn only, where a load looks the same");
    }
    let hidden = looked.map_or(0.0, |(size, half)| (size.abs() + half) * 0.5 * covered);
    let (size, half) = one;
    if size.abs() > half && size.abs() < half + hidden {
        return unknown(slack);
    }
    found(Some(one), None, friction, String::new)
}

/// What is told of one: where it is `there`, else where it was `looked` for; beside a friction \[V\].
fn found(
    there: Option<(f64, f64)>,
    looked: Option<(f64, f64)>,
    friction: f64,
    why: impl Fn() -> String,
) -> Finding {
    match (there, looked) {
        (Some((size, half)), _) if size.abs() > half && size.abs() > MATTERS * friction => {
            Finding::There { size: Ranged::new(size, size - half, size + half).at_least(KNOWN) }
        }
        (Some((size, half)), _) | (None, Some((size, half))) => {
            let below = size.abs() + half;
            if below > UNSURE * friction {
                let share = 100.0 * below / friction;
                Finding::Unknown {
                    why: format!(
                        "by these blocks it may be up to {share:.0} % of the friction, or nothing"
                    ),
                }
            } else {
                Finding::NotThere { below }
            }
        }
        (None, None) => Finding::Unknown { why: why() },
    }
}

/// Waves, and which were looked for.
fn ripple(
    mut trails: Vec<Trail>,
    mut held_back: Vec<Trail>,
    friction: f64,
    step: f64,
) -> (Vec<Wave>, Option<(f64, f64)>) {
    let mut found = Vec::new();
    let Some(range) = waves::range(&trails.iter().collect::<Vec<_>>(), step) else {
        return (found, None);
    };
    while found.len() < WAVES {
        let Some((wave, fitted)) = next_wave(&trails, &held_back, friction, range) else { break };
        trails = trails.iter().map(|trail| fitted.less(trail)).collect();
        held_back = held_back.iter().map(|trail| fitted.less(trail)).collect();
        found.push(wave);
    }
    (found, Some((range.0 * TAU, range.1 * TAU)))
}

/// The strongest wave, if it is one.
fn next_wave(
    trails: &[Trail],
    held_back: &[Trail],
    friction: f64,
    range: (f64, f64),
) -> Option<(Wave, Fitted)> {
    let all: Vec<&Trail> = trails.iter().collect();
    let waves = waves::strongest(&all, range)?;
    let columns = [Column::Sine(waves), Column::Cosine(waves)];
    let fitted = Fitted::of(&waves::showing(&all, waves), &columns, true)?;
    let (size, half) = fitted.wave(0);
    let kept = waves::showing(&held_back.iter().collect::<Vec<_>>(), waves);
    let stands_out = size > STANDS_OUT * half && size > MATTERS * friction;
    let predicts = !kept.is_empty()
        && fitted.missed(&kept, true) < (1.0 - CLEARLY).powi(2) * fit::there(&kept);
    let size = Ranged::new(size, size - half, size + half);
    (stands_out && predicts).then_some((Wave { per_turn: waves * TAU, size }, fitted))
}

/// Play shows in how the drive answers the tones, if at all.
fn play(drive: &Drive) -> Finding {
    match drive.seems_early() {
        true => Finding::Likely {
            why: format!(
                "the drive seems to answer the tones {:.1} ms before they are asked: a load behind a play does so, which is thrown from one side to the other; how wide the play is an encoder on the motor's side does not tell",
                -1e3 * drive.delay.value
            ),
        },
        false => Finding::Unknown {
            why: "the encoder is on the motor's side, and the drive answers as one without play: a narrow play, a light load or one that is held does not show there; a sensor behind the gear tells it".to_owned(),
        },
    }
}

/// Places from the lowest to the highest \[rad\].
fn covered(trails: &[Trail]) -> f64 {
    let places = || trails.iter().flat_map(fit::parts).map(|(_, (place, _))| place);
    let (low, high) =
        (places().fold(f64::INFINITY, f64::min), places().fold(-f64::INFINITY, f64::max));
    (high - low).max(0.0)
}

/// A trail of longer parts.
fn together(trail: &Trail) -> Trail {
    let mean = |parts: &[(f64, f64)]| {
        let n = parts.len() as f64;
        let sum = parts.iter().fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
        (sum.0 / n, sum.1 / n)
    };
    let way = |parts: &[(f64, f64)]| parts.chunks_exact(TOGETHER).map(mean).collect();
    Trail {
        length: trail.length * TOGETHER.min(PARTS) as f64,
        forward: way(&trail.forward),
        backward: way(&trail.backward),
        ..trail.clone()
    }
}

#[cfg(test)]
mod tests;
