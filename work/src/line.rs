//! The options of a command without its program: whoever asks in another way than on a terminal is
//! held to the same names, ranges and complaints.

use clap::{Args, CommandFactory, FromArgMatches, Parser};

use crate::BadInput;

#[derive(Debug, Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Line<A: Args> {
    #[command(flatten)]
    args: A,
}

/// Reads a command line, without the program and the command in front of it.
///
/// # Errors
/// [`BadInput`] says in a sentence what the command would complain of.
pub fn parse<A: Args>(line: &[String]) -> Result<A, BadInput> {
    let mut command = Line::<A>::command();
    command
        .try_get_matches_from_mut(line)
        .and_then(|found| Line::<A>::from_arg_matches(&found))
        .map_or_else(|error| Err(BadInput(sentence(&error))), |Line { args }| Ok(args))
}

/// What clap says, without the parts that speak of a terminal.
fn sentence(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let end =
        ["\n\nUsage:", "\n\nFor more information"].iter().filter_map(|mark| text.find(mark)).min();
    let text = text.get(..end.unwrap_or(text.len())).unwrap_or(&text);
    let words: Vec<&str> = text.trim_start_matches("error:").split_whitespace().collect();
    words.join(" ")
}
