//! The part of `frictionlab identify` that identifies an axis from a recording of what drives it.

use std::sync::atomic::AtomicBool;

use anyhow::Context;
use friction_ident::rigid_axis::low_pass_of_the_force_helps;
use friction_ident::{AxisTerm, IdentError};
use recording::{AxisKind, Recording};
use work::progress::Progress;
use work::{BadInput, Interrupted};

use super::friction::FILES;
use super::{IdentifyArgs, conditioning, motor, read};
use crate::axis::structure::{StructureChoice, Structured, structured};
use crate::axis::{self, Identification, IdentifyError, Settings, channels};

/// Share by which sampling periods may differ and still be one rate.
const SAME_RATE: f64 = 0.01;

/// What is to be identified, read.
#[derive(Debug)]
pub struct Asked {
    recording: Recording,
    validation: Option<Recording>,
    settings: Settings,
    /// Nothing tells whether the axis is linear or rotary.
    assumed: bool,
}

impl Asked {
    /// Reads the recordings as the options say.
    ///
    /// # Errors
    /// [`BadInput`] or [`RecordingError`](recording::RecordingError) for whatever is wrong with the
    /// options or the files.
    pub fn read(args: &IdentifyArgs) -> anyhow::Result<Self> {
        let motor = motor(args)?;
        let Some(recording) = read(&args.files, args, &motor)? else {
            let missing = "a file is missing: give a CSV file or a bag";
            return Err(BadInput(missing.to_owned()).into());
        };
        let validation = read(&args.validate, args, &motor)?;
        let mut suits = conditioning(args, &recording);
        suits.low_pass_force = low_pass_of_the_force_helps(&channels(&recording), &suits);
        // At another rate the usual cutoffs are others, however fast the motion is.
        let same_rate =
            |other: &&Recording| (other.time_step / recording.time_step - 1.0).abs() < SAME_RATE;
        let own = validation.as_ref().filter(same_rate).map(|other| conditioning(args, other));
        let mut elsewhere = own.map_or(suits, |own| suits.elsewhere(own));
        if let Some(other) = &validation {
            elsewhere.low_pass_force |= low_pass_of_the_force_helps(&channels(other), &elsewhere);
        }
        let settings = Settings {
            conditioning: suits,
            elsewhere,
            given_cutoff: args.cutoff.is_some(),
            inertia: !(args.without_inertia || recording.friction_only),
            offset: !args.without_offset,
            axis: args.axis.or(recording.axis).unwrap_or(AxisKind::Linear),
            gravity: args.axis.or(recording.axis) != Some(AxisKind::Linear),
            structured: args.structure.is_some(),
            free_run: args.free_run,
        };
        if args.structure.is_some() && !settings.inertia {
            let refused = "--structure needs a driving force, but this recording's force is friction alone; with a bag add --torque-from-voltage";
            return Err(BadInput(refused.to_owned()).into());
        }
        let assumed = recording.axis.is_none() && args.axis.is_none();
        Ok(Self { recording, validation, settings, assumed })
    }

    /// Identifies the plain models. Structures are compared by [`compare`](Self::compare).
    ///
    /// # Errors
    /// [`BadInput`] for what cannot be identified.
    pub fn identify(self) -> anyhow::Result<Found> {
        let Self { recording, validation, settings, assumed } = self;
        let mut found =
            axis::identify(&recording, validation.as_ref(), &settings).map_err(with_option)?;
        if assumed {
            found.notes.push(
                "The column names do not tell whether the axis is linear or rotary; units are shown for a linear one. \
                 Say --axis rotary if it turns."
                    .to_owned(),
            );
        }
        Ok(Found { found, structured: None, recording, validation, settings })
    }
}

/// What was found of an axis.
#[derive(Debug)]
pub struct Found {
    /// The plain models.
    pub found: Identification,
    /// The structure of the axis, where it was asked for.
    pub structured: Option<Structured>,
    /// What it was found from.
    pub recording: Recording,
    /// What it was tried on.
    pub validation: Option<Recording>,
    settings: Settings,
}

impl Found {
    /// Whether the comparison of structures was stopped; what there was by then is here.
    #[must_use]
    pub fn interrupted(&self) -> bool {
        self.structured.as_ref().is_some_and(|found| found.interrupted)
    }

    /// Compares structures. Once `cancel` is set it ends with what there is.
    ///
    /// # Errors
    /// [`BadInput`] for what cannot be compared; [`Interrupted`] where nothing was compared before
    /// `cancel` was set.
    pub fn compare(
        &mut self,
        wanted: &StructureChoice,
        progress: &Progress,
        cancel: &AtomicBool,
    ) -> anyhow::Result<()> {
        let Self { recording, validation, settings, .. } = self;
        let estimation =
            axis::conditioned(recording, &settings.conditioning).map_err(with_option)?;
        let other = validation.as_ref().map(|other| axis::conditioned(other, &settings.elsewhere));
        let other = other.transpose().map_err(with_option)?;
        let found =
            structured(&estimation, other.as_ref(), wanted, settings.axis, progress, cancel);
        progress.finish();
        if let Err(IdentError::Columns { names }) = &found
            && one_direction(&estimation.velocity, names)
        {
            return self.without_structure();
        }
        let mut found = found.map_err(|error| {
            // No structure can do without an inertia.
            let option = match &error {
                IdentError::NegativeInertia { .. } => {
                    " (--force-column NAME:-SCALE, or --without-inertia in place of --structure)"
                }
                _ => "",
            };
            BadInput(format!("{}: {error}{option}", recording.path.display()))
        })?;
        if let (Some(structured), Some(_)) = (&mut found, &self.found.too_fast) {
            if let Some(source) = self.found.refusal(structured.estimation.relative_error) {
                let path = recording.path.clone();
                return Err(with_option(IdentifyError { path, stretch: None, source }).into());
            }
            structured.fit.estimates.distrust();
        }
        if let Some(structured) = found.as_mut().filter(|_| !recording.beside.is_empty()) {
            structured.fit.estimates.distrust_what_other_joints_move();
        }
        if found.is_none() {
            let stopped = "stopped before any structure was compared; nothing was written";
            return Err(Interrupted(stopped.to_owned()).into());
        }
        if let Some(structured) = &found {
            self.found.stand_beside(structured);
        }
        self.structured = found;
        Ok(())
    }

    /// Lets the symmetric model stand for the axis: in one direction it is all that can be told.
    ///
    /// # Errors
    /// [`BadInput`] where that model is none.
    fn without_structure(&mut self) -> anyhow::Result<()> {
        let path = || self.recording.path.clone();
        let refused = |source| with_option(IdentifyError { path: path(), stretch: None, source });
        self.found.symmetric.fit.possible().map_err(refused)?;
        if let Some(source) = self.found.refusal(f64::INFINITY) {
            return Err(refused(source).into());
        }
        self.found.notes.push(
            "No structure was compared: each has an offset or friction of each direction, and in a motion of one direction \
             neither can be told from Coulomb friction. The symmetric model stands for the axis, and its Coulomb friction contains \
             the offset. Record a motion that reverses to compare structures."
                .to_owned(),
        );
        Ok(())
    }

    /// What is told on a terminal.
    #[must_use]
    pub fn terminal(&self) -> String {
        let (structured, validation) = (self.structured.as_ref(), self.validation.as_ref());
        axis::terminal::render(&self.found, structured, &self.recording, validation)
    }

    /// The document for programs, `identification.json`.
    ///
    /// # Errors
    /// If something of it cannot be said in JSON, a mistake of this program.
    pub fn document(&self) -> anyhow::Result<String> {
        let Self { found, recording, validation, .. } = self;
        let document = axis::document::render(found, recording, validation.as_ref());
        match &self.structured {
            Some(structured) => with_structure(&document, structured),
            None => Ok(document),
        }
    }

    /// The contents of [`FILES`].
    ///
    /// # Errors
    /// If something of it cannot be said in JSON or YAML, a mistake of this program.
    pub fn contents(&self) -> anyhow::Result<[String; 3]> {
        let Self { found, structured, recording, .. } = self;
        let (structured, validation) = (structured.as_ref(), self.validation.as_ref());
        let page = axis::page::page(found, structured, recording, validation);
        let name = recording.path.display().to_string();
        let parameters = match structured {
            Some(structured) => {
                axis::structure_parameters::render(structured, &name, found.settings.axis)?
            }
            None => axis::parameters::render(found, &name),
        };
        let page = report::linked(page, [FILES[2], FILES[0]]);
        Ok([self.document()?, report::render_page(&page), parameters])
    }
}

/// Whether an axis never moves back, so that parameters of these names cannot be told apart.
fn one_direction(velocity: &[f64], names: &[String]) -> bool {
    let level = |name: &str| names.iter().any(|other| other == name);
    let never = velocity.iter().all(|v| *v >= 0.0) || velocity.iter().all(|v| *v <= 0.0);
    never || level("offset") && level("f_c")
}

/// The document with the structure in it.
fn with_structure(document: &str, found: &Structured) -> anyhow::Result<String> {
    let mut tree: serde_json::Value =
        serde_json::from_str(document).context("cannot describe the results")?;
    tree["structure"] = axis::structure_page::document(found);
    Ok(format!("{tree:#}\n"))
}

/// The error with the option that mends it.
fn with_option(error: IdentifyError) -> BadInput {
    let option = match &error.source {
        IdentError::Cutoff { .. } => " (--cutoff HZ)",
        IdentError::Order(_) => " (--order N)",
        IdentError::CannotFollow { .. } => " (--cutoff HZ takes of it what there is)",
        IdentError::Decimation(_) => " (--decimate N)",
        IdentError::TooFewSamples { .. } => " (--trim N, --order N, --decimate N)",
        IdentError::NegativeInertia { .. } => {
            " (--structure auto, --force-column NAME:-SCALE, --without-inertia)"
        }
        IdentError::NotExcited { terms } if terms.contains(&AxisTerm::Inertia) => {
            " (--without-inertia)"
        }
        IdentError::NotExcited { terms } if terms.contains(&AxisTerm::Offset) => {
            " (--without-offset)"
        }
        _ => "",
    };
    BadInput(format!("{error}{option}"))
}

#[cfg(test)]
mod tests {
    use clap::{Args, Command, FromArgMatches};

    use super::*;

    /// What the command does up to writing.
    fn found(arguments: &[&str]) -> anyhow::Result<Found> {
        let all = std::iter::once("identify").chain(arguments.iter().copied());
        let matches = IdentifyArgs::augment_args(Command::new("identify")).get_matches_from(all);
        let args = IdentifyArgs::from_arg_matches(&matches)?;
        let mut found = Asked::read(&args)?.identify()?;
        if let Some(wanted) = &args.structure {
            let progress = Progress::counting(1, "structures", true);
            found.compare(wanted, &progress, &AtomicBool::new(false))?;
        }
        Ok(found)
    }

    /// 24 s of a joint of 0.02 kg m^2 with friction that has a dip of this depth.
    fn joint(dip: f64, velocity: impl Fn(f64) -> (f64, f64)) -> String {
        let mut x = 0.0;
        let row = |k: u32| {
            let t = f64::from(k) * 2e-3;
            x += 2e-3 * velocity(t).0;
            let (v, a) = velocity(t);
            let level = 0.3 + dip * (-(v / 0.8).powi(2)).exp();
            let torque = 0.02 * a + 0.05 * v + level * v.signum() + 1e-3 * (977.0 * t).sin();
            format!("{t},{x},{torque}\n")
        };
        format!("t_s,q_rad,tau_Nm\n{}", (0..12_000).map(row).collect::<String>())
    }

    /// With `--structure auto` a motion of one direction was refused: offset and f_c cannot be told
    /// apart.
    #[test]
    fn one_direction_has_inertia_and_friction_with_structures_too() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("one_way.csv");
        let speed = |t: f64| (4.0 + 3.0 * (1.3 * t).sin(), 3.9 * (1.3 * t).cos());
        std::fs::write(&path, joint(0.0, speed)).unwrap();
        let path = path.display().to_string();
        let alone = found(&[&path]).unwrap();
        for more in [&["auto"][..], &["symmetric"], &["auto", "--without-offset"]] {
            let with = found(&[&[&path, "--structure"], more].concat()).unwrap();
            assert!(with.structured.is_none());
            assert_eq!(with.found.symmetric.fit, alone.found.symmetric.fit);
            let said = with.terminal();
            assert!(said.contains("neither can be told from Coulomb friction"), "{said}");
            assert!(said.contains("inertia") && said.contains("viscous"), "{said}");
            let yaml = &with.contents().unwrap()[2];
            assert!(yaml.contains("friction_observer"), "{yaml}");
        }
    }

    /// The low-pass of a slow recording, whose acceleration is covered by noise above 3 Hz, was that of
    /// a fast one too: what was right to a thousandth was said not to hold there.
    #[test]
    fn a_faster_recording_confirms_what_a_slow_one_found() {
        let folder = tempfile::tempdir().unwrap();
        let files = ["slow.csv", "fast.csv"].map(|name| folder.path().join(name));
        let tones: [&[(f64, f64)]; 2] =
            [&[(0.5, 1.0), (0.3, 2.1), (0.2, 3.3)], &[(0.5, 1.0), (0.1, 31.0), (0.03, 70.0)]];
        for (path, tones) in files.iter().zip(tones) {
            let row = |k: u32| {
                let t = f64::from(k) * 1e-3;
                let sum = |of: fn(f64, f64) -> f64| -> f64 {
                    tones.iter().map(|(size, w)| size * of(*w, w * t)).sum()
                };
                let x = (sum(|_, angle| angle.sin()) / 1e-3).floor() * 1e-3;
                let (v, a) =
                    (sum(|w, angle| w * angle.cos()), sum(|w, angle| -w * w * angle.sin()));
                let noise = 2e-3 * (977.0 * t).sin();
                let torque = 0.02 * a + 0.05 * v + 0.05 * v.signum() + noise;
                format!("{t},{x},{torque}\n")
            };
            let rows: String = (0..20_000).map(row).collect();
            std::fs::write(path, format!("t_s,q_rad,tau_Nm\n{rows}")).unwrap();
        }
        let thinned = folder.path().join("thinned.csv");
        let rows = std::fs::read_to_string(&files[1]).unwrap();
        let rows = rows.lines().enumerate().filter(|(k, _)| *k == 0 || k % 5 == 1);
        let rows: Vec<&str> = rows.map(|(_, row)| row).collect();
        std::fs::write(&thinned, rows.join("\n")).unwrap();
        let [slow, fast] = files.map(|path| path.display().to_string());
        // The same motion, recorded less often, is not slower.
        let same = found(&[&thinned.display().to_string(), "--validate", &fast]).unwrap();
        assert_eq!(same.settings.elsewhere, same.settings.conditioning);
        let found = found(&[&slow, "--validate", &fast]).unwrap();
        let Settings { conditioning, elsewhere, .. } = found.settings;
        assert!(conditioning.acceleration_cutoff < 10.0, "{conditioning:?}");
        assert!(elsewhere.acceleration_cutoff > 12.0, "{elsewhere:?}");
        assert!(found.found.warnings.is_empty(), "{:?}", found.found.warnings);
        let there = found.found.symmetric.validation.as_ref().unwrap();
        assert!(there.relative_error < 5.0, "{}", there.relative_error);
        let said = found.found.notes.join(" ");
        assert!(said.contains("fast.csv: its motion is faster"), "{said}");
    }

    /// What was wrong with the plain models alone stood first, as if the result were not to be trusted.
    #[test]
    fn a_plain_models_warning_stands_with_it_after_the_chosen_structure() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dip.csv");
        let speed = |t: f64| {
            let ((s, c), (fast_s, fast_c)) = ((1.1 * t).sin_cos(), (3.7 * t).sin_cos());
            (2.0 * c + fast_c, -2.2 * s - 3.7 * fast_s)
        };
        std::fs::write(&path, joint(0.5, speed)).unwrap();
        let path = path.display().to_string();
        let plain = found(&[&path]).unwrap();
        assert!(plain.found.warnings[0].starts_with("The symmetric model"));
        assert!(plain.found.warnings[0].ends_with("--structure auto offers more."));
        let with = found(&[&path, "--structure", "symmetric,symmetric+stribeck"]).unwrap();
        assert!(with.found.warnings.is_empty(), "{:?}", with.found.warnings);
        let said = with.terminal();
        let place = |text: &str| said.find(text).unwrap_or_else(|| panic!("no {text}: {said}"));
        assert!(place("symmetric+stribeck:") < place("WARNING: The symmetric model"), "{said}");
        assert!(place("\nsymmetric: ") < place("WARNING: The symmetric model"), "{said}");
        assert!(said.contains("symmetric+stribeck, does not have this fault"), "{said}");
        let document = with.document().unwrap();
        assert!(document.contains("does not have this fault"), "{document}");
    }
}
