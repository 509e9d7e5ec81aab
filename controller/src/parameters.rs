//! The parameters of a controller, as ROS 2 and parameter files have them.

use std::collections::BTreeMap;

use ::parameters::{
    Declared, ParameterError, ParameterValue, ValueRange, Values, choices, parameters,
};
use friction_model::Motor;

use crate::{
    AccelerationFeedback, Compensation, ControlMode, Controller, ControllerOptions, DerivativeOn,
    Dither, DitherShape, GuardOptions, Impulse, LagGains, Load, PiGains, PidGains, PlantInverse,
    PlantInverseName, VelocityLaw, VelocityLawName, design::LinearDrive,
};

choices!(ControlMode, VelocityLawName, DerivativeOn, PlantInverseName, DitherShape);

/// Highest voltage limit of any rig \[V\]: the end of extra-low direct voltage, as the driver has
/// it.
const HIGHEST_VOLTAGE: f64 = 60.0;

parameters! {
    /// Parameters of the node `controller`.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct ControllerParameters {
        mode: ControlMode = ControlMode::Velocity, "What is regulated";
        velocity_law: VelocityLawName = VelocityLawName::Lag, "Linear law of velocity";
        lag: LagGains = LagGains::THESIS;
        pi: PiGains = PiGains::THESIS;
        pid: PidGains = PidGains::THESIS;
        derivative_on: DerivativeOn = DerivativeOn::Measurement, "What the PID differentiates";
        derivative_filter: f64 = 0.005, "Time constant of the PID's derivative filter",
            unit("s"), range(ValueRange::NON_NEGATIVE);
        resting_angle: f64 = 0.0,
            "Error up to which the PID's integral stands still while the reference does",
            unit("rad"), range(ValueRange::NON_NEGATIVE);
        inverse: PlantInverseName = PlantInverseName::Off,
            "How much of the drive's inverse is fed forward";
        drive: LinearDrive = LinearDrive::of(&Motor::SRV02);
        load: Load = Load::NONE;
        compensation: bool = true, "Whether the friction estimate is compensated";
        compensation_scale: f64 = 1.0, "Fraction of the estimate that is compensated",
            range(ValueRange::Double(0.0, 2.0));
        volts_per_newton_metre: f64 = Motor::SRV02.volts_per_newton_metre(),
            "Voltage that overcomes 1 N m of friction", unit("V/(N m)"),
            range(ValueRange::POSITIVE);
        guard: bool = true, "Whether compensation that hunts is scaled back";
        dither: Dither = Dither { shape: DitherShape::Sine, amplitude: 0.0, frequency: 50.0 };
        acceleration: AccelerationFeedback = AccelerationFeedback { gain: 0.0, filter: 0.01 };
        impulse: Impulse = Impulse { height: 0.0, width: 0.002, period: 0.1 };
        fade: f64 = 0.1, "Time in which a change of the compensation is faded in", unit("s"),
            range(ValueRange::NON_NEGATIVE);
        voltage_limit: f64 = 6.0, "Largest magnitude of the command", unit("V"),
            more("the rig's driver cuts it at its own limit"),
            range(ValueRange::Double(0.1, HIGHEST_VOLTAGE));
        tolerated_cycles: u32 = 10,
            "Joint states in a row that are no numbers before it is a fault",
            range(ValueRange::Integer(0, 10_000));
        reference_timeout: f64 = 0.5,
            "Age at which a reference is stale and ramps to zero velocity", unit("s"),
            range(ValueRange::Double(0.01, 60.0));
        reference_deceleration: f64 = 10.0, "How fast a stale reference goes to zero velocity",
            unit("rad/s^2"), range(ValueRange::POSITIVE);
        estimate_timeout: f64 = 0.02,
            "Age at which a friction estimate is no longer compensated", unit("s"),
            range(ValueRange::Double(0.001, 1.0));
        estimate_wait: f64 = 0.0006,
            "Longest wait for the estimate that belongs to a joint state", unit("s"),
            range(ValueRange::Double(0.0, 0.01));
        period: f64 = 0.001, "Period of the joint states", unit("s"),
            range(ValueRange::Double(0.0001, 0.01)), read_only();
        autostart: bool = true, "Configure and activate when the program starts", read_only();
    }
}

impl ControllerParameters {
    /// The defaults for whoever gives parameters of these names: of the velocity laws, the one that
    /// is given gains is the default.
    #[must_use]
    pub fn for_given<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let (mut lag, mut pi) = (false, false);
        for name in names {
            lag |= name.starts_with("lag.");
            pi |= name.starts_with("pi.");
        }
        let velocity_law = if pi && !lag { VelocityLawName::Pi } else { VelocityLawName::Lag };
        Self { velocity_law, ..Self::default() }
    }

    /// The options that they say, checked as a whole.
    ///
    /// # Errors
    /// [`ParameterError::Refused`] with the controller's reason.
    pub fn options(&self) -> Result<ControllerOptions, ParameterError> {
        let options = self.unchecked();
        // What cannot be built is refused here, and not in the middle of the loop.
        Controller::new(options).map_err(ParameterError::refused)?;
        Ok(options)
    }

    pub(crate) fn unchecked(&self) -> ControllerOptions {
        ControllerOptions {
            mode: self.mode,
            period: self.period,
            velocity: match self.velocity_law {
                VelocityLawName::Lag => VelocityLaw::Lag(self.lag),
                VelocityLawName::Pi => VelocityLaw::Pi(self.pi),
            },
            pid: self.pid,
            derivative_on: self.derivative_on,
            derivative_filter: self.derivative_filter,
            resting_angle: self.resting_angle,
            inverse: match self.inverse {
                PlantInverseName::Off => PlantInverse::Off,
                PlantInverseName::Gain => PlantInverse::Gain(self.drive),
                PlantInverseName::Whole => PlantInverse::Whole(self.drive),
            },
            load: self.load,
            compensation: Compensation {
                enabled: self.compensation,
                volts_per_newton_metre: self.volts_per_newton_metre,
                scale: self.compensation_scale,
            },
            acceleration: (self.acceleration.gain > 0.0).then_some(self.acceleration),
            dither: (self.dither.amplitude > 0.0).then_some(self.dither),
            impulse: (self.impulse.height > 0.0).then_some(self.impulse),
            guard: self.guard.then(GuardOptions::default),
            tolerated_cycles: self.tolerated_cycles,
            fade: self.fade,
            voltage_limit: self.voltage_limit,
        }
    }

    /// The parameters that say `options`; what belongs to the node alone has its default.
    #[must_use]
    pub fn of(options: &ControllerOptions) -> Self {
        let usual = Self::default();
        let (lag, pi) = match options.velocity {
            VelocityLaw::Lag(gains) => (gains, usual.pi),
            VelocityLaw::Pi(gains) => (usual.lag, gains),
        };
        let drive = match options.inverse {
            PlantInverse::Off => usual.drive,
            PlantInverse::Gain(drive) | PlantInverse::Whole(drive) => drive,
        };
        Self {
            mode: options.mode,
            velocity_law: options.velocity.into(),
            lag,
            pi,
            pid: options.pid,
            derivative_on: options.derivative_on,
            derivative_filter: options.derivative_filter,
            resting_angle: options.resting_angle,
            inverse: options.inverse.into(),
            drive,
            load: options.load,
            compensation: options.compensation.enabled,
            compensation_scale: options.compensation.scale,
            volts_per_newton_metre: options.compensation.volts_per_newton_metre,
            guard: options.guard.is_some(),
            dither: options.dither.unwrap_or(usual.dither),
            acceleration: options.acceleration.unwrap_or(usual.acceleration),
            impulse: options.impulse.unwrap_or(usual.impulse),
            fade: options.fade,
            voltage_limit: options.voltage_limit,
            tolerated_cycles: options.tolerated_cycles,
            period: options.period,
            ..usual
        }
    }

    /// The values that make a node control with `options`: what a program sets that wants the node
    /// to do what it would do itself. Gains of the other law, and what belongs to additions that
    /// are not there, are left out, and so is the period, which cannot be set while the node runs.
    ///
    /// # Errors
    /// [`ParameterError::Refused`] if no parameters say it: another guard than the usual one is no
    /// parameter.
    pub fn saying(
        options: &ControllerOptions,
    ) -> Result<BTreeMap<String, ParameterValue>, ParameterError> {
        let parameters = Self::of(options);
        if parameters.options()? != *options {
            return Err(ParameterError::refused(
                "the node controller has no parameters for these options, as another guard than the usual one: run this without the nodes",
            ));
        }
        let law = <&str>::from(parameters.velocity_law);
        let said = |name: &&str| {
            let (group, within) = name.split_once('.').unwrap_or((*name, ""));
            match group {
                "lag" | "pi" => group == law,
                "drive" => options.inverse != PlantInverse::Off,
                "dither" => options.dither.is_some() || within == "amplitude",
                "acceleration" => options.acceleration.is_some() || within == "gain",
                "impulse" => options.impulse.is_some() || within == "height",
                "period" | "autostart" => false,
                _ => !group.starts_with("reference_") && !group.starts_with("estimate_"),
            }
        };
        let values: Values = parameters.values();
        let said = values.iter().filter(|(name, _)| said(name));
        Ok(said.map(|(name, value)| (name.to_owned(), value.clone())).collect())
    }
}

impl Default for ControllerOptions {
    /// The thesis's gains at 1 kHz on the SRV-02, compensation physical, switched on and guarded,
    /// no plant inverse, no additions, +-6 V.
    fn default() -> Self {
        ControllerParameters::default().unchecked()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_can_be_built_and_gains_choose_the_law() {
        let usual = ControllerParameters::default();
        usual.options().unwrap();
        let pi = ControllerParameters::for_given(["pi.k_p"]).options().unwrap();
        assert!(matches!(pi.velocity, VelocityLaw::Pi(_)), "gains of a PI in the file mean a PI");
        let same = VelocityLaw::Lag(LagGains { gamma: 0.0, ..LagGains::THESIS });
        let (VelocityLaw::Lag(lag), VelocityLaw::Pi(pi)) = (same, pi.velocity) else { panic!() };
        assert_eq!((pi.k_p, pi.k_i), (lag.k_p, lag.k_p / lag.t_i));
    }

    #[test]
    fn whatever_a_run_sets_can_be_said() {
        let usual = ControllerOptions::default();
        let drive = LinearDrive { gain: 2.0, time_constant: 0.03 };
        let square = Dither { shape: DitherShape::Square, amplitude: 0.4, frequency: 90.0 };
        for options in [
            usual,
            ControllerOptions {
                mode: ControlMode::Position,
                voltage_limit: 3.0,
                fade: 0.0,
                ..usual
            },
            ControllerOptions {
                velocity: VelocityLaw::Pi(PiGains { k_p: 1.5, k_i: 12.0 }),
                ..usual
            },
            ControllerOptions {
                pid: PidGains { k_p: 9.0, k_i: 1.0, k_d: 0.2 },
                derivative_on: DerivativeOn::Error,
                guard: None,
                ..usual
            },
            ControllerOptions { inverse: PlantInverse::Whole(LinearDrive::THESIS), ..usual },
            ControllerOptions { inverse: PlantInverse::Gain(drive), dither: Some(square), ..usual },
            ControllerOptions {
                impulse: Some(Impulse { height: 1.0, width: 0.01, period: 0.05 }),
                acceleration: Some(AccelerationFeedback { gain: 0.03, filter: 0.004 }),
                ..usual
            },
        ] {
            let said = ControllerParameters::saying(&options).unwrap();
            let given = ControllerParameters::for_given(said.keys().map(String::as_str));
            let values = Values::given(&given.declarations(), &said).unwrap();
            assert_eq!(given.with(&values).options().unwrap(), options);
        }
    }

    #[test]
    fn what_no_parameter_says_is_refused_by_name() {
        let guard = Some(GuardOptions { swings: 9, ..GuardOptions::default() });
        let options = ControllerOptions { guard, ..ControllerOptions::default() };
        let said = ControllerParameters::saying(&options).unwrap_err().to_string();
        assert!(said.contains("guard"), "{said}");
    }
}
