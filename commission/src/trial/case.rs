//! One machine: commissioned, and what came of it held against what it is.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use experiment_runner::protocol::ConstantVelocityProtocol;
use machine_rig::{Machine, Peaks, forget, peaks};
use rig_setup::{RigChoice, RigSetup};
use serde::{Deserialize, Deserializer, Serialize};
use work::progress::Progress;

use super::finish::{Finish, finish};
use super::told::{Told, told};
use super::truth::{Truth, load, truth};
use super::user::Mistake;
use crate::axis::{Axis, Known};
use crate::bed::{Arm, Bed, amplitude};
use crate::friction::Curve;
use crate::friction::wanted::{CurveParameter, Wanted};
use crate::hand_over::Found;
use crate::loop_design::{Plant, QUICK, design};
use crate::protocols::steps::{Fixed, steps};
use crate::run::identity;
use crate::travel::{ANGLE, TravelAsked};
use crate::{Asked, CommissionError, Dossier, Stage};

/// A parameter that was found, beside the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Held {
    /// Which.
    pub parameter: CurveParameter,
    /// What was found.
    pub value: f64,
    /// Its interval, where it has one.
    pub interval: Option<(f64, f64)>,
    /// The truth while it was measured, from and to.
    pub truth: (f64, f64),
    /// Whether the interval holds some of it.
    pub holds: bool,
}

/// What came of a machine that was commissioned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Commissioned {
    /// Rig time \[s\].
    pub seconds: f64,
    /// What is fed forward.
    pub arm: Arm,
    /// Why the friction stage ended.
    pub ending: crate::friction::Ending,
    /// Parameters that have intervals.
    pub held: Vec<Held>,
    /// What was told of the structure.
    pub told: Vec<Told>,
    /// What the hand-over does on the task; none where the safety layer stopped it.
    pub handed_over: Option<Finish>,
    /// What whoever knows the plant does there, likewise.
    pub oracle: Option<Finish>,
    /// The fixed protocol on the same machine, where it was wanted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub protocol: Option<Protocol>,
}

/// What the fixed protocol of the thesis came to on a machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Protocol {
    /// Rig time, with rests of a warm motor \[s\].
    pub seconds: f64,
    /// Steps, and those in which the shaft turned steadily.
    pub steps: (usize, usize),
    /// Whether it told a curve: not where too few steps were steady, or the safety layer ended it.
    pub told: bool,
    /// Parameters that have intervals.
    pub held: Vec<Held>,
}

/// A machine of the trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// Its friction model.
    pub friction: String,
    /// What came of it.
    pub commissioned: Option<Commissioned>,
    /// Otherwise the stage that ended it, and what it said.
    pub refused: Option<(Stage, String)>,
    /// Whether its user's file contradicts itself or the rig, so that it is to be refused.
    pub cannot: bool,
    /// Whether it was refused for that, before anything moved.
    pub rightly: bool,
    /// The farthest that it was driven.
    pub peaks: Peaks,
    /// Voltage and speed that were allowed; the speed as the shaft has it where the encoder tells
    /// what was allowed.
    #[serde(deserialize_with = "endless")]
    pub limits: (f64, f64),
    /// Speed up to which a stop may be met [rad/s].
    pub creeping: f64,
}

/// Reads limits: `null`, which JSON has for what is infinite, is no limit.
fn endless<'de, D: Deserializer<'de>>(from: D) -> Result<(f64, f64), D::Error> {
    let (voltage, velocity): (Option<f64>, Option<f64>) = Deserialize::deserialize(from)?;
    Ok((voltage.unwrap_or(f64::INFINITY), velocity.unwrap_or(f64::INFINITY)))
}

/// What creeps, as a share of the speed that the whole voltage gives.
const CREEPING: f64 = 0.01;
/// The same where ends are looked for: a hundredth of the energy.
const GENTLE: f64 = 0.1;
/// The most by which a shaft may run past its speed limit before the safety layer has it: what a
/// cycle of full voltage adds, and noise.
const PAST: f64 = 1.1;

impl Case {
    /// Whether voltage or speed went past what was allowed, or a stop was met faster than creeping.
    #[must_use]
    pub fn broke_limits(&self) -> bool {
        self.peaks.voltage > self.limits.0 * 1.001 + 0.5 * self.limits.0 / 128.0
            || self.peaks.velocity > PAST * self.limits.1
            || self.peaks.hit > self.creeping
    }
}

/// Commissions `machine`; its file and its folder of results are in `folder`.
///
/// # Errors
/// [`CommissionError`] if something cannot be written, or the trial itself cannot go on.
pub fn case(
    machine: &Machine,
    file: &Path,
    folder: &Path,
    (wanted, allowed, protocol): (&Wanted, f64, Option<&ConstantVelocityProtocol>),
    stop: &Arc<AtomicBool>,
) -> Result<Case, CommissionError> {
    let place = file.display().to_string();
    forget(&place);
    let rig: RigChoice = format!("machine:{place}")
        .parse()
        .map_err(|error| CommissionError::Asked(format!("{error}")))?;
    // The user's file has the limits that the maker of the machine gives, or nearly.
    let mistake = Mistake::of(machine);
    let told = mistake.map_or(machine.limits, |mistake| mistake.made(machine));
    let setup = RigSetup { limits: told, ..RigSetup::default() };
    // Ends that its user does not know are looked for, and touched.
    let sought = machine.stops.is_some() && machine.limits.travel.is_none();
    let travel = sought.then_some(TravelAsked::Find(ANGLE));
    let asked = Asked { rig, setup, wanted: wanted.clone(), travel, allowed };
    let limits = allowed_of(machine);
    let mut case = Case {
        name: machine.name.clone(),
        friction: machine.friction.name().to_string(),
        commissioned: None,
        refused: None,
        cannot: mistake.is_some(),
        rightly: false,
        peaks: Peaks::default(),
        limits,
        creeping: if sought { GENTLE } else { CREEPING }
            * machine.motor.gain()
            * machine.voltage_range,
    };
    let known = match crate::run::look(&asked) {
        Ok(known) => known,
        Err(error) => {
            let why = error.to_string();
            let moved = peaks(&place).is_some_and(|peaks| peaks.voltage > 0.0);
            case.rightly = !moved
                && error.is_bad_input()
                && mistake.is_some_and(|mistake| mistake.is_named(&why));
            case.refused = Some((Stage::Meet, why));
            forget(&place);
            return Ok(case);
        }
    };
    let dossier = Dossier::begin(folder, &identity(&asked, Some(&known), None))?;
    // Of an earlier trial in the same folder.
    dossier.forget_from(Stage::Meet)?;
    let outcome = crate::run::run(&asked, &known, &dossier, stop, &Progress::new(allowed, true));
    case.peaks = peaks(&place).unwrap_or_default();
    match outcome {
        Ok(outcome) => {
            case.commissioned =
                Some(judge(machine, (&asked, &known), (&outcome.found, protocol), stop)?);
        }
        Err(error) if error.is_stopped() => return Err(error),
        Err(error) => {
            let done = dossier.done().len();
            let stage = Stage::ALL.get(done).copied().unwrap_or(Stage::HandOver);
            case.refused = Some((stage, error.to_string()));
        }
    }
    forget(&place);
    Ok(case)
}

/// Voltage and speed that its user allows. A speed limit is of what the encoder tells: where its
/// counts are wrong in the user's file, and no other sensor tells the speed, nobody could know
/// better.
fn allowed_of(machine: &Machine) -> (f64, f64) {
    (
        machine.limits.voltage.unwrap_or(machine.voltage_range),
        machine.limits.velocity.unwrap_or(f64::INFINITY) / machine.position_scale,
    )
}

fn judge(
    machine: &Machine,
    (asked, known): (&Asked, &Known),
    (found, protocol): (&Found, Option<&ConstantVelocityProtocol>),
    stop: &Arc<AtomicBool>,
) -> Result<Commissioned, CommissionError> {
    // Meet and drive come before the friction stage; what warms up goes on meanwhile.
    let (early, late) = (truth(machine, 0.0), truth(machine, found.seconds));
    let held_by = |curve: &Curve, late: &Truth| held(curve, &early, late);
    let held = held_by(&found.chosen.curve, &late);
    let structure = found.chosen.structure.as_ref();
    let told = structure.map_or_else(Vec::new, |found| told(machine, &late, found));
    let progress = Progress::new(1.0, true);
    let allowed = f64::INFINITY;
    let mut axis = Axis::new(&asked.rig, asked.setup, Arc::clone(stop), &progress, (allowed, 0.0));
    let known = &found.met.known(known);
    axis.stay_within(known.travel);
    axis.stay_below(known.velocity);
    axis.calibrate(found.met.calibration);
    if !(found.met.tachometer && found.met.torque) {
        axis.trust_the_encoder_alone();
    }
    let bed = Bed::of(known, &found.drive, (&found.friction, &found.chosen), found.control.design)?
        .breaking_loose(found.met.breakaway())
        .sticking(found.control.stuck)?
        .resting(found.control.resting_angle)
        .feeding_back(found.control.fed_back);
    let bed = found.proof.handed_over(&bed);
    let arm = found.control.arm;
    let handed_over = stopped(finish(&mut axis, &bed, arm))?;
    let oracle =
        stopped(oracle(&mut axis, machine, known, (&late, amplitude(known, &found.friction))))?;
    let before = axis.used();
    let protocol = match protocol {
        None => None,
        Some(protocol) => {
            let fixed = fixed(&mut axis, known, found, protocol);
            // Warming up goes on meanwhile.
            let end = truth(machine, found.seconds + axis.used());
            let steps = fixed.as_ref().map_or((0, 0), |fixed| fixed.steps);
            let curve = stopped(fixed)?.and_then(|fixed| fixed.curve);
            Some(Protocol {
                seconds: axis.used() - before,
                steps,
                told: curve.is_some(),
                held: curve.map_or_else(Vec::new, |curve| held_by(&curve, &end)),
            })
        }
    };
    Ok(Commissioned {
        seconds: found.seconds,
        arm: found.control.arm,
        ending: found.friction.ending,
        held,
        told,
        handed_over,
        oracle,
        protocol,
    })
}

/// What the safety layer stopped is none; what the user stopped ends the trial.
fn stopped<T>(tried: Result<T, CommissionError>) -> Result<Option<T>, CommissionError> {
    match tried {
        Err(error) if error.is_stopped() => Err(error),
        tried => Ok(tried.ok()),
    }
}

/// The fixed protocol with the loop of the friction stage, up to the fastest speed of that stage. It
/// goes one way for seconds: where the travel has ends it is not driven, and tells nothing.
fn fixed(
    axis: &mut Axis<'_>,
    known: &Known,
    found: &Found,
    protocol: &ConstantVelocityProtocol,
) -> Result<Fixed, CommissionError> {
    if axis.reach().is_some() {
        return Ok(Fixed { curve: None, seconds: 0.0, steps: (0, 0) });
    }
    let parts = (&found.met, &found.drive);
    let blocks = crate::friction::blocks(known, parts, &found.friction.followed_by, None);
    steps(axis, &blocks, protocol, found.friction.speeds.1)
}

fn held(curve: &Curve, early: &Truth, late: &Truth) -> Vec<Held> {
    let all = [CurveParameter::FC, CurveParameter::FS, CurveParameter::VS, CurveParameter::Slope];
    let one = |parameter: CurveParameter| {
        // A curve without a dip says nothing of what makes one.
        let of_a_dip = matches!(parameter, CurveParameter::FS | CurveParameter::VS);
        if of_a_dip && !curve.dips {
            return None;
        }
        let (a, b) = (early.of(parameter)?, late.of(parameter)?);
        let ranged = parameter.of(curve);
        let (low, high) = (ranged.low?, ranged.high?);
        let truth = (a.min(b), a.max(b));
        let holds = low <= truth.1 && truth.0 <= high;
        let interval = Some((low, high));
        Some(Held { parameter, value: ranged.value, interval, truth, holds })
    };
    all.into_iter().filter_map(one).collect()
}

/// The best that whoever knows the plant gets from the same means.
fn oracle(
    axis: &mut Axis<'_>,
    machine: &Machine,
    known: &Known,
    (truth, amplitude): (&Truth, f64),
) -> Result<Finish, CommissionError> {
    let counts = f64::from(machine.sensors.encoder_counts_per_turn);
    let plant = Plant {
        drive: controller::design::LinearDrive {
            gain: 1.0 / truth.slope,
            time_constant: truth.time_constant,
        },
        delay: f64::from(machine.delay) * machine.period,
        period: machine.period,
        encoder_step: std::f64::consts::TAU / counts,
        voltage_limit: known.voltage,
    };
    let design = design(&plant, QUICK, Stage::Control)?;
    let bed = Bed::new(plant, design, (truth.f_s, truth.f_c), (truth.v_s, truth.delta), amplitude)?
        .carrying(load(machine));
    let arms = bed.arms();
    let mut best: Option<Finish> = None;
    for arm in arms {
        let tried = finish(axis, &bed, arm)?;
        if best.as_ref().is_none_or(|best| tried.error < best.error) {
            best = Some(tried);
        }
    }
    best.ok_or_else(|| CommissionError::Asked("there are no arms".to_owned()))
}

#[cfg(test)]
mod tests {
    use machine_rig::random;

    use super::*;

    /// Machine 7111 has an encoder whose counts are wrong in the user's file, and no tachometer.
    #[test]
    fn a_speed_limit_is_of_what_the_encoder_tells() {
        let machine = random::machine(7111);
        assert!(machine.position_scale < 0.3 && !machine.sensed.tachometer);
        let limits = allowed_of(&machine);
        let told = limits.1 * machine.position_scale;
        assert!((told - machine.limits.velocity.unwrap()).abs() < 1e-9, "{limits:?}");
    }
}
