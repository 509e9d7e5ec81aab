//! The parameters of a servo: names, units, bounds, and what to measure where a log does not show
//! them.

use serde::Serialize;
use strum::VariantArray;

/// One parameter of a servo that drives a pendulum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, VariantArray)]
#[serde(rename_all = "snake_case")]
pub enum ServoParameter {
    /// Torque constant k_t \[N m/A\], which is the back-EMF constant \[V s/rad\] too.
    TorqueConstant,
    /// Winding resistance R \[Ohm\].
    Resistance,
    /// Inertia of rotor and gear on the load side \[kg m^2\].
    Armature,
    /// Angle of the pendulum where the position reads zero \[rad\].
    PositionOffset,
    /// Coulomb friction K_c \[N m\].
    Coulomb,
    /// Viscous friction K_v \[N m s/rad\].
    Viscous,
    /// Friction per transmitted torque |tau_e - tau_m|, K_l.
    Load,
    /// Friction per external torque, K_e.
    ExternalLoad,
    /// Friction per motor torque, K_m.
    MotorLoad,
    /// Stribeck part of the Coulomb friction K_cs \[N m\].
    StribeckCoulomb,
    /// Stribeck part of [`Load`](Self::Load), K_ls.
    StribeckLoad,
    /// Stribeck part of [`ExternalLoad`](Self::ExternalLoad), K_es.
    StribeckExternal,
    /// Stribeck part of [`MotorLoad`](Self::MotorLoad), K_ms.
    StribeckMotor,
    /// Stribeck friction per squared external torque where the motor's is larger, K_eq \[1/(N m)\].
    QuadraticExternal,
    /// Stribeck friction per squared motor torque where the external one is larger, K_mq
    /// \[1/(N m)\].
    QuadraticMotor,
    /// Stribeck velocity w_s \[rad/s\].
    StribeckVelocity,
    /// Exponent alpha of the Stribeck curve.
    StribeckExponent,
    /// Time from a goal to its effect \[s\].
    Delay,
    /// Friction per squared motor torque \[1/(N m)\].
    LoadSquared,
    /// Share of friction that ripples with the angle, sine part.
    RippleSine,
    /// Cosine part.
    RippleCosine,
    /// Ripples of friction a turn. No level fits them; parameters that are given may have them.
    RippleCount,
    /// What the position gain does over what the servo's description says it does.
    GainScale,
    /// The largest command over what the servo's description says.
    FullScale,
    /// Speed at which the servo lets its goal move \[rad/s\].
    GoalSpeed,
}
use ServoParameter as P;

impl ServoParameter {
    /// All of them.
    pub const ALL: &'static [Self] = <Self as VariantArray>::VARIANTS;

    /// Name, unit, lower and upper bound.
    const fn row(self) -> (&'static str, &'static str, f64, f64) {
        match self {
            P::TorqueConstant => ("k_t", "N m/A", 0.1, 3.0),
            P::Resistance => ("r", "Ohm", 2.0, 5.0),
            P::Armature => ("armature", "kg m^2", 1e-4, 0.05),
            P::PositionOffset => ("q_offset", "rad", -0.1, 0.1),
            P::Coulomb => ("k_c", "N m", 0.0, 0.2),
            P::Viscous => ("k_v", "N m s/rad", 0.0, 1.0),
            P::Load => ("k_l", "", 0.0, 0.5),
            P::ExternalLoad => ("k_e", "", 0.0, 0.5),
            P::MotorLoad => ("k_m", "", 0.0, 0.5),
            P::StribeckCoulomb => ("k_cs", "N m", 0.0, 0.2),
            P::StribeckLoad => ("k_ls", "", 0.0, 1.0),
            P::StribeckExternal => ("k_es", "", 0.0, 1.0),
            P::StribeckMotor => ("k_ms", "", 0.0, 1.0),
            P::QuadraticExternal => ("k_eq", "1/(N m)", 0.0, 0.01),
            P::QuadraticMotor => ("k_mq", "1/(N m)", 0.0, 0.01),
            P::StribeckVelocity => ("w_s", "rad/s", 0.1, 3.0),
            P::StribeckExponent => ("alpha", "", 1.0, 10.0),
            P::Delay => ("delay", "s", -0.02, 0.04),
            P::LoadSquared => ("k_2", "1/(N m)", 0.0, 2.0),
            P::RippleSine => ("ripple_sin", "", -0.3, 0.3),
            P::RippleCosine => ("ripple_cos", "", -0.3, 0.3),
            P::RippleCount => ("ripples", "1/turn", 10.0, 400.0),
            P::GainScale => ("gain_scale", "", 0.05, 20.0),
            P::FullScale => ("full_scale", "", 0.3, 1.0),
            P::GoalSpeed => ("goal_speed", "rad/s", 0.5, 50.0),
        }
    }

    /// Name as in files.
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// Unit; empty where it has none.
    pub const fn unit(self) -> &'static str {
        self.row().1
    }

    /// The parameter of this name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|parameter| parameter.name() == name)
    }

    /// Lowest and highest value of the search for a servo of half a newton metre; a description of
    /// another servo gives its own.
    pub const fn bounds(self) -> (f64, f64) {
        let row = self.row();
        (row.2, row.3)
    }

    /// What to measure where a log does not show it.
    pub const fn remedy(self) -> &'static str {
        match self {
            P::TorqueConstant | P::Resistance => {
                "measure the winding's resistance with an ohmmeter, or record the motor current beside the position"
            }
            P::Armature => "record free swings with two different masses",
            P::PositionOffset => {
                "let the pendulum hang at rest without torque and read the position"
            }
            P::Coulomb | P::Viscous => {
                "turn the servo without a pendulum at several steady speeds in both directions and record the duty cycle"
            }
            P::Load | P::ExternalLoad | P::MotorLoad | P::LoadSquared => {
                "lift and lower several masses slowly, so that the motor drives the load and the load the motor at the same torque"
            }
            P::StribeckCoulomb
            | P::StribeckLoad
            | P::StribeckExternal
            | P::StribeckMotor
            | P::QuadraticExternal
            | P::QuadraticMotor => {
                "raise the duty cycle slowly until the axis lets go, at several angles of the pendulum"
            }
            P::StribeckVelocity | P::StribeckExponent => {
                "record steady speeds between 0.02 and 1 rad/s"
            }
            P::Delay => {
                "record the reply to a step of the goal with time stamps of command and position from one clock"
            }
            P::GainScale => {
                "block the axis a known angle off its goal and measure the duty cycle; until then only gain times torque constant is known"
            }
            P::FullScale => "block the axis far off its goal and measure the largest duty cycle",
            P::GoalSpeed => "ask for a step of the goal and record how fast the servo follows",
            P::RippleSine | P::RippleCosine | P::RippleCount => {
                "turn slowly through several turns under a steady load and record the duty cycle over the angle"
            }
        }
    }

    /// The value that switches its effect off.
    pub const fn neutral(self) -> f64 {
        match self {
            P::StribeckVelocity | P::StribeckExponent => 1.0,
            P::TorqueConstant => 0.4,
            P::Resistance => 3.5,
            P::Armature => 2e-3,
            P::GainScale | P::FullScale => 1.0,
            P::GoalSpeed => f64::INFINITY,
            _ => 0.0,
        }
    }
}
