//! Tables of steady points.

use std::path::Path;

use friction_ident::SteadyPoint;

use super::{FrictionRecording, Preparation};
use crate::column::Channel;
use crate::sheet::{Cells, Found, Loaded, Missing, Sheet};
use crate::table::Columns;
use crate::{ChannelSource, Irregularities, RecordingError, Remarks};

const EXAMPLE: &str = "velocity_rad_s,torque_Nm";

/// Names of the standard deviation of a point's friction.
const DEVIATIONS: [&str; 4] =
    ["torque_deviation_Nm", "force_deviation_N", "torque_deviation", "deviation"];

pub(super) fn is_points(path: &Path, loaded: &Loaded<'_>, columns: &Columns) -> bool {
    let Ok(sheet) = Sheet::open(path, loaded, &columns.layout, EXAMPLE) else { return false };
    columns.layout.period.is_none()
        && !sheet.has(Channel::Time, columns.time.as_ref())
        && sheet.has(Channel::Velocity, columns.velocity.as_ref())
        && sheet.has(Channel::Force, columns.force.as_ref())
}

/// Steady points: nothing is accelerated, and where there is no sensor friction is what drives.
pub(super) fn points(
    path: &Path,
    loaded: &Loaded<'_>,
    columns: &Columns,
    how: &Preparation,
) -> Result<FrictionRecording, RecordingError> {
    let (drive, source) = (how.constants(), how.torque);
    drive.check(source).map_err(|source| RecordingError::Unusable { path: path.into(), source })?;
    let mut drive_errors = how.drive_errors();
    let mut sheet = Sheet::open(path, loaded, &columns.layout, EXAMPLE)?;
    let velocity = sheet.require(Channel::Velocity, columns.velocity.as_ref())?;
    let force = sheet.require(columns.measured.channel(), columns.force.as_ref())?;
    sheet.check_axis(&velocity, &force)?;
    let deviation = sheet
        .names
        .iter()
        .position(|name| DEVIATIONS.iter().any(|known| known.eq_ignore_ascii_case(name)))
        .map(|index| Found {
            index,
            source: ChannelSource { name: sheet.names[index].clone(), scale: force.source.scale },
            axis: None,
            assumed: false,
            written: None,
            scaled: false,
            clock: false,
            rest: None,
            guess: None,
        });
    let wanted: Vec<&Found> = [&velocity, &force].into_iter().chain(&deviation).collect();
    let Cells { values, blank, .. } = sheet.columns(&wanted, Missing::LeftOut)?;
    let mut points = Vec::new();
    for (index, (&velocity, &channel)) in values[0].iter().zip(&values[1]).enumerate() {
        for error in &mut drive_errors {
            error.points.push(drive.friction_error(source, error.constant, channel, velocity, 0.0));
        }
        points.push(SteadyPoint {
            velocity,
            torque: drive.friction(source, channel, velocity, 0.0),
            deviation: values.get(2).map(|deviations| deviations[index]),
            place: None,
        });
    }
    let axis = velocity.axis.or(force.axis);
    let mut remarks = Remarks::default();
    remarks.velocity.scaled = crate::remarks::scale_of(&sheet, Channel::Velocity, &velocity);
    remarks.force.scaled = crate::remarks::scale_of(&sheet, columns.measured.channel(), &force);
    Ok(FrictionRecording {
        path: path.into(),
        samples: points.len(),
        points,
        stretches: Vec::new(),
        axis,
        outliers: Vec::new(),
        drive_errors,
        irregularities: Irregularities::default()
            .written_as(blank, sheet.dialect)
            .remarking(remarks),
    })
}
