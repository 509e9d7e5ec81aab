//! Whether the force of a recording with rests needs the low-pass of the motion.
//!
//! Above the cutoff the force may hold what the motion has no longer: noise, or an axis that shakes.
//! The low-pass of the thinning takes that away, but not at the ends of pieces, and a recording that is
//! cut at its rests is full of ends. With the low-pass of the motion the force loses it before. A force
//! that jumps where the axis stops loses that too, though, and is better left alone: the recording
//! decides.

use super::{AxisModel, Load, choose_load};
use crate::IdentError;
use crate::conditioning::{Conditioned, Conditioning, Signals, condition_stretches};

/// Share of the error with the force as recorded that must at most be left.
const CLEARLY: f64 = 0.9;

/// Whether rests cut the recording to pieces, and a plain model predicts a force with the low-pass of the
/// motion clearly better than the force as recorded.
pub fn low_pass_of_the_force_helps(stretches: &[(f64, Signals)], how: &Conditioning) -> bool {
    let moving = |low_pass_force: bool| -> Result<Conditioned, IdentError> {
        let how = Conditioning { low_pass_force, ..*how };
        let whole = condition_stretches(stretches, &how)?.coarsened()?;
        whole.moving().map(|(moving, _)| moving)
    };
    let Ok(as_recorded) = moving(false) else { return false };
    if as_recorded.pieces.len() == as_recorded.stretches() {
        return false;
    }
    let errors =
        moving(true).ok().and_then(|other| least_error(&other)).zip(least_error(&as_recorded));
    errors.is_some_and(|(with, without)| with < CLEARLY * without)
}

/// The least error with which a plain model predicts parts of a recording that it was not fitted to \[%\],
/// with whatever load.
fn least_error(recording: &Conditioned) -> Option<f64> {
    let loads = [Load::Spring, Load::Gravity];
    let choice = choose_load(recording, AxisModel::ASYMMETRIC, &loads)
        .or_else(|| choose_load(recording, AxisModel::SYMMETRIC, &loads))?;
    choice.compared.iter().map(|(_, error)| *error).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis_structure::{AxisStructure, AxisUnits, fit_structure};

    const TURN: f64 = std::f64::consts::TAU;

    /// An axis of 0.012 kg m^2 and 0.25 N m goes from point to point in 0.4 s and holds for 0.3 s; while
    /// it moves its controller shakes it at 45 Hz with so many N m.
    fn from_point_to_point(shaken: f64) -> (Vec<f64>, Vec<f64>) {
        let (dt, step) = (5e-3, 2e-5);
        let at = |k: u32| {
            let t = f64::from(k) * dt;
            let (turn, within) = ((t / 0.7).floor(), t % 0.7);
            let way = if turn % 2.0 == 0.0 { 1.0 } else { -1.0 };
            let (u, shake) = ((within / 0.4).min(1.0), TURN * 45.0);
            let moves = if u < 1.0 { 1.0 } else { 0.0 };
            let gone = 2.0 * (u - (TURN * u).sin() / TURN);
            let torque = moves * shaken * (shake * within).sin();
            let acceleration = 2.0 * TURN / 0.16 * (TURN * u).sin();
            let place = way * (gone - 1.0) - torque / (0.012 * shake * shake);
            let force = 0.012 * way * acceleration + torque + 0.25 * way * moves;
            ((place / step).floor() * step, force)
        };
        (0..4000).map(at).unzip()
    }

    /// A stranger's axis with holds: 8 % of the force was left where a fit over the whole recording left
    /// 2.6 %, because the force held what the low-pass takes from the motion, and short pieces kept it.
    #[test]
    fn what_the_motion_has_no_longer_is_taken_from_the_force_of_short_pieces() {
        let fit = |shaken: f64| {
            let (position, force) = from_point_to_point(shaken);
            let signals = Signals {
                time_step: 5e-3,
                position: Some(&position),
                readings: None,
                velocity: None,
                force: &force,
            };
            let stretches = [(0.0, signals)];
            let how = Conditioning::for_time_step(5e-3);
            let low_pass_force = low_pass_of_the_force_helps(&stretches, &how);
            let how = Conditioning { low_pass_force, ..how };
            let (moving, rest) = condition_stretches(&stretches, &how).unwrap().moving().unwrap();
            assert!(rest.out > 5.0, "{rest:?}");
            let fit = fit_structure(&moving, AxisStructure::SYMMETRIC, &AxisUnits::ROTARY).unwrap();
            let off = |name: &'static str, truth: f64| {
                (fit.estimates.value(name).unwrap() / truth - 1.0).abs()
            };
            assert!(off("inertia", 0.012) < 0.01 && off("f_c", 0.25) < 0.05, "{:?}", fit.estimates);
            (low_pass_force, fit.relative_error)
        };
        let (low_pass_force, error) = fit(0.5);
        assert!(low_pass_force && error < 3.0, "{error}");
        let (low_pass_force, error) = fit(0.0);
        assert!(!low_pass_force && error < 3.0, "{error}");
    }

    /// Where nothing is cut the low-pass of the thinning does all that is needed.
    #[test]
    fn the_force_of_a_recording_without_rests_stays_as_it_was_recorded() {
        let (position, force): (Vec<f64>, Vec<f64>) = (0..4000)
            .map(|k| {
                let t = f64::from(k) * 5e-3;
                let shake = 0.5 * (TURN * 45.0 * t).sin();
                (
                    (2.0 * t).sin(),
                    -0.048 * (2.0 * t).sin() + 0.25 * (2.0 * t).cos().signum() + shake,
                )
            })
            .unzip();
        let signals = Signals {
            time_step: 5e-3,
            position: Some(&position),
            readings: None,
            velocity: None,
            force: &force,
        };
        let how = Conditioning::for_time_step(5e-3);
        assert!(!low_pass_of_the_force_helps(&[(0.0, signals)], &how));
    }
}
