//! What is to be said of the frequencies that are taken for motion.

use std::fmt;

use friction_ident::motion_band::share_beyond;
use friction_ident::quantiser::count_of;
use friction_ident::{Conditioning, IdentError, Signals, adequacy};
use recording::Recording;

use super::channels;
use super::terminal::{hertz, low_pass};

/// Share of the motion beyond the low-pass from which a warning is due.
const TOO_MUCH: f64 = 0.01;

/// That the cutoffs are not the usual one.
pub(super) fn note(recording: &Recording, how: &Conditioning) -> Option<String> {
    let usual = Conditioning::for_time_step(recording.time_step).cutoff;
    let [motion, acceleration, usual_text] =
        [how.cutoff, how.acceleration_cutoff, usual].map(hertz);
    if how.acceleration_cutoff < usual {
        return Some(format!(
            "The acceleration is taken up to {acceleration} Hz, the velocity up to {motion} Hz; usual at this rate are {usual_text} Hz. Above, the noise of the position covers the motion, and would draw the inertia towards zero (--cutoff HZ overrides)."
        ));
    }
    (how.cutoff > usual).then(|| {
        format!(
            "The motion is faster than {usual_text} Hz, which is usual at this rate: it is taken up to {motion} Hz (--cutoff HZ overrides)."
        )
    })
}

/// That the force of a recording has a low-pass too.
pub(super) fn of_the_force(recording: &Recording, how: &Conditioning) -> Option<String> {
    how.low_pass_force.then(|| {
        let (path, cutoff) = (recording.path.display(), hertz(how.cutoff));
        format!(
            "{path}: without its rests the recording is in pieces, and what the force holds above {cutoff} Hz, where the motion ends, would fill their ends: the force has the low-pass of the motion too, with which a plain model predicts clearly better."
        )
    })
}

/// That more is taken of the motion of another recording, `there`, than of this one, `here`.
pub(super) fn faster(
    other: &Recording,
    here: &Conditioning,
    there: &Conditioning,
) -> Option<String> {
    let is_more =
        there.cutoff > here.cutoff || there.acceleration_cutoff > here.acceleration_cutoff;
    is_more.then(|| {
        format!(
            "{}: its motion is faster and is taken up to {} (--cutoff HZ overrides both).",
            other.path.display(),
            low_pass(there)
        )
    })
}

/// Motion that is faster than what is taken of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TooFast {
    share: f64,
    cutoff: f64,
    rate: f64,
    /// Over how many steps of its encoder the position goes, where those are few.
    held: Option<f64>,
}

/// Steps of an encoder within which an axis holds its place and does not move.
const HELD: f64 = 8.0;

impl TooFast {
    /// Whether a recording's motion is.
    pub(super) fn of(recording: &Recording, how: &Conditioning) -> Option<Self> {
        let stretches: Vec<Signals> =
            channels(recording).into_iter().map(|(_, signals)| signals).collect();
        let share = share_beyond(&stretches, how.order, how.cutoff)?;
        let (cutoff, rate) = (how.cutoff, 1.0 / recording.time_step);
        let held = steps(recording).filter(|steps| *steps <= HELD);
        (share > TOO_MUCH).then_some(Self { share, cutoff, rate, held })
    }

    /// The recording is of no use where the best of its models leaves so much of the force besides:
    /// relative error \[%\].
    pub(super) fn refusal(&self, relative_error: f64) -> Option<IdentError> {
        let Self { share, cutoff, rate, held } = *self;
        let explained = 1.0 - (0.01 * relative_error).powi(2);
        let why = match held {
            Some(steps) => IdentError::HoldsStill { steps },
            None => IdentError::CannotFollow { share, cutoff, rate, explained },
        };
        (explained < adequacy::LEAST_EXPLAINED).then_some(why)
    }
}

/// Over how many steps of its encoder a position goes; none where it is no encoder's.
fn steps(recording: &Recording) -> Option<f64> {
    let position = recording.position.as_deref()?;
    let step = count_of(position)?;
    let (low, high) = position
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    Some((high - low) / step)
}

impl fmt::Display for TooFast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.0} % of the motion is faster than the {} Hz that are taken of it: recorded at {} Hz, it cannot be followed. Parameters are not to be trusted, whatever their errors; sample faster or move more slowly.",
            100.0 * self.share,
            hertz(self.cutoff),
            hertz(self.rate)
        )
    }
}
