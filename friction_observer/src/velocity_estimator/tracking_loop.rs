//! A tracking loop (phase-locked loop) on the encoder: a filter of second order that follows a ramp
//! without lag.
//!
//! ```text
//! theta^' = w^ + 2 b (theta - theta^)
//! w^'     = b^2 (theta - theta^)
//! ```
//!
//! Both poles lie at `-b`, the bandwidth \[rad/s\]. In discrete time it is an alpha-beta filter
//! with both poles at `p = exp(-b dt)`: `alpha = 1 - p^2`, `beta = (1 - p)^2`, stable for every
//! bandwidth (Benedict and Bordner 1962; the critically damped choice). At a constant velocity the
//! error is zero, at a constant acceleration `a` it is `2 a / b`. A step of the encoder `q` shows
//! as a velocity of at most `beta q / dt`, about `b^2 q dt`.

use friction_model::TimeStep;

use crate::finite::held;

/// Differences beyond this one are a new start, not a motion \[rad\].
const JUMP: f64 = 10.0;

/// A tracking loop running at a fixed period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackingLoop {
    dt: f64,
    alpha: f64,
    beta_over_dt: f64,
    /// Position and velocity; `None` before the first reading.
    state: Option<(f64, f64)>,
}

impl TrackingLoop {
    /// A loop with `bandwidth` \[rad/s\], called once every `dt`.
    #[must_use]
    pub fn new(bandwidth: f64, dt: TimeStep) -> Self {
        let dt = dt.seconds();
        let p = (-bandwidth * dt).exp();
        Self { dt, alpha: 1.0 - p * p, beta_over_dt: (1.0 - p).powi(2) / dt, state: None }
    }

    /// Takes the encoder's `position` \[rad\] in; the velocity now \[rad/s\]. The position must be
    /// finite. After a jump of more than 10 rad the loop goes on from there with the velocity it
    /// had.
    #[inline]
    pub fn step(&mut self, position: f64) -> f64 {
        let (theta, velocity) = self.state.unwrap_or((position, 0.0));
        let ahead = theta + velocity * self.dt;
        let error = position - ahead;
        let (theta, velocity) = if error.abs() < JUMP {
            (ahead + self.alpha * error, held(velocity + self.beta_over_dt * error))
        } else {
            (position, velocity)
        };
        self.state = Some((theta, velocity));
        velocity
    }

    /// Forgets what it has seen.
    pub fn reset(&mut self) {
        self.state = None;
    }
}
