//! The drive's quantities, with their errors, from the fit in volts.

use super::Breakaway;
use super::constants::Calibration;
use crate::Uncertain;
use crate::axis_structure::AxisUnits;
use crate::estimate::{Doubt, Estimate, Estimates, Interval, IntervalMethod, Verdict};
use crate::parameter_id::{ParameterId, Side};
use crate::statistics::{Sample, student_95};

/// Turns the fit in volts into the drive's quantities.
pub(super) struct Report<'a> {
    source: &'a Estimates,
    units: &'a AxisUnits,
    /// Whether the friction torque was measured.
    sensor: bool,
    /// Volts per acceleration.
    acceleration: f64,
    /// Volts per speed.
    damping: f64,
    /// The fitted terms of speed, with their shares of the damping.
    speed: Vec<(ParameterId, f64)>,
    made: Vec<Estimate>,
    notes: Vec<String>,
}

impl<'a> Report<'a> {
    pub fn of(source: &'a Estimates, units: &'a AxisUnits, sensor: bool) -> Self {
        let value = |id: ParameterId| source.value(id).unwrap_or(0.0);
        let speed: Vec<(ParameterId, f64)> = if sensor {
            vec![("back_emf".into(), 1.0)]
        } else {
            let f_v = ParameterId::new("f_v");
            vec![(f_v.side(Side::Forward), 0.5), (f_v.side(Side::Backward), 0.5)]
        };
        Self {
            source,
            units,
            sensor,
            acceleration: value("inertia".into()),
            damping: speed.iter().map(|(id, share)| share * value(*id)).sum(),
            speed,
            made: Vec::new(),
            notes: Vec::new(),
        }
    }

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

    /// The quantities, and what must be known to read them right.
    pub fn filled(
        mut self,
        calibration: Option<&Calibration>,
        found: &[Breakaway],
    ) -> (Vec<Estimate>, Vec<String>) {
        self.motion();
        match (self.sensor, calibration) {
            (true, _) => self.measured(),
            (false, Some(calibration)) => self.calibrated(calibration),
            (false, None) => self.uncalibrated(),
        }
        if !self.sensor {
            self.friction_in_volts();
        }
        for (side, direction) in [(Side::Forward, 1.0), (Side::Backward, -1.0)] {
            self.deadband(ParameterId::new("deadband").side(side), direction, found);
        }
        self.notes.push(
            "The delay contains half a sample of a held voltage, the armature's inductance, and any lead of the motion sensor.".to_owned(),
        );
        (self.made, self.notes)
    }

    /// The derivatives of `factor` times the damping by the terms of speed.
    fn by(&self, factor: f64) -> Vec<(ParameterId, f64)> {
        self.speed.iter().map(|(id, share)| (*id, factor * share)).collect()
    }

    /// One of two units: on an axis that turns, and on one that slides.
    fn unit(&self, rotary: &'static str, linear: &'static str) -> &'static str {
        if *self.units == AxisUnits::ROTARY { rotary } else { linear }
    }

    /// What voltage and motion alone say.
    fn motion(&mut self) {
        let (acceleration, damping) = (self.acceleration, self.damping);
        let unit = self.unit("rad/s/V", "m/s/V");
        self.derive("gain", unit, 1.0 / damping, &self.by(-damping.powi(-2)), 0.0);
        let mut both = self.by(-acceleration * damping.powi(-2));
        both.push(("inertia".into(), 1.0 / damping));
        self.derive("time_constant", "s", acceleration / damping, &both, 0.0);
        let unit = self.unit("V s^2/rad", "V s^2/m");
        let by = [("inertia".into(), 1.0)];
        self.derive("volts_per_acceleration", unit, acceleration, &by, 0.0);
        if let Some(delay) = self.source.get("delay") {
            self.made.push(delay.clone());
        }
    }

    /// What the measured friction torque adds.
    fn measured(&mut self) {
        let volts = self.source.value("volts_per_torque").unwrap_or(0.0);
        let unit = self.unit("V s/rad", "V s/m");
        self.derive("back_emf", unit, self.damping, &self.by(1.0), 0.0);
        let unit = self.unit("V/(N m)", "V/N");
        self.derive("volts_per_torque", unit, volts, &[("volts_per_torque".into(), 1.0)], 0.0);
        let by = [
            ("inertia".into(), 1.0 / volts),
            ("volts_per_torque".into(), -self.acceleration / (volts * volts)),
        ];
        self.derive("inertia", self.units.inertia, self.acceleration / volts, &by, 0.0);
        self.notes.push(
            "The friction torque was measured: gain and time constant are those of the motor alone."
                .to_owned(),
        );
    }

    /// What the motor's constants, or the force per volt, add.
    fn calibrated(&mut self, calibration: &Calibration) {
        let (acceleration, damping) = (self.acceleration, self.damping);
        let Uncertain { value: force, standard_error: error } = calibration.force_per_volt();
        let extra = (acceleration * error).powi(2);
        let by = [("inertia".into(), force)];
        self.derive("inertia", self.units.inertia, acceleration * force, &by, extra);
        if let Calibration::Motor { torque_constant, .. } = calibration {
            let viscous = (damping - torque_constant.value) * force;
            let extra = ((damping - torque_constant.value) * error).powi(2)
                + (force * torque_constant.standard_error).powi(2);
            self.derive("viscous", self.units.viscous, viscous, &self.by(force), extra);
        }
    }

    /// What stays open without them.
    fn uncalibrated(&mut self) {
        self.made.push(Estimate {
            id: "inertia".into(),
            unit: self.units.inertia,
            value: f64::NAN,
            standard_error: None,
            interval: None,
            verdict: Verdict::NotIdentifiable {
                doubt: Doubt::RatioOnly,
                remedy: "the motor's torque constant and resistance, the force per volt, or a torque sensor",
            },
        });
        self.notes.push(
            "Voltage and motion alone know the inertia only as a ratio to the torque per volt."
                .to_owned(),
        );
    }

    /// Friction as the voltage that it takes, where no torque was measured.
    fn friction_in_volts(&mut self) {
        self.notes.push(
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
