//! `controller.yaml`: the gains as a ROS 2 parameter file.

use controller::design::LoopLaw;
use controller::{ControllerOptions, ControllerParameters};
use parameters::Declared;
use parameters::file::Writer;

use super::DesignOptions;

/// The file as text; `run --parameters` and `live --parameters` read it.
#[must_use]
pub fn parameters(options: &DesignOptions) -> String {
    let usual = ControllerOptions::default();
    let (names, designed): (&[&str], _) = match options.linear.law {
        LoopLaw::Velocity(velocity) => {
            (&["velocity_law", "lag.", "pi."], ControllerOptions { velocity, ..usual })
        }
        LoopLaw::Position { gains: pid, derivative_on, filter: derivative_filter } => (
            &["pid.", "derivative_"],
            ControllerOptions { pid, derivative_on, derivative_filter, ..usual },
        ),
    };
    let designed = ControllerParameters::of(&designed);
    let law = <&str>::from(designed.velocity_law);
    let other = if law == "lag" { "pi." } else { "lag." };
    let mut file = Writer::default();
    let version = env!("CARGO_PKG_VERSION");
    file.comment(&format!("Designed by frictionlab {version} from {}.", options.asked));
    file.node("/controller");
    let values = designed.values();
    for declared in designed.declarations() {
        let name = declared.name();
        let wanted = names.iter().any(|start| name.starts_with(start)) && !name.starts_with(other);
        if let Some(value) = values.get(name).filter(|_| wanted) {
            file.value(name, value.clone(), "");
        }
    }
    file.text()
}

#[cfg(test)]
mod tests {
    use controller::design::{LinearDrive, LinearLoop};
    use controller::{DerivativeOn, LagGains, PiGains, PidGains, VelocityLaw};

    use super::*;
    use experiment_runner::run::Given;

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
            let mut given = Given::default();
            given.take("controller.yaml", &parameters(&options)).unwrap();
            let read = given.controller(&ControllerOptions::default()).unwrap();
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
