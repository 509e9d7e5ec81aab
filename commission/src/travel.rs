//! The travel of a commission: asked for, found, or kept from before.
//!
//! It is by the rig's own count. What was counted once holds as long as the encoder counts on: a
//! device that says for how long it has run tells that, and a simulated rig begins where it began.

use std::fmt;
use std::str::FromStr;
use std::time::{SystemTime, UNIX_EPOCH};

use rig_driver::safety::Travel;
use rig_setup::{Ends, Search, find_ends, find_moves};
use serde::{Deserialize, Serialize};

use crate::axis::{Axis, Known};
use crate::reach::{self, LEAST};
use crate::{CommissionError, Stage};

/// Angle either way within which ends are looked for, where none is said \[rad\]: two turns.
const ANGLE: f64 = 2.0 * std::f64::consts::TAU;
/// The least and the largest that may be said \[rad\].
const ANGLES: (f64, f64) = (0.5, 200.0);
/// Speed of the search, as a share of the speed limit.
const SPEED: f64 = 0.03;
/// Time in which its ramp would reach the voltage limit \[s\].
const RAMP: f64 = 12.0;
/// Highest voltage of the ramp, as a share of the limit.
const SHARE: f64 = 0.95;
/// What may be added to twice the voltage that moves the shaft, as a share of the limit.
const ABOVE: f64 = 0.05;
/// What is left free before a place that held the shaft, as a share of what was walked.
const GAP: f64 = 0.02;
/// Rig time of what is not creeping \[s\].
const BESIDE: f64 = 30.0;
/// How much longer than that a device has to have run whose count is believed \[s\].
const SURE: f64 = 2.0;

/// Where the shaft may be, as it is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TravelAsked {
    /// From so far below to so far above where the shaft stands when the command begins \[rad\].
    Around(f64, f64),
    /// Whatever is found, up to that angle either way \[rad\].
    Find(f64),
}

impl FromStr for TravelAsked {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if text == "find" {
            return Ok(Self::Find(ANGLE));
        }
        if let Some(angle) = text.strip_prefix("find:") {
            let angle = angle.trim().parse().ok().filter(|a| (ANGLES.0..=ANGLES.1).contains(a));
            return angle.map(Self::Find).ok_or_else(|| {
                format!("`{text}` is no search; expected `find`, or find:ANGLE with an angle from {} to {} rad, as in find:20", ANGLES.0, ANGLES.1)
            });
        }
        let ends = text.split_once(':').and_then(|(low, high)| {
            Some((low.trim().parse::<f64>().ok()?, high.trim().parse::<f64>().ok()?))
        });
        ends.filter(|(low, high)| *low < 0.0 && *high > 0.0 && low.is_finite() && high.is_finite())
            .map(|(low, high)| Self::Around(low, high))
            .ok_or_else(|| {
                format!("`{text}` is no travel; expected LOW:HIGH in rad around where the shaft stands, as in -0.5:1.5, or `find`")
            })
    }
}

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
    let moves =
        axis.session(SHARE * known.voltage, |session, say| find_moves(session, &search, say))?;
    // The safety layer holds what it may be pushed with.
    let most = moves.most(&search, SHARE * known.voltage);
    let ends = axis.session(most, |session, say| find_ends(session, &search, &moves, say))?;
    Sought::of(ends, angle)
}

/// A travel in the folder of a commission.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    /// Where the shaft may be, by the rig's own count.
    pub travel: Travel,
    /// When it was counted \[s since the Unix epoch\].
    pub at: f64,
}

impl Kept {
    /// Counted now.
    #[must_use]
    pub fn now(travel: Travel) -> Self {
        Self { travel, at: now() }
    }

    /// Refuses it where the rig's count may have begun anew since: `powered_for` is how long the
    /// device says that it has run \[s\].
    ///
    /// # Errors
    /// [`CommissionError::Asked`] says how to go on.
    pub fn check(&self, simulated: bool, powered_for: Option<f64>) -> Result<(), CommissionError> {
        let since = now() - self.at;
        if simulated || powered_for.is_some_and(|powered| powered > since + SURE) {
            return Ok(());
        }
        let why = match powered_for {
            Some(powered) => {
                format!("the device started anew {powered:.0} s ago, and its encoder with it")
            }
            None => "the device does not say whether its encoder has counted on".to_owned(),
        };
        Err(CommissionError::Asked(format!(
            "the travel of this commission was counted from a place that nobody knows any more: {why}. Nothing has moved. Turn the shaft to the middle, and say --travel LOW:HIGH once more, from where it stands then, or --travel find"
        )))
    }
}

/// Seconds since the Unix epoch.
fn now() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_travel_is_read_and_a_wrong_one_is_told_what_was_expected() {
        assert_eq!("-0.5:1.5".parse(), Ok(TravelAsked::Around(-0.5, 1.5)));
        assert_eq!("find".parse(), Ok(TravelAsked::Find(ANGLE)));
        assert_eq!("find:20".parse(), Ok(TravelAsked::Find(20.0)));
        for (text, said) in
            [("0.5:1.5", "-0.5:1.5"), ("fnd", "find"), ("find:0", "find:20"), ("nan:1", "LOW:HIGH")]
        {
            let error = text.parse::<TravelAsked>().unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
    }

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

    #[test]
    fn a_kept_travel_holds_where_the_device_has_run_since() {
        let kept = Kept { at: now() - 100.0, ..Kept::now(reach::around(0.0, (-1.0, 1.0))) };
        assert!(kept.check(false, Some(3600.0)).is_ok() && kept.check(true, None).is_ok());
        for powered_for in [Some(50.0), None] {
            let error = kept.check(false, powered_for).unwrap_err();
            assert!(error.is_bad_input() && error.to_string().contains("--travel"), "{error}");
        }
    }
}
