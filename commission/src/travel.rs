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
    fn a_kept_travel_holds_where_the_device_has_run_since() {
        let kept =
            Kept { at: now() - 100.0, ..Kept::now(Travel { min: -1.0, max: 1.0, margin: 0.1 }) };
        assert!(kept.check(false, Some(3600.0)).is_ok() && kept.check(true, None).is_ok());
        for powered_for in [Some(50.0), None] {
            let error = kept.check(false, powered_for).unwrap_err();
            assert!(error.is_bad_input() && error.to_string().contains("--travel"), "{error}");
        }
    }
}
