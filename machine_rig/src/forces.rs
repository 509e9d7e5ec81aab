//! Torques that depend on where the shaft is.

use serde::{Deserialize, Serialize};

/// A load that hangs: `torque sin(q - angle)` pulls back.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gravity {
    /// Largest torque [N m], zero or more.
    pub torque: f64,
    /// Where it hangs \[rad\].
    pub angle: f64,
}

/// A spring, as a cable is: `stiffness (q - rest)` pulls back.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Stiffness [N m/rad], zero or more.
    pub stiffness: f64,
    /// Where it is slack \[rad\].
    pub rest: f64,
}

/// Torque that comes again with the turn, of a gear or of a motor's teeth:
/// `torque sin(per_turn q + phase)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ripple {
    /// Largest torque [N m], zero or more.
    pub torque: f64,
    /// Periods a turn of the load, above zero.
    pub per_turn: f64,
    /// Phase at the zero of the encoder \[rad\].
    #[serde(default)]
    pub phase: f64,
}

/// All of them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Forces {
    /// A load that hangs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Gravity>,
    /// A cable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spring: Option<Spring>,
    /// Gear and motor.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ripple: Vec<Ripple>,
}

impl Forces {
    /// Torque that drives the shaft at `position` [N m].
    #[must_use]
    pub fn torque(&self, position: f64) -> f64 {
        let gravity = self.gravity.map_or(0.0, |g| g.torque * (position - g.angle).sin());
        let spring = self.spring.map_or(0.0, |s| s.stiffness * (position - s.rest));
        let ripple: f64 =
            self.ripple.iter().map(|r| r.torque * (r.per_turn * position + r.phase).sin()).sum();
        -gravity - spring + ripple
    }

    /// The first number that cannot be, with its name.
    pub(crate) fn wrong(&self) -> Option<(&'static str, f64)> {
        let not_negative =
            |name, value: f64| (!(value >= 0.0 && value.is_finite())).then_some((name, value));
        let finite = |name, value: f64| (!value.is_finite()).then_some((name, value));
        let gravity = self.gravity.and_then(|g| {
            not_negative("forces.gravity.torque", g.torque)
                .or_else(|| finite("forces.gravity.angle", g.angle))
        });
        let spring = || {
            self.spring.and_then(|s| {
                not_negative("forces.spring.stiffness", s.stiffness)
                    .or_else(|| finite("forces.spring.rest", s.rest))
            })
        };
        let ripple = || {
            self.ripple.iter().find_map(|r| {
                not_negative("forces.ripple.torque", r.torque)
                    .or_else(|| not_negative("forces.ripple.per_turn", r.per_turn))
                    .or_else(|| finite("forces.ripple.phase", r.phase))
            })
        };
        gravity.or_else(spring).or_else(ripple)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_and_spring_pull_back_to_where_they_rest() {
        let forces = Forces {
            gravity: Some(Gravity { torque: 2.0, angle: 0.3 }),
            spring: Some(Spring { stiffness: 0.5, rest: 0.3 }),
            ripple: Vec::new(),
        };
        assert_eq!(forces.torque(0.3), 0.0);
        assert!((forces.torque(0.8) + 2.0 * 0.5_f64.sin() + 0.25).abs() < 1e-12);
        assert!((forces.torque(-0.2) - 2.0 * 0.5_f64.sin() - 0.25).abs() < 1e-12);
    }
}
