//! The steps by which signs, gains and zeros are found.
//!
//! 1. At rest: what tachometer and torque sensor show at zero volts.
//! 2. Slow ramps of voltage, both ways, until the encoder moves: what it takes to move the shaft,
//!    and whether the encoder counts the way the voltage pushes.
//! 3. Steady voltages above that, both ways in turn: the tachometer over the encoder's speed is a
//!    line whose slope is its gain, and the torque of either direction has a sign.

use friction_ident::Uncertain;
use friction_ident::statistics::{Sample, line};
use rig_driver::{Measurement, Sign};

use super::findings::{Findings, Level};
use super::strokes::{Room, strokes};
use super::unseen::Unseen;
use super::{RigSetupError, Session};

/// Lengths and sizes of the steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Procedure {
    /// Time at rest \[s\].
    pub rest: f64,
    /// Rate of the ramps [V/s].
    pub ramp: f64,
    /// Ramps in each direction.
    pub ramps: u32,
    /// Travel that counts as motion \[counts\], where it is an angle too.
    pub moved: i64,
    /// Smallest angle that counts as motion \[rad\]: below it friction may still hold the shaft
    /// elastically, however fine the encoder is.
    pub moved_angle: f64,
    /// Where each ramp after the first of its direction begins, as a share of what moved the shaft
    /// before.
    pub again: f64,
    /// Highest steady voltage above the one that moves the shaft \[V\]; none for that of the session.
    pub above: Option<f64>,
    /// Speed that no steady voltage is to reach [rad/s]; none for any.
    pub fastest: Option<f64>,
    /// Where the shaft may be, where its travel has ends: the steady voltages are strokes then.
    pub room: Option<Room>,
    /// Voltages in each direction.
    pub levels: u32,
    /// Time for a level to settle, and to be read \[s\].
    pub settle: f64,
    /// Time over which a level is read \[s\].
    pub read: f64,
}

impl Default for Procedure {
    /// About half a minute.
    fn default() -> Self {
        Self {
            rest: 1.0,
            ramp: 0.2,
            ramps: 3,
            moved: 8,
            moved_angle: 0.01,
            again: 0.0,
            above: None,
            fastest: None,
            room: None,
            levels: 3,
            settle: 0.4,
            read: 0.8,
        }
    }
}

/// Angle that a shaft at rest may creep \[rad\].
const STILL: f64 = 5e-4;
/// Longest wait for a shaft to come to rest \[s\].
const PATIENCE: f64 = 8.0;
/// The least that a steady voltage is above the one that moves the shaft, as a share of it.
const LEAST: f64 = 0.1;
/// A level whose speed is below this share of the fastest one was no motion: a load stopped it.
const STOPPED: f64 = 0.05;
/// Windows a level is cut into, each a point of the line.
const WINDOWS: usize = 4;

/// Does the steps. `say` is told what begins.
///
/// # Errors
/// [`RigSetupError`] if the rig refuses, does not move, or shows what no wiring explains.
pub fn run(
    session: &mut Session<'_>,
    procedure: &Procedure,
    mut say: impl FnMut(&str),
) -> Result<Findings, RigSetupError> {
    say("at rest");
    at_rest(session, procedure)?;
    let rest = session.hold(0.0, procedure.rest)?;
    let counts = travel(&rest);
    if counts.abs() > 1 && angle(&rest) > STILL {
        return Err(RigSetupError::MovesAtRest { counts });
    }
    let undetermined = |what| move || RigSetupError::Undetermined { what };
    let of_rest = |value: fn(&Measurement) -> f64, what| {
        Sample::of(rest.iter().map(value)).uncertain_mean().ok_or_else(undetermined(what))
    };
    let tachometer_zero = of_rest(|seen| seen.tachometer_velocity, "the tachometer's zero")?;
    let torque_zero = of_rest(|seen| seen.torque, "the torque's zero")?;

    let (mut forward, mut backward, mut signs) = (Vec::new(), Vec::new(), Vec::new());
    let mut width: f64 = 0.0;
    for ramp in 1..=procedure.ramps {
        say(&format!("slow ramps of voltage, {ramp} of {}", procedure.ramps));
        for (direction, found) in [(1.0, &mut forward), (-1.0, &mut backward)] {
            let lowest = found.iter().copied().fold(f64::INFINITY, f64::min);
            let from = if lowest.is_finite() { procedure.again * lowest } else { 0.0 };
            let unseen = Unseen::of(&rest, session.period());
            let Breakaway { above, below, counts } =
                breakaway(session, procedure, (direction, from), unseen)?;
            found.push(0.5 * (above + below));
            width = width.max(above - below);
            signs.push(direction * counts as f64);
            at_rest(session, procedure)?;
            session.cool()?;
        }
    }
    let encoder_sign = common_sign(&signs).ok_or(RigSetupError::EncoderErratic)?;
    // Within the bracket any voltage is as likely; repeating the ramp does not make it narrower.
    let deadband = |volts: &[f64]| {
        let Uncertain { value, standard_error } = Sample::of(volts.iter().copied())
            .uncertain_mean()
            .ok_or_else(undetermined("the deadband"))?;
        Ok::<_, RigSetupError>(Uncertain {
            value,
            standard_error: standard_error.hypot(width / 12f64.sqrt()),
        })
    };
    let (deadband_forward, deadband_backward) = (deadband(&forward)?, deadband(&backward)?);

    let mut levels: Vec<(f64, Vec<Measurement>)> = Vec::new();
    let start = deadband_forward.value.max(deadband_backward.value);
    if let Some(room) = procedure.room {
        say("strokes to and fro");
        let highest = procedure.above.map_or(f64::INFINITY, |above| start + above);
        let most = session.max_volts().min(highest);
        let forward = encoder_sign.factor();
        levels = strokes(session, room, (start, most), forward, procedure.settle)?;
    }
    let steady = if procedure.room.is_some() { 0 } else { procedure.levels };
    for level in 1..=steady {
        let share = f64::from(level) / f64::from(procedure.levels);
        let highest = procedure.above.map_or(f64::INFINITY, |above| start + above);
        let mut volts = start + share * (session.max_volts().min(highest) - start);
        // The speed grows as the voltage above the one that moves the shaft.
        if let (Some(fastest), Some((before, seen))) = (procedure.fastest, levels.last()) {
            let speed = angle(seen) / procedure.read;
            let most = start + (before.abs() - start) * fastest / speed.max(f64::MIN_POSITIVE);
            if most < 1.2 * (before.abs() - start) + start {
                break;
            }
            volts = volts.min(most);
        }
        if let (Some(heat), Some(_)) = (session.heat(), procedure.above) {
            let bearable = heat.bearable(procedure.settle + procedure.read);
            volts = volts.min(bearable.max((1.0 + LEAST) * start));
        }
        // Forwards and back in turn: the shaft stays near where it began.
        for direction in [1.0, -1.0] {
            say(&format!("steady at {:+.2} V", direction * volts));
            session.hold(direction * volts, procedure.settle)?;
            let seen = session.hold(direction * volts, procedure.read)?;
            levels.push((direction * volts, seen));
            session.hold(0.0, procedure.settle)?;
            session.cool()?;
        }
    }
    session.hold(0.0, procedure.settle)?;
    evaluate(Known {
        tachometer_zero,
        torque_zero,
        encoder_sign,
        deadband_forward,
        deadband_backward,
        levels,
    })
}

/// Zero volts until the shaft rests, at most as long as a pendulum swings.
fn at_rest(session: &mut Session<'_>, procedure: &Procedure) -> Result<(), RigSetupError> {
    let mut waited = 0.0;
    while waited < PATIENCE {
        let seen = session.hold(0.0, procedure.settle)?;
        waited += procedure.settle;
        if travel(&seen).abs() <= 1 || angle(&seen) < STILL {
            break;
        }
    }
    Ok(())
}

/// Voltages between which a shaft broke away \[V\], and its travel.
struct Breakaway {
    /// The whole travel was reached: it slides.
    above: f64,
    /// Half the travel was reached: friction may still have held it elastically.
    below: f64,
    counts: i64,
}

/// A ramp in one direction until the shaft moves.
fn breakaway(
    session: &mut Session<'_>,
    procedure: &Procedure,
    (direction, from): (f64, f64),
    mut unseen: Unseen,
) -> Result<Breakaway, RigSetupError> {
    let (mut volts, mut start, step) = (from, None, procedure.ramp * session.period());
    let mut below = None;
    loop {
        let seen = session.step(|_| direction * volts)?;
        unseen.watch(&seen, volts)?;
        let (first, origin) = *start.get_or_insert((seen.encoder_counts, seen.encoder_position));
        let counts = seen.encoder_counts - first;
        let angle = (seen.encoder_position - origin).abs();
        if 2 * counts.abs() >= procedure.moved && 2.0 * angle >= procedure.moved_angle {
            below.get_or_insert(volts);
        }
        if counts.abs() >= procedure.moved && angle >= procedure.moved_angle {
            session.step(|_| 0.0)?;
            return Ok(Breakaway { above: volts, below: below.unwrap_or(volts), counts });
        }
        volts += step;
        if volts > session.max_volts() {
            session.step(|_| 0.0)?;
            let direction = if direction > 0.0 { "forwards" } else { "backwards" };
            return Err(RigSetupError::DoesNotMove {
                direction,
                volts: session.max_volts(),
                travelled: counts,
            });
        }
    }
}

struct Known {
    tachometer_zero: Uncertain,
    torque_zero: Uncertain,
    encoder_sign: Sign,
    deadband_forward: Uncertain,
    deadband_backward: Uncertain,
    levels: Vec<(f64, Vec<Measurement>)>,
}

/// What follows from the readings.
fn evaluate(known: Known) -> Result<Findings, RigSetupError> {
    let Known {
        tachometer_zero,
        torque_zero,
        encoder_sign,
        deadband_forward,
        deadband_backward,
        levels,
    } = known;
    let sign = encoder_sign.factor();
    let mut points = Vec::new();
    let mut shown = Vec::new();
    let mut torques = Vec::new();
    for (volts, seen) in &levels {
        let size = seen.len().div_ceil(WINDOWS).max(3);
        for window in seen.chunks(size).filter(|window| window.len() == size) {
            let encoder: Vec<(f64, f64)> =
                window.iter().map(|seen| (seen.time, sign * seen.encoder_position)).collect();
            let speed = line(&encoder)
                .ok_or(RigSetupError::Undetermined { what: "the encoder's speed" })?;
            let tachometer = window.iter().map(|seen| seen.tachometer_velocity).sum::<f64>()
                / window.len() as f64;
            points.push((speed.slope.value, tachometer));
        }
        let torque = Sample::of(seen.iter().map(|seen| seen.torque - torque_zero.value))
            .uncertain_mean()
            .ok_or(RigSetupError::Undetermined { what: "the torque at a steady voltage" })?;
        let Some(&(velocity, tachometer)) = points.last() else {
            return Err(RigSetupError::Undetermined { what: "the encoder's speed" });
        };
        torques.push(Uncertain { value: volts.signum() * torque.value, ..torque });
        shown.push(Level { volts: *volts, velocity, tachometer, torque: torque.value });
    }
    // The ramps told the sign at breakaway; steady motion has to agree.
    let fastest = shown.iter().map(|level| level.velocity.abs()).fold(0.0, f64::max);
    let moves = |level: &Level| level.velocity.abs() > STOPPED * fastest;
    let directions: Vec<f64> =
        shown.iter().filter(|l| moves(l)).map(|l| l.volts * l.velocity).collect();
    if common_sign(&directions) != Some(Sign::Forward) {
        return Err(RigSetupError::EncoderErratic);
    }
    let fitted =
        line(&points).ok_or(RigSetupError::Undetermined { what: "the tachometer's gain" })?;
    let seen = fitted.slope.value.abs() > 5.0 * fitted.slope.standard_error
        && fitted.slope.value.abs() > 0.01;
    let gain = seen.then(|| {
        let Uncertain { value, standard_error } = fitted.slope;
        Uncertain { value: 1.0 / value, standard_error: standard_error / (value * value) }
    });
    // A friction torque has the sign of the motion, and more than noise.
    let told: Vec<f64> = torques
        .iter()
        .filter(|t| t.value.abs() > 5.0 * t.standard_error)
        .map(|t| t.value)
        .collect();
    let torque_sign = if told.len() == torques.len() { common_sign(&told) } else { None };
    Ok(Findings {
        encoder_sign,
        tachometer_gain: gain,
        tachometer_zero,
        tachometer_residual: fitted.residual,
        torque_sign,
        torque_zero,
        deadband_forward,
        deadband_backward,
        levels: shown,
    })
}

/// The sign that all numbers share.
fn common_sign(values: &[f64]) -> Option<Sign> {
    let first = *values.first()?;
    let same = |value: &f64| *value != 0.0 && (*value > 0.0) == (first > 0.0);
    values.iter().all(same).then_some(Sign::of(first))
}

/// Angle from the first to the last reading \[rad\].
fn angle(seen: &[Measurement]) -> f64 {
    match (seen.first(), seen.last()) {
        (Some(first), Some(last)) => (last.encoder_position - first.encoder_position).abs(),
        _ => 0.0,
    }
}

/// Counts from the first to the last reading.
fn travel(seen: &[Measurement]) -> i64 {
    match (seen.first(), seen.last()) {
        (Some(first), Some(last)) => last.encoder_counts - first.encoder_counts,
        _ => 0,
    }
}
