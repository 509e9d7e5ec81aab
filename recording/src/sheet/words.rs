//! The words in a column's name: what they say of the quantity, and whether it is measured.

use crate::column::Channel;
use crate::units;

/// How near a column is to what happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Nearness {
    /// Measured, or actual.
    Measured,
    /// It does not say.
    Plain,
    /// Commanded.
    Commanded,
    /// Wanted, as a reference or a target is.
    Wanted,
}

/// Words of each quantity. Those marked `true` say it with a unit of the quantity only.
const QUANTITIES: [(Channel, &[(&str, bool)]); 4] = [
    (
        Channel::Time,
        &[("time", false), ("zeit", false), ("temps", true), ("tiempo", false), ("t", true)],
    ),
    (
        Channel::Position,
        &[
            ("position", false),
            ("pos", false),
            ("angle", false),
            ("ang", true),
            ("theta", false),
            ("phi", true),
            ("θ", false),
            ("ϑ", false),
            ("φ", false),
            ("ϕ", false),
            ("displacement", true),
            ("winkel", false),
            ("drehwinkel", false),
            ("lage", true),
            ("weg", true),
            ("posición", false),
            ("posicion", false),
            ("ángulo", false),
            ("angulo", false),
            ("déplacement", true),
            ("deplacement", true),
            ("q", true),
            ("x", true),
            ("s", true),
        ],
    ),
    (
        Channel::Velocity,
        &[
            ("velocity", false),
            ("vel", false),
            ("speed", true),
            ("spd", true),
            ("omega", false),
            ("ω", false),
            ("geschwindigkeit", false),
            ("winkelgeschwindigkeit", false),
            ("drehzahl", true),
            ("vitesse", false),
            ("velocidad", false),
            ("v", true),
            ("w", true),
            ("n", true),
        ],
    ),
    (
        Channel::Force,
        &[
            ("force", false),
            ("torque", false),
            ("tau", false),
            ("τ", false),
            ("tq", false),
            ("trq", false),
            ("effort", false),
            ("kraft", false),
            ("moment", false),
            ("drehmoment", false),
            ("antriebsmoment", false),
            ("motormoment", false),
            ("couple", true),
            ("fuerza", false),
            ("momento", false),
            ("par", true),
            ("f", true),
            ("m", true),
            ("t", true),
        ],
    ),
];

const MEASURED: [&str; 16] = [
    "measured",
    "meas",
    "measurement",
    "mess",
    "gemessen",
    "actual",
    "act",
    "ist",
    "istwert",
    "feedback",
    "fb",
    "fbk",
    "real",
    "medido",
    "medida",
    "mesuré",
];
const COMMANDED: [&str; 6] = ["cmd", "command", "commanded", "demand", "demanded", "input"];
const WANTED: [&str; 14] = [
    "ref",
    "reference",
    "target",
    "setpoint",
    "set",
    "sp",
    "desired",
    "des",
    "wanted",
    "goal",
    "soll",
    "sollwert",
    "consigne",
    "consigna",
];
/// Words that leave the quantity what it is.
const BESIDE: [&str; 23] = [
    "motor", "moteur", "joint", "axis", "achse", "axe", "eje", "shaft", "drive", "link",
    "actuator", "servo", "output", "value", "wert", "encoder", "enc", "angular", "linear",
    "rotary", "elapsed", "relative", "rel",
];
/// Words of what is no channel of its own, or not the one that drives.
const OTHER: [&str; 22] = [
    "error",
    "err",
    "fehler",
    "erreur",
    "deviation",
    "std",
    "sigma",
    "limit",
    "max",
    "min",
    "friction",
    "reibung",
    "load",
    "last",
    "external",
    "ext",
    "disturbance",
    "gravity",
    "spring",
    "offset",
    "bias",
    "constant",
];

/// What the words of a name say.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Words {
    words: Vec<String>,
}

impl Words {
    /// The words of a name, without its unit.
    pub(super) fn of(name: &str) -> Self {
        let stem = units::parts(name).stem;
        let mut words: Vec<String> = vec![String::new()];
        let mut small = false;
        for letter in stem.chars() {
            let begins = !letter.is_alphanumeric() || small && letter.is_uppercase();
            if begins {
                words.push(String::new());
            }
            if let (true, Some(word)) = (letter.is_alphanumeric(), words.last_mut()) {
                word.extend(letter.to_lowercase());
            }
            small = letter.is_lowercase();
        }
        words.retain(|word| !word.is_empty());
        Self { words }
    }

    fn any(&self, of: &[&str]) -> bool {
        self.words.iter().any(|word| of.contains(&word.as_str()))
    }

    /// How near it is to what happened.
    pub(super) fn nearness(&self) -> Nearness {
        if self.any(&WANTED) {
            Nearness::Wanted
        } else if self.any(&COMMANDED) {
            Nearness::Commanded
        } else if self.any(&MEASURED) {
            Nearness::Measured
        } else {
            Nearness::Plain
        }
    }

    /// Whether it says that it is something else.
    pub(super) fn is_other(&self) -> bool {
        self.any(&OTHER)
    }

    /// Whether the words say that quantity and no other, with a unit of it or without one.
    pub(super) fn say(&self, channel: Channel, with_unit: bool) -> bool {
        let known = |channel: Channel, word: &str| {
            let own = QUANTITIES.iter().filter(|(other, _)| *other == channel);
            own.flat_map(|(_, words)| words.iter())
                .any(|(known, unit)| *known == word && (with_unit || !unit))
        };
        let beside = |word: &str| {
            [&MEASURED[..], &COMMANDED, &WANTED, &BESIDE].iter().any(|some| some.contains(&word))
        };
        let said = |word: &&String| known(channel, word);
        self.words.iter().filter(said).count() == 1
            && self.words.iter().all(|word| known(channel, word) || beside(word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_split_at_blanks_marks_and_capitals() {
        let of = |name: &str| Words::of(name).words.join(" ");
        assert_eq!(of("Position Actual [rad]"), "position actual");
        assert_eq!(of("jointPos_deg"), "joint pos");
        assert_eq!(of("tau_cmd_Nm"), "tau cmd");
        assert_eq!(of("θ [rad]"), "θ");
    }

    #[test]
    fn words_say_one_quantity_and_whether_it_was_measured() {
        assert!(Words::of("cmd_torque_Nm").say(Channel::Force, true));
        assert!(Words::of("Winkel").say(Channel::Position, false));
        assert!(!Words::of("F").say(Channel::Force, false), "one letter may be anything");
        assert!(!Words::of("torque limit").say(Channel::Force, false));
        assert!(!Words::of("position torque").say(Channel::Force, false));
        assert_eq!(Words::of("tau_cmd").nearness(), Nearness::Commanded);
        assert!(Words::of("torque_meas").nearness() < Words::of("torque").nearness());
    }
}
