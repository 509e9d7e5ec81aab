//! A stretch of a recording on an even grid of times.

use super::between::between;
use super::uneven::Uneven;

/// Where a sample on the even grid is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// The recorded sample at or before it.
    pub index: usize,
    /// Which one follows that; samples may have been dropped between.
    pub next: usize,
    /// How far on the way to the next one it lies, from 0.
    pub part: f64,
}

/// An evenly sampled stretch of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct EvenStretch {
    /// Time of its first sample \[s\].
    pub start: f64,
    /// Sampling period \[s\].
    pub time_step: f64,
    /// The recording was going on before it, and broke off.
    pub after_gap: bool,
    pub(super) places: Places,
}

/// Where the samples of a stretch are read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Places {
    /// At samples, or between two of them.
    Grid(Vec<Place>),
    /// Everywhere between.
    Resampled(Uneven),
}

impl EvenStretch {
    /// Samples.
    #[must_use]
    pub fn len(&self) -> usize {
        match &self.places {
            Places::Grid(places) => places.len(),
            Places::Resampled(uneven) => uneven.len(),
        }
    }

    /// The first two recorded samples of it.
    pub(crate) fn first_two(&self) -> Option<(usize, usize)> {
        let Places::Grid(places) = &self.places else { return None };
        let [first, next, ..] = &places[..] else { return None };
        (next.part == 0.0).then_some((first.index, next.index))
    }

    /// Whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A channel of the recording on the even grid. What was recorded on the grid comes out bit by
    /// bit.
    ///
    /// `step` is that of a quantiser, if the channel comes from one: what is read between two
    /// samples keeps to its steps.
    #[must_use]
    pub fn channel(&self, recorded: &[f64], step: Option<f64>) -> Vec<f64> {
        let value = |index: usize| recorded.get(index).copied().unwrap_or_default();
        let read = |place: &Place| {
            let here = value(place.index);
            if place.part == 0.0 {
                return here;
            }
            between([here, value(place.next)], place.part, step)
        };
        match &self.places {
            Places::Grid(places) => places.iter().map(read).collect(),
            Places::Resampled(uneven) => uneven.channel(recorded, step),
        }
    }

    /// The readings of a sensor that are nearest to the samples, each as it was recorded; none where
    /// the samples were not brought to another rate.
    #[must_use]
    pub fn nearest(&self, recorded: &[f64]) -> Option<Vec<f64>> {
        match &self.places {
            Places::Grid(_) => None,
            Places::Resampled(uneven) => Some(uneven.nearest(recorded)),
        }
    }
}
