//! Peak of the sensitivity and noise of the voltage, of the loop as it runs.
//!
//! The loop is linearised about steady motion by two runs that differ in one small impulse of
//! voltage: what both give less each other is the impulse response of the sensitivity function
//! `S = 1 / (1 + L)`, with sampling, delay, filters and whatever the estimator feeds back. Its
//! Fourier transform has the peak. Another pair differs in the encoder's rounding, as even noise:
//! what the voltages differ by is the noise.
//!
//! Super-twisting and the fuzzy table are steepest about zero deviation, where the impulse acts: of
//! theirs this is the worst.

use controller::Reference;

use super::{Identified, Looped, Settings};
use crate::CommissionError;

/// Voltage of the impulse \[V\]: small beside every friction.
const IMPULSE: f64 = 1e-5;
/// Time to settle, and time that is looked at, in time constants of the loop.
const SETTLES: f64 = 15.0;
const LASTS: f64 = 40.0;
/// Fewest and most cycles of either.
const CYCLES: (f64, f64) = (800.0, 30_000.0);
/// What may be left of the response in its last tenth, of its largest.
const LEFT: f64 = 0.02;
/// Frequencies a decade.
const A_DECADE: f64 = 60.0;

/// How robust a loop is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robustness {
    /// Peak of the sensitivity function; infinite for a loop that does not settle.
    pub peak: f64,
    /// Root mean square of the voltage that the encoder's steps make \[V\].
    pub noise: f64,
}

/// That of the loop of `settings` about motion at `velocity` [rad/s], whose time constant is
/// `1/frequency`.
///
/// # Errors
/// [`CommissionError`] for settings that cannot be.
pub fn robustness(
    identified: &Identified,
    settings: &Settings,
    (velocity, frequency): (f64, f64),
) -> Result<Robustness, CommissionError> {
    let period = identified.plant.period;
    let cycles = |lengths: f64| (lengths / frequency / period).clamp(CYCLES.0, CYCLES.1) as usize;
    let (settles, lasts) = (cycles(SETTLES), cycles(LASTS));
    let wanted = |looped: &Looped| Reference {
        position: velocity * looped.time(),
        velocity,
        acceleration: 0.0,
    };
    let mut quiet = Looped::new(identified, settings, velocity)?;
    for _ in 0..settles {
        quiet.step_free(&wanted(&quiet), 0.0, 0.0);
    }
    let (mut struck, mut noisy) = (quiet.clone(), quiet.clone());
    let mut rounding = Rounding { state: 1, step: identified.plant.encoder_step };
    let mut response = Vec::with_capacity(lasts);
    let mut noise = 0.0;
    for cycle in 0..lasts {
        let added = if cycle == 0 { IMPULSE } else { 0.0 };
        let at = wanted(&quiet);
        let calm = quiet.step_free(&at, 0.0, 0.0).volts;
        response.push((struck.step_free(&at, 0.0, added).volts + added - calm) / IMPULSE);
        noise += (noisy.step_free(&at, rounding.next(), 0.0).volts - calm).powi(2);
    }
    let noise = (noise / lasts as f64).sqrt();
    Ok(Robustness { peak: peak(&response, frequency * period), noise })
}

/// The peak of the Fourier transform of a response that has died down.
fn peak(response: &[f64], lowest: f64) -> f64 {
    let largest = |part: &[f64]| part.iter().map(|x| x.abs()).fold(0.0, f64::max);
    let tail = largest(response.get(response.len() - response.len() / 10..).unwrap_or(&[]));
    // Not a number is no response that has died down.
    let died = tail <= LEFT * largest(response);
    if !died {
        return f64::INFINITY;
    }
    controller::design::frequency::frequencies(0.1 * lowest, std::f64::consts::PI, A_DECADE)
        .into_iter()
        .map(|angle| {
            let turn = nalgebra::Complex::from_polar(1.0, -angle);
            let mut at = nalgebra::Complex::new(1.0, 0.0);
            let mut sum = nalgebra::Complex::new(0.0, 0.0);
            for x in response {
                sum += at * *x;
                at *= turn;
            }
            sum.norm()
        })
        .fold(0.0, f64::max)
}

/// Even noise of one step, always the same.
struct Rounding {
    state: u64,
    step: f64,
}

impl Rounding {
    fn next(&mut self) -> f64 {
        // Knuth's linear congruence; its upper bits are used.
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let share = (self.state >> 11) as f64 / (1u64 << 53) as f64;
        (share - 0.5) * self.step
    }
}

#[cfg(test)]
mod tests {
    use controller::design::LinearDrive;
    use friction_model::ModelName;
    use friction_observer::EstimatorOptions;

    use super::*;
    use crate::Stage;
    use crate::identified::Levels;
    use crate::loop_design::{Plant, QUICK, design};

    /// What runs has the peak and the noise that the design computes.
    #[test]
    fn the_loop_that_runs_has_the_peak_of_its_design() {
        for delay in [0.0, 0.003] {
            let plant = Plant {
                drive: LinearDrive::THESIS,
                delay,
                period: 1e-3,
                encoder_step: std::f64::consts::TAU / 4096.0,
                voltage_limit: 6.0,
            };
            let found = design(&plant, QUICK, Stage::Control).unwrap();
            let identified =
                Identified { plant, levels: Levels { f_s: 0.5, f_c: 0.4, v_s: 0.01, delta: 2.0 } };
            let settings = Settings {
                controller: found.controller(&plant),
                estimator: EstimatorOptions::default(),
                friction: friction_model::AnyModel::test_bed(ModelName::Stribeck),
            };
            let seen = robustness(&identified, &settings, (1.0, found.natural_frequency)).unwrap();
            assert!((seen.peak / found.sensitivity_peak - 1.0).abs() < 0.02, "{seen:?} {found:?}");
            assert!((0.7..1.3).contains(&(seen.noise / found.noise)), "{seen:?} {found:?}");
        }
    }
}
