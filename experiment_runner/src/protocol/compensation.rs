//! Compensation: which tasks the compensations are compared in.

use controller::ControlMode;
use serde::{Deserialize, Serialize};

use super::ProtocolFile;
use super::quantity::{Dimension, Quantity};
use super::tracking::{InverseUse, TrackingProtocol};
use super::{ProtocolError, count, within};
use crate::waveform::Waveform;

/// One task with its name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CompensationTask {
    /// Name in tables and files.
    pub name: String,
    /// What is driven.
    pub protocol: TrackingProtocol,
}

/// The tasks in which compensations are compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CompensationProtocol {
    /// The tasks, in the order they are driven.
    pub tasks: Vec<CompensationTask>,
}

impl CompensationProtocol {
    /// The same with `repetitions` of each task.
    #[must_use]
    pub fn repeated(mut self, repetitions: u32) -> Self {
        self.tasks.iter_mut().for_each(|task| task.protocol.repetitions = repetitions);
        self
    }

    /// Time that `arms` compensations take on a rig \[s\].
    #[must_use]
    pub fn rig_seconds(&self, arms: usize) -> f64 {
        self.tasks.iter().map(|task| task.protocol.rig_seconds(arms)).sum()
    }
}

impl ProtocolFile for CompensationProtocol {
    const NAME: &'static str = "compensation";
    const TEXT: &'static str = include_str!("../../protocols/compensation.yaml");
    type Sheet = Sheet;
}

/// The file's form.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sheet {
    #[serde(rename = "experiment")]
    _experiment: String,
    tasks: Vec<TaskSheet>,
    repetitions: u32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TaskSheet {
    name: String,
    regulate: ControlMode,
    reference: ReferenceSheet,
    duration: Quantity,
    #[serde(default)]
    inverse: InverseUse,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum ReferenceSheet {
    Sine { amplitude: Quantity, frequency: Quantity },
    Step { to: Quantity, at: Quantity },
    Constant(Quantity),
}

impl TryFrom<Sheet> for CompensationProtocol {
    type Error = ProtocolError;

    fn try_from(sheet: Sheet) -> Result<Self, ProtocolError> {
        let repetitions = count(sheet.repetitions, "repetitions", 1, 1000)?;
        let mut tasks: Vec<CompensationTask> = Vec::with_capacity(sheet.tasks.len());
        for (index, task) in sheet.tasks.into_iter().enumerate() {
            let key = |field: &str| format!("tasks[{index}].{field}");
            let plain = |c: char| c.is_ascii_alphanumeric() || " -_.".contains(c);
            if task.name.trim().is_empty() || task.name.len() > 60 || !task.name.chars().all(plain)
            {
                let expected = "a name of up to 60 letters, digits, blanks, -, _ and .";
                return Err(ProtocolError::new(key("name"), format!("`{}`", task.name), expected));
            }
            if tasks.iter().any(|other| other.name == task.name) {
                let expected = "different from the tasks before it";
                return Err(ProtocolError::new(key("name"), format!("`{}`", task.name), expected));
            }
            let duration = within(task.duration, &key("duration"), Dimension::Time, 0.1, 3600.0)?;
            let reference = reference(&task.reference, task.regulate, duration, &key)?;
            let protocol = TrackingProtocol {
                mode: task.regulate,
                reference,
                inverse: task.inverse,
                duration,
                repetitions,
            };
            tasks.push(CompensationTask { name: task.name, protocol });
        }
        if tasks.is_empty() {
            return Err(ProtocolError::new("tasks", "empty", "a list of one task or more"));
        }
        Ok(Self { tasks })
    }
}

fn reference(
    sheet: &ReferenceSheet,
    mode: ControlMode,
    duration: f64,
    key: &dyn Fn(&str) -> String,
) -> Result<Waveform, ProtocolError> {
    let (dimension, most) = match mode {
        ControlMode::Velocity => (Dimension::AngularVelocity, 50.0),
        ControlMode::Position => (Dimension::Angle, 1000.0),
    };
    let level = |quantity, field: &str| {
        within(quantity, &key(&format!("reference.{field}")), dimension, -most, most)
    };
    let step = |to, at| match mode {
        ControlMode::Velocity => Waveform::StepVelocity { velocity: to, at },
        ControlMode::Position => Waveform::StepPosition { position: to, at },
    };
    Ok(match *sheet {
        ReferenceSheet::Sine { amplitude, frequency } => {
            let amplitude = level(amplitude, "sine.amplitude")?;
            let field = key("reference.sine.frequency");
            let angular_frequency =
                within(frequency, &field, Dimension::AngularVelocity, 1e-3, 500.0)?;
            match mode {
                ControlMode::Velocity => Waveform::SineVelocity { amplitude, angular_frequency },
                ControlMode::Position => Waveform::SinePosition { amplitude, angular_frequency },
            }
        }
        ReferenceSheet::Step { to, at } => {
            let at = within(at, &key("reference.step.at"), Dimension::Time, 0.0, duration)?;
            step(level(to, "step.to")?, at)
        }
        ReferenceSheet::Constant(to) => step(level(to, "constant")?, 0.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_tasks_are_those_of_the_thesis_tables() {
        let shipped = CompensationProtocol::shipped().unwrap();
        let names: Vec<_> = shipped.tasks.iter().map(|task| task.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "velocity tracking",
                "velocity regulation",
                "position tracking",
                "position regulation"
            ]
        );
        assert_eq!(shipped.tasks[0].protocol, TrackingProtocol::velocity());
        assert_eq!(shipped.tasks[2].protocol, TrackingProtocol::position());
        assert_eq!(shipped.tasks[1].protocol.inverse, InverseUse::Gain);
        assert_eq!(
            shipped.tasks[1].protocol.reference,
            Waveform::StepVelocity { velocity: 1.0, at: 0.0 }
        );
    }

    #[test]
    fn every_mistake_gets_its_sentence() {
        for (from, to, said) in [
            (
                "amplitude: 0.30 rad/s",
                "amplitude: 0.30 rad",
                "`tasks[0].reference.sine.amplitude` must be an angular velocity from -50 to 50 rad/s, but is 0.3 rad",
            ),
            ("at: 1 s", "at: 61 s", "`tasks[3].reference.step.at` must be a time from 0 to 60 s"),
            ("constant: 1 rad/s", "constant: 99 rad/s", "`tasks[1].reference.constant`"),
            ("inverse: gain", "inverse: some", "some"),
            ("sine:", "sinus:", "sinus"),
            (
                "name: position tracking",
                "name: velocity tracking",
                "`tasks[2].name` must be different from the tasks before it",
            ),
            ("regulate: position", "regulate: happiness", "happiness"),
            ("duration: 58.7 s", "duration: 0 s", "`tasks[0].duration` must be a time"),
            (
                "repetitions: 5",
                "repetitions: 0",
                "`repetitions` must be a whole number from 1 to 1000",
            ),
        ] {
            let text = CompensationProtocol::TEXT;
            assert!(text.contains(from), "{from} is not in the shipped file");
            let message =
                CompensationProtocol::read(&text.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(message.contains(said), "{from} -> {to}: {message}");
        }
    }
}
