//! A scale that was given beside a name that says a unit.

use serde::Serialize;

use super::{Label, exact};
use crate::ChannelSource;
use crate::column::Channel;
use crate::sheet::{Found, Sheet};
use crate::units::{self, Quantity};

/// A scale that stands in place of the unit in a name.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Scaled {
    /// The column.
    pub name: Label,
    /// The scale.
    pub scale: f64,
    /// The unit as the name has it.
    pub unit: Label,
    /// Its factor to SI.
    pub factor: f64,
    /// The SI unit of what it measures.
    pub si: &'static str,
}

impl Scaled {
    /// A scale that was given for a column of a channel; none where its name says no unit, the SI
    /// unit, or one that the scale has in it.
    pub(crate) fn of(channel: Channel, name: &str, stem: &str, scale: f64) -> Option<Self> {
        let parts = units::parts(stem);
        let (text, unit) = parts.unit.and_then(|text| Some((text, units::unit_of(text)?)))?;
        // `x_min` is the least, and not minutes.
        let time = (unit.quantity == Quantity::Time) == (channel == Channel::Time);
        let said = (unit.factor - 1.0).abs() > 1e-12 && (scale / unit.factor - 1.0).abs() > 1e-3;
        let si = match unit.quantity {
            Quantity::Time => "s",
            Quantity::Length => "m",
            Quantity::Angle => "rad",
            Quantity::Speed => "m/s",
            Quantity::AngularSpeed => "rad/s",
            Quantity::Force => "N",
            Quantity::Torque => "N m",
            Quantity::Voltage => "V",
            Quantity::Current => "A",
            Quantity::Bare => return None,
        };
        let (name, text) = (Label::of(name), Label::of(text));
        (said && (time || parts.bracketed)).then_some(Self {
            name,
            scale,
            unit: text,
            factor: unit.factor,
            si,
        })
    }

    /// In words.
    pub(super) fn describe(self) -> String {
        let Self { name, scale, unit, factor, si } = self;
        format!(
            "`{name}` is multiplied by {scale} as you say; the {unit} of its name is not taken into account: if the scale is for values in {si}, give `{name}:{}`",
            exact(scale * factor)
        )
    }
}

/// What is to be said of a scale that was given for a column.
pub(crate) fn scale_of(sheet: &Sheet<'_>, channel: Channel, found: &Found) -> Option<Scaled> {
    let stem = sheet.stem_of(found)?;
    let ChannelSource { name, scale } = &found.source;
    found.scaled.then(|| Scaled::of(channel, name, stem, *scale)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tester gave the torque constant of a motor beside milliamperes.
    #[test]
    fn a_scale_beside_a_unit_is_told_and_one_beside_an_si_unit_is_not() {
        let of = |channel, name: &str, scale| Scaled::of(channel, name, name, scale);
        let said = of(Channel::Force, "current_mA", 0.061).unwrap().describe();
        for part in ["`current_mA` is multiplied by 0.061", "the mA of its name", "mA:0.000061`"] {
            assert!(said.contains(part), "{said}");
        }
        assert!(of(Channel::Position, "angle [deg]", 0.02).is_some());
        for (channel, name, scale) in [
            (Channel::Force, "current_A", 0.061),
            (Channel::Force, "control_V", 35.0),
            (Channel::Force, "tau", 2.0),
            (Channel::Position, "q [counts]", 0.001),
            (Channel::Position, "q_mm", 0.001),
            (Channel::Position, "x_min", 0.5),
        ] {
            assert_eq!(of(channel, name, scale), None, "{name}");
        }
    }
}
