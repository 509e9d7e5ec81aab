//! How warm each rig's motor is, beyond the life of the rig's back end and of the process.
//!
//! The model of the safety layer begins anew with every configuration; a motor does not. What it
//! had is kept in the process, and for a real rig in a file, and cools by the time that went by.
//! Where nothing is known, or the file cannot be read, the motor counts as warm as one that was too
//! hot and may just go on. No trouble with the file keeps anything from starting.

use std::{
    collections::BTreeMap,
    env, fs, io,
    path::{Path, PathBuf},
    sync::Mutex,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use super::locked::locked;
use crate::safety::SafetyLimits;

const HEADER: &str = "winding temperature, version 1";
/// A clock that says less was never set: 2020-01-01 [s since the epoch].
const PLAUSIBLE: f64 = 1_577_836_800.0;
/// Time in which the motor may have been heated after the last note of a process that did not end
/// orderly \[s\].
const UNKNOWN_TIME: f64 = 3.0;
/// Longest file that is read.
const LONGEST: u64 = 4096;

/// What is known of a motor.
#[derive(Debug, Clone, Copy)]
struct Known {
    /// Above ambient \[K\].
    rise: f64,
    at: Instant,
}

/// The motors that this process has driven.
#[derive(Debug, Default)]
pub(super) struct Warmth(Mutex<BTreeMap<String, Known>>);

/// The file of a real rig.
#[derive(Debug, Clone)]
pub(super) struct Record {
    path: PathBuf,
    rig: String,
}

impl Record {
    /// In `folder`, or where programs keep their state if that is empty; none if nobody says where
    /// that is.
    pub(super) fn of(rig: &str, folder: &str) -> Option<Self> {
        let folder = if folder.is_empty() { default_folder()? } else { PathBuf::from(folder) };
        let name: String =
            rig.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        Some(Self { path: folder.join(format!("{name}.temperature")), rig: rig.to_owned() })
    }

    /// Writes the rise above ambient \[K\]; `at_rest` says that nothing drives the motor any more.
    /// It appears whole or not at all; after a power cut it may be gone, which counts as unknown.
    pub(super) fn write(&self, rise: f64, at_rest: bool) -> io::Result<()> {
        let text = format!(
            "{HEADER}\nrig: {}\nrise_k: {rise}\nat_rest: {at_rest}\nunix_s: {}\n",
            self.rig,
            unix_time(SystemTime::now())
        );
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder)?;
        }
        let new = self.path.with_extension(format!("{}.new", std::process::id()));
        fs::write(&new, text)?;
        fs::rename(&new, &self.path).inspect_err(|_| _ = fs::remove_file(&new))
    }

    /// The rise \[K\] now, by what the file says.
    fn read(&self, limits: &SafetyLimits) -> Result<f64, String> {
        let length = fs::metadata(&self.path).map_err(|e| e.to_string())?;
        if !length.is_file() || length.len() > LONGEST {
            return Err("it is no file of this program".to_owned());
        }
        let text = fs::read_to_string(&self.path).map_err(|e| e.to_string())?;
        judge(&text, &self.rig, unix_time(SystemTime::now()), limits)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }
}

/// The rise \[K\] at `now` [s since the epoch] by the text of a file.
fn judge(text: &str, rig: &str, now: f64, limits: &SafetyLimits) -> Result<f64, String> {
    let mut lines = text.lines();
    if lines.next() != Some(HEADER) {
        return Err("it is no file of this program".to_owned());
    }
    let fields: BTreeMap<&str, &str> = lines.filter_map(|line| line.split_once(": ")).collect();
    let number = |name: &str| {
        let number = fields.get(name).and_then(|text| text.parse::<f64>().ok());
        number
            .filter(|number| number.is_finite() && *number >= 0.0)
            .ok_or_else(|| format!("{name} is missing"))
    };
    if fields.get("rig") != Some(&rig) {
        return Err("it is another rig's".to_owned());
    }
    let (rise, then) = (number("rise_k")?, number("unix_s")?);
    let rise = match fields.get("at_rest") {
        Some(&"true") => rise,
        Some(&"false") => limits.heated_rise(rise, UNKNOWN_TIME),
        _ => return Err("at_rest is missing".to_owned()),
    };
    // A clock that was never set, or that was turned back, says nothing of the time that went by.
    let plausible = then >= PLAUSIBLE && now >= then;
    Ok(limits.cooled_rise(rise, if plausible { now - then } else { 0.0 }))
}

impl Warmth {
    /// How far the rig's motor is above ambient \[K\], and a sentence where that is assumed.
    /// Nothing is known of a simulated one before its first configuration: it is new.
    pub(super) fn rise(
        &self,
        rig: &str,
        limits: &SafetyLimits,
        record: Option<&Record>,
        simulated: bool,
    ) -> (f64, Option<String>) {
        if let Some(known) = locked(&self.0).get(rig) {
            return (limits.cooled_rise(known.rise, known.at.elapsed().as_secs_f64()), None);
        }
        if simulated || limits.motor.is_none() {
            return (0.0, None);
        }
        let read = record.map_or_else(
            || {
                Err("there is no folder for it: set the parameter state_folder or XDG_STATE_HOME"
                    .to_owned())
            },
            |record| {
                record.read(limits).map_err(|why| format!("{}: {why}", record.path().display()))
            },
        );
        match read {
            Ok(rise) => (rise, None),
            Err(why) => {
                let rise = limits.assumed_rise();
                (
                    rise,
                    Some(format!(
                        "the motor's temperature is not known and counts as {rise:.0} K above ambient ({why})"
                    )),
                )
            }
        }
    }

    /// Notes how far the rig's motor is above ambient \[K\].
    pub(super) fn note(&self, rig: &str, rise: f64) {
        locked(&self.0).insert(rig.to_owned(), Known { rise, at: Instant::now() });
    }
}

fn unix_time(time: SystemTime) -> f64 {
    time.duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO).as_secs_f64()
}

fn default_folder() -> Option<PathBuf> {
    let given = |name: &str| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let state = given("XDG_STATE_HOME").or_else(|| Some(given("HOME")?.join(".local/state")))?;
    Some(state.join("frictionlab"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: f64 = 1.8e9;

    fn text(rise: f64, at_rest: bool, then: f64) -> String {
        format!(
            "{HEADER}\nrig: serial:/dev/x\nrise_k: {rise}\nat_rest: {at_rest}\nunix_s: {then}\n"
        )
    }

    #[test]
    fn what_went_by_cools_the_motor_only_by_a_clock_that_can_be_believed() {
        let limits = SafetyLimits::default();
        let rise = |text: &str| judge(text, "serial:/dev/x", NOW, &limits);
        assert_eq!(rise(&text(60.0, true, NOW)), Ok(60.0));
        assert!((rise(&text(60.0, true, NOW - 20.0)).unwrap() - 22.07).abs() < 0.01);
        assert_eq!(rise(&text(60.0, true, NOW + 1.0)), Ok(60.0), "the clock was turned back");
        assert_eq!(rise(&text(60.0, true, 100.0)), Ok(60.0), "the clock was never set");
        assert!(
            rise(&text(60.0, false, NOW)).unwrap() > 90.0,
            "it went on heating after the last note"
        );
    }

    #[test]
    fn what_cannot_be_read_counts_as_warm_and_keeps_nothing_from_starting() {
        let limits = SafetyLimits::default();
        for wrong in [
            "",
            "hello",
            HEADER,
            &text(f64::NAN, true, NOW),
            &text(-1.0, true, NOW),
            &text(1.0, true, NOW)[..60],
        ] {
            assert!(judge(wrong, "serial:/dev/x", NOW, &limits).is_err(), "{wrong:?}");
        }
        assert!(
            judge(&text(1.0, true, NOW), "serial:/dev/y", NOW, &limits)
                .unwrap_err()
                .contains("another rig")
        );
        let record = Record::of("serial:/dev/x", "/dev/null/nowhere").unwrap();
        assert!(record.write(10.0, true).is_err());
        let (rise, said) = Warmth::default().rise("serial:/dev/x", &limits, Some(&record), false);
        assert_eq!(rise, limits.assumed_rise());
        assert!(said.unwrap().contains("not known"));
        assert_eq!(Warmth::default().rise("simulated", &limits, None, true), (0.0, None));
    }

    #[test]
    fn a_motor_stays_warm_over_clean_up_and_over_a_restart() {
        let limits = SafetyLimits::default();
        let folder = tempfile::tempdir().unwrap();
        let record =
            Record::of("serial:/dev/x", &folder.path().join("new").to_string_lossy()).unwrap();
        let first = Warmth::default();
        first.note("serial:/dev/x", 50.0);
        let (kept, said) = first.rise("serial:/dev/x", &limits, Some(&record), false);
        assert!(kept > 40.0 && kept <= 50.0 && said.is_none());
        record.write(50.0, true).unwrap();
        let (after, said) = Warmth::default().rise("serial:/dev/x", &limits, Some(&record), false);
        assert!(after > 20.0 && after <= 50.0 && said.is_none(), "{after}");
    }
}
