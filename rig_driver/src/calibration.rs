//! Signs, gains and zeros of a rig's sensors, as found by calibration.

use ::parameters::{Declaration, Declared, ParameterValue, Spec, ValueRange, Values, parameters};
use serde::{Deserialize, Serialize};

use crate::{Measurement, Rig, RigError};

/// When a limit of a rig's driver counts.
pub(crate) const LIMIT: &str =
    "taken when the node is configured; on a real rig at the start only, see allow_limits";

/// Whether a sensor counts the way the motor turns at a positive voltage. In files 1 or -1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "i8", into = "i8")]
pub enum Sign {
    /// It does.
    #[default]
    Forward,
    /// It counts the other way.
    Reversed,
}

impl Sign {
    /// 1 or -1.
    #[must_use]
    pub const fn factor(self) -> f64 {
        match self {
            Self::Forward => 1.0,
            Self::Reversed => -1.0,
        }
    }

    /// The sign of a number; zero counts as forward.
    #[must_use]
    pub const fn of(value: f64) -> Self {
        if value < 0.0 { Self::Reversed } else { Self::Forward }
    }
}

/// A number that is no sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a sign is 1 or -1, but is {0}")]
pub struct SignError(pub i8);

impl From<Sign> for i8 {
    fn from(sign: Sign) -> Self {
        match sign {
            Sign::Forward => 1,
            Sign::Reversed => -1,
        }
    }
}

impl TryFrom<i8> for Sign {
    type Error = SignError;

    fn try_from(value: i8) -> Result<Self, SignError> {
        match value {
            1 => Ok(Self::Forward),
            -1 => Ok(Self::Reversed),
            other => Err(SignError(other)),
        }
    }
}

/// A sign is a whole number: 1 or -1.
impl Declared for Sign {
    fn declare(&self, name: &str, spec: &Spec, into: &mut Vec<Declaration>) {
        let value = ParameterValue::Integer(i8::from(*self).into());
        into.push(spec.range(ValueRange::Either(-1, 1)).declaration(name, value));
    }

    fn take(&mut self, name: &str, values: &Values) {
        if let Some(ParameterValue::Integer(value)) = values.get(name)
            && let Some(Ok(sign)) = i8::try_from(*value).ok().map(Self::try_from)
        {
            *self = sign;
        }
    }

    fn give(&self, name: &str, into: &mut Values) {
        into.set(name, ParameterValue::Integer(i8::from(*self).into()));
    }
}

parameters! {
    /// What turns raw readings into true ones. The voltage is the measure of all signs: a positive
    /// one turns the shaft forwards. By default readings are true as they are.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct Calibration {
        encoder_sign: Sign = Sign::Forward, "Sign of encoder counts, 1 or -1", constraint(LIMIT);
        tachometer_gain: f64 = 1.0, "True velocity over the tachometer's",
            range(ValueRange::NotZero), constraint(LIMIT);
        tachometer_zero: f64 = 0.0, "Tachometer's reading at rest", unit("rad/s"),
            constraint(LIMIT);
        torque_sign: Sign = Sign::Forward, "Sign of the friction torque, 1 or -1",
            constraint(LIMIT);
        torque_zero: f64 = 0.0, "Torque sensor's reading without torque", unit("N m"),
            constraint(LIMIT);
        deadband_forward: f64 = 0.0, "Lowest voltage that moves the shaft forwards", unit("V"),
            range(ValueRange::NON_NEGATIVE), constraint(LIMIT);
        deadband_backward: f64 = 0.0, "Lowest magnitude of the voltage that moves it backwards",
            unit("V"), range(ValueRange::NON_NEGATIVE), constraint(LIMIT);
    }
}

impl Calibration {
    /// The true readings behind raw ones. The potentiometer stays as it is.
    #[must_use]
    pub fn correct(&self, raw: &Measurement) -> Measurement {
        let sign = self.encoder_sign.factor();
        Measurement {
            encoder_counts: i64::from(i8::from(self.encoder_sign)) * raw.encoder_counts,
            encoder_position: sign * raw.encoder_position,
            tachometer_velocity: self.tachometer_gain
                * (raw.tachometer_velocity - self.tachometer_zero),
            torque: self.torque_sign.factor() * (raw.torque - self.torque_zero),
            ..*raw
        }
    }
}

impl Calibration {
    /// What puts right what `first` has not: the calibration that does both at once.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let both = |a: Sign, b: Sign| Sign::of(a.factor() * b.factor());
        Self {
            encoder_sign: both(first.encoder_sign, self.encoder_sign),
            tachometer_gain: first.tachometer_gain * self.tachometer_gain,
            tachometer_zero: first.tachometer_zero + self.tachometer_zero / first.tachometer_gain,
            torque_sign: both(first.torque_sign, self.torque_sign),
            torque_zero: first.torque_zero + first.torque_sign.factor() * self.torque_zero,
            deadband_forward: self.deadband_forward,
            deadband_backward: self.deadband_backward,
        }
    }
}

/// A rig with its readings corrected. It stands inside the safety layer, which is to see true
/// readings.
#[derive(Debug)]
pub struct Calibrated<R> {
    rig: R,
    calibration: Calibration,
}

impl<R: Rig> Calibrated<R> {
    /// The rig with its calibration.
    ///
    /// # Errors
    /// [`RigError::OutOfRange`] names the field that cannot be.
    pub fn new(rig: R, calibration: Calibration) -> Result<Self, RigError> {
        calibration.check()?;
        Ok(Self { rig, calibration })
    }
}

impl<R: Rig> Rig for Calibrated<R> {
    fn beneath(&self) -> Option<&dyn Rig> {
        Some(&self.rig)
    }

    fn beneath_mut(&mut self) -> Option<&mut dyn Rig> {
        Some(&mut self.rig)
    }

    fn period(&self) -> f64 {
        self.rig.period()
    }

    fn measure(&mut self) -> Measurement {
        self.calibration.correct(&self.rig.measure())
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.rig.apply(volts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::miswired::{Miswired, Miswiring};

    /// A rig that shows what it is told to.
    struct Fixed(Measurement);

    impl Rig for Fixed {
        fn period(&self) -> f64 {
            1e-3
        }

        fn measure(&mut self) -> Measurement {
            self.0
        }

        fn apply(&mut self, _: f64) -> Result<(), RigError> {
            Ok(())
        }
    }

    #[test]
    fn the_right_calibration_undoes_a_wrong_wiring() {
        let truth = Measurement {
            encoder_counts: 70,
            encoder_position: 0.1,
            tachometer_velocity: -2.0,
            torque: 0.3,
            ..Measurement::default()
        };
        let wiring = Miswiring {
            encoder_reversed: true,
            tachometer_gain: -0.8,
            tachometer_zero: 0.05,
            torque_reversed: true,
            torque_zero: -0.2,
            ..Miswiring::default()
        };
        let calibration = Calibration {
            encoder_sign: Sign::Reversed,
            tachometer_gain: -1.0 / 0.8,
            tachometer_zero: 0.05,
            torque_sign: Sign::Reversed,
            torque_zero: -0.2,
            ..Calibration::default()
        };
        let mut rig = Calibrated::new(Miswired::new(Fixed(truth), wiring), calibration).unwrap();
        let seen = rig.measure();
        assert_eq!((seen.encoder_counts, seen.encoder_position), (70, 0.1));
        assert!(
            (seen.tachometer_velocity + 2.0).abs() < 1e-12 && (seen.torque - 0.3).abs() < 1e-12,
            "{seen:?}"
        );
    }

    #[test]
    fn one_calibration_after_another_is_one_that_does_both() {
        let first = Calibration {
            encoder_sign: Sign::Reversed,
            tachometer_gain: -2.0,
            tachometer_zero: 0.3,
            torque_sign: Sign::Reversed,
            torque_zero: 0.1,
            ..Calibration::default()
        };
        let second =
            Calibration { tachometer_gain: 0.5, tachometer_zero: -0.2, torque_zero: 0.05, ..first };
        let raw = Measurement {
            encoder_counts: 7,
            encoder_position: 0.7,
            tachometer_velocity: 1.3,
            torque: 0.4,
            ..Measurement::default()
        };
        let (twice, once) =
            (second.correct(&first.correct(&raw)), second.after(&first).correct(&raw));
        assert_eq!(twice.encoder_counts, once.encoder_counts);
        assert!((twice.tachometer_velocity - once.tachometer_velocity).abs() < 1e-12);
        assert!((twice.torque - once.torque).abs() < 1e-12);
        assert_eq!(second.after(&Calibration::default()), second);
    }

    #[test]
    fn a_calibration_that_cannot_be_is_refused_by_name() {
        let good = Calibration::default();
        good.check().unwrap();
        for (wrong, name) in [
            (Calibration { tachometer_gain: 0.0, ..good }, "tachometer_gain"),
            (Calibration { torque_zero: f64::NAN, ..good }, "torque_zero"),
            (Calibration { deadband_backward: -0.1, ..good }, "deadband_backward"),
        ] {
            assert!(wrong.check().unwrap_err().to_string().starts_with(name));
        }
        assert!(Sign::try_from(0).unwrap_err().to_string().contains("1 or -1"));
    }
}
