//! From what was read of a stretch to motion and friction.

use friction_ident::quantiser::{
    Turn, between_counts, count_of, path_beside_velocity, path_within_scatter, step_of,
};
use friction_ident::stretch::Before;
use friction_ident::zero_phase::{LowPass, decimate};
use friction_ident::{
    ChannelDeviations, ConstantError, DriveSignals, IdentError, SavitzkyGolay, Stretch,
    friction_torque,
};

use super::{FrictionRecording, Outlier, Preparation, Samples, Smoothing};
use crate::timing::EvenStretch;

pub(super) fn prepare(
    samples: &Samples,
    even: &EvenStretch,
    how: &Preparation,
    found: &mut FrictionRecording,
) -> Result<(Stretch, Vec<ConstantError>), IdentError> {
    let dt = even.time_step;
    let mut clean = |channel: &'static str, values: &[f64]| -> Result<Vec<f64>, IdentError> {
        let Some(hampel) = how.outliers else { return Ok(values.to_vec()) };
        let cleaned = hampel.clean(values)?;
        found.outliers.extend(cleaned.replaced.iter().map(|replaced| Outlier {
            channel,
            time: even.start + replaced.index as f64 * dt,
            measured: replaced.measured,
            by: replaced.by,
        }));
        Ok(cleaned.signal)
    };
    let column = clean("force", &even.channel(&samples.force, None))?;
    let velocity = samples.velocity.as_ref().map(|values| even.channel(values, None));
    let velocity = velocity.map(|values| clean("velocity", &values)).transpose()?;
    let position = samples.position.as_ref().map(|values| even.channel(values, samples.step));
    let position = position.map(|values| clean("position", &values)).transpose()?;
    // Neither an encoder's steps nor a sensor's noise are motion: a path between the readings is used.
    let position = match (position, &velocity) {
        (Some(position), Some(velocity)) => {
            let count = count_of(&position).unwrap_or(0.0);
            Some(path_beside_velocity(&position, count, velocity, dt))
        }
        (Some(position), None) => Some(match step_of(&position) {
            Some(step) => between_steps(position, step)?,
            None => path_within_scatter(&position),
        }),
        (None, _) => None,
    };

    let filter = SavitzkyGolay::new(3, frame(dt, even.len()))?;
    let rate = 1.0 / dt;
    let smooth = |signal: &[f64]| -> Result<Vec<f64>, IdentError> {
        match how.smoothing {
            Smoothing::SavitzkyGolay => filter.smooth(signal),
            Smoothing::Butterworth => {
                let cutoff = how.cutoff.unwrap_or((rate / 10.0).min(100.0));
                LowPass::butterworth(how.order, cutoff, rate)?.filter(signal)
            }
            Smoothing::None => Ok(signal.to_vec()),
        }
    };
    let position = position.map(|position| smooth(&position)).transpose()?;
    let from_position = velocity.is_none();
    let measured = match (velocity, &position) {
        (Some(velocity), _) => velocity,
        (None, Some(position)) => filter.derivative(position, dt)?,
        (None, None) => return Err(IdentError::NoMotion),
    };
    let signals = DriveSignals {
        time_step: dt,
        velocity: &measured,
        torque: &column,
        voltage: &column,
        current: &column,
    };
    // What the scatter of the samples is, the residuals of the fit say.
    let friction =
        friction_torque(how.torque, &signals, &how.constants(), &ChannelDeviations::default())?;
    let velocity = if from_position { measured } else { smooth(&measured)? };
    let thin = |values: Vec<f64>| decimate(&values, how.decimate);
    let mut stretch = Stretch::new(
        dt * how.decimate as f64,
        thin(velocity)?,
        position.map(thin).transpose()?,
        thin(friction.torque)?,
    )?;
    // Experiment 2 begins at a fortieth of its fastest velocity, and has slid before.
    let fastest = stretch.velocity.iter().fold(0.0f64, |fastest, v| fastest.max(v.abs()));
    if stretch.velocity.first().is_some_and(|v| v.abs() < 0.01 * fastest) {
        stretch.before = Before::Rested;
    } else if even.after_gap {
        // The motion went on while nothing was recorded.
        stretch.before = Before::Slid;
    }
    let thinned = |error: ConstantError| Ok(ConstantError { torque: thin(error.torque)?, ..error });
    let errors = friction.constants.into_iter().map(thinned).collect::<Result<_, IdentError>>()?;
    Ok((stretch, errors))
}

/// Counts a sample, on average, from which an encoder is fine enough to be differentiated as it is.
const FINE: f64 = 16.0;

/// The position between the counts of an encoder \[m or rad\]. One that hardly moved has no path
/// between its counts and stays as it is; so does one whose counts are much finer than its motion,
/// of which the edges passed would fill the memory.
fn between_steps(position: Vec<f64>, step: f64) -> Result<Vec<f64>, IdentError> {
    let way: f64 = position.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
    if way > FINE * step * position.len() as f64 {
        return Ok(position);
    }
    let first = position.first().copied().unwrap_or(0.0);
    match between_counts(&position, step, Turn::Sharp) {
        Ok(path) => Ok(path.into_iter().map(|x| first + x).collect()),
        Err(IdentError::TooFewSamples { .. }) => Ok(position),
        Err(error) => Err(error),
    }
}

/// Samples of the thesis's 31 ms, odd, five at least and no more than there are.
fn frame(dt: f64, samples: usize) -> usize {
    let half = (0.0155 / dt).round().clamp(2.0, 15.0) as usize;
    (2 * half + 1).min(samples - (samples + 1) % 2)
}
