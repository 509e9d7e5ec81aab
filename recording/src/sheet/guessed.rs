//! Which column holds a channel, where none has one of its usual names: by the words in the names,
//! and as a last resort by a unit that one column alone has.

use super::words::{Nearness, Words};
use super::{Found, Guess, Sheet};
use crate::RecordingError;
use crate::column::Channel;
use crate::units;

impl Sheet<'_> {
    /// The column that the words in its name, or else its unit, say to be the channel; none where
    /// none is.
    ///
    /// # Errors
    /// [`RecordingError::Unrecognised`] with those that may be it, where several may.
    pub(in super::super) fn guessed(
        &self,
        channel: Channel,
    ) -> Result<Option<Found>, RecordingError> {
        match self.candidates(channel)[..] {
            [] => Ok(None),
            [index] => {
                let found = self.found(channel, index, None)?;
                Ok(Some(Found { guess: self.guess(channel, index), ..found }))
            }
            _ => Err(self.unrecognised(channel)),
        }
    }

    /// The position and the velocity, where neither has a usual name.
    ///
    /// # Errors
    /// As of [`Sheet::guessed`].
    pub(in super::super) fn or_guessed(
        &self,
        position: Option<Found>,
        velocity: Option<Found>,
    ) -> Result<(Option<Found>, Option<Found>), RecordingError> {
        if position.is_some() || velocity.is_some() {
            return Ok((position, velocity));
        }
        Ok((self.guessed(Channel::Position)?, self.guessed(Channel::Velocity)?))
    }

    /// The columns that may be the channel; one where it is certain.
    pub(super) fn candidates(&self, channel: Channel) -> Vec<usize> {
        let by_words = self.by_words(channel);
        let in_unit = |stem: &str, _: &Words| in_unit(channel, stem);
        match self.guessable(channel) && by_words.is_empty() {
            true => self.nearest(channel, &in_unit),
            false => by_words,
        }
    }

    /// Why a column was taken that has none of the usual names of the channel.
    fn guess(&self, channel: Channel, index: usize) -> Option<Guess> {
        let nearness = Words::of(&self.columns.get(index)?.stem).nearness();
        if !self.says(channel) {
            Some(Guess::ByUnit)
        } else {
            (nearness > Nearness::Plain).then_some(Guess::Commanded)
        }
    }

    /// Whether there is a column of which the words say that it is the channel.
    pub(super) fn says(&self, channel: Channel) -> bool {
        !self.by_words(channel).is_empty()
    }

    fn guessable(&self, channel: Channel) -> bool {
        let known = matches!(
            channel,
            Channel::Time | Channel::Position | Channel::Velocity | Channel::Force
        );
        // Which joint's a column is, only the usual names tell.
        let alone = channel == Channel::Time || self.joints().is_empty();
        known && alone && !self.dialect.headerless
    }

    fn by_words(&self, channel: Channel) -> Vec<usize> {
        let says = |stem: &str, words: &Words| {
            channel.unit_in(stem).is_ok_and(|unit| words.say(channel, unit.is_some()))
        };
        if self.guessable(channel) { self.nearest(channel, &says) } else { Vec::new() }
    }

    /// The columns for which `is` holds, of those the ones that are nearest to what happened.
    fn nearest(&self, channel: Channel, is: &dyn Fn(&str, &Words) -> bool) -> Vec<usize> {
        let of = |(index, stem): (usize, &str)| {
            let words = Words::of(stem);
            let nearness = words.nearness();
            // What was wanted of a motion is not the motion; a torque that was commanded drives.
            let happened = channel == Channel::Force || nearness <= Nearness::Plain;
            (happened && !words.is_other() && is(stem, &words)).then_some((index, nearness))
        };
        let stems = self.columns.iter().map(|column| column.stem.as_str()).enumerate();
        let found: Vec<(usize, Nearness)> = stems.filter_map(of).collect();
        let Some(nearest) = found.iter().map(|(_, nearness)| *nearness).min() else {
            return Vec::new();
        };
        found.into_iter().filter(|(_, own)| *own == nearest).map(|(index, _)| index).collect()
    }
}

/// Whether a name has a unit of the channel. A letter behind a name may be another thing.
fn in_unit(channel: Channel, stem: &str) -> bool {
    let parts = units::parts(stem);
    let sure = parts.bracketed || parts.unit.is_some_and(|unit| unit.chars().count() > 1);
    sure && matches!(channel.unit_in(stem), Ok(Some(_)))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::layout::Layout;
    use crate::sheet::Loaded;

    fn guessed(header: &str, channel: Channel) -> Result<Option<String>, String> {
        let text = format!("{header}\n1,2,3,4\n");
        let loaded = Loaded::from(text.as_bytes());
        let sheet = Sheet::open(Path::new("x.csv"), &loaded, &Layout::default(), "t_s").unwrap();
        let found = sheet.guessed(channel).map_err(|error| error.to_string())?;
        Ok(found.map(|found| found.source.name))
    }

    /// Names that a tester's tables have, which were not recognised.
    #[test]
    fn names_are_understood_by_their_words() {
        for (channel, names) in [
            (
                Channel::Force,
                &[
                    "tq[mNm]",
                    "F (N)",
                    "F_N",
                    "cmd_torque_Nm",
                    "tau_cmd_Nm",
                    "Motor torque (Nm)",
                    "Drehmoment",
                    "Kraft",
                    "Moment",
                    "Couple (Nm)",
                    "Fuerza",
                    "motorTorqueActual",
                    "M [Nm]",
                ][..],
            ),
            (
                Channel::Position,
                &[
                    "Joint angle (deg)",
                    "joint_pos_deg",
                    "Position Actual [rad]",
                    "Actual position (°)",
                    "θ [rad]",
                    "Winkel",
                    "Ángulo",
                    "s [mm]",
                ],
            ),
            (Channel::Velocity, &["Geschwindigkeit", "Vitesse", "n [rpm]", "Drehzahl (U/min)"]),
            (Channel::Time, &["Zeit (s)", "Zeit", "Temps (s)", "Elapsed time (ms)"]),
        ] {
            for name in names {
                let header = format!("{name},a,b,c");
                assert_eq!(guessed(&header, channel), Ok(Some((*name).to_owned())), "{name}");
            }
        }
    }

    #[test]
    fn measured_comes_before_commanded_and_a_unit_that_one_column_has_comes_last() {
        let force = |header: &str| guessed(header, Channel::Force);
        let is = |name: &str| Ok(Some(name.to_owned()));
        assert_eq!(force("tau_ref_Nm,tau_cmd_Nm,tau_meas_Nm,b"), is("tau_meas_Nm"));
        assert_eq!(force("tau_ref_Nm,tau_cmd_Nm,a,b"), is("tau_cmd_Nm"));
        assert_eq!(force("cell [N],a,b,c"), is("cell [N]"));
        assert_eq!(force("torque_limit_Nm,load_Nm,a,b"), Ok(None));
        let motion = |header: &str| guessed(header, Channel::Position);
        assert_eq!(motion("target angle (deg),actual angle (deg),b,c"), is("actual angle (deg)"));
        assert_eq!(motion("target angle (deg),position_error_deg,b,c"), Ok(None));
        assert_eq!(motion("table_mm,a,b,c"), is("table_mm"));
        assert_eq!(motion("lid_m,a,b,c"), Ok(None));
        let several = motion("motor pos (deg),joint pos (deg),b,c").unwrap_err();
        assert!(several.contains("it may be motor pos (deg) or joint pos (deg)"), "{several}");
        assert!(several.contains("converted"), "{several}");
        assert!(force("one [N],other [N],b,c").unwrap_err().contains("one [N] or other [N]"));
    }
}
