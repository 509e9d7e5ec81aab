//! What a commission of a machine should find, in the units in which the machine tells itself.

use controller::Load;
use friction_model::AnyModel;
use machine_rig::{Machine, Warming};

use crate::friction::wanted::CurveParameter;

/// Largest share of the kinetic level by which a model's curve may miss the formula.
const ALIKE: f64 = 2e-3;
/// Speeds at which both are compared.
const SPEEDS: usize = 40;

/// The friction curve of a machine at a time, in volts over told speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Truth {
    /// Kinetic level \[V\].
    pub f_c: f64,
    /// Static level \[V\]; that of `f_c` without a dip.
    pub f_s: f64,
    /// Stribeck velocity [rad/s].
    pub v_s: f64,
    /// Shape of the dip.
    pub delta: f64,
    /// Back-EMF and viscous friction \[V s/rad\].
    pub slope: f64,
    /// Time constant with them \[s\].
    pub time_constant: f64,
    /// Whether the curve has a dip of the shape that is fitted; none where it has another shape.
    pub dips: Option<bool>,
}

/// The truth of `machine` after `time` \[s\].
pub(super) fn truth(machine: &Machine, time: f64) -> Truth {
    let warm = machine.warming.map_or(1.0, |Warming { change, time_constant }| {
        1.0 + change * (1.0 - (-time / time_constant).exp())
    });
    let motor = &machine.motor;
    let volts = warm * motor.volts_per_newton_metre();
    let friction = &machine.friction;
    let of = |name| friction.parameter(name);
    let fastest = motor.gain() * machine.voltage_range;
    let (f_v, slow) = (of("f_v").unwrap_or(0.0), 0.03 * fastest);
    let f_c = of("f_c").unwrap_or_else(|| friction.steady_state(slow) - f_v * slow);
    let dip = of("f_s").zip(of("v_s")).filter(|(f_s, _)| *f_s > f_c);
    let delta = of("delta").unwrap_or(2.0);
    let told = machine.position_scale;
    let slope = (motor.back_emf() + volts * f_v) / told;
    let load = machine.backlash.map_or(0.0, |play| play.inertia);
    let inertia = 1.0 + load / motor.inertia;
    let (f_s, v_s) = dip.unwrap_or((f_c, 1.0));
    let formula = |v: f64| f_c + (f_s - f_c) * (-(v / v_s).powi(2)).exp() + f_v * v;
    Truth {
        f_c: volts * f_c,
        f_s: volts * f_s,
        v_s: told * v_s,
        delta,
        slope,
        time_constant: motor.time_constant() * inertia * motor.back_emf() / (told * slope),
        dips: follows(friction, f_c, fastest, formula).then_some(dip.is_some()),
    }
}

/// The load that depends on the place, in volts over told places, as the calibrated readings count
/// it; none where none is there.
pub(super) fn load(machine: &Machine) -> Option<Load> {
    let forces = &machine.forces;
    if forces.gravity.is_none() && forces.spring.is_none() {
        return None;
    }
    // A sine over told places is one only where these are the true ones.
    if forces.gravity.is_some() && (machine.position_scale - 1.0).abs() > 1e-9 {
        return None;
    }
    let volts = machine.motor.volts_per_newton_metre();
    let (gravity, spring) = (forces.gravity, forces.spring);
    let (torque, angle) = gravity.map_or((0.0, 0.0), |g| (volts * g.torque, g.angle));
    let (stiffness, rest) = spring.map_or((0.0, 0.0), |s| (volts * s.stiffness, s.rest));
    // A reversed motor turns places and voltages round.
    let turned = turned(machine);
    Some(Load {
        offset: -turned * stiffness * rest,
        sine: torque * angle.cos(),
        cosine: -turned * torque * angle.sin(),
        slope: stiffness / machine.position_scale,
    })
}

/// One, or minus one where what is called forwards is backwards.
pub(super) fn turned(machine: &Machine) -> f64 {
    let reversed = machine.wiring.iter().flat_map(|w| w.split(',')).any(|m| m == "motor");
    if reversed { -1.0 } else { 1.0 }
}

/// Whether the model's curve is that formula up to the fastest speed.
fn follows(friction: &AnyModel, f_c: f64, fastest: f64, formula: impl Fn(f64) -> f64) -> bool {
    (0..SPEEDS).all(|i| {
        let velocity = fastest * 1e-4_f64.powf(i as f64 / SPEEDS as f64);
        (friction.steady_state(velocity) - formula(velocity)).abs() <= ALIKE * f_c
    })
}

impl Truth {
    /// A parameter of the curve, where it has a meaning.
    pub(super) fn of(&self, parameter: CurveParameter) -> Option<f64> {
        let dips = self.dips?;
        match parameter {
            CurveParameter::FC => Some(self.f_c),
            CurveParameter::FS => dips.then_some(self.f_s),
            CurveParameter::VS => dips.then_some(self.v_s),
            CurveParameter::Slope => Some(self.slope),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use machine_rig::random;

    #[test]
    fn the_truth_of_a_machine_is_its_curve_in_volts() {
        let mut told = 0;
        for seed in 0..60 {
            let machine = random::machine(seed);
            let truth = truth(&machine, 0.0);
            if truth.dips.is_none() {
                continue;
            }
            told += 1;
            let fastest = machine.motor.gain() * machine.voltage_range;
            for share in [0.001, 0.01, 0.1, 0.9] {
                let v = share * fastest;
                let torque = machine.friction.steady_state(v);
                let volts =
                    machine.motor.back_emf() * v + machine.motor.volts_per_newton_metre() * torque;
                let said = machine.position_scale * v;
                let dip = (truth.f_s - truth.f_c) * (-(said / truth.v_s).powi(2)).exp();
                let by_truth = truth.f_c + dip + truth.slope * said;
                assert!((volts - by_truth).abs() < 5e-3 * truth.f_c, "{seed}: {volts} {by_truth}");
            }
        }
        assert!(told > 30, "{told}");
    }
}
