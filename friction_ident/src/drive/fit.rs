//! The fit: with a measured friction torque by linear least squares, without it by the axis model
//! with the voltage as its force.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::constants::Calibration;
use super::{Breakaway, breakaways};
use crate::axis_structure::{
    AxisStructure, AxisUnits, LONGEST_DELAY, fit_structure, read_between, rows_of,
};
use crate::bounded::Minimum;
use crate::conditioning::{Conditioned, Conditioning, Piece, Signals, condition_stretches};
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Unknown, Verdict};
use crate::parameter_id::{ParameterId, Side};
use crate::residual_whiteness::effective_share;
use crate::statistics::{Sample, student_95};
use crate::zero_phase::LowPass;
use crate::{Ending, IdentError, Uncertain, least_squares};

/// What was recorded of a drive without a gap, all channels at the same instants. A voltage that is
/// held over a sample stands at its beginning.
#[derive(Debug, Clone, Copy)]
pub struct DriveRecording<'a> {
    /// Time of the first sample \[s].
    pub start: f64,
    /// Sampling period \[s].
    pub time_step: f64,
    /// Motor voltage \[V].
    pub voltage: &'a [f64],
    /// Position \[m or rad].
    pub position: Option<&'a [f64]>,
    /// Velocity \[m/s or rad/s]; the position is not used where this is given.
    pub velocity: Option<&'a [f64]>,
    /// Friction torque \[N m] or force \[N] from a sensor.
    pub friction: Option<&'a [f64]>,
}

/// A drive that was identified.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriveFit {
    /// `gain` K, `time_constant` T, `delay`, `inertia` and whatever else was known or found; see
    /// the module.
    pub estimates: Estimates,
    /// Starts of motion out of rest.
    pub breakaways: Vec<Breakaway>,
    /// `100 |residual| / |voltage|` \[%].
    pub relative_error: f64,
    /// Share of the residual's samples that count as independent.
    pub effective_share: f64,
    /// Time of the kept samples \[s].
    pub time: Vec<f64>,
    /// Voltage there \[V].
    pub measured: Vec<f64>,
    /// What the drive's equation says \[V].
    pub predicted: Vec<f64>,
    /// What must be known to read the numbers right.
    pub notes: Vec<String>,
}

/// Identifies a drive from the stretches of a recording, all of one sampling period; neither
/// filters nor the delay reach across the gaps between them.
///
/// # Errors
/// [`IdentError`] for recordings that are too short, not finite, without motion, or that do not
/// excite the drive.
pub fn fit_drive<'a>(
    recording: &[DriveRecording<'a>],
    how: &Conditioning,
    calibration: Option<&Calibration>,
    units: &AxisUnits,
) -> Result<DriveFit, IdentError> {
    let signals = |stretch: &DriveRecording<'a>| {
        let DriveRecording { start, time_step, voltage, position, velocity, .. } = *stretch;
        (start, Signals { time_step, position, velocity, force: voltage })
    };
    let conditioned = condition_stretches(&recording.iter().map(signals).collect::<Vec<_>>(), how)?;
    let friction: Option<Vec<&[f64]>> = recording.iter().map(|stretch| stretch.friction).collect();
    let sensor = friction.is_some();
    let fitted = match friction {
        Some(friction) => with_torque(&conditioned, &friction)?,
        None => without_torque(&conditioned)?,
    };
    let found = breakaways(&conditioned);
    let mut report = Report { source: &fitted.estimates, made: Vec::new() };
    let notes = report.fill(calibration, &found, units, sensor);
    let made = report.made;
    let (correlation, covariance) = (Vec::new(), Vec::new());
    let Fitted { estimates, time, measured, predicted, share } = fitted;
    let error: f64 = measured.iter().zip(&predicted).map(|(a, b)| (a - b).powi(2)).sum();
    let power: f64 = measured.iter().map(|u| u * u).sum();
    Ok(DriveFit {
        estimates: Estimates { parameters: made, correlation, covariance, ..estimates },
        breakaways: found,
        relative_error: 100.0 * (error / power).sqrt(),
        effective_share: share,
        time,
        measured,
        predicted,
        notes,
    })
}

/// The fit in volts.
struct Fitted {
    estimates: Estimates,
    time: Vec<f64>,
    measured: Vec<f64>,
    predicted: Vec<f64>,
    share: f64,
}

fn without_torque(recording: &Conditioned) -> Result<Fitted, IdentError> {
    let structure = AxisStructure { stribeck: true, delay: true, ..AxisStructure::ASYMMETRIC };
    let fit = fit_structure(recording, structure, &AxisUnits::ROTARY)?;
    let prediction = fit.predict(recording)?;
    Ok(Fitted {
        share: fit.effective_share,
        estimates: fit.estimates,
        time: prediction.time,
        measured: prediction.measured,
        predicted: prediction.predicted,
    })
}

/// `u = inertia w' + back_emf w + volts_per_torque F + offset`, all but the voltage read `delay`
/// later.
fn with_torque(recording: &Conditioned, friction: &[&[f64]]) -> Result<Fitted, IdentError> {
    let Conditioned { time_step, first, velocity, acceleration, force, decimate, .. } = recording;
    let friction = measured_friction(recording, friction)?;
    let filter = match decimate {
        1 => None,
        factor => Some(LowPass::chebyshev(8, 0.05, 0.4 / *factor as f64, 1.0)?),
    };
    let smooth = |column: &[f64]| match &filter {
        Some(filter) => recording.by_piece(column, |piece| filter.filter(piece)),
        None => Ok(column.to_vec()),
    };
    let pieces = &recording.pieces;
    let rows: usize = pieces.iter().map(|piece| rows_of(piece, *decimate)).sum();
    if rows < 40 {
        return Err(IdentError::TooFewSamples {
            what: "the regression, after trimming and decimation,",
            needed: 40,
            found: rows,
            lower: "the trim or the decimation",
        });
    }
    let read = |column: &[f64], delay: f64| -> Vec<f64> {
        let of = |piece: &Piece| {
            let own = column.get(piece.kept.clone()).unwrap_or_default();
            (0..rows_of(piece, *decimate))
                .map(move |k| read_between(own, (k * decimate) as f64 + delay))
        };
        pieces.iter().flat_map(of).collect()
    };
    let y = DVector::from_vec(read(&smooth(force)?, 0.0));
    let columns = [smooth(acceleration)?, smooth(velocity)?, smooth(&friction)?];
    let matrix = |delay: f64| {
        let mut matrix = DMatrix::from_element(rows, 4, 1.0);
        for (j, column) in columns.iter().enumerate() {
            matrix.column_mut(j).copy_from_slice(&read(column, delay));
        }
        matrix
    };
    const NAMES: [(&str, &str, &str); 5] = [
        ("inertia", "V s^2", "steps and fast changes of the voltage"),
        ("back_emf", "V s", "several speeds"),
        (
            "volts_per_torque",
            "V/(N m)",
            "reversals, so that the friction changes while the speed hardly does",
        ),
        ("offset", "V", "motion in both directions"),
        ("delay", "s", "steps of the voltage, sampled faster"),
    ];
    let solve = |delay: f64| {
        least_squares::solve(&matrix(delay), &y).map_err(|degenerate| {
            let names = degenerate.columns.iter().filter_map(|&j| NAMES.get(j));
            IdentError::Columns { names: names.map(|name| name.0.to_owned()).collect() }
        })
    };
    let delay = golden(0.0, LONGEST_DELAY as f64, |delay| {
        solve(delay).map_or(f64::INFINITY, |solution| solution.residual.norm_squared())
    });
    let solution = solve(delay)?;
    let h = 1e-2;
    let (before, after) = ((delay - h).max(0.0), (delay + h).min(LONGEST_DELAY as f64));
    let slope = (matrix(after) - matrix(before)) * &solution.x / ((after - before) * time_step);
    let design = matrix(delay);
    let mut jacobian = DMatrix::zeros(rows, 5);
    jacobian.columns_mut(0, 4).copy_from(&-&design);
    jacobian.set_column(4, &-slope);
    let mut x = solution.x.as_slice().to_vec();
    x.push(delay * time_step);
    let at_bound = delay < 1e-3 || delay > LONGEST_DELAY as f64 - 1e-3;
    let share = effective_share(solution.residual.as_slice());
    let minimum = Minimum {
        x,
        sum: solution.residual.norm_squared(),
        residuals: solution.residual.clone(),
        jacobian,
        held: vec![false, false, false, false, at_bound],
        evaluations: 0,
        ending: Ending::Converged,
    };
    let unknowns = NAMES.map(|(name, unit, remedy)| Unknown { id: name.into(), unit, remedy });
    let time = |piece: &Piece| {
        let start = piece.start;
        (0..rows_of(piece, *decimate))
            .map(move |k| start + (first + k * decimate) as f64 * time_step)
    };
    Ok(Fitted {
        estimates: Estimates::linearised(&minimum, &unknowns, share),
        time: pieces.iter().flat_map(time).collect(),
        measured: y.as_slice().to_vec(),
        predicted: (design * &solution.x).as_slice().to_vec(),
        share,
    })
}

/// The friction torque on the kept samples of every stretch.
fn measured_friction(recording: &Conditioned, friction: &[&[f64]]) -> Result<Vec<f64>, IdentError> {
    const CHANNEL: &str = "the friction torque";
    let mut kept = Vec::with_capacity(recording.force.len());
    for piece in &recording.pieces {
        let all = friction.get(piece.stretch).copied().unwrap_or_default();
        let own = all.get(recording.first..recording.first + piece.kept.len());
        kept.extend_from_slice(own.ok_or(IdentError::UnequalLengths {
            channel: CHANNEL,
            found: all.len(),
            expected: piece.kept.len() + 2 * recording.first,
        })?);
    }
    if let Some(index) = kept.iter().position(|value| !crate::finite::usable(*value)) {
        let value = kept[index];
        return Err(IdentError::NotFinite {
            channel: CHANNEL,
            index: recording.first + index,
            value,
        });
    }
    Ok(kept)
}

/// The least value of a function with one valley (Kiefer 1953).
fn golden(mut low: f64, mut high: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    while high - low > 1e-4 {
        if fa < fb {
            (high, b, fb) = (b, a, fa);
            a = high - ratio * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + ratio * (high - low);
            fb = f(b);
        }
    }
    0.5 * (low + high)
}

/// Turns the fit in volts into the drive's quantities.
struct Report<'a> {
    source: &'a Estimates,
    made: Vec<Estimate>,
}

impl Report<'_> {
    /// A quantity computed from the fitted ones: value, and its derivatives by name; `extra` is
    /// variance from elsewhere.
    fn derive(
        &mut self,
        id: impl Into<ParameterId>,
        unit: &'static str,
        value: f64,
        by: &[(ParameterId, f64)],
        extra: f64,
    ) {
        let mut variance = extra;
        for (a, da) in by {
            for (b, db) in by {
                let (Some(i), Some(j)) = (self.source.place(*a), self.source.place(*b)) else {
                    continue;
                };
                variance += da * db * self.source.covariance[i][j];
            }
        }
        let error = variance.sqrt();
        let half = student_95(self.source.degrees_of_freedom) * error;
        let relative_error = error / value.abs();
        let verdict = if relative_error < 0.5 {
            Verdict::Identified
        } else {
            let remedy = "a stronger excitation: steps, a chirp, and slow triangles of the voltage";
            Verdict::NotIdentifiable { doubt: Doubt::LargeError { relative_error }, remedy }
        };
        self.made.push(Estimate {
            id: id.into(),
            unit,
            value,
            standard_error: Some(error),
            interval: Some(Interval {
                low: value - half,
                high: value + half,
                method: IntervalMethod::Linearised,
            }),
            verdict,
        });
    }

    fn fill(
        &mut self,
        calibration: Option<&Calibration>,
        found: &[Breakaway],
        units: &AxisUnits,
        torque: bool,
    ) -> Vec<String> {
        let mut notes = Vec::new();
        let value = |id: ParameterId| self.source.value(id).unwrap_or(0.0);
        let acceleration = value("inertia".into());
        let speed: Vec<(ParameterId, f64)> = if torque {
            vec![("back_emf".into(), 1.0)]
        } else {
            let f_v = ParameterId::new("f_v");
            vec![(f_v.side(Side::Forward), 0.5), (f_v.side(Side::Backward), 0.5)]
        };
        let damping: f64 = speed.iter().map(|(name, share)| share * value(*name)).sum();
        let volts_per_torque = torque.then(|| value("volts_per_torque".into()));
        let by = |factor: f64| {
            speed.iter().map(|(name, share)| (*name, factor * share)).collect::<Vec<_>>()
        };
        let rotary = *units == AxisUnits::ROTARY;
        self.derive(
            "gain",
            if rotary { "rad/s/V" } else { "m/s/V" },
            1.0 / damping,
            &by(-damping.powi(-2)),
            0.0,
        );
        let mut both = by(-acceleration * damping.powi(-2));
        both.push(("inertia".into(), 1.0 / damping));
        self.derive("time_constant", "s", acceleration / damping, &both, 0.0);
        self.derive(
            "volts_per_acceleration",
            if rotary { "V s^2/rad" } else { "V s^2/m" },
            acceleration,
            &[("inertia".into(), 1.0)],
            0.0,
        );
        if let Some(delay) = self.source.get("delay") {
            self.made.push(delay.clone());
        }
        match (volts_per_torque, calibration) {
            (Some(volts), _) => {
                self.derive(
                    "back_emf",
                    if rotary { "V s/rad" } else { "V s/m" },
                    damping,
                    &by(1.0),
                    0.0,
                );
                let unit = if rotary { "V/(N m)" } else { "V/N" };
                self.derive(
                    "volts_per_torque",
                    unit,
                    volts,
                    &[("volts_per_torque".into(), 1.0)],
                    0.0,
                );
                let by = [
                    ("inertia".into(), 1.0 / volts),
                    ("volts_per_torque".into(), -acceleration / (volts * volts)),
                ];
                self.derive("inertia", units.inertia, acceleration / volts, &by, 0.0);
                notes.push(
                    "The friction torque was measured: gain and time constant are those of the motor alone."
                        .to_owned(),
                );
            }
            (None, Some(calibration)) => {
                self.calibrated(calibration, acceleration, damping, &speed, units)
            }
            (None, None) => {
                self.made.push(Estimate {
                    id: "inertia".into(),
                    unit: units.inertia,
                    value: f64::NAN,
                    standard_error: None,
                    interval: None,
                    verdict: Verdict::NotIdentifiable {
                        doubt: Doubt::RatioOnly,
                        remedy: "the motor's torque constant and resistance, the force per volt, or a torque sensor",
                    },
                });
                notes.push(
                    "Voltage and motion alone know the inertia only as a ratio to the torque per volt."
                        .to_owned(),
                );
            }
        }
        if !torque {
            notes.push(
                "Back-EMF and viscous friction are one term here: gain and time constant are those of the drive with its bearings."
                    .to_owned(),
            );
            for &side in Side::of(true) {
                let level = ParameterId::new("f_c").side(side);
                let volts = self.source.value(level).unwrap_or(0.0);
                let id = ParameterId::new("coulomb_voltage").side(side);
                self.derive(id, "V", volts, &[(level, 1.0)], 0.0);
            }
        }
        for (side, direction) in [(Side::Forward, 1.0), (Side::Backward, -1.0)] {
            self.deadband(ParameterId::new("deadband").side(side), direction, found);
        }
        notes.push(
            "The delay contains half a sample of a held voltage, the armature's inductance, and any lead of the motion sensor.".to_owned(),
        );
        notes
    }

    fn calibrated(
        &mut self,
        calibration: &Calibration,
        acceleration: f64,
        damping: f64,
        speed: &[(ParameterId, f64)],
        units: &AxisUnits,
    ) {
        let Uncertain { value: force, standard_error: error } = calibration.force_per_volt();
        let extra = (acceleration * error).powi(2);
        self.derive(
            "inertia",
            units.inertia,
            acceleration * force,
            &[("inertia".into(), force)],
            extra,
        );
        if let Calibration::Motor { torque_constant, .. } = calibration {
            let viscous = (damping - torque_constant.value) * force;
            let by: Vec<_> = speed.iter().map(|(name, share)| (*name, force * share)).collect();
            let extra = ((damping - torque_constant.value) * error).powi(2)
                + (force * torque_constant.standard_error).powi(2);
            self.derive("viscous", units.viscous, viscous, &by, extra);
        }
    }

    /// Mean voltage of the breakaways in one direction, with the error of a mean.
    fn deadband(&mut self, id: ParameterId, direction: f64, found: &[Breakaway]) {
        let volts: Vec<f64> =
            found.iter().filter(|b| b.direction == direction).map(|b| b.voltage.abs()).collect();
        let n = volts.len();
        let sample = Sample::of(volts.into_iter());
        let mean = sample.mean;
        let remedy = "a slow triangle of the voltage through zero, so that the axis starts from rest several times";
        let error = (sample.variance() / n.max(1) as f64).sqrt();
        let half = student_95(n.saturating_sub(1)) * error;
        let interval =
            Interval { low: mean - half, high: mean + half, method: IntervalMethod::Linearised };
        self.made.push(if n < 3 {
            let (doubt, value) =
                (Doubt::TooFewEvents { found: n, needed: 3 }, if n == 0 { f64::NAN } else { mean });
            let verdict = Verdict::NotIdentifiable { doubt, remedy };
            Estimate { id, unit: "V", value, standard_error: None, interval: None, verdict }
        } else {
            let verdict = Verdict::Identified;
            let (standard_error, interval) = (Some(error), Some(interval));
            Estimate { id, unit: "V", value: mean, standard_error, interval, verdict }
        });
    }
}
