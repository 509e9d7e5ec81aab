//! `frictionlab design`: gains from specifications, or what gains are worth.

use studies::design::asked::{DesignArgs, contents, designed};
use studies::design::summary;

/// Runs it.
///
/// # Errors
/// [`BadInput`](work::BadInput) for gains, specifications or a drive that cannot be, or a folder
/// that cannot be written.
pub fn execute(args: &DesignArgs) -> anyhow::Result<()> {
    let found = designed(args)?;
    let shared = args.shared();
    let folder = shared.to.reserve("design")?;
    let files = contents(&found);
    folder.write(&files)?;
    let file = |name: &str| folder.join(name).display().to_string();
    let text = format!(
        "{}Report  {}\nGains   {}\n",
        summary(&found),
        file("report.html"),
        file("controller.yaml")
    );
    shared.saying.result(shared.quiet, &files[2].1, &text)
}
