//! Where a shaft of limited travel may be.
//!
//! The safety layer holds the travel at every moment. The stages stay farther inside, so that it
//! need not: they turn round in time, with room to brake.

use rig_driver::safety::Travel;

use crate::CommissionError;

/// What a stage leaves free at either end, as a share of the travel.
const ROOM: f64 = 0.06;
/// The smallest travel in which anything can be told of friction \[rad\]: the shaft starts, slides
/// and stops in it.
pub const LEAST: f64 = 0.5;
/// Part of the travel beyond which the safety layer holds the voltage back: the rest is its room to
/// brake.
const HELD: f64 = 0.04;

/// Where the stages may be, by the rig's own count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Lower end \[rad\].
    pub low: f64,
    /// Upper end \[rad\].
    pub high: f64,
}

impl Reach {
    /// Within a travel.
    #[must_use]
    pub fn within(travel: &Travel) -> Self {
        let room = ROOM * (travel.max - travel.min);
        Self { low: travel.min + room, high: travel.max - room }
    }

    /// Its length \[rad\].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.high - self.low
    }

    /// Its middle \[rad\].
    #[must_use]
    pub fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// Whether a place is in it.
    #[must_use]
    pub fn holds(&self, place: f64) -> bool {
        (self.low..=self.high).contains(&place)
    }

    /// Whether what is at `place` with `velocity` [rad/s] and takes `time` \[s\] to stop would leave
    /// it.
    #[must_use]
    pub fn is_left(&self, place: f64, velocity: f64, time: f64) -> bool {
        let stops = place + velocity * time;
        (velocity >= 0.0 && stops > self.high) || (velocity <= 0.0 && stops < self.low)
    }
}

/// The travel from `low` to `high` \[rad\] of where the shaft stands: it is never farther, and from a
/// little before either end on no voltage pushes it outwards.
#[must_use]
pub fn around(place: f64, (low, high): (f64, f64)) -> Travel {
    let margin = HELD * (high - low);
    Travel { min: place + low + margin, max: place + high - margin, margin }
}

/// Refuses a travel that reaches beyond the `own` one of the rig's limits, or that is held less far
/// before its ends.
///
/// # Errors
/// [`CommissionError::Asked`] says what the limits allow.
pub fn check_inside(asked: &Travel, own: &Travel) -> Result<(), CommissionError> {
    let inside = asked.min >= own.min
        && asked.max <= own.max
        && asked.min - asked.margin >= own.min - own.margin
        && asked.max + asked.margin <= own.max + own.margin;
    if inside {
        return Ok(());
    }
    Err(CommissionError::Asked(format!(
        "--travel reaches from {:.3} to {:.3} rad by the encoder, and the limits of this rig allow {:.3} to {:.3} rad: say a narrower one, or leave it out; who wants a wider one changes the rig's profile",
        asked.min, asked.max, own.min, own.max
    )))
}

/// Refuses a travel that is too small, or in which the shaft does not stand.
///
/// # Errors
/// [`CommissionError::Asked`] says the travel that is needed.
pub fn check(travel: &Travel, place: f64) -> Result<(), CommissionError> {
    let width = travel.max - travel.min;
    if width.is_nan() || width < LEAST {
        return Err(CommissionError::Asked(format!(
            "the travel is {width:.3} rad, and a commission needs {LEAST} rad or more: the shaft starts, slides and stops in it"
        )));
    }
    if !Reach::within(travel).holds(place) {
        return Err(CommissionError::Asked(format!(
            "the shaft stands at {place:.3} rad by the encoder, and the travel is from {:.3} to {:.3} rad: turn it by hand to the middle, and begin again",
            travel.min, travel.max
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stages_have_room_before_the_safety_layer_and_it_before_the_ends() {
        let travel = around(5.0, (-1.0, 2.0));
        assert!(travel.min - travel.margin >= 4.0 - 1e-12);
        assert!(travel.max + travel.margin <= 7.0 + 1e-12);
        let reach = Reach::within(&travel);
        assert!(reach.low > travel.min + 0.1 && reach.high < travel.max - 0.1);
        check(&travel, 5.0).unwrap();
        assert!(check(&travel, 7.0).unwrap_err().to_string().contains("middle"));
        let small = check(&around(0.0, (-0.2, 0.2)), 0.0).unwrap_err();
        assert!(small.to_string().contains("needs 0.5 rad") && small.is_bad_input(), "{small}");
    }

    #[test]
    fn what_moves_away_from_an_end_does_not_leave() {
        let reach = Reach { low: -1.0, high: 1.0 };
        assert!(reach.is_left(0.9, 2.0, 0.1) && !reach.is_left(0.9, -2.0, 0.1));
        assert!(reach.is_left(-0.9, -2.0, 0.1) && !reach.is_left(0.9, 0.5, 0.1));
    }
}
