//! `frictionlab identify-drive` between reading and printing: [`page`] is the HTML, [`parameters`]
//! the ROS parameter file, both from [`Identified`].

mod error;
pub mod linear;
pub mod page;
pub mod parameters;

pub use error::DriveFileError;

use std::fmt::Write;
use std::path::PathBuf;

use friction_ident::drive::{Calibration, DriveFit, DriveRecording, combine, fit_drive};
use friction_ident::{Conditioning, Estimate, IdentError, ParameterId};
use serde_json::json;

use crate::axis::structure::units;
use crate::rows::rows;
use recording::driven::DrivenRecording;
use recording::{AxisKind, Irregularities, RecordedStretch};

/// A drive found in one or several recordings.
#[derive(Debug, Clone)]
pub struct Identified {
    /// Kind of axis.
    pub axis: AxisKind,
    /// Gear ratio, where it is known; the parameter file needs it.
    pub gear_ratio: Option<f64>,
    /// What was known of the motor.
    pub calibration: Option<Calibration>,
    /// Each recording with its fit.
    pub fits: Vec<(PathBuf, DriveFit)>,
    /// What was uneven about the times of each recording.
    pub timing: Vec<Irregularities>,
    /// All recordings together.
    pub estimates: Vec<Estimate>,
}

/// Identifies every recording and puts them together.
///
/// # Errors
/// The recording and why it cannot be identified.
pub fn identify(
    recordings: &[DrivenRecording],
    axis: AxisKind,
    calibration: Option<Calibration>,
    gear_ratio: Option<f64>,
) -> Result<Identified, (PathBuf, IdentError)> {
    let (mut fits, mut timing) = (Vec::new(), Vec::new());
    for recording in recordings {
        let part = |stretch: &RecordedStretch| {
            let own = stretch.samples.clone();
            DriveRecording {
                start: stretch.start,
                time_step: recording.time_step,
                voltage: &recording.voltage[own.clone()],
                position: recording.position.as_deref().map(|all| &all[own.clone()]),
                velocity: recording.velocity.as_deref().map(|all| &all[own.clone()]),
                friction: recording.friction.as_deref().map(|all| &all[own.clone()]),
            }
        };
        let drive: Vec<DriveRecording> = recording.stretches.iter().map(part).collect();
        let how = Conditioning::for_time_step(recording.time_step);
        let mut fit = fit_drive(&drive, &how, calibration.as_ref(), units(axis))
            .map_err(|error| (recording.path.clone(), error))?;
        let irregular = &recording.irregularities;
        let uneven = irregular.doubts().into_iter().chain(irregular.describe());
        fit.notes.extend(uneven.map(|said| format!("{}: {said}", recording.path.display())));
        if recording.one_cycle_in > 1 {
            fit.notes.push(format!(
                "{}: one control cycle in {} was recorded, and the voltage between is not known: only what is steady can be trusted. `--record full` keeps every cycle.",
                recording.path.display(),
                recording.one_cycle_in
            ));
        }
        timing.push(recording.irregularities);
        fits.push((recording.path.clone(), fit));
    }
    let lists: Vec<_> = fits.iter().map(|(_, fit)| fit.estimates.parameters.clone()).collect();
    Ok(Identified { axis, gear_ratio, calibration, estimates: combine(&lists), fits, timing })
}

impl Identified {
    /// The value of an identified quantity.
    pub fn value(&self, id: impl Into<ParameterId>) -> Option<f64> {
        let id = id.into();
        let known = self.estimates.iter().find(|estimate| estimate.id == id)?;
        known.is_identified().then_some(known.value)
    }

    /// What the reader must know, each once.
    pub fn notes(&self) -> Vec<String> {
        let mut notes: Vec<String> = Vec::new();
        for note in self.fits.iter().flat_map(|(_, fit)| &fit.notes) {
            if !notes.contains(note) {
                notes.push(note.clone());
            }
        }
        notes
    }

    /// `identification-drive.json`.
    pub fn document(&self) -> String {
        let document = json!({
            "format": "frictionlab-drive",
            "format_version": 1,
            "program_version": env!("CARGO_PKG_VERSION"),
            "axis": self.axis,
            "known": self.calibration,
            "estimates": self.estimates,
            "recordings": self.fits.iter().zip(&self.timing).map(|((path, fit), timing)| json!({
                "file": path.display().to_string(),
                "relative_error_percent": fit.relative_error,
                "effective_share": fit.effective_share,
                "estimates": fit.estimates.parameters,
                "breakaways": fit.breakaways,
                "timing": timing,
            })).collect::<Vec<_>>(),
            "notes": self.notes(),
        });
        format!("{document:#}\n")
    }

    /// What the terminal shows.
    pub fn summary(&self) -> String {
        let mut text = String::new();
        for (path, fit) in &self.fits {
            let _ = writeln!(
                text,
                "{}: {} samples fitted, relative error of the voltage {:.2} %, {} starts out of rest",
                path.display(),
                fit.measured.len(),
                fit.relative_error,
                fit.breakaways.len()
            );
        }
        let rows = rows(&self.estimates);
        let width = |i: usize| rows.iter().map(|row| row[i].chars().count()).max().unwrap_or(0);
        let (a, b, c, d) = (width(0), width(1), width(2), width(3));
        for [name, value, unit, interval, verdict] in &rows {
            let _ = writeln!(text, "  {name:a$}  {value:>b$}  {unit:c$}  {interval:d$}  {verdict}");
        }
        for note in self.notes() {
            let _ = writeln!(text, "note: {note}");
        }
        text
    }
}
