//! A Kalman filter on the drive: position, velocity and friction from encoder, tachometer and
//! voltage.
//!
//! ```text
//! theta' = w
//! T w'   = K (u - r F) - w
//! F'     = white noise of intensity q^2
//! ```
//!
//! discretised exactly for a held voltage, with `F` as a random walk. The encoder's rounding counts
//! as even noise, `q_e / sqrt(12)`, the tachometer's as white. The gain is that of the filter after
//! a long time, so that a step costs a few multiplications. The random walk is what lets the filter
//! follow friction that it has no model of: the larger `q`, the sooner it follows a reversal and
//! the more it shows of the encoder's steps.

use friction_model::TimeStep;
use nalgebra::{Matrix1, Matrix2, Matrix2x3, Matrix3, RowVector3, SMatrix, Vector3};

use super::steady_gain::steady_gain;
use crate::finite::held;
use crate::{NominalDrive, ObserverError};

/// Differences beyond this one are a new start, not a motion \[rad\].
const JUMP: f64 = 10.0;

/// A Kalman filter on the drive at a fixed period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KalmanFilter {
    a: Matrix3<f64>,
    /// What 1 V held for a period adds to the states.
    b: Vector3<f64>,
    /// Correction per rad of the encoder's innovation.
    by_encoder: Vector3<f64>,
    /// Correction per rad/s of the tachometer's innovation; zero without a tachometer.
    by_tachometer: Vector3<f64>,
    fused: bool,
    /// Position \[rad\], velocity \[rad/s\] and friction \[N m\]; `None` before the first reading.
    state: Option<Vector3<f64>>,
}

impl KalmanFilter {
    /// A filter that has seen nothing, called once every `dt`. `encoder_step` \[rad\],
    /// `tachometer_noise` \[rad/s\] where the tachometer is used, `friction_walk`
    /// \[N m per square root of a second\].
    ///
    /// # Errors
    /// [`ObserverError::NoGain`] if the Riccati equation has no usable solution for these numbers.
    pub fn new(
        drive: &NominalDrive,
        encoder_step: f64,
        tachometer_noise: Option<f64>,
        friction_walk: f64,
        dt: TimeStep,
    ) -> Result<Self, ObserverError> {
        let h = dt.seconds();
        let NominalDrive { gain, time_constant, volts_per_newton_metre } = *drive;
        let decay = (-h / time_constant).exp();
        let lag = time_constant * (1.0 - decay);
        // What 1 V does to position and velocity in a period.
        let (position, velocity) = (gain * (h - lag), gain * (1.0 - decay));
        let r = volts_per_newton_metre;
        let a = Matrix3::new(1.0, lag, -r * position, 0.0, decay, -r * velocity, 0.0, 0.0, 1.0);
        let b = Vector3::new(position, velocity, 0.0);
        let walk = friction_walk * friction_walk * h;
        // Friction wanders within the period too: half of its way acts on the velocity.
        let way = Vector3::new(-0.5 * r * position, -0.5 * r * velocity, 1.0);
        let q = way * way.transpose() * walk;
        let rounding = encoder_step * encoder_step / 12.0;
        let wrong = ObserverError::NoGain;
        let (by_encoder, by_tachometer) = match tachometer_noise {
            None => {
                let c = RowVector3::new(1.0, 0.0, 0.0);
                let gain = steady_gain(&a, &c, &q, &Matrix1::new(rounding)).ok_or(wrong)?;
                (gain, Vector3::zeros())
            }
            Some(noise) => {
                let c = Matrix2x3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
                let r = Matrix2::new(rounding, 0.0, 0.0, noise * noise);
                let gain: SMatrix<f64, 3, 2> = steady_gain(&a, &c, &q, &r).ok_or(wrong)?;
                (gain.column(0).into(), gain.column(1).into())
            }
        };
        let fused = tachometer_noise.is_some();
        Ok(Self { a, b, by_encoder, by_tachometer, fused, state: None })
    }

    /// Takes the readings in, as far as there are any, and the `voltage` \[V\] applied since the
    /// last call; the velocity now \[rad/s\]. Not a number before the first position.
    #[inline]
    pub fn step(&mut self, position: Option<f64>, tachometer: Option<f64>, voltage: f64) -> f64 {
        let Some(before) = self.state else {
            let Some(position) = position else { return f64::NAN };
            let velocity = tachometer.filter(|_| self.fused).unwrap_or(0.0);
            self.state = Some(Vector3::new(position, velocity, 0.0));
            return velocity;
        };
        let mut state = self.a * before + self.b * held(voltage);
        let ahead = state;
        if let Some(position) = position {
            let innovation = position - ahead.x;
            if innovation.abs() < JUMP {
                state += self.by_encoder * innovation;
            } else {
                state.x = position;
            }
        }
        if let Some(tachometer) = tachometer {
            state += self.by_tachometer * (tachometer - ahead.y);
        }
        (state.y, state.z) = (held(state.y), held(state.z));
        self.state = Some(state);
        state.y
    }

    /// Forgets what it has seen.
    pub fn reset(&mut self) {
        self.state = None;
    }
}
