//! Options of the controller as the parameters of the node that say them.

use std::collections::BTreeMap;

use ros_node::{ParameterValue, parameters::ParameterStore};

use super::{declarations, parameters::ControlSettings};
use crate::{ControlMode, ControllerOptions, DerivativeOn, DitherShape, PlantInverse, VelocityLaw};

/// The parameters that make the node control with `options`: what a program sets that wants the
/// node to do what it would do itself. The period is left out, which cannot be set while the node
/// runs.
///
/// # Errors
/// A sentence if no parameters say it: acceleration feedback, impulses and another guard than the
/// usual one are no parameters.
pub fn parameters_of(
    options: &ControllerOptions,
) -> Result<BTreeMap<String, ParameterValue>, String> {
    let mut said = BTreeMap::new();
    let mut text = |name: &str, value: &str| {
        said.insert(name.to_owned(), ParameterValue::String(value.to_owned()));
    };
    text("mode", if options.mode == ControlMode::Position { "position" } else { "velocity" });
    text(
        "derivative_on",
        if options.derivative_on == DerivativeOn::Error { "error" } else { "measurement" },
    );
    let (law, gains) = match options.velocity {
        VelocityLaw::Lag(lag) => {
            ("lag", vec![("lag.k_p", lag.k_p), ("lag.t_i", lag.t_i), ("lag.gamma", lag.gamma)])
        }
        VelocityLaw::Pi(pi) => ("pi", vec![("pi.k_p", pi.k_p), ("pi.k_i", pi.k_i)]),
    };
    text("velocity_law", law);
    let (inverse, drive) = match options.inverse {
        PlantInverse::Off => ("off", None),
        PlantInverse::Gain(drive) => ("gain", Some(drive)),
        PlantInverse::Whole(drive) => ("whole", Some(drive)),
    };
    text("inverse", inverse);
    if let Some(dither) = options.dither {
        text("dither.shape", if dither.shape == DitherShape::Square { "square" } else { "sine" });
    }
    let drive = drive
        .map(|drive| [("drive.gain", drive.gain), ("drive.time_constant", drive.time_constant)])
        .into_iter();
    let dither = options.dither.map_or(vec![("dither.amplitude", 0.0)], |dither| {
        vec![("dither.amplitude", dither.amplitude), ("dither.frequency", dither.frequency)]
    });
    let doubles = [
        ("pid.k_p", options.pid.k_p),
        ("pid.k_i", options.pid.k_i),
        ("pid.k_d", options.pid.k_d),
        ("derivative_filter", options.derivative_filter),
        ("compensation_scale", options.compensation.scale),
        ("volts_per_newton_metre", options.compensation.volts_per_newton_metre),
        ("fade", options.fade),
        ("voltage_limit", options.voltage_limit),
    ];
    for (name, value) in doubles.into_iter().chain(gains).chain(dither).chain(drive.flatten()) {
        said.insert(name.to_owned(), ParameterValue::Double(value));
    }
    for (name, value) in
        [("compensation", options.compensation.enabled), ("guard", options.guard.is_some())]
    {
        said.insert(name.to_owned(), ParameterValue::Boolean(value));
    }
    said.insert(
        "tolerated_cycles".to_owned(),
        ParameterValue::Integer(i64::from(options.tolerated_cycles)),
    );

    // Read as the node will read them, they must come to the same.
    let store = ParameterStore::new(declarations(&[]), &said, Box::new(|_, _| Ok(())))
        .map_err(|(name, reason)| format!("{name}: {reason}"))?;
    let read = ControlSettings::read(store.values())?.options;
    if (ControllerOptions { period: options.period, ..read }) == *options {
        Ok(said)
    } else {
        let lacking = [
            (options.acceleration.is_some(), "acceleration feedback"),
            (options.impulse.is_some(), "impulses"),
            (true, "these options"),
        ];
        let what = lacking.into_iter().find(|(is, _)| *is).map_or("", |(_, what)| what);
        Err(format!("the node controller has no parameters for {what}: run this without the nodes"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dither, PiGains, PidGains, design::LinearDrive};

    #[test]
    fn what_a_run_sets_can_be_said() {
        let usual = ControllerOptions::default();
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
            ControllerOptions {
                inverse: PlantInverse::Gain(LinearDrive { gain: 2.0, time_constant: 0.03 }),
                dither: Some(Dither {
                    shape: DitherShape::Square,
                    amplitude: 0.4,
                    frequency: 90.0,
                }),
                ..usual
            },
        ] {
            parameters_of(&options).unwrap();
        }
    }

    #[test]
    fn what_no_parameter_says_is_refused_by_name() {
        let impulse = Some(crate::Impulse { height: 1.0, width: 0.01, period: 0.1 });
        let said = parameters_of(&ControllerOptions { impulse, ..ControllerOptions::default() })
            .unwrap_err();
        assert!(said.contains("impulses"), "{said}");
    }
}
