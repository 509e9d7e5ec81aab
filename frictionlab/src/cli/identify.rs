//! `frictionlab identify`: friction and inertia from a recording.

use anyhow::Context;
use friction_ident::{AxisTerm, IdentError};
use identification::asked::friction::{FILES, Written, identify};
use identification::asked::{IdentifyArgs, check, conditioning, motor, read};
use identification::axis::structure::{StructureChoice, Structured, structured};
use identification::axis::{self, IdentifyError, Settings};
use identification::friction;
use recording::{AxisKind, Recording};
use work::progress::Progress;
use work::{BadInput, Interrupted};

use crate::interruption;

/// Reads, identifies, writes `identification.json`, `report.html` and `parameters.yaml`, and prints
/// a table.
///
/// # Errors
/// [`BadInput`] for whatever is wrong with the files, the options or the output folder; nothing is
/// written then.
pub fn execute(args: &IdentifyArgs) -> anyhow::Result<()> {
    check(args)?;
    args.saying.begin();
    if args.is_friction() {
        return execute_friction(args);
    }
    let motor = motor(args)?;
    let Some(recording) = read(&args.files, args, &motor)? else {
        return Err(BadInput("a file is missing: give a CSV file or a bag".to_owned()).into());
    };
    let validation = read(&args.validate, args, &motor)?;
    let conditioning = conditioning(args, &recording);
    let assumed = recording.axis.is_none() && args.axis.is_none();
    let settings = Settings {
        conditioning,
        inertia: !(args.without_inertia || recording.friction_only),
        offset: !args.without_offset,
        axis: args.axis.or(recording.axis).unwrap_or(AxisKind::Linear),
        gravity: args.axis.or(recording.axis) != Some(AxisKind::Linear),
        structured: args.structure.is_some(),
        free_run: args.free_run,
    };
    let mut found =
        axis::identify(&recording, validation.as_ref(), &settings).map_err(with_option)?;
    if assumed {
        found.notes.push(
            "The column names do not tell whether the axis is linear or rotary; units are shown for a linear one. \
             Say --axis rotary if it turns."
                .to_owned(),
        );
    }

    let validation = validation.as_ref();
    let structured = match &args.structure {
        Some(_) if !settings.inertia => {
            return Err(BadInput("--structure needs a driving force, but this recording's force is friction alone; with a bag add --torque-from-voltage".to_owned()).into());
        }
        Some(wanted) => compare(&recording, validation, &settings, wanted, args.quiet)?,
        None => None,
    };
    if let Some(structured) = &structured {
        found.warnings.splice(0..0, structured.warnings.iter().cloned());
    }
    let page = axis::page::page(&found, structured.as_ref(), &recording, validation);
    let mut document = axis::document::render(&found, &recording, validation);
    if let Some(structured) = &structured {
        document = with_structure(&document, structured)?;
    }
    let name = recording.path.display().to_string();
    let parameters = match &structured {
        Some(structured) => axis::structure_parameters::render(structured, &name)?,
        None => axis::parameters::render(&found, &name),
    };
    let files = [
        ("identification.json", document),
        (
            "report.html",
            report::render_page(&report::linked(page, ["parameters.yaml", "identification.json"])),
        ),
        ("parameters.yaml", parameters),
    ];
    let folder = args.to.reserve("identify")?;
    folder.write(&files)?;
    let mut text = axis::terminal::render(&found, &recording, validation);
    if let Some(structured) = &structured {
        text.push_str(&axis::structure_page::terminal(structured));
    }
    let names = files.each_ref().map(|(name, _)| *name).join(", ");
    let text = format!("{text}\nwritten to {}: {names}\n", folder.path().display());
    args.saying.result(args.quiet, &files[0].1, &text)
}

/// The error with the option that mends it.
fn with_option(error: IdentifyError) -> BadInput {
    let option = match &error.source {
        IdentError::Cutoff { .. } => " (--cutoff HZ)",
        IdentError::Order(_) => " (--order N)",
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

/// Compares structures with a progress bar; ctrl-C ends the comparison with what there is.
fn compare(
    recording: &Recording,
    validation: Option<&Recording>,
    settings: &Settings,
    wanted: &StructureChoice,
    quiet: bool,
) -> anyhow::Result<Option<Structured>> {
    let estimation = axis::conditioned(recording, settings).map_err(with_option)?;
    let other = validation.map(|other| axis::conditioned(other, settings)).transpose();
    let other = other.map_err(with_option)?;
    let cancel = interruption::watch(interruption::WRITING)?;
    let progress = Progress::counting(1, "structures", quiet);
    let found = structured(&estimation, other.as_ref(), wanted, settings.axis, &progress, &cancel);
    progress.finish();
    let found =
        found.map_err(|error| BadInput(format!("{}: {error}", recording.path.display())))?;
    if found.is_none() {
        return Err(Interrupted(
            "stopped before any structure was compared; nothing was written".to_owned(),
        )
        .into());
    }
    Ok(found)
}

/// The document with the structure in it.
fn with_structure(document: &str, found: &Structured) -> anyhow::Result<String> {
    let mut tree: serde_json::Value =
        serde_json::from_str(document).context("cannot describe the results")?;
    tree["structure"] = axis::structure_page::document(found);
    Ok(format!("{tree:#}\n"))
}

/// Reads, identifies every model, writes `identification.json`, `report.html` and
/// `parameters.yaml`, and prints a table.
///
/// # Errors
/// [`BadInput`] for whatever is wrong with the files, the options or the output folder; nothing is
/// written then. [`Interrupted`] after ctrl-C; what there was by then is written.
fn execute_friction(args: &IdentifyArgs) -> anyhow::Result<()> {
    let cancel = interruption::watch(interruption::WRITING)?;
    let progress = Progress::counting(1, "models", args.quiet);
    let Written { found, folder } = identify(args, thesis::BESIDE.friction, &progress, &cancel)?;
    let text = format!(
        "{}\nwritten to {}: {}\n",
        friction::terminal::render(&found),
        folder.path().display(),
        FILES.join(", ")
    );
    let document =
        if args.saying.json { friction::document::render(&found) } else { String::new() };
    args.saying.result(args.quiet, &document, &text)?;
    if found.interrupted {
        return Err(Interrupted(format!(
            "stopped before the end; the best found by then is in {}",
            folder.path().display()
        ))
        .into());
    }
    Ok(())
}
