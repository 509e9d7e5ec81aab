//! The controller in a parameter file.

use controller::{
    AccelerationFeedback, Controller, ControllerOptions, DerivativeOn, Dither, Impulse, LagGains,
    PiGains, PidGains, PlantInverse, VelocityLaw,
};
use serde::{Deserialize, Serialize};

/// Parameters of `/controller`. The velocity law stands as `lag` or `pi`; what is left out keeps
/// its default.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerParameters {
    /// Gains of the lag compensator of velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lag: Option<LagGains>,
    /// Gains of the PI of velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pi: Option<PiGains>,
    /// Gains of the PID of position.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pid: Option<PidGains>,
    /// What the PID differentiates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub derivative_on: Option<DerivativeOn>,
    /// Time constant of its derivative filter [s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub derivative_filter: Option<f64>,
    /// The plant inverse.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inverse: Option<PlantInverse>,
    /// Feedback of the estimated acceleration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration: Option<AccelerationFeedback>,
    /// Dither.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dither: Option<Dither>,
    /// The knocker's impulses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub impulse: Option<Impulse>,
    /// Fraction of the friction estimate that is compensated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compensation_scale: Option<f64>,
    /// Voltage that overcomes 1 N m [V/(N m)]: said for the reader; a run takes it from its drive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub volts_per_newton_metre: Option<f64>,
    /// Largest magnitude of the voltage [V]: said for the reader; a run takes it from its rig.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub voltage_limit: Option<f64>,
}

impl ControllerParameters {
    /// What `options` say.
    #[must_use]
    pub fn of(options: &ControllerOptions) -> Self {
        let (lag, pi) = match options.velocity {
            VelocityLaw::Lag(gains) => (Some(gains), None),
            VelocityLaw::Pi(gains) => (None, Some(gains)),
        };
        Self {
            lag,
            pi,
            pid: Some(options.pid),
            derivative_on: Some(options.derivative_on),
            derivative_filter: Some(options.derivative_filter),
            inverse: (options.inverse != PlantInverse::Off).then_some(options.inverse),
            acceleration: options.acceleration,
            dither: options.dither,
            impulse: options.impulse,
            compensation_scale: Some(options.compensation.scale),
            volts_per_newton_metre: Some(options.compensation.volts_per_newton_metre),
            voltage_limit: Some(options.voltage_limit),
        }
    }

    /// From the node's parameters.
    ///
    /// # Errors
    /// A sentence about what is wrong.
    pub(super) fn read(node: &serde_json::Value) -> Result<Self, String> {
        let found: Self =
            serde_json::from_value(node.clone()).map_err(|e| format!("in `controller`: {e}"))?;
        if found.lag.is_some() && found.pi.is_some() {
            return Err(
                "in `controller`: both `lag` and `pi` are given; velocity has one law, leave one out"
                    .to_owned(),
            );
        }
        let mut options = ControllerOptions::default();
        found.apply(&mut options);
        Controller::new(options).map_err(|e| format!("in `controller`: {e}"))?;
        Ok(found)
    }

    /// Sets what is given in `options`, but for what is the rig's: its voltage limit and its volts
    /// per newton metre.
    pub fn apply(&self, options: &mut ControllerOptions) {
        if let Some(gains) = self.lag {
            options.velocity = VelocityLaw::Lag(gains);
        }
        if let Some(gains) = self.pi {
            options.velocity = VelocityLaw::Pi(gains);
        }
        options.pid = self.pid.unwrap_or(options.pid);
        options.derivative_on = self.derivative_on.unwrap_or(options.derivative_on);
        options.derivative_filter = self.derivative_filter.unwrap_or(options.derivative_filter);
        options.inverse = self.inverse.unwrap_or(options.inverse);
        options.acceleration = self.acceleration.or(options.acceleration);
        options.dither = self.dither.or(options.dither);
        options.impulse = self.impulse.or(options.impulse);
        options.compensation.scale = self.compensation_scale.unwrap_or(options.compensation.scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::given::read_controller;

    #[test]
    fn a_file_of_the_controller_alone_is_read() {
        let text = "/controller:\n  ros__parameters:\n    pi:\n      k_p: 1.0\n      k_i: 20.0\n    inverse:\n      gain:\n        gain: 1.863\n        time_constant: 0.02388\n";
        let found = read_controller(text).unwrap().unwrap();
        let mut options = ControllerOptions::default();
        found.apply(&mut options);
        assert_eq!(options.velocity, VelocityLaw::Pi(PiGains { k_p: 1.0, k_i: 20.0 }));
        assert_eq!(options.inverse, PlantInverse::Gain(controller::design::LinearDrive::THESIS));
        assert_eq!(options.pid, PidGains::THESIS);
    }

    #[test]
    fn what_is_written_is_what_is_read() {
        let options = ControllerOptions {
            velocity: VelocityLaw::Pi(PiGains { k_p: 1.25, k_i: 20.5 }),
            dither: Some(Dither {
                shape: controller::DitherShape::Square,
                amplitude: 0.25,
                frequency: 50.0,
            }),
            ..Default::default()
        };
        let text = serde_saphyr::to_string(&std::collections::BTreeMap::from([(
            "/controller",
            std::collections::BTreeMap::from([(
                "ros__parameters",
                ControllerParameters::of(&options),
            )]),
        )]))
        .unwrap();
        let mut read = ControllerOptions::default();
        read_controller(&text).unwrap().unwrap().apply(&mut read);
        assert_eq!(read, options, "{text}");
    }

    #[test]
    fn two_laws_or_a_wrong_gain_are_refused() {
        let file = |body: &str| format!("/controller:\n  ros__parameters:\n{body}");
        let lag = "    lag: {k_p: 1.0, t_i: 0.1, gamma: 0.1}\n";
        for (body, said) in [
            (format!("{lag}    pi: {{k_p: 1.0, k_i: 1.0}}\n"), "one law"),
            ("    pi: {k_p: -1.0, k_i: 1.0}\n".to_owned(), "k_p"),
            ("    speed: 1.0\n".to_owned(), "speed"),
        ] {
            let message = read_controller(&file(&body)).unwrap_err();
            assert!(message.contains(said), "{message}");
        }
    }
}
