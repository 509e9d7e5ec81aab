//! Several recordings of one axis as one: their stretches, one behind the other.

use std::path::PathBuf;

use crate::beside::Beside;
use crate::{Recording, RecordingError};

/// Time steps that differ by less than this share are alike.
const ALIKE: f64 = 1e-3;

/// Joins recordings of one axis. A velocity, or a position, that not all of them have is left out
/// of all; the times of each go on where those before it end.
///
/// # Errors
/// [`RecordingError::NotJoined`] where they differ in rate, in kind or direction of the axis, in
/// what the force is, or have neither position nor velocity in common.
pub fn joined(recordings: Vec<Recording>) -> Result<Option<Recording>, RecordingError> {
    let mut rest = recordings.into_iter();
    let Some(mut all) = rest.next() else { return Ok(None) };
    let first = all.path.clone();
    let mut paths = vec![all.path.display().to_string()];
    for stretch in &mut all.stretches {
        stretch.file.get_or_insert_with(|| (first.clone(), 0.0));
    }
    for next in rest {
        let refused = |why: String| RecordingError::NotJoined {
            first: first.clone(),
            other: next.path.clone(),
            why,
        };
        let (here, there) = (all.time_step, next.time_step);
        if (there / here - 1.0).abs() > ALIKE {
            return Err(refused(format!(
                "one has {:.6} samples a second and the other {:.6}; --resample HZ brings both to one rate",
                1.0 / here,
                1.0 / there
            )));
        }
        if let (Some(one), Some(other)) = (all.axis, next.axis)
            && one != other
        {
            return Err(refused("one axis turns and the other moves straight".to_owned()));
        }
        if all.friction_only != next.friction_only {
            return Err(refused(
                "the force of one is friction alone, that of the other drives the axis".to_owned(),
            ));
        }
        let samples = all.samples();
        let start = all.duration() + here;
        if all.readings.is_some() || next.readings.is_some() {
            let read = |of: &Recording| of.readings.clone().or_else(|| of.position.clone());
            all.readings = both(read(&all), read(&next));
        }
        all.position = both(all.position, next.position);
        all.velocity = both(all.velocity, next.velocity);
        if all.position.is_none() && all.velocity.is_none() {
            return Err(refused(
                "they have neither a position nor a velocity in common".to_owned(),
            ));
        }
        all.force.extend(next.force);
        all.stretches.extend(next.stretches.into_iter().map(|mut stretch| {
            stretch.file = Some((next.path.clone(), start));
            stretch.start += start;
            stretch.samples = stretch.samples.start + samples..stretch.samples.end + samples;
            stretch
        }));
        all.irregularities = all.irregularities.and(next.irregularities);
        all.axis = all.axis.or(next.axis);
        Beside::merge(&mut all.beside, next.beside);
        paths.push(next.path.display().to_string());
    }
    all.path = PathBuf::from(paths.join(", "));
    Ok(Some(all))
}

/// One channel behind the other, where both are there.
fn both(one: Option<Vec<f64>>, other: Option<Vec<f64>>) -> Option<Vec<f64>> {
    let (mut one, other) = (one?, other?);
    one.extend(other);
    Some(one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::irregularities::Irregularities;
    use crate::{AxisKind, ChannelSource, RecordedStretch, Sources};

    fn recording(name: &str, samples: usize, position: bool) -> Recording {
        let channel = || ChannelSource { name: "x".to_owned(), scale: 1.0 };
        Recording {
            path: name.into(),
            time_step: 0.01,
            position: position.then(|| vec![0.5; samples]),
            readings: None,
            velocity: Some(vec![1.0; samples]),
            force: vec![2.0; samples],
            stretches: RecordedStretch::whole(samples),
            irregularities: Irregularities { filled: 1, ..Irregularities::default() },
            axis: None,
            friction_only: false,
            sources: Sources { time: channel(), position: None, velocity: None, force: channel() },
            beside: vec![],
        }
    }

    #[test]
    fn stretches_stand_behind_one_another_and_share_their_channels() {
        let both = joined(vec![recording("a", 100, true), recording("b", 50, false)]);
        let both = both.unwrap().unwrap();
        assert_eq!((both.samples(), both.position.is_none()), (150, true));
        assert_eq!(both.path, PathBuf::from("a, b"));
        assert_eq!(both.stretches[1].samples, 100..150);
        assert!((both.stretches[1].start - 1.0).abs() < 1e-12, "{:?}", both.stretches);
        let files: Vec<_> = both.stretches.iter().map(|one| one.file.clone().unwrap()).collect();
        assert_eq!(files, [("a".into(), 0.0), ("b".into(), 1.0)]);
        assert!((both.duration() - 1.49).abs() < 1e-9);
        assert_eq!(both.irregularities.filled, 2);
        assert_eq!(joined(Vec::new()).unwrap(), None);
    }

    #[test]
    fn what_is_no_recording_of_the_same_axis_is_refused() {
        let with = |change: fn(&mut Recording)| {
            let mut other = recording("b", 50, true);
            change(&mut other);
            let first = Recording { axis: Some(AxisKind::Rotary), ..recording("a", 100, true) };
            joined(vec![first, other]).unwrap_err().to_string()
        };
        assert!(with(|b| b.time_step = 0.02).contains("--resample"));
        assert!(with(|b| b.axis = Some(AxisKind::Linear)).contains("turns"));
        assert!(with(|b| b.friction_only = true).contains("friction alone"));
        assert!(with(|b| (b.position, b.velocity) = (None, None)).contains("neither"));
    }
}
