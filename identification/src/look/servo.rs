//! What the log of a servo holds, before any fit.

use std::fmt::Write;

use friction_ident::statistics::upper_median;
use recording::servo_log::ServoFile;
use report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace};
use serde::Serialize;

use crate::servo::description::ServoDescription;
use crate::servo::logs::{check_motion, prepare};

/// What a log holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ServoLook {
    /// `servo_log`.
    form: &'static str,
    path: String,
    /// As the header names it; none where it does not.
    motor: Option<String>,
    /// Motion, gain and mass, or the file's name.
    title: String,
    mass: f64,
    length: f64,
    gain: f64,
    nominal_supply: Option<f64>,
    measured_supply: Option<f64>,
    entries: usize,
    duration: f64,
    /// One by the median step \[Hz\]; none for a single entry.
    rate: Option<f64>,
    longest_step: f64,
    position: [f64; 2],
    goal: [f64; 2],
    /// Share of the entries in which the motor is driven.
    driven: f64,
    /// What can be identified, with the command.
    can: Vec<String>,
    /// What is not as it should be, in sentences.
    problems: Vec<String>,
}

/// Looks at a log.
#[must_use]
pub fn servo(file: &ServoFile) -> ServoLook {
    let range = |values: &[f64]| {
        values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| {
            [least.min(*value), most.max(*value)]
        })
    };
    let mut steps: Vec<f64> = file.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let longest_step = steps.iter().copied().fold(0.0, f64::max);
    let first_and_last = file.time.first().zip(file.time.last());
    let driven = file.enabled.iter().filter(|on| **on).count() as f64;
    let motor = file.text("motor").map(str::to_owned);
    let (problems, named) = problems(file, motor.as_deref());
    let path = file.path.display().to_string();
    let can = vec![format!(
        "friction of the servo, best from logs of several gains and masses together: \
         frictionlab identify-servo {path}{named}"
    )];
    ServoLook {
        form: "servo_log",
        title: file.title(),
        mass: file.mass,
        length: file.length,
        gain: file.gain,
        nominal_supply: file.nominal_supply,
        measured_supply: file.measured_supply,
        entries: file.time.len(),
        duration: first_and_last.map_or(0.0, |(first, last)| last - first),
        rate: upper_median(&mut steps).filter(|step| *step > 0.0).map(f64::recip),
        longest_step,
        position: range(&file.position),
        goal: range(&file.goal),
        driven: driven / file.enabled.len().max(1) as f64,
        path,
        motor,
        can,
        problems,
    }
}

/// What is wrong with the log, and the option that its command needs.
fn problems(file: &ServoFile, motor: Option<&str>) -> (Vec<String>, &'static str) {
    let Some(motor) = motor else {
        let why = "its header does not name the servo (`motor`): say which it is with --servo NAME";
        return (vec![why.to_owned()], " --servo NAME");
    };
    let Ok(servo) = ServoDescription::of_motor(motor) else {
        let why = format!(
            "no servo `{motor}` is described: frictionlab identify-servo --list-servos shows which are, and \
             how to describe one"
        );
        return (vec![why], " --servo FILE.yaml");
    };
    let mut notes = Vec::new();
    let checked = prepare(file.clone(), &servo, &mut notes)
        .and_then(|named| check_motion(&[named], &servo, &mut notes));
    notes.extend(checked.err().map(|error| error.to_string()));
    (notes, "")
}

impl ServoLook {
    /// The text.
    #[must_use]
    pub fn terminal(&self) -> String {
        let mut text = format!("{}\n  the log of a servo with a pendulum\n", self.path);
        // Writing to a string cannot fail, hence the ignored results.
        for [name, value] in self.rows() {
            let _ = writeln!(text, "  {name:<17} {value}");
        }
        for (title, lines) in
            [("not as expected", &self.problems), ("can be identified", &self.can)]
        {
            if !lines.is_empty() {
                let _ = writeln!(text, "\n{title}");
            }
            for line in lines {
                let _ = writeln!(text, "  {line}");
            }
        }
        text
    }

    /// Names and values.
    fn rows(&self) -> Vec<[String; 2]> {
        let volts = |volts: Option<f64>| {
            volts.map_or_else(|| "none".to_owned(), |volts| format!("{volts:.2} V"))
        };
        let span = |[least, most]: [f64; 2]| format!("{least:.3} to {most:.3} rad");
        let rate = self.rate.map_or_else(
            || "no rate, as no two entries have different times".to_owned(),
            |rate| format!("{:.3} s at {rate:.0} Hz (median)", self.duration),
        );
        [
            ("motor", self.motor.clone().unwrap_or_else(|| "not named".to_owned())),
            ("motion", self.title.clone()),
            ("pendulum", format!("{} kg at {} m", self.mass, self.length)),
            ("gain (kp)", self.gain.to_string()),
            (
                "supply",
                format!(
                    "{} in the header, {} measured",
                    volts(self.nominal_supply),
                    volts(self.measured_supply)
                ),
            ),
            (
                "entries",
                format!("{}, {rate}; longest step {:.4} s", self.entries, self.longest_step),
            ),
            ("position", span(self.position)),
            ("goal", span(self.goal)),
            ("driven", format!("in {:.0} % of the entries", 100.0 * self.driven)),
        ]
        .map(|(name, value)| [name.to_owned(), value])
        .to_vec()
    }

    /// The page.
    #[must_use]
    pub fn page(&self, file: &ServoFile) -> Page {
        let mut blocks: Vec<Block> = self.problems.iter().cloned().map(Block::Note).collect();
        blocks.push(Block::Table(Table {
            title: "What was understood".to_owned(),
            caption: "Of the header and of the entries.".to_owned(),
            columns: ["what", "value"].map(str::to_owned).to_vec(),
            rows: self.rows().into_iter().map(|row| row.to_vec()).collect(),
            highlight: None,
        }));
        blocks.push(Block::Heading("Can be identified".to_owned()));
        blocks.extend(self.can.iter().cloned().map(Block::Text));
        let line = |name: &str, y: &[f64], style| Trace::Line {
            name: name.to_owned(),
            x: file.time.clone(),
            y: y.to_vec(),
            style,
        };
        blocks.push(Block::Figure(Figure {
            title: "The log over time".to_owned(),
            caption: "Position asked for and measured.".to_owned(),
            x_label: "time [s]".to_owned(),
            log_x: false,
            panels: vec![Panel {
                y_label: "position [rad]".to_owned(),
                traces: vec![
                    line("goal", &file.goal, LineStyle::Dashed),
                    line("measured", &file.position, LineStyle::Solid),
                ],
            }],
        }));
        Page {
            title: "What the servo's log holds".to_owned(),
            subtitle: format!("{}; frictionlab {}", self.path, env!("CARGO_PKG_VERSION")),
            blocks,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_is_told_with_its_command_and_what_is_odd_about_it() {
        let text = |motor: &str| {
            let entry = |k: u32| {
                let t = 0.01 * f64::from(k);
                format!("{{\"timestamp\": {t}, \"position\": {}, \"goal_position\": 0.5}}", 0.5 * t)
            };
            let entries: Vec<String> = (0..101).map(entry).collect();
            format!(
                "{{\"mass\": 0.5, \"length\": 0.1, \"kp\": 32, \"vin\": 12, {motor} \"entries\": [{}]}}",
                entries.join(", ")
            )
        };
        let looked = |motor: &str| {
            let file = tempfile::NamedTempFile::with_suffix(".json").unwrap();
            std::fs::write(file.path(), text(motor)).unwrap();
            servo(&recording::servo_log::read(file.path()).unwrap())
        };
        let seen = looked("\"motor\": \"sts3215\",");
        let shown = seen.terminal();
        for part in ["sts3215", "101, 1.000 s at 100 Hz", "0.5 kg at 0.1 m", "identify-servo", "32"]
        {
            assert!(shown.contains(part), "{part}: {shown}");
        }
        assert!(seen.problems.is_empty() && !shown.contains("--servo"), "{shown}");
        assert!(looked("").terminal().contains("--servo NAME"));
        assert!(looked("\"motor\": \"own\",").terminal().contains("--servo FILE.yaml"));
    }
}
