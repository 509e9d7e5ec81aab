//! The peer's six levels of friction (arXiv 2410.08650) and one of our own, each with the
//! parameters it fits.

use serde::Serialize;
use strum::{EnumIter, EnumString, IntoStaticStr, VariantNames};

use super::parameter::ServoParameter::{self, *};

/// How much a friction torque depends on: speed, load, direction of power.
///
/// With S = exp(-|w/w_s|^alpha), tau_m the motor's and tau_e the external torque, friction is L +
/// K_v |w| with L as given.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Serialize, EnumIter, EnumString, IntoStaticStr, VariantNames,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum FrictionLevel {
    /// L = K_c.
    M1,
    /// L = K_c + S K_cs.
    M2,
    /// L = K_c + K_l |tau_e - tau_m|.
    M3,
    /// L = K_c + K_l |tau_e - tau_m| + S (K_cs + K_ls |tau_e - tau_m|).
    M4,
    /// L = K_c + |K_e tau_e - K_m tau_m| + S (K_cs + |K_es tau_e - K_ms tau_m|).
    M5,
    /// M5 plus S Q; Q is zero unless the torques oppose each other, then K_eq tau_e^2 if |tau_m| >
    /// |tau_e|, else K_mq tau_m^2.
    M6,
    /// Our own: M4, in which L also grows with the square of the motor's torque, k_2 tau_m^2; goals
    /// take effect after a delay.
    Progressive,
}

impl FrictionLevel {
    /// Names of all levels, simplest first.
    pub const NAMES: &'static [&'static str] = <Self as VariantNames>::VARIANTS;

    /// Name as in files and on the command line; it parses back.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// What is fitted, the servo's and the pendulum's parameters first.
    pub const fn parameters(self) -> &'static [ServoParameter] {
        match self {
            Self::M1 => &[TorqueConstant, Resistance, Armature, PositionOffset, Coulomb, Viscous],
            Self::M2 => &[
                TorqueConstant,
                Resistance,
                Armature,
                PositionOffset,
                Coulomb,
                Viscous,
                StribeckCoulomb,
                StribeckVelocity,
                StribeckExponent,
            ],
            Self::M3 => {
                &[TorqueConstant, Resistance, Armature, PositionOffset, Coulomb, Viscous, Load]
            }
            Self::M4 => &[
                TorqueConstant,
                Resistance,
                Armature,
                PositionOffset,
                Coulomb,
                Viscous,
                Load,
                StribeckCoulomb,
                StribeckLoad,
                StribeckVelocity,
                StribeckExponent,
            ],
            Self::M5 => &[
                TorqueConstant,
                Resistance,
                Armature,
                PositionOffset,
                Coulomb,
                Viscous,
                ExternalLoad,
                MotorLoad,
                StribeckCoulomb,
                StribeckExternal,
                StribeckMotor,
                StribeckVelocity,
                StribeckExponent,
            ],
            Self::M6 => &[
                TorqueConstant,
                Resistance,
                Armature,
                PositionOffset,
                Coulomb,
                Viscous,
                ExternalLoad,
                MotorLoad,
                StribeckCoulomb,
                StribeckExternal,
                StribeckMotor,
                StribeckVelocity,
                StribeckExponent,
                QuadraticExternal,
                QuadraticMotor,
            ],
            Self::Progressive => &[
                TorqueConstant,
                Resistance,
                Armature,
                PositionOffset,
                Coulomb,
                Viscous,
                Load,
                StribeckCoulomb,
                StribeckLoad,
                StribeckVelocity,
                StribeckExponent,
                LoadSquared,
                Delay,
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_peer_and_parse_back() {
        assert_eq!(FrictionLevel::NAMES, ["m1", "m2", "m3", "m4", "m5", "m6", "progressive"]);
        for name in FrictionLevel::NAMES {
            assert_eq!(name.parse::<FrictionLevel>().unwrap().name(), *name);
        }
        assert!("m7".parse::<FrictionLevel>().is_err());
    }
}
