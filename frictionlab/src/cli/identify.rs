//! `frictionlab identify`: friction and inertia from a recording.

use identification::asked::friction::{FILES, Written, identify};
use identification::asked::{IdentifyArgs, axis, check};
use identification::friction;
use work::Interrupted;
use work::progress::Progress;

use crate::interruption;

/// Reads, identifies, writes `identification.json`, `report.html` and `parameters.yaml`, and prints
/// a table.
///
/// # Errors
/// [`BadInput`](work::BadInput) for whatever is wrong with the files, the options or the output
/// folder; nothing is written then.
pub fn execute(args: &IdentifyArgs) -> anyhow::Result<()> {
    check(args)?;
    args.saying.begin();
    if args.is_friction() {
        return execute_friction(args);
    }
    let mut found = axis::Asked::read(args)?.identify()?;
    if let Some(wanted) = &args.structure {
        // Ctrl-C ends the comparison with what there is.
        let cancel = interruption::watch(interruption::WRITING)?;
        let progress = Progress::counting(1, "structures", args.quiet);
        found.compare(wanted, &progress, &cancel)?;
    }
    let contents = found.contents()?;
    let folder = args.to.reserve("identify")?;
    let files: Vec<(&str, String)> = FILES.into_iter().zip(contents).collect();
    folder.write(&files)?;
    let names = FILES.join(", ");
    let path = folder.path().display();
    let text = format!("{}\nwritten to {path}: {names}\n", found.terminal());
    args.saying.result(args.quiet, &files[0].1, &text)
}

/// Reads, identifies every model, writes `identification.json`, `report.html` and
/// `parameters.yaml`, and prints a table.
///
/// # Errors
/// [`BadInput`](work::BadInput) for whatever is wrong with the files, the options or the output
/// folder; nothing is written then. [`Interrupted`] after ctrl-C; what there was by then is written.
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
