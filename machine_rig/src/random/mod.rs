//! Machines drawn at random: what a stranger may bring.
//!
//! Drive, friction and everything around them are drawn over a decade and more, each by itself, so
//! that most machines have several difficulties at once. A machine is a function of its seed.

mod friction;
mod travel;

use friction_model::{ModelName, Motor};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rig_driver::safety::RigLimits;
use rig_driver::{Channel, Sensors};

use crate::{Backlash, Forces, Gravity, Machine, Ripple, Sensed, Spring, Thermal, Warming};

/// Frequency of the teeth's contact behind backlash \[Hz\].
const TEETH: f64 = 150.0;

/// Numbers of one machine.
struct Draw(Pcg64Mcg);

impl Draw {
    fn even(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Evenly in the logarithm.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        self.even(low.ln(), high.ln()).exp()
    }

    /// Whether something that has that share is the case.
    fn is(&mut self, share: f64) -> bool {
        self.0.random::<f64>() < share
    }

    fn some<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.0.random_range(0..of.len())]
    }

    fn sign(&mut self) -> f64 {
        if self.is(0.5) { 1.0 } else { -1.0 }
    }
}

/// The machine of that seed.
#[must_use]
pub fn machine(seed: u64) -> Machine {
    // Neighbouring seeds are to be strangers to each other.
    let mut draw = Draw(Pcg64Mcg::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0xf1ab));
    let voltage_range = draw.some(&[6.0, 10.0, 12.0, 24.0]);
    let voltage = voltage_range * draw.even(0.6, 1.0);
    // The speed that the voltage limit gives without friction.
    let fastest = draw.decades(3.0, 60.0);
    let back_emf = voltage / fastest;
    let resistance = draw.decades(0.5, 10.0);
    let time_constant = draw.decades(0.01, 0.2);
    let gear_ratio = draw.decades(1.0, 200.0);
    let motor = Motor {
        motor_constant: back_emf / gear_ratio,
        gear_ratio,
        armature_resistance: resistance,
        inertia: time_constant * back_emf * back_emf / resistance,
    };
    let substeps = 10;
    let step = 1e-3 / f64::from(substeps);
    let level = draw.decades(0.025, 0.25) * voltage / motor.volts_per_newton_metre();
    let scale = friction::Scale {
        level,
        speed: fastest * draw.decades(0.003, 0.03),
        // A deflection that the integration still follows at the highest speed.
        deflection: draw.decades(1e-3, 1e-2).max(1.5 * fastest * step),
        damping: draw.even(0.0, 0.5) * back_emf / motor.volts_per_newton_metre(),
        static_over_kinetic: draw.even(1.02, 1.7),
    };
    let friction = friction::drawn(&mut draw, &scale);
    let forces = forces(&mut draw, level, gear_ratio);
    let backlash = draw.is(0.4).then(|| {
        let inertia = draw.decades(0.1, 1.0) * motor.inertia;
        let stiffness = inertia * (std::f64::consts::TAU * TEETH).powi(2);
        Backlash { width: draw.decades(2e-3, 3e-2), inertia, stiffness }
    });
    let warming =
        draw.is(0.5).then(|| Warming { change: -0.1, time_constant: draw.decades(60.0, 600.0) });
    let stickier = if draw.is(0.3) { draw.sign() * draw.even(0.02, 0.3) } else { 0.0 };
    let sensed = Sensed { tachometer: draw.is(0.5), torque: draw.is(0.1), current: draw.is(0.3) };
    let (limits, wiring) = (limits(&mut draw, voltage, fastest), wiring(&mut draw, sensed));
    // Who chose the motor saw to it that it bears its friction, and some more.
    let breakaway = 1.7 * level * motor.volts_per_newton_metre();
    let thermal = Thermal {
        continuous: draw.even(1.2, 3.0) * breakaway + 0.05 * voltage,
        time_constant: draw.decades(5.0, 60.0),
    };
    let position_scale = if draw.is(0.1) { draw.decades(0.25, 4.0) } else { 1.0 };
    let machine = Machine {
        name: format!("machine {seed}"),
        motor,
        friction,
        stickier,
        warming,
        forces,
        backlash,
        sensors: sensors(&mut draw, voltage_range, fastest, level),
        sensed,
        position_scale,
        delay: draw.some(&[0, 1, 2, 3]),
        period: 1e-3,
        substeps,
        voltage_range,
        limits,
        wiring,
        thermal: Some(thermal),
        breaks: None,
        stops: None,
        seed,
    };
    travel::limited(machine)
}

fn forces(draw: &mut Draw, level: f64, gear_ratio: f64) -> Forces {
    let gravity = draw
        .is(0.5)
        .then(|| Gravity { torque: level * draw.even(0.0, 0.6), angle: draw.even(-1.5, 1.5) });
    let spring = draw.is(0.15).then(|| Spring {
        // A part of the friction after a turn.
        stiffness: level * draw.even(0.01, 0.1) / std::f64::consts::TAU,
        rest: draw.even(-0.5, 0.5),
    });
    let mut ripple = Vec::new();
    let mut wave = |draw: &mut Draw, strongest: f64, per_turn: f64| {
        let torque = level * draw.even(0.01, strongest);
        let phase = draw.even(0.0, std::f64::consts::TAU);
        ripple.push(Ripple { torque, per_turn, phase });
    };
    if draw.is(0.5) {
        let teeth = draw.decades(10.0, 100.0).round();
        wave(draw, 0.15, teeth);
    }
    if draw.is(0.3) {
        let slots = draw.some(&[4.0, 6.0, 12.0, 24.0]);
        wave(draw, 0.1, slots * gear_ratio.round());
    }
    Forces { gravity, spring, ripple }
}

fn sensors(draw: &mut Draw, voltage_range: f64, fastest: f64, level: f64) -> Sensors {
    let steps = f64::from(1u32 << draw.some(&[8u32, 10, 12, 14, 16]));
    let channel =
        |range: f64, noise: f64| Channel { range, resolution: 2.0 * range / steps, noise };
    Sensors {
        encoder_counts_per_turn: draw.decades(500.0, 1_048_576.0).round() as u32,
        tachometer: channel(2.0 * fastest, fastest * draw.decades(5e-4, 1e-2)),
        torque: channel(20.0 * level, level * draw.decades(1e-2, 1e-1)),
        voltage_resolution: 2.0 * voltage_range / steps,
        ..Sensors::default()
    }
}

fn limits(draw: &mut Draw, voltage: f64, fastest: f64) -> RigLimits {
    // The speed limit of a careful user, or one that is never met.
    let velocity = fastest * if draw.is(0.3) { draw.even(0.4, 1.0) } else { 1.3 };
    RigLimits { voltage: Some(voltage), velocity: Some(velocity), ..RigLimits::default() }
}

fn wiring(draw: &mut Draw, sensed: Sensed) -> Option<String> {
    let mut mistakes = Vec::new();
    if draw.is(0.15) {
        mistakes.push("motor".to_owned());
    }
    if draw.is(0.15) {
        mistakes.push("encoder".to_owned());
    }
    if sensed.tachometer && draw.is(0.3) {
        mistakes.push(format!("tachometer={:.3}", draw.sign() * draw.even(0.7, 1.4)));
    }
    if sensed.torque && draw.is(0.2) {
        mistakes.push("torque".to_owned());
    }
    (!mistakes.is_empty()).then(|| mistakes.join(","))
}

/// Names of the friction models that are drawn: those that a shaft at rest, creeping and sliding can
/// have. Leuven's is left out: a stiffness of its hysteresis fits one set of sizes only.
const MODELS: [ModelName; 14] = [
    ModelName::CoulombViscous,
    ModelName::Stiction,
    ModelName::Stribeck,
    ModelName::RateDependentStiction,
    ModelName::Karnopp,
    ModelName::Armstrong,
    ModelName::ResetIntegrator,
    ModelName::Dahl,
    ModelName::LuGre,
    ModelName::ElastoPlastic,
    ModelName::Gms,
    ModelName::Xiong,
    ModelName::Proposed,
    ModelName::ProposedLinear,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_is_a_function_of_its_seed_and_can_be() {
        let mut models = std::collections::BTreeSet::new();
        for seed in 0..200 {
            let one = machine(seed);
            one.check().unwrap();
            assert_eq!(machine(seed), one);
            models.insert(one.friction.name());
        }
        assert_eq!(models.len(), MODELS.len(), "{models:?}");
    }

    #[test]
    fn a_machine_reads_back_from_its_file() {
        let folder = tempfile::tempdir().unwrap();
        for seed in 0..50 {
            let path = folder.path().join("machine.yaml");
            std::fs::write(&path, machine(seed).text().unwrap()).unwrap();
            assert_eq!(Machine::read(&path).unwrap(), machine(seed));
        }
    }
}
