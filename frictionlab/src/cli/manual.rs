//! `frictionlab manual`: the help of every command as files.

use std::fmt::Write;
use std::path::PathBuf;

use clap::{Command, ValueEnum};
use clap_mangen::Man;
use files::Folder;
use work::destination::RUNS;

/// Columns of the help on a page.
const WIDTH: usize = 100;

/// Write the manual pages of every command into a folder
///
/// One page a command, as in `man ./frictionlab-run.1`. To have them found by `man frictionlab-run`:
///
///   frictionlab manual ~/.local/share/man/man1 --force
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct ManualArgs {
    /// The folder, new or empty
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// What is written
    #[arg(long, value_enum, default_value_t = Format::Man)]
    format: Format,
    /// Write into a folder that is not empty, and replace files of the same names
    #[arg(long)]
    force: bool,
}

/// What a manual is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Manual pages, one a command
    Man,
    /// One Markdown page, commands.md, with the help of every command
    Markdown,
}

/// Writes it; `command` is the whole command.
///
/// # Errors
/// A folder that holds something, or that cannot be written.
pub fn execute(args: &ManualArgs, command: &Command) -> anyhow::Result<()> {
    let mut command = command.clone();
    command.build();
    let folder = Folder::reserve(Some(&args.folder), RUNS.as_ref(), "manual", args.force)?;
    let files = match args.format {
        Format::Man => man_pages(&command)?,
        Format::Markdown => vec![("commands.md".to_owned(), markdown(&command))],
    };
    let files: Vec<_> = files.iter().map(|(name, text)| (name.as_str(), text.clone())).collect();
    Ok(folder.write(&files)?)
}

/// The command and every command beneath it but `help`, which has nothing of its own to say.
fn all(command: &Command) -> Vec<&Command> {
    let beneath = command.get_subcommands().filter(|command| command.get_name() != "help");
    std::iter::once(command).chain(beneath.flat_map(all)).collect()
}

/// A page a command, with its name as a file.
fn man_pages(command: &Command) -> std::io::Result<Vec<(String, String)>> {
    let page = |command: &Command| {
        let mut page = Vec::new();
        Man::new(command.clone()).render(&mut page)?;
        let name = command.get_display_name().unwrap_or(command.get_name());
        Ok((format!("{name}.1"), String::from_utf8_lossy(&page).into_owned()))
    };
    all(command).into_iter().map(page).collect()
}

/// One page with the help of every command.
fn markdown(command: &Command) -> String {
    let mut page = String::from(
        "<!-- Made by `cargo xtask book` from the commands' definitions. -->\n\n# Commands\n\n\
         What `frictionlab COMMAND --help` prints. `frictionlab COMMAND -h` is shorter.\n",
    );
    for command in all(command) {
        let name = command.get_bin_name().unwrap_or(command.get_name());
        let help = command.clone().term_width(WIDTH).render_long_help().to_string();
        // Writing to a string cannot fail.
        let _ = write!(page, "\n## {name}\n\n```text\n");
        help.trim_end().lines().for_each(|line| {
            let _ = writeln!(page, "{}", line.trim_end());
        });
        page += "```\n";
    }
    page
}
