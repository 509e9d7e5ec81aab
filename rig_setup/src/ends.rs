//! The ends of a travel, looked for gently.
//!
//! A slow ramp tells what just moves the shaft. Then it creeps: the voltage grows while the shaft is
//! slower than it should be and falls as soon as it is faster, at most to a little above what moved
//! it. Where it stands still under that, something holds it: an end, or what such a voltage does not
//! overcome. It is not pushed harder.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::unseen::Unseen;
use super::{RigSetupError, Session};

/// How ends are looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// Angle either way of the start within which ends are looked for \[rad\].
    pub angle: f64,
    /// Speed of the creeping [rad/s].
    pub speed: f64,
    /// Rate of the ramp that finds what moves the shaft [V/s].
    pub ramp: f64,
    /// What may be added to twice the voltage that moves the shaft \[V\].
    pub above: f64,
}

/// What was found, by the rig's own count \[rad\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ends {
    /// Where the shaft was held at the lower end; none where nothing held it.
    pub low: Option<f64>,
    /// The same at the upper end.
    pub high: Option<f64>,
    /// The lowest and the highest place that it was at.
    pub walked: (f64, f64),
    /// The highest voltage that was put out \[V\].
    pub volts: f64,
}

/// Travel that counts as motion in a ramp: counts, where it is that angle \[rad\] too; below it
/// friction may still hold the shaft elastically.
const MOVED: i64 = 4;
const MOVED_ANGLE: f64 = 0.03;
/// What it may be pushed with, over what just moves it.
const TWICE: f64 = 2.0;
/// Time in which the voltage grows by what moves the shaft \[s\].
const GROWS_IN: f64 = 0.5;
/// Where it begins again after the shaft was too fast, as a share of what moves it.
const AGAIN: f64 = 0.6;
/// Times the wanted speed at which it is zero at once.
const TOO_FAST: f64 = 2.0;
/// Longest window of the speed \[s\], and the counts after which a shorter one does.
const WINDOW: f64 = 0.04;
const COUNTS: i64 = 2;
/// Time without motion under the whole voltage after which something holds the shaft \[s\].
const HELD: f64 = 0.4;
/// Angle that is no motion \[rad\]; a count is none either.
const STILL: f64 = 0.002;
/// Over known ground it goes so much faster.
const KNOWN: f64 = 3.0;
/// Times the time that the wanted speed would take after which a way is given up.
const PATIENCE: f64 = 6.0;
/// Time at zero volts between two ways \[s\].
const SETTLE: f64 = 0.4;

/// How a way ended.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    /// At the place where it should.
    There,
    /// Something held the shaft.
    Held,
    /// It took too long.
    Long,
}

/// What just moves a shaft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moves {
    /// The voltage, the larger of both directions \[V\].
    pub volts: f64,
    /// The way that the encoder counts at a positive voltage.
    counts: f64,
    /// The direction of the voltage in which it was seen to move: at an end there is one only.
    towards: f64,
}

impl Moves {
    /// The highest voltage with which ends are looked for, at most `limit` \[V\].
    #[must_use]
    pub fn most(&self, search: &Search, limit: f64) -> f64 {
        (TWICE * self.volts + search.above).min(limit)
    }
}

/// Finds by slow ramps from zero what just moves the shaft.
///
/// # Errors
/// [`RigSetupError`] if the rig refuses or the shaft moves neither way.
pub fn find_moves(
    session: &mut Session<'_>,
    search: &Search,
    mut say: impl FnMut(&str),
) -> Result<Moves, RigSetupError> {
    say("looking for the ends: what just moves the shaft");
    let (forwards, backwards) = (ramp(session, search, 1.0)?, ramp(session, search, -1.0)?);
    let volts = |found: Option<(f64, f64)>| found.map_or(0.0, |(volts, _)| volts);
    let (counts, towards) = match (forwards, backwards) {
        (Some((_, sign)), _) => (sign, 1.0),
        (None, Some((_, sign))) => (-sign, -1.0),
        (None, None) => {
            return Err(RigSetupError::DoesNotMove {
                direction: "either way",
                volts: session.max_volts(),
                travelled: 0,
            });
        }
    };
    Ok(Moves { volts: volts(forwards).max(volts(backwards)), counts, towards })
}

/// Looks for the ends, and comes back to the middle where there are any; no voltage of the session
/// should be above [`Moves::most`]. `say` is told what begins.
///
/// # Errors
/// [`RigSetupError`] if the rig refuses.
pub fn find_ends(
    session: &mut Session<'_>,
    search: &Search,
    moves: &Moves,
    mut say: impl FnMut(&str),
) -> Result<Ends, RigSetupError> {
    let start = session.step(|_| 0.0)?.encoder_position;
    let mut creep =
        Creep { search: *search, moves: moves.volts, highest: 0.0, walked: (start, start) };
    let mut found = [None, None];
    for direction in [moves.towards, -moves.towards] {
        let up = direction * moves.counts > 0.0;
        let beyond = move |goal: f64| move |x: f64| if up { x >= goal } else { x <= goal };
        let way = if up { "up" } else { "down" };
        say(&format!("looking for an end, creeping while the encoder counts {way}"));
        // What was walked already is known.
        creep.go(session, direction, search.speed * KNOWN, beyond(start))?;
        let goal = start + if up { search.angle } else { -search.angle };
        if creep.go(session, direction, search.speed, beyond(goal))? == Way::Held {
            let (low, high) = creep.walked;
            found[usize::from(up)] = Some(if up { high } else { low });
        }
        session.hold(0.0, SETTLE)?;
        session.cool()?;
    }
    let [low, high] = found;
    if low.is_some() || high.is_some() {
        say("back to the middle");
        let middle = 0.5 * (creep.walked.0 + creep.walked.1);
        // It is where the second way ended.
        let up = moves.towards * moves.counts > 0.0;
        let back = move |x: f64| if up { x >= middle } else { x <= middle };
        creep.go(session, moves.towards, search.speed * KNOWN, back)?;
        session.hold(0.0, SETTLE)?;
    }
    Ok(Ends { low, high, walked: creep.walked, volts: creep.highest })
}

/// A ramp from zero until the shaft moves: the voltage, and the way that the encoder counts; none
/// where it does not move.
fn ramp(
    session: &mut Session<'_>,
    search: &Search,
    direction: f64,
) -> Result<Option<(f64, f64)>, RigSetupError> {
    let step = search.ramp * session.period();
    let mut unseen = Unseen::of(&session.hold(0.0, SETTLE)?, session.period());
    let first = session.step(|_| 0.0)?;
    let (mut volts, mut found) = (0.0, None);
    while volts <= session.max_volts() && found.is_none() {
        let seen = session.step(|_| direction * volts)?;
        unseen.watch(&seen, volts)?;
        let way = seen.encoder_position - first.encoder_position;
        let counts = (seen.encoder_counts - first.encoder_counts).abs();
        if counts >= MOVED && way.abs() >= MOVED_ANGLE {
            found = Some((volts, way.signum()));
        }
        volts += step;
    }
    session.hold(0.0, SETTLE)?;
    session.cool()?;
    Ok(found)
}

/// What is known while it creeps.
struct Creep {
    search: Search,
    /// Voltage that just moves the shaft \[V\].
    moves: f64,
    /// The highest that was put out \[V\].
    highest: f64,
    /// The lowest and the highest place \[rad\].
    walked: (f64, f64),
}

impl Creep {
    fn saw(&mut self, place: f64, volts: f64) {
        self.walked = (self.walked.0.min(place), self.walked.1.max(place));
        self.highest = self.highest.max(volts.abs());
    }

    /// Creeps in a direction of the voltage until it `is_there`, or something holds the shaft.
    fn go(
        &mut self,
        session: &mut Session<'_>,
        direction: f64,
        speed: f64,
        is_there: impl Fn(f64) -> bool,
    ) -> Result<Way, RigSetupError> {
        let period = session.period();
        let most = (TWICE * self.moves + self.search.above).min(session.max_volts());
        let rate = (self.moves / GROWS_IN).max(self.search.ramp) * period;
        let longest = PATIENCE * 2.0 * self.search.angle / speed;
        let mut seen: VecDeque<(i64, f64)> = VecDeque::new();
        let window = ((WINDOW / period) as usize).max(2);
        let (mut volts, mut out) = (AGAIN * self.moves, 0.0);
        let (mut anchor, mut held, mut time) = (None, 0.0, 0.0);
        while time < longest {
            let now = session.step(|_| direction * out)?;
            time += period;
            let (counts, place) = (now.encoder_counts, now.encoder_position);
            self.saw(place, out);
            if is_there(place) {
                return Ok(Way::There);
            }
            if seen.len() > window {
                seen.pop_front();
            }
            let turns = turning((counts, place), &seen, period) / speed;
            seen.push_back((counts, place));
            let (anchored, at) = *anchor.get_or_insert((counts, place));
            if (counts - anchored).abs() > 1 && (place - at).abs() > STILL {
                (anchor, held) = (Some((counts, place)), 0.0);
            }
            held = if out >= most { held + period } else { 0.0 };
            if held > HELD {
                return Ok(Way::Held);
            }
            if turns > TOO_FAST {
                (volts, out) = (volts.min(AGAIN * self.moves), 0.0);
            } else {
                volts = (volts + rate * (1.0 - turns).clamp(-4.0, 1.0)).clamp(0.0, most);
                out = volts;
            }
            if let Some((heat, rise)) = session.heat().zip(session.winding_rise())
                && heat.is_hot(rise)
            {
                session.cool()?;
                seen.clear();
            }
        }
        Ok(Way::Long)
    }
}

/// Speed over the shortest window in which the encoder counted enough [rad/s].
fn turning(now: (i64, f64), seen: &VecDeque<(i64, f64)>, period: f64) -> f64 {
    let mut speed = 0.0;
    for (cycles, before) in seen.iter().rev().enumerate() {
        speed = (now.1 - before.1).abs() / (period * (cycles + 1) as f64);
        if (now.0 - before.0).abs() >= COUNTS {
            break;
        }
    }
    speed
}
