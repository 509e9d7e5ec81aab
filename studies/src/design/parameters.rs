//! `controller.yaml`: the gains as a ROS 2 parameter file.

use std::fmt::Write;

use controller::VelocityLaw;
use controller::design::LoopLaw;

use super::DesignOptions;
use files::commented_yaml::number;

/// The file as text; `run --parameters` and `live --parameters` read it.
#[must_use]
pub fn parameters(options: &DesignOptions) -> String {
    let mut text = format!(
        "# Designed by frictionlab {} from {}.\n/controller:\n  ros__parameters:\n",
        env!("CARGO_PKG_VERSION"),
        options.asked
    );
    let mut map = |name: &str, entries: &[(&str, f64)]| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "    {name}:");
        for (key, value) in entries {
            let _ = writeln!(text, "      {key}: {}", number(*value));
        }
    };
    match options.linear.law {
        LoopLaw::Velocity(VelocityLaw::Lag(gains)) => {
            map("lag", &[("k_p", gains.k_p), ("t_i", gains.t_i), ("gamma", gains.gamma)]);
        }
        LoopLaw::Velocity(VelocityLaw::Pi(gains)) => {
            map("pi", &[("k_p", gains.k_p), ("k_i", gains.k_i)])
        }
        LoopLaw::Position { gains, derivative_on, filter } => {
            map("pid", &[("k_p", gains.k_p), ("k_i", gains.k_i), ("k_d", gains.k_d)]);
            let on = match derivative_on {
                controller::DerivativeOn::Error => "error",
                controller::DerivativeOn::Measurement => "measurement",
            };
            let _ = write!(
                text,
                "    derivative_on: {on}\n    derivative_filter: {}\n",
                number(filter)
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use controller::design::{LinearDrive, LinearLoop};
    use controller::{ControllerOptions, DerivativeOn, LagGains, PiGains, PidGains};

    use super::*;
    use experiment_runner::run::read_controller;

    #[test]
    fn the_file_is_read_back_by_a_run() {
        let lag = LagGains { k_p: 1.25, t_i: 0.1, gamma: 0.03 };
        let pi = PiGains { k_p: 2.0, k_i: 1e-5 };
        let gains = PidGains { k_p: 6.0, k_i: 11.0, k_d: 0.1 };
        for law in [
            LoopLaw::Velocity(VelocityLaw::Lag(lag)),
            LoopLaw::Velocity(VelocityLaw::Pi(pi)),
            LoopLaw::Position { gains, derivative_on: DerivativeOn::Error, filter: 0.002 },
        ] {
            let linear = LinearLoop { drive: LinearDrive::THESIS, law };
            let options = DesignOptions {
                linear,
                period: 1e-3,
                volts_per_newton_metre: 4.8,
                asked: "gains by hand".to_owned(),
            };
            let mut read = ControllerOptions::default();
            read_controller(&parameters(&options)).unwrap().unwrap().apply(&mut read);
            let expected = match law {
                LoopLaw::Velocity(velocity) => ControllerOptions { velocity, ..Default::default() },
                LoopLaw::Position { gains, derivative_on, filter } => ControllerOptions {
                    pid: gains,
                    derivative_on,
                    derivative_filter: filter,
                    ..Default::default()
                },
            };
            assert_eq!(read, expected);
        }
    }
}
