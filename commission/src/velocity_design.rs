//! The linear velocity loop that a drive allows: a PI as fast as margins, delay and the noise of its
//! velocity let it be.
//!
//! Its velocity is the tachometer's. Where there is none a device gives the encoder's difference
//! over ten cycles: later by five of them, and in steps of a count over ten cycles.

use controller::design::frequency::margins;
use controller::design::{LinearLoop, LoopLaw, PiSpecification, pi_from_specification};
use controller::{PiGains, VelocityLaw};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::loop_design::{PEAK, Plant, QUICK};

/// Cycles over which a device takes the encoder's difference.
const DIFFERENCE: f64 = 10.0;
/// Phase margin that is designed for \[degrees\].
const MARGIN: f64 = 65.0;
/// Fastest and slowest crossover that is looked at [rad/s], and the ratio of two neighbours.
const FASTEST: f64 = 400.0;
const SLOWEST: f64 = 0.5;
const RATIO: f64 = 0.93;

/// A velocity loop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct VelocityDesign {
    /// Gains.
    pub gains: PiGains,
    /// Crossover [rad/s].
    pub crossover: f64,
    /// Peak of the sensitivity function, sampled and with the delay.
    pub sensitivity_peak: f64,
    /// Root mean square of the voltage that the velocity's noise makes \[V\].
    pub noise: f64,
}

/// The loop for the noise of the tachometer [rad/s], or for the encoder where there is none.
///
/// None where no loop keeps the margins.
#[must_use]
pub fn velocity_design(plant: &Plant, tachometer_noise: Option<f64>) -> Option<VelocityDesign> {
    let window = DIFFERENCE * plant.period;
    let (noise, later) = match tachometer_noise {
        Some(noise) => (noise, 0.0),
        // Two roundings, each even over a step.
        None => (plant.encoder_step / 6f64.sqrt() / window, 0.5 * window),
    };
    let delay = plant.delay.max(0.0) + later;
    let mut crossover = FASTEST;
    while crossover > SLOWEST {
        if let Some(found) = candidate(plant, (noise, delay), crossover) {
            return Some(found);
        }
        crossover *= RATIO;
    }
    None
}

fn candidate(plant: &Plant, (noise, delay): (f64, f64), crossover: f64) -> Option<VelocityDesign> {
    // What the delay takes of the phase the specification has to have more.
    let taken = (crossover * (delay + 0.5 * plant.period)).to_degrees();
    // A drive slower than the loop needs less lead than the margin: its own lag is the limit.
    let most = 179.0 - (crossover * plant.drive.time_constant).atan().to_degrees();
    let phase_margin = (MARGIN + taken).min(most);
    let gains =
        pi_from_specification(&plant.drive, &PiSpecification { crossover, phase_margin }).ok()?;
    let noise = gains.k_p * noise;
    let linear = LinearLoop { drive: plant.drive, law: LoopLaw::Velocity(VelocityLaw::Pi(gains)) };
    let late = |w: f64| Complex::from_polar(1.0, -w * delay);
    let open = |w: f64| linear.open_sampled(w, plant.period) * late(w);
    let nyquist = 0.999 * std::f64::consts::PI / plant.period;
    let found = margins(open, 0.01 * crossover, nyquist);
    let stable = found.phase_margin.is_some_and(|margin| margin > 30.0)
        && found.gain_margin.is_none_or(|margin| margin > 2.0);
    let sensitivity_peak = found.sensitivity_peak;
    let good = stable && sensitivity_peak <= PEAK && noise <= QUICK * plant.voltage_limit;
    good.then_some(VelocityDesign { gains, crossover, sensitivity_peak, noise })
}

#[cfg(test)]
mod tests {
    use controller::design::LinearDrive;

    use super::*;

    #[test]
    fn delay_noise_and_a_coarse_encoder_make_the_loop_slower() {
        let plant = Plant {
            drive: LinearDrive::THESIS,
            delay: 0.0,
            period: 1e-3,
            encoder_step: std::f64::consts::TAU / 4096.0,
            voltage_limit: 6.0,
        };
        let quick = velocity_design(&plant, Some(0.01)).unwrap();
        let noisy = velocity_design(&plant, Some(0.3)).unwrap();
        let late = velocity_design(&Plant { delay: 0.01, ..plant }, Some(0.01)).unwrap();
        let encoder = velocity_design(&plant, None).unwrap();
        assert!(quick.crossover > 50.0, "{quick:?}");
        for found in [quick, noisy, late, encoder] {
            assert!(found.sensitivity_peak <= PEAK && found.noise <= QUICK * 6.0, "{found:?}");
            assert!(found.gains.k_p > 0.0 && found.gains.k_i > 0.0);
        }
        for slower in [noisy, late, encoder] {
            assert!(slower.crossover < quick.crossover, "{slower:?}");
        }
        assert_eq!(velocity_design(&Plant { delay: 5.0, ..plant }, None), None);
    }
}
