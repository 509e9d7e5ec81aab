//! The options that name the columns of a table, and what a table without a time, with several
//! joints or in several files needs besides.

#![expect(
    rustdoc::broken_intra_doc_links,
    reason = "options are read in a terminal, where units are not escaped"
)]

use std::path::PathBuf;

use crate::Column;
use crate::layout::Layout;
use crate::table::{Columns, Measured};
use crate::timing::period;

/// The options that name the columns of a table.
#[derive(Debug, Clone, Default, PartialEq, clap::Args)]
pub struct ColumnArgs {
    /// Column of the time [s], by name or by number.
    #[arg(
        long,
        alias = "time-column",
        value_name = "NAME[:SCALE]",
        help_heading = "Columns of a table"
    )]
    pub time: Option<Column>,

    /// Column of the position [m or rad].
    #[arg(
        long,
        alias = "position-column",
        value_name = "NAME[:SCALE]",
        help_heading = "Columns of a table"
    )]
    pub position: Option<Column>,

    /// Column of the velocity [m/s or rad/s], to be used in place of the position.
    #[arg(
        long,
        alias = "velocity-column",
        value_name = "NAME[:SCALE]",
        help_heading = "Columns of a table"
    )]
    pub velocity: Option<Column>,

    /// Column of the force [N] or torque [N m]; SCALE turns its values into that unit.
    #[arg(
        id = "force_column",
        long = "force-column",
        value_name = "NAME[:SCALE]",
        help_heading = "Columns of a table"
    )]
    pub force: Option<Column>,

    /// What is said of the table besides.
    #[command(flatten)]
    pub layout: LayoutArgs,
}

/// The options of a table without a time, or in several files.
#[derive(Debug, Clone, Default, PartialEq, clap::Args)]
pub struct LayoutArgs {
    /// Time from row to row [s], for a table without a column of the time.
    #[arg(
        long,
        value_name = "SECONDS",
        value_parser = period,
        allow_negative_numbers = true,
        conflicts_with = "time",
        help_heading = "Columns of a table"
    )]
    pub period: Option<f64>,

    /// Another table whose columns stand beside those of FILE, row by row; may be repeated. A
    /// folder of tables is read so without it.
    #[arg(long, value_name = "TABLE", help_heading = "Columns of a table")]
    pub beside: Vec<PathBuf>,
}

impl LayoutArgs {
    /// The layout, for one joint.
    #[must_use]
    pub fn layout(&self, joint: Option<&str>) -> Layout {
        let Self { period, beside } = self;
        Layout { joint: joint.map(str::to_owned), period: *period, beside: beside.clone() }
    }

    /// The options that were given.
    #[must_use]
    pub fn given(&self) -> Vec<&'static str> {
        let period = self.period.map(|_| "--period");
        let beside = (!self.beside.is_empty()).then_some("--beside");
        period.into_iter().chain(beside).collect()
    }
}

impl ColumnArgs {
    /// The columns, for one joint of several.
    #[must_use]
    pub fn columns(&self, measured: Measured, joint: Option<&str>) -> Columns {
        Columns {
            time: self.time.clone(),
            position: self.position.clone(),
            velocity: self.velocity.clone(),
            force: self.force.clone(),
            measured,
            layout: self.layout.layout(joint),
        }
    }

    /// The options that were given.
    #[must_use]
    pub fn given(&self) -> Vec<&'static str> {
        [
            ("--time", &self.time),
            ("--position", &self.position),
            ("--velocity", &self.velocity),
            ("--force-column", &self.force),
        ]
        .into_iter()
        .filter_map(|(option, column)| column.as_ref().map(|_| option))
        .chain(self.layout.given())
        .collect()
    }
}
