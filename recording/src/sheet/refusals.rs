//! What is refused of a table, in sentences with its columns.

use std::path::Path;

use super::{Found, Sheet};
use crate::RecordingError;
use crate::column::Channel;

impl Sheet<'_> {
    /// Refuses a motion along a line beside a torque, and a turn beside a force, where both say
    /// their unit: what comes of that has the unit of neither.
    pub(in super::super) fn check_axis(
        &self,
        motion: &Found,
        force: &Found,
    ) -> Result<(), RecordingError> {
        let said = |found: &Found| found.axis.filter(|_| found.written.is_some() && !found.scaled);
        let (Some(one), Some(other)) = (said(motion), said(force)) else { return Ok(()) };
        if one == other {
            return Ok(());
        }
        Err(RecordingError::TwoAxes {
            path: self.path.into(),
            motion: motion.source.name.clone(),
            force: force.source.name.clone(),
            unit: one.force_unit(),
        })
    }

    pub(super) fn no_column(&self, channel: Channel, name: &str) -> RecordingError {
        if self.dialect.headerless && name.parse::<usize>().is_err() {
            return self.no_header();
        }
        RecordingError::NoColumn {
            path: self.path.into(),
            name: name.to_owned(),
            present: self.names.join(", "),
            channel,
        }
    }

    pub(in super::super) fn no_header(&self) -> RecordingError {
        RecordingError::NoHeader {
            path: self.path.into(),
            example: self.example,
            columns: self.names.len(),
        }
    }

    pub(in super::super) fn unrecognised(&self, channel: Channel) -> RecordingError {
        if self.dialect.headerless {
            return self.no_header();
        }
        let mut present = self.present();
        let candidates: Vec<&str> =
            self.candidates(channel).iter().map(|&index| self.names[index].as_str()).collect();
        if candidates.len() > 1 {
            present = format!("{present} (it may be {})", candidates.join(" or "));
        }
        let current = self.optional(Channel::Current, None).ok().flatten();
        if let Some(current) = current.filter(|_| channel == Channel::Force) {
            let name = current.source.name;
            present = format!(
                "{present} (the current {name} becomes a torque by the motor's constant KT: \
                 --force-column '{name}:KT')"
            );
        }
        RecordingError::Unrecognised { path: self.path.into(), channel, present }
    }

    /// The names of the columns, and what of the file is none.
    fn present(&self) -> String {
        /// What is told of it at most.
        const TOLD: usize = 3;
        let names = self.names.join(", ");
        match self.left_out() {
            [] => names,
            left_out => {
                let told: Vec<&str> = left_out.iter().take(TOLD).map(String::as_str).collect();
                format!("{names} ({})", told.join("; "))
            }
        }
    }
}

/// A line that is no text.
pub(super) fn damaged(path: &Path, error: &csv::Error) -> RecordingError {
    let line = error.position().map_or(1, csv::Position::line);
    let detail = match error.kind() {
        csv::ErrorKind::Utf8 { .. } => "it is not UTF-8 text".to_owned(),
        _ => error.to_string(),
    };
    RecordingError::Line { path: path.into(), line, detail }
}
