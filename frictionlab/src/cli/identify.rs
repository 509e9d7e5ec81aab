//! `frictionlab identify`: friction and inertia from a recording.

use std::sync::atomic::AtomicBool;

use files::Folder;
use identification::asked::friction::{FILES, Written, identify};
use identification::asked::{IdentifyArgs, axis, check};
use identification::friction;
use work::Interrupted;
use work::progress::Progress;

/// Reads, identifies, writes `identification.json`, `report.html` and `parameters.yaml`, and prints
/// a table. Once `cancel` is set, a comparison ends with what there is.
///
/// # Errors
/// [`BadInput`](work::BadInput) for whatever is wrong with the files, the options or the output
/// folder; nothing is written then. [`Interrupted`] after ctrl-C; what there was by then is written.
pub fn execute(args: &IdentifyArgs, cancel: &AtomicBool) -> anyhow::Result<()> {
    check(args)?;
    args.saying.begin();
    if args.is_friction() {
        return execute_friction(args, cancel);
    }
    let asked = axis::Asked::read(args)?;
    // Before the work: a folder that cannot be written is told at once.
    let folder = args.to.reserve("identify")?;
    let mut found = asked.identify()?;
    if let Some(wanted) = &args.structure {
        let progress = Progress::counting(1, "structures", args.quiet);
        found.compare(wanted, &progress, cancel)?;
    }
    let contents = found.contents()?;
    let files: Vec<(&str, String)> = FILES.into_iter().zip(contents).collect();
    folder.write(&files)?;
    let names = FILES.join(", ");
    let path = folder.path().display();
    let text = format!("{}\nwritten to {path}: {names}\n", found.terminal());
    args.saying.result(args.quiet, &files[0].1, &text)?;
    ended(found.interrupted(), &folder)
}

/// The error of what was stopped before its end.
fn ended(interrupted: bool, folder: &Folder) -> anyhow::Result<()> {
    if interrupted {
        let path = folder.path().display();
        let said = format!("stopped before the end; the best found by then is in {path}");
        return Err(Interrupted(said).into());
    }
    Ok(())
}

/// Reads, identifies every model, writes `identification.json`, `report.html` and
/// `parameters.yaml`, and prints a table.
///
/// # Errors
/// [`BadInput`](work::BadInput) for whatever is wrong with the files, the options or the output
/// folder; nothing is written then. [`Interrupted`] after ctrl-C; what there was by then is written.
fn execute_friction(args: &IdentifyArgs, cancel: &AtomicBool) -> anyhow::Result<()> {
    let progress = Progress::counting(1, "models", args.quiet);
    let Written { found, folder } = identify(args, thesis::BESIDE.friction, &progress, cancel)?;
    let text = format!(
        "{}\nwritten to {}: {}\n",
        friction::terminal::render(&found),
        folder.path().display(),
        FILES.join(", ")
    );
    let document =
        if args.saying.json { friction::document::render(&found) } else { String::new() };
    args.saying.result(args.quiet, &document, &text)?;
    ended(found.interrupted, &folder)
}
