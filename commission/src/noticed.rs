//! Sensors that contradict each other, or say nothing: told before anything faster moves, and refused
//! where the user's own file says otherwise.

use report::numbers::{percent, significant};
use rig_driver::Calibration;
use rig_setup::Findings;

use crate::axis::Known;
use crate::{CommissionError, Stage};

/// Two scales that differ by more than this share contradict each other, if it is three standard errors
/// too.
const DIFFERS: f64 = 0.05;
/// The same of a scale that the user's file states.
const STATED: f64 = 0.1;

/// What was noticed of the sensors.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Noticed {
    /// In sentences.
    pub said: Vec<String>,
    /// The fastest speed by the encoder from now on, where that is less than before [rad/s].
    pub fastest: Option<f64>,
}

/// What is noticed where the signs were `found`.
pub(crate) fn noticed(found: &Findings, known: &Known) -> Noticed {
    let mut all = Noticed::default();
    if let Some(shows) = differs(found) {
        let fastest = (shows > 1.0).then_some(known.velocity / shows);
        let limit = fastest.map_or_else(
            || "the speed limit is held by the encoder, which shows more".to_owned(),
            |fastest| {
                format!(
                    "the speed limit is held by the tachometer, which shows more: {} rad/s by the encoder instead of {}",
                    significant(fastest, 3),
                    significant(known.velocity, 3)
                )
            },
        );
        all.said.push(format!(
            "encoder and tachometer contradict each other: the tachometer shows {} of the encoder's speed, so one of the two scales is wrong. The encoder is believed, and the tachometer is scaled to it; {limit}. {}",
            percent(100.0 * shows, 1),
            by_hand(known)
        ));
        all.fastest = fastest;
    }
    if known.torque && found.torque_sign.is_none() {
        let level = found.torque_zero.value;
        let stands = found.levels.iter().all(|level| level.torque.abs() < 1e-12);
        let what = if stands && level != 0.0 {
            format!(
                "stands at {} N m whatever the shaft does: it is at the end of its range, or unplugged",
                significant(level, 3)
            )
        } else {
            "does not show the friction of the motion: look at its plug, its range and its zero"
                .to_owned()
        };
        all.said.push(format!("the torque sensor {what}. Nothing depends on it here"));
    }
    all
}

/// What the tachometer shows of the encoder's speed, where that is not all of it.
fn differs(found: &Findings) -> Option<f64> {
    let gain = found.tachometer_gain?;
    let shows = 1.0 / gain.value.abs();
    let sure = 3.0 * gain.standard_error / (gain.value * gain.value);
    ((shows - 1.0).abs() > DIFFERS.max(sure)).then_some(shows)
}

/// How the encoder's scale is looked at.
pub(crate) fn by_hand(known: &Known) -> String {
    let counts = known.description.as_ref().map(|said| said.counts_per_turn);
    counts.filter(|counts| *counts > 0.0).map_or_else(
        || {
            "Turn the shaft by hand once round and look whether the encoder tells 6.283 rad"
                .to_owned()
        },
        |counts| format!("Turned by hand once round, the encoder has to count {counts:.0}"),
    )
}

/// Refuses a rig whose tachometer shows another share of the encoder's speed than the user's file says.
///
/// # Errors
/// [`CommissionError::Unusable`] says both, and what to do.
pub(crate) fn as_stated(
    found: &Findings,
    stated: Option<Calibration>,
    known: &Known,
) -> Result<(), CommissionError> {
    let Some((stated, gain)) = stated.zip(found.tachometer_gain) else { return Ok(()) };
    let ratio = (gain.value / stated.tachometer_gain).abs();
    let sure = 3.0 * (gain.standard_error / stated.tachometer_gain).abs();
    if (ratio - 1.0).abs() <= STATED.max(sure) {
        return Ok(());
    }
    Err(CommissionError::Unusable {
        stage: Stage::Meet,
        why: format!(
            "encoder and tachometer contradict the rig's profile: it says that the true speed is {} times what the tachometer shows, and by the encoder it is {} times. One of the two scales is not what it was, and by a wrong one the shaft may turn faster than its limit, so nothing faster was driven. {}. `frictionlab rig calibrate` writes what holds now",
            significant(stated.tachometer_gain.abs(), 3),
            significant(gain.value.abs(), 3),
            by_hand(known)
        ),
    })
}

#[cfg(test)]
mod tests {
    use friction_ident::Uncertain;
    use rig_driver::Sign;
    use rig_setup::Level;

    use super::*;

    fn found(gain: f64) -> Findings {
        let known = |value| Uncertain { value, standard_error: 0.001 };
        Findings {
            encoder_sign: Sign::Forward,
            tachometer_gain: Some(known(gain)),
            tachometer_zero: known(0.0),
            tachometer_residual: 0.01,
            torque_sign: None,
            torque_zero: known(2.5),
            deadband_forward: known(0.5),
            deadband_backward: known(0.5),
            levels: vec![Level { volts: 1.0, velocity: 1.0, tachometer: 1.0 / gain, torque: 0.0 }],
        }
    }

    fn known() -> Known {
        Known {
            about: None,
            description: None,
            voltage: 6.0,
            velocity: 9.0,
            torque: true,
            period: 1e-3,
            winding: None,
            travel: None,
            switched_on: None,
            corrected_by: None,
        }
    }

    #[test]
    fn sensors_that_contradict_each_other_hold_the_limit_by_the_faster_of_both() {
        let slow = noticed(&found(-0.5), &known());
        assert!(slow.said[0].contains("200.0 %") && slow.fastest == Some(4.5), "{slow:?}");
        assert!(slow.said[1].contains("stands at 2.50 N m"), "{slow:?}");
        let fast = noticed(&found(1.25), &known());
        assert!(fast.said[0].contains("80.0 %") && fast.fastest.is_none(), "{fast:?}");
        let alike = noticed(&found(1.01), &Known { torque: false, ..known() });
        assert_eq!(alike, Noticed::default());
    }

    #[test]
    fn a_scale_that_is_not_what_the_file_states_is_refused() {
        let stated = |gain| Some(Calibration { tachometer_gain: gain, ..Calibration::default() });
        as_stated(&found(1.25), stated(-1.26), &known()).unwrap();
        as_stated(&found(1.25), None, &known()).unwrap();
        let said = as_stated(&found(1.25), stated(1.0), &known()).unwrap_err().to_string();
        assert!(said.contains("contradict") && said.contains("rig calibrate"), "{said}");
    }
}
