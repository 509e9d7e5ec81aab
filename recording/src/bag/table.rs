//! The cycles of a bag as one table.

use std::collections::BTreeMap;
use std::path::Path;

use msgs::RosMessage;
use msgs::friction_msgs::{ControllerState, FrictionEstimate, Reference, RigMeasurement};
use msgs::sensor_msgs::JointState;
use msgs::topics;

use super::{BagError, BagReader};
use crate::csv_table::CsvTable;

/// Names of the columns, with units. The first five are those that `frictionlab identify` reads.
const COLUMNS: [&str; 12] = [
    "t_s",
    "position_rad",
    "velocity_rad_s",
    "voltage_V",
    "torque_Nm",
    "potentiometer_rad",
    "reference_position_rad",
    "reference_velocity_rad_s",
    "reference_acceleration_rad_s2",
    "command_V",
    "friction_estimate_Nm",
    "deflection_rad",
];

/// A table as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Comma-separated values behind a line of column names.
    pub text: String,
    /// Lines without that one.
    pub rows: usize,
}

/// The messages of each control cycle side by side, one line a time stamp. Time is that since the
/// first \[s\]; `voltage_V` is the voltage that was on the motor in the period before, `torque_Nm`
/// the friction torque.
///
/// # Errors
/// [`BagError`] names what cannot be read, or that the bag has none of the topics of a cycle.
pub fn table(path: &Path) -> Result<Table, BagError> {
    let bag = BagReader::open(path)?;
    let mut rows: BTreeMap<u64, [Option<f64>; COLUMNS.len()]> = BTreeMap::new();
    let mut known = false;
    fn read<M: RosMessage, const N: usize>(
        bag: &BagReader,
        topic: &str,
        rows: &mut BTreeMap<u64, [Option<f64>; COLUMNS.len()]>,
        values: impl Fn(&M) -> [(usize, Option<f64>); N],
    ) -> Result<bool, BagError> {
        if !bag.topics().iter().any(|info| info.name == topic && info.type_name == M::type_name()) {
            return Ok(false);
        }
        for (stamp, message) in bag.messages::<M>(topic)? {
            let row = rows.entry(stamp).or_default();
            for (column, value) in values(&message) {
                row[column] = value.filter(|value| value.is_finite()).or(row[column]);
            }
        }
        Ok(true)
    }
    known |= read(&bag, topics::JOINT_STATES.name, &mut rows, |m: &JointState| {
        [
            (1, m.position.first().copied()),
            (2, m.velocity.first().copied()),
            (4, m.effort.first().copied()),
        ]
    })?;
    known |= read(&bag, topics::RIG_MEASUREMENT.name, &mut rows, |m: &RigMeasurement| {
        [
            (1, Some(m.encoder_position)),
            (2, Some(m.tachometer_velocity)),
            (3, Some(m.voltage_applied)),
            (4, Some(m.torque)),
            (5, Some(m.potentiometer_position)),
        ]
    })?;
    known |= read(&bag, topics::REFERENCE.name, &mut rows, |m: &Reference| {
        [(6, Some(m.position)), (7, Some(m.velocity)), (8, Some(m.acceleration))]
    })?;
    known |= read(&bag, topics::CONTROLLER_STATE.name, &mut rows, |m: &ControllerState| {
        [(9, Some(m.total))]
    })?;
    known |= read(&bag, topics::FRICTION_ESTIMATE.name, &mut rows, |m: &FrictionEstimate| {
        [(10, Some(m.torque)), (11, Some(m.deflection))]
    })?;
    if !known {
        return Err(BagError::NoTopic {
            path: path.into(),
            topic: topics::JOINT_STATES.name.into(),
            present: bag
                .topics()
                .iter()
                .map(|info| info.name.as_str())
                .collect::<Vec<_>>()
                .join(", "),
        });
    }
    let mut table = CsvTable::new(COLUMNS);
    let start = rows.keys().next().copied().unwrap_or(0);
    for (stamp, values) in &rows {
        let since = stamp - start;
        table.cell(format_args!("{}.{:09}", since / 1_000_000_000, since % 1_000_000_000));
        for value in &values[1..] {
            match value {
                Some(value) => table.cell(value),
                None => table.cell(""),
            }
        }
        table.end_row();
    }
    Ok(Table { text: table.text(), rows: rows.len() })
}
