//! The real recordings of axes and joints, in SI units, with what their makers say of the scales.

use std::collections::HashMap;
use std::fmt::Write;
use std::fs;
use std::ops::Range;
use std::path::Path;

use anyhow::{Context, Result};

/// A table of one axis.
struct Driven {
    folder: &'static str,
    file: &'static str,
    kind: &'static str,
    /// Time, position, and what drives it.
    columns: [&'static str; 3],
    /// Force or torque per unit of the last.
    scale: f64,
}

const fn emps(file: &'static str) -> Driven {
    let columns = ["t_s", "position_m", "control_V"];
    Driven { folder: "emps", file, kind: "linear", columns, scale: 35.150_651_882_485_47 }
}

/// Its torque per volt is not known: what is found is in volts.
const fn qube(file: &'static str) -> Driven {
    let columns = ["t", "theta", "plant_input"];
    Driven { folder: "qube_servo", file, kind: "rotary", columns, scale: 1.0 }
}

const DRIVEN: [Driven; 4] =
    [emps("estimation"), emps("validation"), qube("episode_1"), qube("episode_2")];
/// Turns of each motor of the arm a turn of its joint.
const TX40_RATIOS: [f64; 6] = [32.0, 32.0, 45.0, -48.0, 45.0, 32.0];
/// Time between the rows of the arm, which has no column of it \[s\].
const TX40_STEP: f64 = 2e-4;
/// Blocks that are dealt out in turn.
const BLOCKS: usize = 16;

/// A recording of one axis: what drives it, and its motion.
pub struct Axis {
    pub name: String,
    /// `rotary` or `linear`.
    pub kind: &'static str,
    pub time: Vec<f64>,
    pub position: Vec<f64>,
    pub force: Vec<f64>,
}

/// How a recording is halved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Split {
    /// The first half of the time, and the second.
    Time,
    /// Every other one of its blocks.
    Blocks,
}

impl Split {
    pub const ALL: [Self; 2] = [Self::Time, Self::Blocks];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Time => "first and second half",
            Self::Blocks => "odd and even blocks",
        }
    }

    /// Rows of both halves.
    fn rows(self, count: usize) -> [Vec<Range<usize>>; 2] {
        let blocks = match self {
            Self::Time => 2,
            Self::Blocks => BLOCKS,
        };
        let block = |k: usize| k * count / blocks..(k + 1) * count / blocks;
        [0, 1].map(|first| (first..blocks).step_by(2).map(block).collect())
    }
}

impl Axis {
    /// Both halves as files: time, position, force. Where blocks are left out the times have a gap.
    pub fn halves(&self, split: Split) -> [String; 2] {
        split.rows(self.time.len()).map(|ranges| self.csv(&ranges))
    }

    fn csv(&self, ranges: &[Range<usize>]) -> String {
        let mut text = String::from("time,q,tau\n");
        for k in ranges.iter().cloned().flatten() {
            let _ = writeln!(text, "{},{},{}", self.time[k], self.position[k], self.force[k]);
        }
        text
    }
}

/// Every recording of an axis or joint in the folder.
///
/// # Errors
/// A file that is there and cannot be read.
pub fn axes(data: &Path) -> Result<Vec<Axis>> {
    let mut axes = Vec::new();
    for Driven { folder, file, kind, columns: names, scale } in DRIVEN {
        let path = data.join(folder).join(format!("{file}.csv"));
        if path.is_file() {
            let mut columns = columns(&path)?;
            let [time, position, driven] = names.map(|name| taken(&mut columns, &path, name));
            axes.push(Axis {
                name: format!("{folder} {file}"),
                kind,
                time: time?,
                position: position?,
                force: driven?.iter().map(|value| scale * value).collect(),
            });
        }
    }
    let [motors, torques] =
        ["motor_position_rad.csv", "motor_torque_Nm.csv"].map(|file| data.join("tx40").join(file));
    if motors.is_file() && torques.is_file() {
        let (mut angles, mut drives) = (columns(&motors)?, columns(&torques)?);
        for (joint, ratio) in (1..).zip(TX40_RATIOS) {
            let called = format!("Joint_{joint}");
            let angle = taken(&mut angles, &motors, &called)?;
            let torque = taken(&mut drives, &torques, &called)?;
            axes.push(Axis {
                name: format!("tx40 joint {joint}"),
                kind: "rotary",
                time: (0..angle.len()).map(|k| k as f64 * TX40_STEP).collect(),
                position: angle.iter().map(|angle| angle / ratio).collect(),
                force: torque.iter().map(|torque| torque * ratio).collect(),
            });
        }
    }
    Ok(axes)
}

fn taken(columns: &mut HashMap<String, Vec<f64>>, path: &Path, name: &str) -> Result<Vec<f64>> {
    columns.remove(name).with_context(|| format!("{}: no column {name}", path.display()))
}

/// Columns of a table of numbers, by name.
fn columns(path: &Path) -> Result<HashMap<String, Vec<f64>>> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').map(str::trim).collect();
    let mut columns = vec![Vec::new(); names.len()];
    for (line, number) in lines.zip(2..) {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            let value = cell.trim().parse();
            column.push(value.with_context(|| format!("{}, line {number}", path.display()))?);
        }
    }
    Ok(names.into_iter().map(str::to_owned).zip(columns).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_disjoint_and_whole() {
        for split in Split::ALL {
            for count in [33, 1000] {
                let [first, second] = split.rows(count);
                let mut all: Vec<usize> = first.into_iter().chain(second).flatten().collect();
                all.sort_unstable();
                assert_eq!(all, (0..count).collect::<Vec<_>>(), "{split:?}");
            }
        }
    }
}
