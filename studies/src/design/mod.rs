//! A linear loop assessed: step response, margins, what theory says of it under friction.
//!
//! [`assess`] computes, [`page()`] and [`summary`] show, [`parameters`] is the file that `run` and
//! `live` read, [`document`] the one for programs.

pub mod asked;
mod document;
mod page;
mod parameters;
mod terminal;
mod worth;

use controller::ControllerError;
use controller::PidGains;
use controller::design::frequency::{Margins, frequencies, margins, margins_sampled};
use controller::design::response::{StepDefinition, StepFigures, StepResponse, step_response};
use controller::design::sector::{SectorMargin, friction_to_velocity, sector_margin};
use controller::design::theory::{PositiveRealness, position_theorem, positive_realness};
use controller::design::{LinearLoop, LoopLaw};

pub use document::document;
pub use page::page;
pub use parameters::parameters;
pub use terminal::summary;
pub use worth::{Tracked, Worth};

/// What is assessed.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignOptions {
    /// Drive and law.
    pub linear: LinearLoop,
    /// Control period \[s\].
    pub period: f64,
    /// Voltage that overcomes 1 N m of friction [V/(N m)].
    pub volts_per_newton_metre: f64,
    /// What was asked for, in words.
    pub asked: String,
}

/// What it is worth.
#[derive(Debug, Clone)]
pub struct Assessment {
    /// What was assessed.
    pub options: DesignOptions,
    /// Step response with the discrete controller.
    pub response: StepResponse,
    /// Its figures with each definition of rise and settling.
    pub figures: Vec<(StepDefinition, StepFigures)>,
    /// Margins, continuous in time.
    pub continuous: Margins,
    /// Margins as the loop runs, sampled.
    pub sampled: Margins,
    /// Open loop.
    pub bode: Bode,
    /// Whether velocity under a braking torque is (strictly) positive real.
    pub realness: PositiveRealness,
    /// Of a position loop: from where on the real part of `G(jw)` of the thesis's theorem 5.2 is
    /// negative [rad/s].
    pub theorem_fails_from: Option<f64>,
    /// Friction that is proven harmless.
    pub sector: SectorMargin,
    /// What it is worth on a rig, where that was asked for.
    pub worth: Option<Worth>,
}

/// The open loop over frequency.
#[derive(Debug, Clone, Default)]
pub struct Bode {
    /// Frequency [rad/s].
    pub frequency: Vec<f64>,
    /// Gain \[dB\] and phase \[degrees\], continuous in time.
    pub continuous: (Vec<f64>, Vec<f64>),
    /// Gain \[dB\] and phase \[degrees\] as it runs; ends at the Nyquist frequency.
    pub sampled: (Vec<f64>, Vec<f64>),
}

/// Assesses a loop.
///
/// # Errors
/// [`ControllerError`] names the gain, drive or period that cannot be.
pub fn assess(options: DesignOptions) -> Result<Assessment, ControllerError> {
    let DesignOptions { linear, period, volts_per_newton_metre, .. } = options;
    linear.check(period)?;
    let h = friction_to_velocity(&linear, volts_per_newton_metre)?;
    let response = step_response(&linear, period, seconds(&linear, period))?;
    let definitions = [StepDefinition::default(), StepDefinition::FIVE_PERCENT];
    let nyquist = 0.999 * std::f64::consts::PI / period;
    let lowest = 1e-4 / linear.drive.time_constant;
    let open = |w: f64| linear.open(w);
    let theorem_fails_from = match linear.law {
        LoopLaw::Velocity(_) => None,
        LoopLaw::Position { gains, .. } => {
            let r = volts_per_newton_metre;
            let inertia = linear.drive.time_constant / (linear.drive.gain * r);
            let torque = PidGains {
                k_p: gains.k_p / r,
                k_i: gains.k_i / r,
                k_d: (gains.k_d + 1.0 / linear.drive.gain) / r,
            };
            position_theorem(inertia, torque)?
                .real_part()
                .positive_roots()
                .and_then(|roots| roots.last().copied())
                .map(f64::sqrt)
        }
    };
    Ok(Assessment {
        figures: definitions
            .iter()
            .map(|definition| (*definition, response.figures(definition)))
            .collect(),
        response,
        continuous: margins(open, lowest, 1e3 / period),
        sampled: margins_sampled(&linear, period, lowest),
        bode: bode(&linear, period, nyquist),
        realness: positive_realness(&h),
        theorem_fails_from,
        sector: sector_margin(&h),
        worth: None,
        options,
    })
}

/// Long enough for the slowest pole of the closed loop, or a second where it does not settle; at
/// most a minute.
fn seconds(linear: &LinearLoop, period: f64) -> f64 {
    let slowest = linear
        .characteristic()
        .roots()
        .into_iter()
        .flatten()
        .map(|pole| -pole.re)
        .fold(f64::INFINITY, f64::min);
    if slowest > 0.0 { (8.0 / slowest).clamp(20.0 * period, 60.0) } else { 1.0 }
}

fn bode(linear: &LinearLoop, period: f64, nyquist: f64) -> Bode {
    let mut bode = Bode { frequency: frequencies(0.1, 10.0 / period, 60.0), ..Bode::default() };
    for &w in &bode.frequency {
        let at = linear.open(w);
        bode.continuous.0.push(20.0 * at.norm().log10());
        bode.continuous.1.push(at.arg().to_degrees());
        let at = if w < nyquist { linear.open_sampled(w, period) } else { f64::NAN.into() };
        bode.sampled.0.push(20.0 * at.norm().log10());
        bode.sampled.1.push(at.arg().to_degrees());
    }
    unwrap(&mut bode.continuous.1);
    unwrap(&mut bode.sampled.1);
    bode
}

/// Takes full turns out of a phase \[degrees\], so that it has no jumps.
fn unwrap(phase: &mut [f64]) {
    let mut turns = 0.0;
    let mut before = f64::NAN;
    for value in phase {
        let step = *value - before;
        if step > 180.0 {
            turns -= 360.0;
        } else if step < -180.0 {
            turns += 360.0;
        }
        before = *value;
        *value += turns;
    }
}

#[cfg(test)]
mod tests {
    use controller::design::LinearDrive;
    use controller::design::sector::UpperSlope;
    use controller::{DerivativeOn, VelocityLaw};

    use super::*;

    fn assessed(law: LoopLaw) -> Assessment {
        let linear = LinearLoop { drive: LinearDrive::THESIS, law };
        assess(DesignOptions {
            linear,
            period: 1e-3,
            volts_per_newton_metre: 4.8426,
            asked: String::new(),
        })
        .unwrap()
    }

    #[test]
    fn the_thesis_velocity_loop_is_strictly_positive_real_and_stands_any_friction_that_brakes() {
        let found = assessed(LoopLaw::Velocity(VelocityLaw::default()));
        assert_eq!(found.realness, PositiveRealness::StrictlyPositiveReal);
        assert_eq!(found.sector.upper_from_zero, Some(UpperSlope::Any));
        assert!((found.continuous.crossover.unwrap() - 111.03).abs() < 0.1);
        // Half a period of delay at 111 rad/s is 3.2 degrees.
        let delay =
            (found.continuous.phase_margin.unwrap() - found.sampled.phase_margin.unwrap()) / 111.03;
        assert!((delay.to_radians() - 5e-4).abs() < 5e-5, "{delay}");
        let settling = found.figures[0].1.settling_time.unwrap();
        assert!((settling - 0.280).abs() < 3e-3, "{settling}");
    }

    /// `Re 1/G = K_p / r - J w^2` with back-EMF as well: it has no part in it.
    #[test]
    fn the_thesis_position_loop_is_not_positive_real() {
        let found = assessed(LoopLaw::Position {
            gains: PidGains::THESIS,
            derivative_on: DerivativeOn::Measurement,
            filter: 0.005,
        });
        assert!(matches!(found.realness, PositiveRealness::NotPositiveReal(_)));
        let expected = (5.7517f64 * 1.863 / 0.02388).sqrt();
        assert!((found.theorem_fails_from.unwrap() / expected - 1.0).abs() < 1e-9);
        assert!(matches!(found.sector.upper_from_zero, Some(UpperSlope::Finite(_))));
        // The phase is drawn without jumps.
        assert!(found.bode.continuous.1.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 20.0));
    }
}
