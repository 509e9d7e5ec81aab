//! What the terminal shows: before anything moves, and at the end.

use std::fmt::Write;

use report::numbers::{percent, significant};

use super::Found;
use crate::axis::Known;
use crate::bed::{Arm, Stuck};
use crate::control::Control;
use crate::friction::wanted::Wanted;
use crate::friction::{Ending, Friction};
use crate::hunting::smallest;
use crate::noticed::by_hand;
use crate::proof::Proof;
use crate::travel::TravelAsked;

/// What is one count but for rounding.
const ONE: f64 = 1.001;

/// What is believed of a rig before it moves.
#[must_use]
pub fn believed(rig: &str, known: &Known, travel: Option<TravelAsked>, minutes: f64) -> String {
    let mut text = format!("rig       {rig}\n");
    // Writing to a string cannot fail.
    if let Some(about) = &known.about {
        let _ = writeln!(text, "device    {about}");
    }
    let _ = writeln!(
        text,
        "limits    {} V, {} rad/s, held by the safety layer at every moment",
        significant(known.voltage, 3),
        significant(known.velocity, 3)
    );
    let _ = writeln!(text, "cycle     {} ms", significant(1e3 * known.period, 3));
    let _ = writeln!(text, "used      the motor's voltage and the encoder; no other sensor");
    let _ = writeln!(
        text,
        "scale     every angle, every speed and the speed limit are by the encoder's counts: where these are wrong, the shaft turns faster than is meant. {}",
        by_hand(known)
    );
    let _ = writeln!(
        text,
        "motion    the shaft turns both ways, {}, for at most {} min; ctrl-C ends it at zero volts",
        where_to(travel, known),
        significant(minutes, 3)
    );
    text
}

/// Where the shaft is to be.
fn where_to(asked: Option<TravelAsked>, known: &Known) -> String {
    match (known.travel, asked) {
        (Some(travel), _) => format!(
            "from {} to {} rad by its encoder",
            significant(travel.min, 3),
            significant(travel.max, 3)
        ),
        (None, Some(TravelAsked::Find(angle))) => format!(
            "first creeping up to {} rad either way until something holds it, and then between what was found",
            significant(angle, 3)
        ),
        (None, _) => "several times round".to_owned(),
    }
}

/// The result in a few lines.
#[must_use]
pub fn summary(found: &Found, wanted: &Wanted) -> String {
    let Found { drive, friction, chosen, control, .. } = found;
    let curve = &chosen.curve;
    let mut text = String::new();
    let mut row = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<14}  {value}");
    };
    for said in &found.met.noticed {
        row("look at this", said.clone());
    }
    for said in &found.met.corrected {
        row("put right", said.clone());
    }
    if let Some(sought) = &found.met.sought {
        row("travel", sought.to_string());
    }
    row("gain", drive.gain.said("rad/s per V"));
    row("time constant", drive.time_constant.said("s"));
    row("delay", drive.delay_said());
    row("f_c", curve.f_c.said("V"));
    row("f_s", curve.f_s.said("V"));
    row("v_s", curve.v_s.said("rad/s"));
    row("friction", ending(friction, wanted));
    if let Some(change) = friction.change {
        row("drift", drift(change));
    }
    row("model", chosen.kind.to_string());
    row("structure", super::structure::summary(found));
    row(
        "loop",
        format!(
            "natural frequency {} rad/s, sensitivity peak {}",
            significant(control.design.natural_frequency, 3),
            significant(control.design.sensitivity_peak, 3)
        ),
    );
    row("fed forward", arm(control.arm).to_owned());
    if let Some(said) = stuck(control) {
        row("breakaway", said);
    }
    row("fed back", fed_back(control));
    row("at rest", rest(found));
    row("margin", margin(found));
    row("velocity loop", velocity(found));
    row("proof", proved(&found.proof));
    if let Some(said) = super::structure::moves(found) {
        row("moves", said);
    }
    row("rig time", format!("{:.0} s", found.seconds));
    text
}

/// Why the friction stage ended, and what is still wanted.
pub(super) fn ending(friction: &Friction, wanted: &Wanted) -> String {
    let blocks = friction.blocks.len();
    let mut text = match friction.ending {
        Ending::Met => format!("every wanted interval is met ({wanted}) after {blocks} blocks"),
        Ending::NoDip => format!(
            "no dip is clear of the noise after {blocks} blocks, so that f_s and v_s have no meaning; all else that was wanted is met ({wanted})"
        ),
        Ending::NothingToGain => format!(
            "not every wanted interval is met ({wanted}), but after {blocks} blocks another would narrow them by less than 1 %: a finer encoder, or a longer characterisation (`frictionlab run characterise`) helps"
        ),
        Ending::OutOfTime => format!(
            "not every wanted interval is met ({wanted}): the time was up after {blocks} blocks; `--resume FOLDER --from friction` with more --minutes goes on"
        ),
    };
    if let Some(able) = friction.kept_from {
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "; the travel is too short for speeds above {} rad/s, of {} that the limits allow: nothing is known of the friction there, nor of a dip that ends there",
            significant(friction.speeds.1, 3),
            significant(able, 3)
        );
    }
    text
}

/// What an arm is, in words.
pub(crate) const fn arm(arm: Arm) -> &'static str {
    match arm {
        Arm::Linear => "nothing: the linear gains alone did as well",
        Arm::Reference => "the reference, through the inverse of the drive",
        Arm::Friction => "the reference through the inverse of the drive, and its friction",
        Arm::Load => {
            "the reference through the inverse of the drive, its friction, and the load at its place"
        }
    }
}

/// What is fed forward of the voltage that broke the shaft loose, in words; nothing where none was tried.
pub(super) fn stuck(control: &Control) -> Option<String> {
    let tried = control.stuck_errors.iter().copied().fold(0.0, f64::max);
    let mrad = significant(1e3 * tried, 3);
    match control.stuck {
        Some(Stuck { f_s, v_s }) => Some(format!(
            "the shaft breaks loose at {} V, more than at any speed that it follows; that is fed forward below about {} rad/s, and leaves {mrad} mrad",
            significant(f_s, 3),
            significant(v_s, 2)
        )),
        None if tried > 0.0 => Some(format!(
            "that the shaft breaks loose at more than it shows at any speed was tried too and is not clearly better ({mrad} mrad)"
        )),
        None => None,
    }
}

/// What is fed back, in words.
pub(crate) fn fed_back(control: &Control) -> String {
    control.fed_back.map_or_else(
        || "nothing: at equal robustness it is not clearly better".to_owned(),
        |fed| {
            let strength = significant(fed.strength, 2);
            format!("{} of strength {strength} ({})", fed.kind, fed.kind.strength_is())
        },
    )
}

/// How far what was identified may drift, in words.
pub(super) fn margin(found: &Found) -> String {
    let Some(drift) = found.proof.drift else { return "not computed".to_owned() };
    let share = |factor: f64| percent(100.0 * factor, 0);
    format!(
        "in simulation the shaft rests after a move while friction is {} to {} of what was found, and with a gain of up to {}",
        share(drift.friction_falls),
        share(drift.friction_rises),
        share(drift.gain_rises)
    )
}

/// The velocity loop, in words.
pub(super) fn velocity(found: &Found) -> String {
    found.control.velocity.map_or_else(
        || "no PI keeps the margins; `frictionlab design velocity` tries gains of your own".to_owned(),
        |design| {
            format!(
                "PI with K_p {} and K_i {}, crossover {} rad/s, sensitivity peak {}, {} mV of noise; `mode: velocity` starts it",
                significant(design.gains.k_p, 4),
                significant(design.gains.k_i, 4),
                significant(design.crossover, 3),
                significant(design.sensitivity_peak, 3),
                significant(1e3 * design.noise, 3)
            )
        },
    )
}

/// Whether the shaft rests after a move.
pub(super) fn rest(found: &Found) -> String {
    let mrad = |angle: f64| significant(1e3 * angle, 3);
    // What an integral that stands still may leave.
    let costs = |angle: f64| {
        format!(
            "the integral stands still up to {} mrad of error while the reference does (`resting_angle`), so that as much may be left when it holds",
            mrad(angle)
        )
    };
    if let Some(calmed) = found.proof.calmed {
        let slower = calmed.design.natural_frequency < found.control.design.natural_frequency;
        let slower = if slower { " and the loop is slower" } else { "" };
        return match calmed.rests {
            true => format!(
                "in the proof the shaft hunted while it was held; now {}{slower}, and after moves either way it was seen to rest",
                costs(calmed.resting_angle)
            ),
            false => format!(
                "in the proof the shaft hunted while it was held, and nothing that was tried in the time that was left was seen to end it; now {}: look at it",
                costs(calmed.resting_angle)
            ),
        };
    }
    let angle = found.control.resting_angle;
    match (found.control.rests, angle > 0.0) {
        (true, false) => "after a move the shaft rests".to_owned(),
        (true, true) if angle <= found.drive.encoder_step * ONE => format!(
            "after a move the shaft rests; the integral stands still within one count of the encoder, {} mrad (`resting_angle`)",
            mrad(angle)
        ),
        (true, true)
            if found.drive.seems_early() && angle <= smallest(found.drive.encoder_step) =>
        {
            format!(
                "after a move the shaft rests; {}, because a play may set it swinging",
                costs(angle)
            )
        }
        (true, true) => {
            format!("after a move the shaft rests, because {}; without that it hunts", costs(angle))
        }
        (false, _) => format!(
            "after a move the shaft was not seen to rest in any of the tries; {}: look at it, and lower pid.k_p and pid.k_d if it still swings",
            costs(angle)
        ),
    }
}

/// How friction changed while it was measured.
pub(super) fn drift(change: f64) -> String {
    format!(
        "friction changed by {} while it was measured, as a drive that warms up does; it is told as it was at the end",
        percent(100.0 * change, 1)
    )
}

/// What the proof says.
#[must_use]
pub fn proved(proof: &Proof) -> String {
    match proof.ratio {
        None => "nothing was added to the linear gains, so there was nothing to prove".to_owned(),
        Some(ratio) => {
            let share =
                |end: Option<f64>| end.map_or("?".to_owned(), |end| percent(100.0 * end, 1));
            format!(
                "the tracking error is {} of what the linear gains alone leave (95 % interval {} to {}, {} pairs)",
                percent(100.0 * ratio.value, 1),
                share(ratio.low),
                share(ratio.high),
                proof.pairs.len()
            )
        }
    }
}
