//! Units in the names of columns, in the forms that people write.
//!
//! `velocity [rad/s]`, `velocity (rad/s)`, `velocity_rad_s`, `velocity_rad.s^-1` and `velocity
//! rad/s` say the same. What stands in brackets is a unit; at the end of a name it is one where it
//! is known.

use std::f64::consts::PI;

use super::AxisKind;

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Time \[s\].
    Time,
    /// Length \[m\].
    Length,
    /// Angle \[rad\].
    Angle,
    /// Velocity along a line \[m/s\].
    Speed,
    /// Velocity of a turn \[rad/s\].
    AngularSpeed,
    /// Force \[N\].
    Force,
    /// Torque \[N m\].
    Torque,
    /// Voltage \[V\].
    Voltage,
    /// Current \[A\].
    Current,
    /// Counts, percent and what else has no size of its own.
    Bare,
}

impl Quantity {
    /// Kind of axis that has such a quantity, where only one has.
    #[must_use]
    pub const fn axis(self) -> Option<AxisKind> {
        match self {
            Self::Angle | Self::AngularSpeed | Self::Torque => Some(AxisKind::Rotary),
            Self::Length | Self::Speed | Self::Force => Some(AxisKind::Linear),
            _ => None,
        }
    }
}

/// A known unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// What it measures.
    pub quantity: Quantity,
    /// Factor to SI.
    pub factor: f64,
}

/// The name of a column, taken apart.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts<'a> {
    /// The name without its unit.
    pub stem: &'a str,
    /// The unit as it is written.
    pub unit: Option<&'a str>,
    /// It stands in brackets, so that it can be nothing else.
    pub bracketed: bool,
}

/// Takes a name apart. The unit at the end of a name without brackets is the longest that is known; a
/// name of more than a letter may be a unit and nothing else, as `rpm`.
#[must_use]
pub fn parts(name: &str) -> Parts<'_> {
    let name = name.trim();
    let none = Parts { stem: name, unit: None, bracketed: false };
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        let Some(inner) = name.strip_suffix(close) else { continue };
        let Some(at) = inner.find(open) else { continue };
        let unit = inner[at + open.len_utf8()..].trim();
        // An index is no unit.
        if unit.is_empty() || unit.bytes().all(|byte| byte.is_ascii_digit()) {
            return none;
        }
        return Parts { stem: trimmed(&inner[..at]), unit: Some(unit), bracketed: true };
    }
    if name.chars().nth(1).is_some() && unit_of(name).is_some() {
        return Parts { stem: "", unit: Some(name), bracketed: false };
    }
    for (at, separator) in name.match_indices(['_', ' ', '.', '/', '-']) {
        let (stem, unit) = (trimmed(&name[..at]), &name[at + separator.len()..]);
        if !stem.is_empty() && unit_of(unit).is_some() {
            return Parts { stem, unit: Some(unit.trim()), bracketed: false };
        }
    }
    none
}

fn trimmed(stem: &str) -> &str {
    stem.trim_end_matches([' ', '_', '.', '/', '-', ',']).trim_start()
}

/// The unit that a text means.
#[must_use]
pub fn unit_of(text: &str) -> Option<Unit> {
    // In mixed case a capital M is mega, which no column here has.
    if text.starts_with('M') && (text == "MN" || text.bytes().any(|byte| byte.is_ascii_lowercase()))
    {
        return None;
    }
    let text = normal(text);
    let found = UNITS.iter().find(|(_, _, names)| names.contains(&text.as_str()));
    found.map(|&(quantity, factor, _)| Unit { quantity, factor })
}

/// One spelling: small letters, `_` for a product, `/` for a quotient.
fn normal(text: &str) -> String {
    let mut text = text
        .trim()
        .trim_start_matches('(')
        .trim_end_matches(')')
        .to_lowercase()
        .replace(['µ', 'μ'], "u")
        .replace(['°', 'º'], "deg")
        .replace("⁻¹", "^-1")
        .replace("**", "^")
        .replace("_per_", "/")
        .replace(" per ", "/")
        .replace([' ', '\u{a0}', '·', '⋅', '∙', '×', '*', '.'], "_");
    for inverse in ["^-1", "^(-1)", "-1"] {
        if let Some(rest) = text.strip_suffix(inverse) {
            let (product, last) = rest.rsplit_once('_').unwrap_or(("1", rest));
            text = format!("{product}/{last}");
            break;
        }
    }
    text.replace("_/", "/").replace("/_", "/").replace('-', "_")
}

const TURN: f64 = 2.0 * PI;
/// Weight of a kilogram \[N\].
const KGF: f64 = 9.806_65;
/// Weight of a pound \[N\].
const LBF: f64 = 4.448_221_615_260_5;
/// \[m\]
const INCH: f64 = 0.0254;
const FOOT: f64 = 12.0 * INCH;

/// What it measures, factor to SI, spellings.
const UNITS: &[(Quantity, f64, &[&str])] = &[
    (Quantity::Time, 1.0, &["s", "sec", "secs", "second", "seconds"]),
    (Quantity::Time, 1e-3, &["ms", "msec", "msecs", "millis", "millisecond", "milliseconds"]),
    (Quantity::Time, 1e-6, &["us", "usec", "usecs", "micros", "microsecond", "microseconds"]),
    (Quantity::Time, 1e-9, &["ns", "nsec", "nsecs", "nanos", "nanosecond", "nanoseconds"]),
    (Quantity::Time, 60.0, &["min", "minute", "minutes"]),
    (Quantity::Length, 1.0, &["m", "meter", "meters", "metre", "metres"]),
    (Quantity::Length, 1e-2, &["cm"]),
    (Quantity::Length, 1e-3, &["mm"]),
    (Quantity::Length, 1e-6, &["um", "micron", "microns"]),
    (Quantity::Length, INCH, &["inch", "inches"]),
    (Quantity::Angle, 1.0, &["rad", "radian", "radians"]),
    (Quantity::Angle, 1e-3, &["mrad"]),
    (Quantity::Angle, 1e-6, &["urad"]),
    (Quantity::Angle, PI / 180.0, &["deg", "degree", "degrees"]),
    (Quantity::Angle, TURN, &["rev", "revs", "revolution", "revolutions", "turn", "turns"]),
    (Quantity::Speed, 1.0, &["m/s", "m_s", "m/sec", "mps"]),
    (Quantity::Speed, 1e-2, &["cm/s", "cm_s"]),
    (Quantity::Speed, 1e-3, &["mm/s", "mm_s", "mm/sec", "mmps"]),
    (Quantity::Speed, 1e-6, &["um/s", "um_s"]),
    (Quantity::Speed, INCH, &["in/s", "inch/s", "inches/s", "ips"]),
    (Quantity::Speed, 1.0 / 60.0, &["m/min", "m_min"]),
    (Quantity::Speed, 1e-3 / 60.0, &["mm/min", "mm_min"]),
    (Quantity::AngularSpeed, 1.0, &["rad/s", "rad_s", "rad/sec", "rad_sec", "radps", "radians/s"]),
    (Quantity::AngularSpeed, 1e-3, &["mrad/s", "mrad_s"]),
    (
        Quantity::AngularSpeed,
        PI / 180.0,
        &["deg/s", "deg_s", "deg/sec", "deg_sec", "degps", "dps", "degrees/s"],
    ),
    (
        Quantity::AngularSpeed,
        TURN / 60.0,
        &["rpm", "r/min", "rev/min", "rev_min", "u/min", "1/min", "turns/min"],
    ),
    (Quantity::AngularSpeed, TURN, &["rps", "rev/s", "rev_s", "r/s", "turns/s", "turns_s"]),
    (Quantity::Force, 1.0, &["n", "newton", "newtons"]),
    (Quantity::Force, 1e-3, &["mn"]),
    (Quantity::Force, 1e3, &["kn"]),
    (Quantity::Force, KGF, &["kgf", "kp"]),
    (Quantity::Force, 1e-3 * KGF, &["gf"]),
    (Quantity::Force, LBF, &["lbf"]),
    (Quantity::Force, LBF / 16.0, &["ozf"]),
    (Quantity::Torque, 1.0, &["nm", "n_m", "newton_meter", "newton_metre", "newtonmeter"]),
    (Quantity::Torque, 1e-3, &["mnm", "mn_m", "nmm", "n_mm"]),
    (Quantity::Torque, 1e-6, &["unm", "un_m"]),
    (Quantity::Torque, 1e-2, &["ncm", "n_cm"]),
    (Quantity::Torque, 1e3, &["knm", "kn_m"]),
    (Quantity::Torque, KGF, &["kgf_m", "kgfm", "kpm", "kgm", "kg_m"]),
    (Quantity::Torque, 1e-2 * KGF, &["kgf_cm", "kgfcm", "kgcm", "kg_cm"]),
    (Quantity::Torque, 1e-5 * KGF, &["gf_cm", "gfcm", "gcm", "g_cm"]),
    (Quantity::Torque, LBF * FOOT, &["lbf_ft", "ft_lbf", "lb_ft", "ft_lb", "lbft", "ftlb"]),
    (Quantity::Torque, LBF * INCH, &["lbf_in", "in_lbf", "lb_in", "in_lb", "lbin", "inlb"]),
    (Quantity::Torque, LBF * INCH / 16.0, &["ozf_in", "oz_in", "in_oz", "ozin", "inoz"]),
    (Quantity::Voltage, 1.0, &["v", "volt", "volts"]),
    (Quantity::Voltage, 1e-3, &["mv"]),
    (Quantity::Current, 1.0, &["a", "amp", "amps", "ampere", "amperes"]),
    (Quantity::Current, 1e-3, &["ma"]),
    (
        Quantity::Bare,
        1.0,
        &[
            "count", "counts", "cnt", "tick", "ticks", "pulse", "pulses", "raw", "lsb", "percent",
            "pct", "pu", "%",
        ],
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_usual_form_of_a_unit_is_the_same_unit() {
        for name in [
            "velocity [rad/s]",
            "velocity(rad/s)",
            "velocity {rad/s}",
            "velocity_rad_s",
            "velocity_rad/s",
            "velocity rad/s",
            "velocity_rad.s^-1",
            "velocity [rad s^-1]",
            "velocity [rad·s⁻¹]",
            "velocity [rad*s**-1]",
            "velocity [rad s-1]",
            "velocity_rad_per_s",
            "velocity_radps",
            "velocity/(rad/s)",
            "velocity / rad/s",
        ] {
            let found = parts(name);
            assert_eq!(found.stem, "velocity", "{name}");
            let unit = unit_of(found.unit.unwrap_or_else(|| panic!("{name} has a unit"))).unwrap();
            assert_eq!((unit.quantity, unit.factor), (Quantity::AngularSpeed, 1.0), "{name}");
        }
    }

    #[test]
    fn units_are_converted() {
        for (text, factor) in [
            ("deg", PI / 180.0),
            ("°/s", PI / 180.0),
            ("rpm", TURN / 60.0),
            ("min^-1", TURN / 60.0),
            ("ms", 1e-3),
            ("µs", 1e-6),
            ("ns", 1e-9),
            ("m/s", 1.0),
            ("mNm", 1e-3),
            ("N m", 1.0),
            ("N·m", 1.0),
            ("N-m", 1.0),
            ("N cm", 1e-2),
            ("N⋅m", 1.0),
            ("kgf cm", 0.0980665),
            ("in-lb", 0.112984829),
            ("oz-in", 0.00706155181),
            ("inch", 0.0254),
            ("MNm", f64::NAN),
            ("N/m", f64::NAN),
            ("furlong", f64::NAN),
        ] {
            let found = unit_of(text).map_or(f64::NAN, |unit| unit.factor);
            let same = (found / factor - 1.0).abs() < 1e-8;
            assert!(same || found.is_nan() && factor.is_nan(), "{text}: {found}");
        }
    }

    #[test]
    fn a_name_may_be_a_unit_and_nothing_else() {
        for name in ["rpm", "deg_s", "rad/s", "mNm", "Ncm", " U/min "] {
            assert_eq!(parts(name).unit, Some(name.trim()), "{name}");
            assert_eq!(parts(name).stem, "", "{name}");
        }
        assert_eq!(parts("v").unit, None);
    }

    #[test]
    fn what_is_no_unit_stays_in_the_name() {
        for name in ["position_reference", "q1", "joint[0]", "velocity", "m", "plant_input"] {
            assert_eq!(parts(name), Parts { stem: name, unit: None, bracketed: false });
        }
    }
}
