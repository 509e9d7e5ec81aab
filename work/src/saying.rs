//! The options that say how much a command tells, and to whom; the same for every command.

use serde::Serialize;

use crate::progress::set_verbose;

/// What is told besides the results.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct Saying {
    /// Print the result as JSON for programs, and nothing else on standard output
    /// (docs/reference/json.md)
    #[arg(long)]
    pub json: bool,
    /// Say on standard error what is being done, stage by stage
    #[arg(long, conflicts_with = "quiet")]
    pub verbose: bool,
}

impl Saying {
    /// Lets every progress say its stages, if that is wanted.
    pub fn begin(self) {
        set_verbose(self.verbose);
    }

    /// Prints the result: the document with `--json`, else the text unless `quiet`.
    ///
    /// # Errors
    /// If standard output cannot be written; whoever stops reading is no error.
    pub fn result(self, quiet: bool, document: &str, text: &str) -> anyhow::Result<()> {
        if self.json {
            let end = if document.ends_with('\n') { "" } else { "\n" };
            print(&format!("{document}{end}"))
        } else if quiet {
            Ok(())
        } else {
            print(text)
        }
    }
}

/// A result as JSON.
///
/// # Errors
/// If it cannot be said in JSON, a mistake of this program.
pub fn document(result: &impl Serialize) -> anyhow::Result<String> {
    use anyhow::Context;
    serde_json::to_string_pretty(result).context("cannot describe the results")
}

/// Prints a text. Whoever reads may have seen enough (`| head`): that is no error.
///
/// # Errors
/// Where standard output cannot be written otherwise.
pub fn print(text: &str) -> anyhow::Result<()> {
    use std::io::Write;
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(anyhow::Error::new(error).context("the text cannot be printed"))
        }
        _ => Ok(()),
    }
}
