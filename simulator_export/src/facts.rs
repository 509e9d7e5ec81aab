//! What is known of each target: its versions, what each can hold, and what differs in the
//! simulator itself.
//!
//! Sources: changelogs and documentation of the targets, wheels of MuJoCo 3.6 to 4.0, mjlab 1.4 to
//! 1.6 and Newton 1.0 to 1.8, looked into in November 2026.

use crate::Version;

/// What a target's friction can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    /// A Coulomb level and a viscous coefficient.
    CoulombViscous,
    /// LuGre with exponent 2 and constant micro-damping; Coulomb and viscous for a model without
    /// pre-sliding.
    LuGre,
    /// A Stribeck curve, without pre-sliding.
    Stribeck,
    /// A level at rest, one in motion, and a viscous coefficient.
    StaticDynamicViscous,
    /// The model itself, where it is one of a few.
    Step,
    /// No torque at all: the reason.
    Nothing(&'static str),
}

/// A version at which a target changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Release {
    /// The first version of which this is true.
    pub since: Version,
    /// What it can hold.
    pub holds: Holds,
    /// The same in words, with the attributes' names.
    pub said: &'static str,
    /// What differs in the simulator itself, whatever the numbers.
    pub beware: &'static [&'static str],
}

/// A target's facts.
#[derive(Debug, Clone, Copy)]
pub struct Facts {
    /// For people.
    pub title: &'static str,
    /// Ending of a file's name.
    pub ending: &'static str,
    /// Versions at which it changed, ascending; one at least.
    pub releases: &'static [Release],
    /// The newest version that is known.
    pub newest: Version,
}

const fn since(
    major: u16,
    minor: u16,
    holds: Holds,
    said: &'static str,
    beware: &'static [&'static str],
) -> Release {
    Release { since: Version::new(major, minor), holds, said, beware }
}

pub(crate) static MJCF: Facts = Facts {
    title: "MuJoCo (MJCF)",
    ending: "xml",
    releases: &[
        since(2, 0, Holds::CoulombViscous, "joint: frictionloss, damping, armature", &[SOFT]),
        since(
            3,
            7,
            Holds::LuGre,
            "dcmotor: lugre, damping, armature, cogging",
            &[EXPONENT, "the dcmotor adds one control input, in volts, which must stay at 0"],
        ),
        since(
            3,
            12,
            Holds::LuGre,
            "dcmotor without an input: lugre, damping, armature, cogging",
            &[EXPONENT],
        ),
        since(
            4,
            0,
            Holds::LuGre,
            "dcmotor without an input or a motor constant: lugre, damping, armature, cogging",
            &[EXPONENT],
        ),
    ],
    newest: Version::new(4, 0),
};

const SOFT: &str = "frictionloss is a soft constraint: below its level the joint creeps";
const EXPONENT: &str = "the exponent of the Stribeck curve is 2 and the micro-damping is constant; frictionloss beside it would count friction twice";

pub(crate) static URDF: Facts = Facts {
    title: "URDF",
    ending: "urdf",
    releases: &[since(
        1,
        0,
        Holds::CoulombViscous,
        "joint dynamics: friction, damping",
        &["what becomes of friction and damping is each simulator's own affair"],
    )],
    newest: Version::new(1, 2),
};

pub(crate) static KS_KV_KA: Facts = Facts {
    title: "feedforward gains kS, kV, kA",
    ending: "json",
    releases: &[since(
        1,
        0,
        Holds::CoulombViscous,
        "kS, kV and, with an inertia, kA; as torque or as volts",
        &["a feedforward knows the speed that is wanted, not the one that is"],
    )],
    newest: Version::new(1, 0),
};

pub(crate) static C_HEADER: Facts = Facts {
    title: "C99 header for firmware",
    ending: "h",
    releases: &[since(
        1,
        0,
        Holds::Step,
        "a step function of LuGre, Dahl with exponent 1, Stribeck, Coulomb and viscous friction, in both directions or in each",
        &[],
    )],
    newest: Version::new(1, 0),
};

pub(crate) static MJLAB: Facts = Facts {
    title: "mjlab",
    ending: "py",
    releases: &[
        since(
            1,
            4,
            Holds::CoulombViscous,
            "fields of any actuator: frictionloss, viscous_damping, armature",
            &[SOFT],
        ),
        since(
            1,
            5,
            Holds::LuGre,
            "BuiltinDcMotorActuatorCfg: lugre, viscous_damping, armature, cogging",
            &[
                EXPONENT,
                "the motor takes volts, which must stay at 0: it stands beside the actuator that drives the joint",
            ],
        ),
    ],
    newest: Version::new(1, 6),
};

pub(crate) static NEWTON: Facts = Facts {
    title: "Newton",
    ending: "py",
    releases: &[
        since(
            1,
            7,
            Holds::CoulombViscous,
            "JointDofConfig: friction, damping, armature",
            &["with SolverMuJoCo friction is a soft constraint: below its level the joint creeps"],
        ),
        since(
            1,
            8,
            Holds::LuGre,
            "SolverMuJoCo's DC motor: lugre, damping, cogging; the joint's armature",
            &[
                EXPONENT,
                "Newton's DC motor has one control input, in volts, which must stay at 0",
                "solvers other than SolverMuJoCo know no DC motor",
            ],
        ),
    ],
    newest: Version::new(1, 8),
};

pub(crate) static ISAAC_LAB: Facts = Facts {
    title: "Isaac Lab",
    ending: "py",
    releases: &[
        since(
            1,
            0,
            Holds::Nothing(
                "with Isaac Sim up to 4.5 a joint's friction is a coefficient of the load, and no torque; Isaac Lab 2.2 with Isaac Sim 5.0 takes a torque",
            ),
            "",
            &[],
        ),
        since(
            2,
            2,
            Holds::StaticDynamicViscous,
            "actuator: friction, dynamic_friction, viscous_friction, armature",
            &[
                "with Isaac Sim 4.5 beneath it `friction` would be a coefficient: use Isaac Sim 5.0 or later",
                "PhysX holds below the static level, Newton creeps",
            ],
        ),
    ],
    newest: Version::new(3, 0),
};

pub(crate) static SDF: Facts = Facts {
    title: "SDFormat",
    ending: "sdf",
    releases: &[since(
        1,
        6,
        Holds::CoulombViscous,
        "axis dynamics: friction, damping",
        &["what becomes of friction and damping is each physics engine's own affair"],
    )],
    newest: Version::new(1, 12),
};

pub(crate) static USD_PHYSX: Facts = Facts {
    title: "USD with PhysX",
    ending: "usda",
    releases: &[since(
        5,
        6,
        Holds::StaticDynamicViscous,
        "PhysxJointAxisAPI: staticFrictionEffort, dynamicFrictionEffort, viscousFrictionCoefficient, armature",
        &["it acts on joints of an articulation only"],
    )],
    newest: Version::new(5, 8),
};

pub(crate) static USD_NEWTON: Facts = Facts {
    title: "USD with Newton's schemas",
    ending: "usda",
    releases: &[since(
        0,
        6,
        Holds::CoulombViscous,
        "NewtonJointAPI: newton:friction, newton:damping, newton:armature",
        &["with SolverMuJoCo friction is a soft constraint: below its level the joint creeps"],
    )],
    newest: Version::new(0, 6),
};

pub(crate) static ROS2_CONTROL: Facts = Facts {
    title: "ros2_control",
    ending: "xml",
    releases: &[since(
        2,
        0,
        Holds::Stribeck,
        "param of a joint: friction_static, friction_coulomb, friction_stribeck_velocity, friction_viscous",
        &[
            "ros2_control has no friction of its own: these names are for the hardware's component to read",
        ],
    )],
    newest: Version::new(6, 0),
};

pub(crate) static UR: Facts = Facts {
    title: "Universal Robots' friction scales (ur_msgs)",
    ending: "yaml",
    releases: &[since(
        2,
        4,
        Holds::CoulombViscous,
        "viscous_scale and coulomb_scale of the arm's own friction model, which --reference tells",
        &["the scales act in direct torque control alone"],
    )],
    newest: Version::new(2, 5),
};

pub(crate) static BAM: Facts = Facts {
    title: "BAM (better-actuator-models)",
    ending: "json",
    releases: &[since(
        1,
        0,
        Holds::Stribeck,
        "model m2: friction_base, friction_stribeck, dtheta_stribeck, alpha, friction_viscous; the motor of --motor",
        &["friction that depends on the load (m3 to m6) is not in this file"],
    )],
    newest: Version::new(1, 0),
};
