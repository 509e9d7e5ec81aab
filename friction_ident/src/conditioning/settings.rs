//! How a recording is conditioned.

/// How a recording is conditioned and thinned.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Conditioning {
    /// Cutoff of the low-pass of position and velocity \[Hz\], where its zero-phase gain is one
    /// half.
    pub cutoff: f64,
    /// Cutoff of that of the acceleration \[Hz\]; one above `cutoff` counts as that.
    pub acceleration_cutoff: f64,
    /// Order of the low-pass in one direction, 1 to 12.
    pub order: usize,
    /// How derivatives are taken.
    pub differences: Differences,
    /// Samples dropped at each end.
    pub trim: usize,
    /// Every how many samples one is kept for the regression, after an anti-alias low-pass; one
    /// keeps all.
    pub decimate: usize,
    /// Whether the force has the low-pass of the motion too, which is of use where rests cut the
    /// recording to pieces
    /// ([`low_pass_of_the_force_helps`](crate::rigid_axis::low_pass_of_the_force_helps)).
    pub low_pass_force: bool,
}

impl Conditioning {
    /// That of another recording of the same axis and rate, which suits it as `own` does: the same where the
    /// motion there is no faster, and else up to where it is.
    #[must_use]
    pub fn elsewhere(self, own: Self) -> Self {
        if own.cutoff <= self.cutoff && own.acceleration_cutoff <= self.acceleration_cutoff {
            return self;
        }
        Self {
            cutoff: own.cutoff.max(self.cutoff),
            acceleration_cutoff: own.acceleration_cutoff.max(self.acceleration_cutoff),
            decimate: own.decimate.min(self.decimate),
            trim: own.trim,
            ..self
        }
    }

    /// What suits a recording with the sampling period `time_step` \[s\]: a tenth of the sampling
    /// rate but at most 100 Hz, fourth order, 50 samples off each end, and decimation to about the
    /// cutoff. At 1 kHz this is the conditioning published with the EMPS benchmark.
    pub fn for_time_step(time_step: f64) -> Self {
        let rate = 1.0 / time_step;
        let cutoff = (rate / 10.0).min(100.0);
        Self {
            cutoff,
            acceleration_cutoff: cutoff,
            order: 4,
            differences: Differences::SecondOrder,
            trim: 50,
            decimate: ((rate / cutoff).round() as usize).clamp(1, 1000),
            low_pass_force: false,
        }
    }
}

/// Central differences. At a frequency `w` they lose a share of the derivative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Differences {
    /// Of two samples: `(w dt)^2 / 6` is lost, 6 % at a tenth of the sampling rate.
    SecondOrder,
    /// Of six: `(w dt)^6 / 140`, 0.05 % there. More of the noise passes.
    SixthOrder,
}
impl Differences {
    /// The derivative of a signal, inside by central differences, next to the ends by shorter and
    /// one-sided ones. `signal` has at least two samples.
    pub(super) fn of(self, signal: &[f64], dt: f64) -> Vec<f64> {
        let last = signal.len() - 1;
        let longest = match self {
            Self::SecondOrder => 1,
            Self::SixthOrder => 3,
        };
        let slope = |k: usize| {
            let across = |reach: usize| signal[k + reach] - signal[k - reach];
            match k.min(last - k).min(longest) {
                0 if k == 0 => signal[1] - signal[0],
                0 => signal[last] - signal[last - 1],
                1 => across(1) / 2.0,
                2 => (8.0 * across(1) - across(2)) / 12.0,
                _ => (45.0 * across(1) - 9.0 * across(2) + across(3)) / 60.0,
            }
        };
        (0..=last).map(|k| slope(k) / dt).collect()
    }
}
