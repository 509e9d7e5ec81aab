//! Tables of steady points.

use std::path::Path;

use csv::StringRecord;
use friction_ident::SteadyPoint;

use super::{FrictionRecording, Preparation};
use crate::column::{Channel, axis_of};
use crate::table::{self, Columns, Header, damaged};
use crate::{ChannelSource, Irregularities, RecordingError};

const EXAMPLE: &str = "velocity_rad_s,torque_Nm";

/// Names of the standard deviation of a point's friction.
const DEVIATIONS: [&str; 4] =
    ["torque_deviation_Nm", "force_deviation_N", "torque_deviation", "deviation"];

pub(super) fn is_points(path: &Path, bytes: &[u8], columns: &Columns) -> bool {
    let Ok((_, names)) = table::open(path, bytes, EXAMPLE) else { return false };
    let has = |channel: Channel, named: bool| named || channel.recognise(&names).is_some();
    !has(Channel::Time, columns.time.is_some())
        && has(Channel::Velocity, columns.velocity.is_some())
        && has(Channel::Force, columns.force.is_some())
}

/// Steady points: nothing is accelerated, and where there is no sensor friction is what drives.
pub(super) fn points(
    path: &Path,
    bytes: &[u8],
    columns: &Columns,
    how: &Preparation,
) -> Result<FrictionRecording, RecordingError> {
    let (drive, source) = (how.constants(), how.torque);
    drive.check(source).map_err(|source| RecordingError::Unusable { path: path.into(), source })?;
    let mut drive_errors = how.drive_errors();
    let (mut reader, names) = table::open(path, bytes, EXAMPLE)?;
    let header = Header { path, names: &names };
    let velocity = header.require(Channel::Velocity, columns.velocity.as_ref())?;
    let force = header.require(Channel::Force, columns.force.as_ref())?;
    let deviation = names
        .iter()
        .position(|name| DEVIATIONS.iter().any(|known| known.eq_ignore_ascii_case(name)))
        .map(|index| table::Found {
            index,
            source: ChannelSource { name: names[index].clone(), scale: force.source.scale },
        });
    let mut points = Vec::new();
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| damaged(path, &error))? {
        let line = record.position().map_or(0, csv::Position::line);
        let number = |found| header.number(&record, line, found);
        let (velocity, channel) = (number(&velocity)?, number(&force)?);
        for error in &mut drive_errors {
            error.points.push(drive.friction_error(source, error.constant, channel, velocity, 0.0));
        }
        points.push(SteadyPoint {
            velocity,
            torque: drive.friction(source, channel, velocity, 0.0),
            deviation: deviation.as_ref().map(number).transpose()?,
        });
    }
    if points.is_empty() {
        return Err(RecordingError::HeaderOnly { path: path.into() });
    }
    let axis = axis_of(&velocity.source.name).or_else(|| axis_of(&force.source.name));
    Ok(FrictionRecording {
        path: path.into(),
        samples: points.len(),
        points,
        stretches: Vec::new(),
        axis,
        outliers: Vec::new(),
        drive_errors,
        irregularities: Irregularities::default(),
    })
}
