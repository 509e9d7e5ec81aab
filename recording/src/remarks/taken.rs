//! A column that was taken for a channel though its name does not say so plainly.

use serde::Serialize;

use super::Label;
use crate::column::Channel;
use crate::sheet::{Found, Guess};

/// A column that was taken for a channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Taken {
    /// The column.
    pub name: Label,
    /// What it was taken for, in words.
    pub channel: &'static str,
    /// The option that names another.
    pub option: &'static str,
    /// Its unit alone told so; else its name says that it was commanded.
    pub by_unit: bool,
}

impl Taken {
    /// What is to be said of a column; nothing of one that was named, or says itself what it is.
    pub(crate) fn of(channel: Channel, found: &Found) -> Option<Self> {
        let by_unit = found.guess? == Guess::ByUnit;
        let option = match channel {
            Channel::Time => "--time",
            Channel::Position => "--position",
            Channel::Velocity => "--velocity",
            _ => "--force-column",
        };
        let name = Label::of(&found.source.name);
        Some(Self { name, channel: channel.describe(), option, by_unit })
    }

    /// In words.
    pub(super) fn describe(self) -> String {
        let Self { name, channel, option, by_unit } = self;
        if by_unit {
            format!(
                "`{name}` is taken for the {channel}: it is the only column in such a unit, and its name does not say so. If it is another, name the right one with {option}"
            )
        } else {
            format!(
                "`{name}` is taken for the {channel}, though by its name it was commanded and not measured. If there is a measured one, name it with {option}"
            )
        }
    }
}
