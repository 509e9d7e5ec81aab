//! Estimates as ROS 2 messages.

use friction_model::Regime;
use msgs::{friction_msgs::FrictionEstimate, std_msgs::Header};

use crate::Estimate;

/// The estimate as a message. `stamp_ns` is the time of the measurement it was made with, in
/// nanoseconds since the epoch.
#[must_use]
pub fn friction_estimate(stamp_ns: u64, estimate: &Estimate) -> FrictionEstimate {
    let &Estimate { source, torque, deflection, gamma, regime, velocity, residual } = estimate;
    FrictionEstimate {
        header: Header::at(stamp_ns),
        model: source.as_str().to_owned(),
        torque,
        deflection,
        gamma,
        regime: match regime {
            Regime::Stick => FrictionEstimate::STICK,
            Regime::Slip => FrictionEstimate::SLIP,
        },
        velocity,
        residual: residual.unwrap_or(f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;
    use crate::Source;

    #[test]
    fn a_rig_without_torque_sensor_has_no_residual() {
        let estimate = Estimate {
            source: Source::Model(ModelName::LuGre),
            torque: 0.5,
            deflection: 1e-5,
            gamma: 0.4,
            regime: Regime::Slip,
            velocity: -1.0,
            residual: None,
        };
        let message = friction_estimate(7, &estimate);
        assert_eq!((message.model.as_str(), message.regime), ("lugre", FrictionEstimate::SLIP));
        assert!(message.residual.is_nan());
        let measured = Estimate { residual: Some(0.25), regime: Regime::Stick, ..estimate };
        let message = friction_estimate(7, &measured);
        assert_eq!((message.residual, message.regime), (0.25, FrictionEstimate::STICK));
    }
}
