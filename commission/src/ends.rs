//! The ends of a travel, found gently.

use std::fmt;

use rig_driver::safety::Travel;
use rig_setup::{Ends, RigSetupError, Search, find_ends, find_moves};
use serde::{Deserialize, Serialize};

use crate::axis::{Axis, Known};
use crate::reach::{self, LEAST};
use crate::{CommissionError, Stage};

/// Speed of the search, as a share of the speed limit.
const SPEED: f64 = 0.03;
/// Time in which its ramp would reach the voltage limit \[s\].
const RAMP: f64 = 12.0;
/// Highest voltage of the ramp, as a share of the limit: where the encoder does not count, nothing else
/// ends it, and the ends are not known yet.
const SHARE: f64 = 0.6;
/// The same of the creeping, once the encoder was seen to count.
const COUNTS: f64 = 0.95;
/// What may be added to twice the voltage that moves the shaft, as a share of the limit.
const ABOVE: f64 = 0.05;
/// What is left free before a place that held the shaft, as a share of what was walked.
const GAP: f64 = 0.02;
/// Rig time of what is not creeping \[s\].
const BESIDE: f64 = 30.0;

/// What a search came to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sought {
    /// What was found.
    pub ends: Ends,
    /// Angle either way within which was looked \[rad\].
    pub angle: f64,
    /// Where the shaft may be; none for an axis that is free.
    pub travel: Option<Travel>,
}

impl Sought {
    fn of(ends: Ends, angle: f64) -> Result<Self, CommissionError> {
        let (low, high) = ends.walked;
        let width = high - low;
        let all_the_way = ends.low.is_none() && ends.high.is_none() && width > 1.8 * angle;
        if all_the_way {
            return Ok(Self { ends, angle, travel: None });
        }
        if width < LEAST {
            return Err(CommissionError::Unusable {
                stage: Stage::Meet,
                why: format!(
                    "looking for the ends of the travel, the shaft was held after {width:.3} rad in all under {:.2} V, and a commission needs {LEAST} rad: look at what blocks it, at the motor's leads and at the encoder's plug; an axis that is stiffer somewhere takes --travel LOW:HIGH",
                    ends.volts
                ),
            });
        }
        let gap = GAP * width;
        let travel = reach::around(0.0, (low + gap, high - gap));
        Ok(Self { ends, angle, travel: Some(travel) })
    }
}

impl fmt::Display for Sought {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Ends { low, high, walked, volts } = self.ends;
        let Some(travel) = self.travel else {
            return write!(
                f,
                "nothing held the shaft within {:.1} rad either way: it is taken to turn for ever",
                self.angle
            );
        };
        let end = |held: Option<f64>, walked: f64| match held {
            Some(place) => format!("something holds it at {place:.3} rad"),
            None => format!("nothing held it up to {walked:.3} rad"),
        };
        write!(
            f,
            "by its encoder, below {} and above {} under at most {volts:.2} V; it stays from {:.3} to {:.3} rad",
            end(low, walked.0),
            end(high, walked.1),
            travel.min,
            travel.max
        )
    }
}

/// Looks for the ends of the travel up to `angle` either way, and comes back to the middle.
///
/// # Errors
/// [`CommissionError`] if the rig refuses, does not move, or is held after too short a way.
pub fn find(axis: &mut Axis<'_>, known: &Known, angle: f64) -> Result<Sought, CommissionError> {
    let search = Search {
        angle,
        speed: SPEED * known.velocity,
        ramp: known.voltage / RAMP,
        above: ABOVE * known.voltage,
    };
    axis.reserve(Stage::Meet, 4.0 * angle / search.speed + BESIDE)?;
    let moves = axis
        .session(SHARE * known.voltage, |session, say| find_moves(session, &search, say))
        .map_err(|error| said(error, known.voltage))?;
    // The safety layer holds what it may be pushed with.
    let most = moves.most(&search, COUNTS * known.voltage);
    let ends = axis.session(most, |session, say| find_ends(session, &search, &moves, say))?;
    Sought::of(ends, angle)
}

/// What to look at where nothing was seen to move.
fn said(error: CommissionError, limit: f64) -> CommissionError {
    match error {
        CommissionError::Rig(RigSetupError::DoesNotMove { volts, travelled, .. }) => {
            CommissionError::Unusable {
                stage: Stage::Meet,
                why: format!(
                    "looking for the ends of the travel, the encoder counted {travelled} up to {volts:.2} V, {:.0} % of the limit of {limit:.2} V, and more is not tried while nobody knows the ends. Turn the shaft by hand first: its counts have to change, else it is the encoder's plug or supply. If they do, look at the motor's leads and the amplifier's enable; an axis that is as stiff takes --travel LOW:HIGH, with which more is tried",
                    100.0 * SHARE
                ),
            }
        }
        error => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_found_leaves_room_and_an_end_that_was_not_reached_is_where_it_was_last() {
        let ends = |low, high, walked| Ends { low, high, walked, volts: 1.0 };
        let both = Sought::of(ends(Some(-1.0), Some(2.0), (-1.0, 2.0)), 12.0).unwrap();
        let travel = both.travel.unwrap();
        assert!(travel.min - travel.margin > -1.0 && travel.max + travel.margin < 2.0);
        let one = Sought::of(ends(Some(-1.0), None, (-1.0, 12.0)), 12.0).unwrap();
        assert!(one.travel.unwrap().max < 12.0 && one.to_string().contains("up to 12"), "{one}");
        let free = Sought::of(ends(None, None, (-12.0, 12.0)), 12.0).unwrap();
        assert!(free.travel.is_none() && free.to_string().contains("12.0 rad"), "{free}");
        // What took too long is known as far as it was walked, and no farther.
        let slow = Sought::of(ends(None, None, (-3.0, 3.0)), 12.0).unwrap();
        assert!(slow.travel.is_some());
        let stuck = Sought::of(ends(Some(0.0), Some(0.02), (0.0, 0.02)), 12.0).unwrap_err();
        assert!(stuck.to_string().contains("blocks"), "{stuck}");
    }
}
