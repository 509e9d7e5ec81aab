//! What was read of a table, and what is to be said of it.

use super::{Both, Remarks, Taken, Used, Watched, scale_of};
use crate::AxisKind;
use crate::column::Channel;
use crate::sheet::{Found, Sheet};

/// A column that was read.
pub(crate) type Column<'a> = (&'a Found, &'a [f64]);

/// What was read of a table, to be remarked on.
pub(crate) struct Read<'a> {
    pub sheet: &'a Sheet<'a>,
    pub time: &'a [f64],
    /// Kind of axis that the names tell.
    pub axis: Option<AxisKind>,
    /// The position, with its turns counted.
    pub position: Option<Column<'a>>,
    /// The velocity, also where it is not used.
    pub velocity: Option<Column<'a>>,
    /// Which of them is used where both are there.
    pub used: Used,
    /// A velocity that is not used is looked at too.
    pub all: bool,
    /// What drives the axis or brakes it, and as what.
    pub force: Option<(Channel, Column<'a>)>,
}

fn watched<'a>((found, values): Column<'a>, unit: &'static str) -> Watched<'a> {
    Watched { name: &found.source.name, scale: found.source.scale, unit, values }
}

impl Read<'_> {
    /// `found` with what else is to be said.
    pub(crate) fn remarks(&self, mut found: Remarks) -> Remarks {
        let of = |of: fn(AxisKind) -> &'static str| self.axis.map_or("", of);
        if let Some((channel, column)) = self.force {
            let unit = match channel {
                Channel::Force | Channel::Friction => of(AxisKind::force_unit),
                channel => channel.unit(),
            };
            found = found.of_force(self.time, watched(column, unit));
            // A voltage at the end of its range is the one that was there.
            let voltage = matches!(channel, Channel::Voltage | Channel::DrivingVoltage);
            found.force.cut = found.force.cut.filter(|_| !voltage);
            found.force.scaled = scale_of(self.sheet, channel, column.0);
            found.force.taken = Taken::of(channel, column.0);
        }
        let position = self.position.map(|column| watched(column, of(AxisKind::position_unit)));
        let velocity = self.velocity.map(|column| watched(column, of(AxisKind::velocity_unit)));
        if let (Some(position), Some((column, _))) = (position, self.position) {
            found = found.of_position(self.time, position);
            found.position.scaled = scale_of(self.sheet, Channel::Position, column);
            found.position.taken = Taken::of(Channel::Position, column);
        }
        let used = position.is_none() || self.used != Used::Position || self.all;
        if let (Some(velocity), Some((column, _)), true) = (velocity, self.velocity, used) {
            let force = self.force.map(|(_, (_, values))| values);
            found = found.of_velocity(self.time, velocity, force);
            found.velocity.scaled = scale_of(self.sheet, Channel::Velocity, column);
            found.velocity.taken = Taken::of(Channel::Velocity, column);
        }
        if let (Some(position), Some(velocity)) = (position, velocity) {
            found = found.compared(self.time, Both { position, velocity, used: self.used });
        }
        found
    }
}
