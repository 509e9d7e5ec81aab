//! The other joints that move while one is recorded.
//!
//! What they do to it, by their weight, their place and their acceleration, is no part of a model of
//! one axis; whoever fits one must know of them.

use serde::Serialize;

/// Travel below which a joint counts as held \[rad or m\].
const HELD: f64 = 0.05;

/// A joint that moves beside the one that is read.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Beside {
    /// Its name.
    pub joint: String,
    /// From its lowest to its highest position \[rad or m\].
    pub travel: f64,
}

impl Beside {
    /// A joint with these positions; none where it is held. What is no number says nothing.
    pub(super) fn of(joint: &str, positions: impl Iterator<Item = f64>) -> Option<Self> {
        let none = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = positions
            .filter(|position| position.is_finite())
            .fold(none, |(low, high), position| (low.min(position), high.max(position)));
        let travel = high - low;
        (travel > HELD).then(|| Self { joint: joint.to_owned(), travel })
    }

    /// Those of several recordings: each joint once, with its longest travel.
    pub(super) fn merge(all: &mut Vec<Self>, more: Vec<Self>) {
        for one in more {
            match all.iter_mut().find(|known| known.joint == one.joint) {
                Some(known) => known.travel = known.travel.max(one.travel),
                None => all.push(one),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_moves_where_it_travels_and_what_is_no_number_does_not() {
        let of = |positions: &[f64]| Beside::of("elbow", positions.iter().copied());
        assert_eq!(of(&[0.5, f64::NAN, 0.51, f64::INFINITY]), None);
        assert_eq!(of(&[]), None);
        let moves = of(&[0.5, f64::NAN, -0.25]).unwrap();
        assert_eq!(moves, Beside { joint: "elbow".to_owned(), travel: 0.75 });
        let mut all = vec![moves.clone()];
        let other = Beside { joint: "wrist".to_owned(), travel: 1.0 };
        Beside::merge(&mut all, vec![Beside { travel: 2.0, ..moves }, other.clone()]);
        assert_eq!(all, [Beside { joint: "elbow".to_owned(), travel: 2.0 }, other]);
    }
}
