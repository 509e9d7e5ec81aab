//! Logs with the description of their servo: what is taken from the header, what from the
//! measurements, and what the two contradict each other in.

use friction_ident::servo::{RawServoLog, ServoLog};
use recording::RecordingError;
use recording::servo_log::ServoFile;

use super::description::ServoDescription;

/// Share by which a measured supply may differ from the header's before it is taken instead.
const SUPPLY_DIFFERS: f64 = 0.1;
/// A measured supply beyond this many times the nominal one, or below its inverse, is in other
/// units.
const NO_SUPPLY: f64 = 3.0;
/// An arm that turns by fewer counts of its encoder than this does not move.
const COUNTS: f64 = 8.0;
/// The least that an arm must turn by where the encoder is finer, or not known \[rad\].
const LEAST_TURN: f64 = 0.01;
/// Positions beyond this are more likely degrees than turns of a pendulum \[rad\].
const MANY_TURNS: f64 = 6.0 * std::f64::consts::PI;

/// A log and what it is called.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedServoLog {
    /// The file as it was read.
    pub file: ServoFile,
    /// The log on its even grid.
    pub log: ServoLog,
}

impl NamedServoLog {
    /// `sin_sin, kp 400, 0.5 kg`, or the file's name where the header names no motion.
    pub fn title(&self) -> String {
        self.file.title()
    }
}

/// Brings a log to the grid, with what its header and its servo's description say. What was taken
/// otherwise than the header has it, or is not part of the model, is added to `notes`.
///
/// # Errors
/// [`RecordingError`] for a header that contradicts the description or itself, and for a log that
/// cannot be used.
pub fn prepare(
    file: ServoFile,
    servo: &ServoDescription,
    notes: &mut Vec<String>,
) -> Result<NamedServoLog, RecordingError> {
    check_mode(&file, servo, notes)?;
    let reach = file.position.iter().fold(0.0f64, |most, q| most.max(q.abs()));
    let mut note = |text: String| {
        if !notes.contains(&text) {
            notes.push(text);
        }
    };
    if reach > MANY_TURNS {
        note(format!(
            "the position in {} reaches {reach:.0}: logs must be in radians, and these look like degrees or counts",
            file.path.display()
        ));
    }
    for (name, what) in [("ki", "an integral"), ("kd", "a derivative")] {
        if file.number(name).is_some_and(|gain| gain != 0.0) {
            note(format!(
                "a header has {what} gain ({name}), which the model has not: its effect goes into the other parameters"
            ));
        }
    }
    let supply = supply(&file, servo, &mut note);
    let root = file.gain.max(0.0).sqrt();
    let damping = match servo.control() {
        "current" => file.damping.unwrap_or(servo.damping_per_root_gain) * root,
        _ => {
            if file.damping.is_some_and(|damping| damping != 0.0) {
                note(
                    "a header has a damping, which a servo in voltage mode is described without: it is left out"
                        .to_owned(),
                );
            }
            0.0
        }
    };
    let raw = RawServoLog {
        mass: file.mass,
        length: file.length,
        gain: file.gain,
        supply,
        arm_mass: file.arm_mass.unwrap_or(0.0),
        damping,
        time: file.time.clone(),
        position: file.position.clone(),
        speed: file.speed.clone(),
        goal: file.goal.clone(),
        enabled: file.enabled.clone(),
    };
    let log = ServoLog::new(&raw).map_err(|error| file.refuse(error.to_string()))?;
    Ok(NamedServoLog { file, log })
}

/// Refuses a log whose header names another mode than the description's; a mode that is a number is
/// noted.
fn check_mode(
    file: &ServoFile,
    servo: &ServoDescription,
    notes: &mut Vec<String>,
) -> Result<(), RecordingError> {
    const FIELDS: [&str; 3] = ["control_mode", "operating_mode", "mode"];
    let Some((field, mode)) =
        FIELDS.iter().find_map(|field| Some((field, file.header.get(*field)?)))
    else {
        return Ok(());
    };
    let Some(mode) = mode.as_str() else {
        let note = format!(
            "a header says {field} {mode}, whose meaning depends on the servo: it is taken for one of servo {} in {} mode",
            servo.name(),
            servo.control()
        );
        if !notes.contains(&note) {
            notes.push(note);
        }
        return Ok(());
    };
    let (expected, others): (&[&str], &[&str]) = match servo.control() {
        "current" => (&["current", "current-based position", "torque"], &[]),
        _ => (&["position", "extended position", "voltage", "pwm"], &["current", "torque"]),
    };
    // `Current-based Position Control` and `current_position` say the same.
    let plain = mode.to_lowercase().replace(['_', '-'], " ");
    let says = |words: &[&str]| words.iter().any(|word| plain.contains(&word.replace('-', " ")));
    if says(expected) && !says(others) {
        return Ok(());
    }
    Err(file.refuse(format!(
        "its header says control mode `{mode}`, but servo {} is described as one in {} mode ({}); give a \
         description of this mode with --servo FILE.yaml",
        servo.name(),
        servo.control(),
        expected.join(", ")
    )))
}

/// Notes each log in which the arm does not move: any friction that is large enough fits it.
///
/// # Errors
/// [`RecordingError`] with the first of them where none of the logs moves.
pub fn check_motion(
    logs: &[NamedServoLog],
    servo: &ServoDescription,
    notes: &mut Vec<String>,
) -> Result<(), RecordingError> {
    let least = servo.encoder_step.map_or(LEAST_TURN, |step| LEAST_TURN.max(COUNTS * step));
    let range = |values: &[f64]| {
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        most - values.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let still: Vec<&NamedServoLog> =
        logs.iter().filter(|named| range(named.log.position()) < least).collect();
    for named in &still {
        let (turned, asked) = (range(named.log.position()), range(named.log.goal()));
        let turned = format!("the arm turns by {:.0} mrad only", 1e3 * turned);
        let asked = format!("the goal moves by {:.0} mrad", 1e3 * asked);
        if still.len() == logs.len() {
            return Err(named.file.refuse(format!(
                "{turned}, while {asked}; any friction that is large enough fits an arm that rests. Check that \
                 `position` holds what was measured and that the motor was driven, or record a motion"
            )));
        }
        notes.push(format!(
            "{}: {turned}, while {asked}; a log of an arm that rests says little, and its small error \
             makes the mean error small",
            named.file.path.display()
        ));
    }
    Ok(())
}

/// The supply to compute with \[V\]: the header's; where what was measured contradicts it, or it is
/// missing, the median measured; else the description's.
fn supply(file: &ServoFile, servo: &ServoDescription, note: &mut impl FnMut(String)) -> f64 {
    let nominal = servo.nominal_voltage;
    let possible = |volts: &f64| (nominal / NO_SUPPLY..nominal * NO_SUPPLY).contains(volts);
    let measured = file.measured_supply.filter(possible);
    if let (Some(volts), None) = (file.measured_supply, measured) {
        note(format!(
            "measured supplies of about {} V are beyond anything for servo {} ({nominal} V): they are left out",
            hundredths(volts),
            servo.name()
        ));
    }
    match (file.nominal_supply, measured) {
        (Some(header), Some(volts)) if (volts / header - 1.0).abs() > SUPPLY_DIFFERS => {
            note(format!(
                "a header says {header} V, but about {} V were measured: the median measured is taken",
                hundredths(volts)
            ));
            volts
        }
        (Some(header), _) => header,
        (None, Some(volts)) => {
            note("a header gives no supply (vin): the median measured is taken".to_owned());
            volts
        }
        (None, None) => {
            note(format!(
                "a header gives no supply (vin) and none was measured: the {nominal} V of servo {} are taken",
                servo.name()
            ));
            nominal
        }
    }
}

/// To two decimals.
fn hundredths(volts: f64) -> f64 {
    (100.0 * volts).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Map, json};

    fn file(header: serde_json::Value, vin: Option<f64>, measured: Option<f64>) -> ServoFile {
        let time: Vec<f64> = (0..50).map(|k| 0.01 * f64::from(k)).collect();
        ServoFile {
            path: "a.json".into(),
            header: header.as_object().cloned().unwrap_or_else(Map::new),
            mass: 0.5,
            length: 0.1,
            gain: 16.0,
            nominal_supply: vin,
            measured_supply: measured,
            arm_mass: Some(0.1),
            damping: Some(2.0),
            position: vec![0.0; 50],
            speed: vec![0.0; 50],
            goal: vec![0.0; 50],
            enabled: vec![true; 50],
            time,
        }
    }

    fn supply_of(vin: Option<f64>, measured: Option<f64>) -> (f64, Vec<String>) {
        let servo = ServoDescription::of_motor("sts3215").unwrap();
        let mut notes = Vec::new();
        let volts = supply(&file(json!({}), vin, measured), &servo, &mut |text| notes.push(text));
        (volts, notes)
    }

    #[test]
    fn a_wrong_supply_in_the_header_gives_way_to_what_was_measured() {
        let (volts, notes) = supply_of(Some(15.0), Some(11.9));
        assert_eq!(volts, 11.9);
        assert!(notes[0].contains("15 V") && notes[0].contains("about 11.9 V"), "{notes:?}");
        assert_eq!(supply_of(Some(12.0), Some(11.9)), (12.0, vec![]));
        assert_eq!(supply_of(None, Some(11.9)).0, 11.9);
        assert_eq!(supply_of(None, None).0, 12.0);
        // 119 tenths of a volt are no volts.
        let (volts, notes) = supply_of(Some(12.0), Some(119.0));
        assert_eq!(volts, 12.0);
        assert!(notes[0].contains("beyond"), "{notes:?}");
    }

    #[test]
    fn an_arm_that_rests_is_told_and_refused_where_no_other_moves() {
        let servo = ServoDescription::of_motor("sts3215").unwrap();
        let mut notes = Vec::new();
        let of = |swing: f64| {
            let mut file = file(json!({}), Some(12.0), None);
            file.goal.iter_mut().zip(&file.time).for_each(|(q, t)| *q = (6.0 * t).sin());
            file.position
                .iter_mut()
                .zip(&file.time)
                .for_each(|(q, t)| *q = swing * (6.0 * t).sin());
            prepare(file, &servo, &mut Vec::new()).unwrap()
        };
        let (still, noisy, moving) = (of(0.0), of(0.002), of(0.5));
        check_motion(std::slice::from_ref(&moving), &servo, &mut notes).unwrap();
        assert!(notes.is_empty());
        let all = [still.clone(), noisy];
        let message = check_motion(&all, &servo, &mut notes).unwrap_err().to_string();
        assert!(message.contains("a.json") && message.contains("turns by 0 mrad"), "{message}");
        check_motion(&[still, moving], &servo, &mut notes).unwrap();
        assert!(notes.len() == 1 && notes[0].contains("rests"), "{notes:?}");
    }

    #[test]
    fn positions_in_degrees_are_told() {
        let servo = ServoDescription::of_motor("sts3215").unwrap();
        let mut degrees = file(json!({}), Some(12.0), None);
        degrees.position[7] = 90.0;
        let mut notes = Vec::new();
        prepare(degrees, &servo, &mut notes).unwrap();
        assert!(notes[0].contains("degrees"), "{notes:?}");
    }

    #[test]
    fn a_control_mode_that_contradicts_the_description_is_refused() {
        let servo = ServoDescription::of_motor("sts3215").unwrap();
        let mut notes = Vec::new();
        let of = |mode: &str| file(json!({ "control_mode": mode }), Some(12.0), None);
        let message = prepare(of("current"), &servo, &mut notes).unwrap_err().to_string();
        assert!(message.contains("a.json") && message.contains("`current`"), "{message}");
        prepare(of("position"), &servo, &mut notes).unwrap();
        assert!(notes.iter().any(|note| note.contains("damping")), "{notes:?}");
        let message =
            prepare(of("Current-based Position Control"), &servo, &mut notes).unwrap_err();
        assert!(message.to_string().contains("voltage mode"), "{message}");
        prepare(of("Position Control Mode"), &servo, &mut notes).unwrap();
        let joint = ServoDescription::of_motor("erob80_100").unwrap();
        for mode in ["current", "Current-based Position Control", "current_position"] {
            prepare(of(mode), &joint, &mut notes).unwrap();
        }
        prepare(of("position"), &joint, &mut notes).unwrap_err();
        let numbered = file(json!({ "operating_mode": 5 }), Some(12.0), None);
        prepare(numbered, &servo, &mut notes).unwrap();
        assert!(notes.iter().any(|note| note.contains("operating_mode 5")), "{notes:?}");
    }
}
