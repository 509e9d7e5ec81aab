//! Which column holds a channel: as it was named, or recognised by its name.

use super::named::Named;
use super::{Found, Sheet};
use crate::column::{Channel, axis_in};
use crate::units;
use crate::{ChannelSource, Column, RecordingError};

impl Sheet<'_> {
    /// The column of a channel, which must be there.
    pub(in super::super) fn require(
        &self,
        channel: Channel,
        named: Option<&Column>,
    ) -> Result<Found, RecordingError> {
        let found = self.optional(channel, named)?;
        found
            .map_or_else(|| self.guessed(channel), |found| Ok(Some(found)))?
            .ok_or_else(|| self.unrecognised(channel))
    }

    /// The column of a channel; none only where it was not named and is not recognised.
    pub(in super::super) fn optional(
        &self,
        channel: Channel,
        named: Option<&Column>,
    ) -> Result<Option<Found>, RecordingError> {
        match named {
            Some(column) => self.find(channel, &column.name, column.scale).map(Some),
            None => match self.recognised(channel)?.or_else(|| self.first_part(channel)) {
                Some(index) => self.found(channel, index, None).map(Some),
                None => Ok(None),
            },
        }
    }

    /// Whether a channel is named or recognised, by a usual name or by the words in one.
    pub(in super::super) fn has(&self, channel: Channel, named: Option<&Column>) -> bool {
        named.is_some() || self.knows(channel) || self.says(channel)
    }

    /// Whether a channel has one of its usual names.
    pub(super) fn knows(&self, channel: Channel) -> bool {
        !matches!(self.recognised(channel), Ok(None)) || self.first_part(channel).is_some()
    }

    /// The joints that columns stand for, in their order.
    pub(in super::super) fn joints(&self) -> Vec<String> {
        let mut labels: Vec<String> = Vec::new();
        for label in self.columns.iter().filter_map(|column| column.label.as_ref()) {
            if !labels.contains(label) {
                labels.push(label.clone());
            }
        }
        labels
    }

    /// The joint that a column belongs to.
    pub(in super::super) fn joint_of(&self, found: &Found) -> Option<&str> {
        self.columns.get(found.index)?.label.as_deref()
    }

    /// The columns of a channel of the joints other than `chosen`, with their names.
    pub(in super::super) fn others(&self, channel: Channel, chosen: &str) -> Vec<(String, Found)> {
        let others = self.joints().into_iter().filter(|label| label != chosen);
        let of = |label: String| {
            let places = self.places(&|column| column.label.as_ref() == Some(&label));
            let stems: Vec<String> =
                places.iter().map(|place| self.columns[*place].stem.clone()).collect();
            let name = channel.recognise(&stems)?;
            let place = stems.iter().position(|stem| stem == name)?;
            let found = self.found(channel, places[place], None).ok()?;
            Some((label, found))
        };
        others.filter_map(of).collect()
    }

    /// The column that is recognised, of the joint that was chosen or of the only one.
    fn recognised(&self, channel: Channel) -> Result<Option<usize>, RecordingError> {
        if self.dialect.headerless {
            return Ok(None);
        }
        let joints = self.joints();
        let joint = self.layout.joint.as_ref().or(joints.first().filter(|_| joints.len() == 1));
        let of =
            |wanted: &dyn Fn(Option<&String>) -> bool| -> Result<Option<usize>, RecordingError> {
                let (indices, stems): (Vec<usize>, Vec<String>) = self
                    .columns
                    .iter()
                    .enumerate()
                    .filter(|(_, column)| wanted(column.label.as_ref()))
                    .map(|(index, column)| (index, column.stem.clone()))
                    .unzip();
                let Some(name) = channel.recognise(&stems) else { return Ok(None) };
                let same = || indices.iter().zip(&stems).filter(|(_, stem)| *stem == name);
                let count = same().count();
                if count > 1 {
                    return Err(self.ambiguous(name, &same().map(|(k, _)| *k).collect::<Vec<_>>()));
                }
                Ok(same().map(|(index, _)| *index).next())
            };
        // A chosen joint's own column before one of all; where none was chosen the other way round.
        let of_joint = |label: Option<&String>| label.is_some() && label == joint;
        let chosen = if self.layout.joint.is_some() { of(&of_joint)? } else { None };
        if let Some(index) = chosen {
            return Ok(Some(index));
        }
        if let Some(index) = of(&|label| label.is_none())? {
            return Ok(Some(index));
        }
        if let Some(index) = of(&of_joint)? {
            return Ok(Some(index));
        }
        let one_of_several = |label: &str| {
            of(&|other| other.is_some_and(|other| other == label))
                .is_ok_and(|found| found.is_some())
        };
        if joint.is_none() && joints.iter().any(|label| one_of_several(label)) {
            let (path, present) = (self.path.into(), joints.join(", "));
            return Err(RecordingError::SeveralJoints { path, present });
        }
        Ok(None)
    }

    /// The column of that name, or of that number where no column is called so.
    pub(in super::super) fn find(
        &self,
        channel: Channel,
        name: &str,
        scale: Option<f64>,
    ) -> Result<Found, RecordingError> {
        let joint = self.layout.joint.as_deref();
        let full = |column: &Named| column.full() == name || column.raw == name;
        let of_joint = |column: &Named| {
            column.bare() == name && column.label.is_some() && column.label.as_deref() == joint
        };
        let mut called: Vec<usize> = self.places(&of_joint);
        if called.is_empty() {
            called = self.places(&full);
        }
        if called.len() > 1 {
            return Err(self.ambiguous(name, &called));
        }
        let by_number = || {
            let number: usize = name.parse().ok()?;
            (1..=self.names.len()).contains(&number).then(|| number - 1)
        };
        let index = called.first().copied().or_else(by_number);
        let Some(index) = index else { return Err(self.no_column(channel, name)) };
        self.found(channel, index, scale)
    }

    /// The error of several columns with one name. They are told apart by what the file calls them,
    /// else by their numbers.
    fn ambiguous(&self, name: &str, places: &[usize]) -> RecordingError {
        let full: Vec<&str> = places.iter().map(|&k| self.columns[k].raw.as_str()).collect();
        let apart = full.iter().enumerate().all(|(k, one)| !full[..k].contains(one));
        let present = if apart {
            full.join(", ")
        } else {
            let numbers: Vec<String> = places.iter().map(|k| (k + 1).to_string()).collect();
            format!("number {}, counted from 1", numbers.join(" and "))
        };
        RecordingError::Ambiguous {
            path: self.path.into(),
            name: name.to_owned(),
            count: places.len(),
            present,
        }
    }

    fn places(&self, is: &dyn Fn(&Named) -> bool) -> Vec<usize> {
        self.columns.iter().enumerate().filter(|(_, column)| is(column)).map(|(k, _)| k).collect()
    }

    /// What a column holds.
    pub(super) fn found(
        &self,
        channel: Channel,
        index: usize,
        scale: Option<f64>,
    ) -> Result<Found, RecordingError> {
        if let (Channel::Time, None, Some(rest)) = (channel, scale, self.other_part(index)) {
            return Ok(self.in_two_columns(index, rest));
        }
        let (called, stem) = (self.names[index].clone(), &self.columns[index].stem);
        let unit = match channel.unit_in(stem) {
            Ok(unit) => unit,
            // Whoever gives a scale knows the unit.
            Err(_) if scale.is_some() => None,
            Err(source) => {
                return Err(RecordingError::Unit {
                    path: self.path.into(),
                    column: called,
                    source,
                });
            }
        };
        let axis = unit.and_then(|unit| unit.quantity.axis()).or_else(|| axis_in(stem));
        let (assumed, scaled) = (scale.is_none() && unit.is_none(), scale.is_some());
        let scale = scale.or(unit.map(|unit| unit.factor)).unwrap_or(1.0);
        let written = unit.and(units::parts(stem).unit).map(str::to_owned);
        let (source, clock) = (ChannelSource { name: called, scale }, channel == Channel::Time);
        let (rest, guess) = (None, None);
        Ok(Found { index, source, axis, assumed, written, scaled, clock, rest, guess })
    }

    /// The name of a column without the joint, with its unit.
    pub(in super::super) fn stem_of(&self, found: &Found) -> Option<&str> {
        self.columns.get(found.index).map(|column| column.stem.as_str())
    }

    /// A column as it is written.
    pub(in super::super) fn raw(&self, index: usize) -> Found {
        let source = ChannelSource { name: self.names[index].clone(), scale: 1.0 };
        let stem = self.columns[index].stem.clone();
        let clock = Channel::Time.recognise(&[stem]).is_some();
        let (axis, written, rest, guess) = (None, None, None, None);
        Found { index, source, axis, assumed: true, written, scaled: false, clock, rest, guess }
    }
}
