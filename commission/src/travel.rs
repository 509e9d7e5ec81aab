//! The travel of a commission, as it is asked for and as it is kept.
//!
//! It is by the rig's own count. What was counted once holds as long as the encoder counts on: a
//! device that says for how long it has run tells that, and a simulated rig begins where it began.

use std::str::FromStr;
use std::time::{SystemTime, UNIX_EPOCH};

use rig_driver::safety::Travel;
use serde::{Deserialize, Serialize};

use crate::CommissionError;

/// Angle either way within which ends are looked for, where none is said \[rad\]: two turns.
pub const ANGLE: f64 = 2.0 * std::f64::consts::TAU;
/// The least and the largest that may be said \[rad\].
const ANGLES: (f64, f64) = (0.5, 200.0);
/// How much longer than that a device has to have run whose count is believed, and how far two clocks
/// may differ \[s\].
const SURE: f64 = 2.0;
/// How much they may drift apart, as a share of the time between.
const DRIFT: f64 = 0.01;

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

/// A travel in the folder of a commission.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    /// Where the shaft may be, by the rig's own count.
    pub travel: Travel,
    /// When it was counted \[s since the Unix epoch\].
    pub at: f64,
    /// When the device was switched on, as it told then \[s since the Unix epoch\].
    pub switched_on: Option<f64>,
}

impl Kept {
    /// Counted now, by a device that was switched on then.
    #[must_use]
    pub fn now(travel: Travel, switched_on: Option<f64>) -> Self {
        Self { travel, at: now(), switched_on }
    }

    /// Refuses it where the rig's count may have begun anew since: `powered_for` is how long the
    /// device says that it has run \[s\]. It has to have run since then, and to have been switched on
    /// when it said before: a clock that was set back would hide a device that started anew.
    ///
    /// # Errors
    /// [`CommissionError::Asked`] says how to go on.
    pub fn check(&self, simulated: bool, powered_for: Option<f64>) -> Result<(), CommissionError> {
        if simulated {
            return Ok(());
        }
        let since = now() - self.at;
        let why = match (powered_for, self.switched_on) {
            (Some(powered), Some(before)) => {
                let apart = (switched_on(powered) - before).abs();
                if powered <= since + SURE {
                    format!("the device started anew {powered:.0} s ago, and its encoder with it")
                } else if apart > SURE + DRIFT * since.max(0.0) {
                    format!(
                        "the device's clock and that of this computer differ by {apart:.0} s from what they said then, so that one was set or began anew"
                    )
                } else {
                    return Ok(());
                }
            }
            (None, _) | (_, None) => {
                "the device does not say whether its encoder has counted on".to_owned()
            }
        };
        Err(CommissionError::Asked(format!(
            "the travel of this commission was counted from a place that nobody knows any more: {why}. Nothing has moved. Turn the shaft to the middle, and say --travel LOW:HIGH once more, from where it stands then, or --travel find"
        )))
    }
}

/// When a device was switched on that has run for so long \[s since the Unix epoch\].
#[must_use]
pub fn switched_on(powered_for: f64) -> f64 {
    now() - powered_for
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
    fn a_kept_travel_holds_where_the_device_has_run_since() {
        let travel = Travel { min: -1.0, max: 1.0, margin: 0.1 };
        let kept = Kept { travel, at: now() - 100.0, switched_on: Some(switched_on(3600.0)) };
        assert!(kept.check(false, Some(3600.0)).is_ok() && kept.check(true, None).is_ok());
        for powered_for in [Some(50.0), None] {
            let error = kept.check(false, powered_for).unwrap_err();
            assert!(error.is_bad_input() && error.to_string().contains("--travel"), "{error}");
        }
        // The clock was set back by an hour, and the device started anew.
        let ahead = Kept { at: now() + 3500.0, switched_on: Some(now() + 2900.0), ..kept };
        let error = ahead.check(false, Some(5.0)).unwrap_err();
        assert!(error.to_string().contains("was set or began anew"), "{error}");
    }
}
