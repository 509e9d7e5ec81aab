//! The linear position loop that a drive allows: as fast as its margins, its delay and the noise
//! of its encoder let it be.

use controller::design::frequency::margins;
use controller::design::{LinearDrive, LinearLoop, LoopLaw, PositionPoles, pid_from_poles};
use controller::{ControlMode, ControllerOptions, DerivativeOn, PidGains};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::{CommissionError, Stage};

/// Largest sensitivity peak of a loop as it runs.
pub const PEAK: f64 = 1.4;
/// Largest share of the voltage limit that the steps of the encoder make as noise, where the loop
/// is to follow well.
pub const QUICK: f64 = 0.02;
/// The same where it is to be steady: a slow shaft must not be shaken by the encoder's steps.
pub const STEADY: f64 = 0.003;
/// Damping ratio of its dominant poles.
const DAMPING: f64 = 0.7;
/// Fastest and slowest loop that is looked at [rad/s], and the ratio of two neighbours.
const FASTEST: f64 = 300.0;
const SLOWEST: f64 = 0.5;
const RATIO: f64 = 0.95;

/// A loop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LoopDesign {
    /// Gains.
    pub gains: PidGains,
    /// Time constant of the derivative's filter \[s\].
    pub filter: f64,
    /// Natural frequency of its poles [rad/s].
    pub natural_frequency: f64,
    /// Peak of the sensitivity function, sampled and with the delay.
    pub sensitivity_peak: f64,
    /// Root mean square of the voltage that the steps of the encoder make \[V\].
    pub noise: f64,
}

/// What a loop is designed for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plant {
    /// The drive.
    pub drive: LinearDrive,
    /// Delay beyond the sampling \[s\].
    pub delay: f64,
    /// Period \[s\].
    pub period: f64,
    /// Angle of one count \[rad\].
    pub encoder_step: f64,
    /// Voltage limit \[V\].
    pub voltage_limit: f64,
}

/// The fastest loop within the margins whose noise is at most that share of the voltage limit.
///
/// # Errors
/// [`CommissionError::Unusable`] where none is.
pub fn design(plant: &Plant, noise: f64, stage: Stage) -> Result<LoopDesign, CommissionError> {
    design_below(plant, noise, FASTEST, stage)
}

/// The same, no faster than `fastest` [rad/s].
///
/// # Errors
/// As for [`design`].
pub fn design_below(
    plant: &Plant,
    noise: f64,
    fastest: f64,
    stage: Stage,
) -> Result<LoopDesign, CommissionError> {
    let mut natural_frequency = fastest.min(FASTEST);
    while natural_frequency > SLOWEST {
        if let Some(found) = candidate(plant, noise, natural_frequency)? {
            return Ok(found);
        }
        natural_frequency *= RATIO;
    }
    Err(CommissionError::Unusable {
        stage,
        why: format!(
            "no position loop keeps a sensitivity peak of {PEAK} with this drive (K = {:.3} rad/s per V, T = {:.4} s, delay {:.4} s) and encoder; `frictionlab design position` tries gains of your own",
            plant.drive.gain, plant.drive.time_constant, plant.delay
        ),
    })
}

/// The loop of that frequency, if it keeps the margins.
fn candidate(plant: &Plant, most: f64, w: f64) -> Result<Option<LoopDesign>, CommissionError> {
    // A loop slower than the drive leaves the drive's own pole where it is: no derivative then.
    let own = 1.0 / plant.drive.time_constant - 2.0 * DAMPING * w;
    let real_pole = own.max(4.0 / 3.0 * w);
    let poles = PositionPoles { damping: DAMPING, natural_frequency: w, real_pole };
    let gains = pid_from_poles(&plant.drive, &poles)?;
    // Rounding may leave a little less than none.
    let gains = PidGains { k_d: gains.k_d.max(0.0), ..gains };
    let filter = (0.2 / w).clamp(2.0 * plant.period, 0.02);
    // The steps of the encoder are even noise; the filtered derivative multiplies them most.
    let noise = (gains.k_p + gains.k_d / filter) * plant.encoder_step / 12f64.sqrt();
    if noise > most * plant.voltage_limit {
        return Ok(None);
    }
    let law = LoopLaw::Position { gains, derivative_on: DerivativeOn::Error, filter };
    let linear = LinearLoop { drive: plant.drive, law };
    linear.check(plant.period)?;
    let late = |frequency: f64| Complex::from_polar(1.0, -frequency * plant.delay.max(0.0));
    let nyquist = 0.999 * std::f64::consts::PI / plant.period;
    let open = |frequency: f64| linear.open_sampled(frequency, plant.period) * late(frequency);
    let found = margins(open, 0.01 * w, nyquist);
    // Behind a crossover without phase margin the peak is no measure: the loop is unstable.
    let stable = found.phase_margin.is_some_and(|margin| margin > 30.0)
        && found.gain_margin.is_none_or(|margin| margin > 2.0);
    let sensitivity_peak = found.sensitivity_peak;
    Ok((stable && sensitivity_peak <= PEAK).then_some(LoopDesign {
        gains,
        filter,
        natural_frequency: w,
        sensitivity_peak,
        noise,
    }))
}

impl LoopDesign {
    /// The controller of the loop; nothing is compensated.
    #[must_use]
    pub fn controller(&self, plant: &Plant) -> ControllerOptions {
        let mut options = ControllerOptions {
            mode: ControlMode::Position,
            period: plant.period,
            pid: self.gains,
            derivative_on: DerivativeOn::Error,
            derivative_filter: self.filter,
            voltage_limit: plant.voltage_limit,
            ..ControllerOptions::default()
        };
        options.compensation.enabled = false;
        options
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plant() -> Plant {
        Plant {
            drive: LinearDrive::THESIS,
            delay: 0.0,
            period: 1e-3,
            encoder_step: std::f64::consts::TAU / 4096.0,
            voltage_limit: 6.0,
        }
    }

    #[test]
    fn delay_and_a_coarse_encoder_make_the_loop_slower() {
        let of = |plant: &Plant| design(plant, QUICK, Stage::Control).unwrap();
        let usual = of(&plant());
        let late = of(&Plant { delay: 0.01, ..plant() });
        let coarse = of(&Plant { encoder_step: 0.0126, ..plant() });
        for found in [usual, late, coarse] {
            assert!(found.sensitivity_peak <= PEAK && found.noise <= QUICK * 6.0, "{found:?}");
        }
        assert!(usual.natural_frequency > 20.0, "{usual:?}");
        assert!(late.natural_frequency < usual.natural_frequency, "{late:?}");
        assert!(coarse.natural_frequency < usual.natural_frequency, "{coarse:?}");
    }

    #[test]
    fn a_drive_that_no_loop_holds_is_refused_with_what_to_try() {
        let said = design(&Plant { delay: 2.0, ..plant() }, QUICK, Stage::Friction).unwrap_err();
        assert!(said.to_string().contains("frictionlab design position"), "{said}");
    }
}
