//! Whether a simulated servo follows its logs at all.

/// Share of the motion that a fit may miss before it counts as failed.
pub const MOST_MISSED: f64 = 0.25;

/// A mean position error beside what it must be judged by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitQuality {
    /// Mean of |simulated - measured| \[rad\].
    pub error: f64,
    /// Mean of |measured - mean of the log|: the error of one who knows nothing of the motion
    /// \[rad\].
    pub motion: f64,
    /// Mean of |goal - measured|: the error of one who takes the servo for perfect \[rad\].
    pub goal: f64,
}

/// Why a fit has failed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PoorFit {
    /// It misses too much of the motion.
    #[error(
        "the simulated position is {:.0} mrad off on average, {:.0} % of the motion itself \
         ({:.0} mrad; at most {:.0} % may be missed)",
        1e3 * error, 1e2 * error / motion, 1e3 * motion, 1e2 * MOST_MISSED
    )]
    Missed {
        /// Mean error \[rad\].
        error: f64,
        /// Mean deviation of the motion \[rad\].
        motion: f64,
    },
    /// The goal itself is as good a guess.
    #[error(
        "the simulated position is {:.0} mrad off on average, and who takes the goal for the \
         position is off by {:.0} mrad only",
        1e3 * error, 1e3 * goal
    )]
    NoBetterThanGoal {
        /// Mean error \[rad\].
        error: f64,
        /// Mean error of the goal \[rad\].
        goal: f64,
    },
}

impl FitQuality {
    /// Of logs as (measured positions, goals), and the mean error of a simulation of them.
    pub fn of<'a>(logs: impl Iterator<Item = (&'a [f64], &'a [f64])>, error: f64) -> Self {
        let (mut motion, mut goal, mut samples) = (0.0, 0.0, 0.0f64);
        for (position, asked) in logs {
            let mean = position.iter().sum::<f64>() / position.len().max(1) as f64;
            motion += position.iter().map(|q| (q - mean).abs()).sum::<f64>();
            goal += position.iter().zip(asked).map(|(q, g)| (q - g).abs()).sum::<f64>();
            samples += position.len() as f64;
        }
        let samples = samples.max(1.0);
        Self { error, motion: motion / samples, goal: goal / samples }
    }

    /// Why it is a failure; `None` where it is none.
    pub fn doubt(&self) -> Option<PoorFit> {
        let Self { error, motion, goal } = *self;
        if error.is_nan() || error > MOST_MISSED * motion {
            Some(PoorFit::Missed { error, motion })
        } else if error >= goal {
            Some(PoorFit::NoBetterThanGoal { error, goal })
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_radian_is_a_failure_and_a_hundredth_is_none() {
        let position: Vec<f64> = (0..1000).map(|k| (0.02 * f64::from(k)).sin()).collect();
        let goal: Vec<f64> = (0..1000).map(|k| (0.02 * f64::from(k) + 0.2).sin()).collect();
        let of = |error| FitQuality::of([(&position[..], &goal[..])].into_iter(), error).doubt();
        assert!(matches!(of(0.5), Some(PoorFit::Missed { .. })));
        assert!(matches!(of(f64::INFINITY), Some(PoorFit::Missed { .. })));
        assert!(matches!(of(f64::NAN), Some(PoorFit::Missed { .. })));
        // The goal is 0.127 rad off.
        assert!(matches!(of(0.14), Some(PoorFit::NoBetterThanGoal { .. })));
        assert_eq!(of(0.01), None);
        assert!(of(0.5).unwrap().to_string().contains("500 mrad"));
    }
}
