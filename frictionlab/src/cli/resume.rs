//! `frictionlab run --resume FOLDER`: goes on with a run that was stopped, by the words it was
//! begun with.

use std::path::{Path, PathBuf};

use clap::{CommandFactory, FromArgMatches, Parser};

use super::help::prepared;
use experiment_runner::asked::RunArgs;
use experiment_runner::run::Journal;
use work::BadInput;

#[derive(Debug, Parser)]
#[command(name = "frictionlab run")]
struct Words {
    #[command(flatten)]
    run: RunArgs,
}

/// The run that was stopped in `folder`: where it is, its arguments with what `args` says of how it
/// is told, and its journal. The program is then in the folder that the run was begun in, because
/// its words name files from there.
///
/// # Errors
/// [`BadInput`] says why it cannot go on.
pub(super) fn open(args: &RunArgs, folder: &Path) -> anyhow::Result<(PathBuf, RunArgs, Journal)> {
    let bad =
        |why: String| BadInput(format!("the run in {} cannot be resumed: {why}", folder.display()));
    let journal = Journal::open(folder)?;
    let folder = std::path::absolute(folder).map_err(|error| bad(error.to_string()))?;
    let mut given = parsed(journal.words()).map_err(|error| bad(error.to_string()))?;
    std::env::set_current_dir(journal.directory()).map_err(|error| {
        bad(format!(
            "it was begun in {}, where its files are: {error}",
            journal.directory().display()
        ))
    })?;
    given.jobs = args.jobs.or(given.jobs);
    (given.quiet, given.saying) = (args.quiet, args.saying);
    Ok((folder, given, journal))
}

fn parsed(words: &[String]) -> Result<RunArgs, clap::Error> {
    let given = prepared(Words::command())
        .try_get_matches_from(["run"].into_iter().chain(words.iter().map(String::as_str)))?;
    Words::from_arg_matches(&given).map(|words| words.run)
}

/// What stands behind `run` on this program's command line; nothing if it is no text.
pub(super) fn words() -> Option<Vec<String>> {
    let behind = std::env::args_os().skip_while(|word| word != "run").skip(1);
    behind.map(|word| word.into_string().ok()).collect()
}

/// How to go on with the run in `folder`, if it can.
pub(super) fn hint(folder: &Path) -> String {
    if Journal::is_in(folder) {
        format!("; `frictionlab run --resume {}` goes on with it", folder.display())
    } else {
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use experiment_runner::asked::NOT_RESUMED;

    use super::*;

    #[test]
    fn a_run_that_goes_on_has_every_option_already_but_how_it_is_told() {
        let command = prepared(Words::command());
        let known = ["resume", "jobs", "quiet", "json", "verbose", "help"];
        for arg in command.get_arguments() {
            let name = arg.get_id().as_str();
            assert!(NOT_RESUMED.contains(&name) != known.contains(&name), "{name}");
        }
        let refused = |words: &[&str]| {
            prepared(Words::command()).try_get_matches_from(["run"].iter().chain(words)).is_err()
        };
        assert!(!refused(&["--resume", "runs/all-1", "--jobs", "2", "--quiet", "--json"]));
        for other in [
            ["--seed", "2"],
            ["--out", "x"],
            ["--rig", "simulated"],
            ["velocity-tracking", "--quick"],
        ] {
            assert!(refused(&["--resume", "runs/all-1", other[0], other[1]]), "{other:?}");
        }
    }

    #[test]
    fn words_are_read_again() {
        let words = ["constant-velocity", "--quick", "--seed", "7", "-q"].map(str::to_owned);
        let args = parsed(&words).unwrap();
        assert!(args.quick && args.quiet && args.seed == 7);
    }
}
