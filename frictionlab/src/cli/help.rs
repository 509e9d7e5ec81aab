//! What all commands have in common on the command line: groups, short options, and help that fits
//! the terminal.

use std::fmt::Write;

use clap::{Arg, Command};

/// The commands by what a person wants to do.
const GROUPS: [(&str, &[&str]); 8] = [
    ("Measure", &["run", "protocols"]),
    (
        "Identify",
        &[
            "look",
            "identify",
            "identify-drive",
            "identify-servo",
            "identify-stiction",
            "compare",
            "samples",
        ],
    ),
    ("Compensate", &["commission", "design", "monte-carlo"]),
    ("Live on ROS 2", &["live", "launch", "node", "serve", "security"]),
    ("Rig", &["rig", "doctor"]),
    ("Science", &["models", "simulate", "export", "features", "truth-matrix"]),
    ("Files", &["runs", "report", "bag", "view"]),
    ("Help", &["completions", "manual"]),
];

/// One meaning for each short option, in every command.
const SHORT: [(&str, char); 5] =
    [("quiet", 'q'), ("verbose", 'v'), ("model", 'm'), ("out", 'o'), ("jobs", 'j')];

/// Longest line of an example that is not parted from its remark.
const EXAMPLE: usize = 78;

/// The command with its groups, short options and help as they are everywhere; negative numbers are
/// values.
#[must_use]
pub fn prepared(command: Command) -> Command {
    let groups = groups(&command);
    let template = format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}\nOptions:\n{{options}}{{after-help}}"
    );
    uniform(command).help_template(template).after_help(
        "Each command says more: `frictionlab COMMAND --help`. Start with `frictionlab run --quick`; results go to numbered folders under runs/.",
    )
}

/// Every command with what it does, group by group; what is in no group comes last.
fn groups(command: &Command) -> String {
    let about = |name: &str| {
        let found = command.get_subcommands().find(|command| command.get_name() == name)?;
        Some(found.get_about().map(ToString::to_string).unwrap_or_default())
    };
    let known = |name: &str| GROUPS.iter().any(|(_, names)| names.contains(&name));
    let others: Vec<&str> =
        command.get_subcommands().map(Command::get_name).filter(|name| !known(name)).collect();
    let mut text = String::new();
    for (title, names) in GROUPS.iter().copied().chain([("Others", others.as_slice())]) {
        let lines: Vec<_> = names.iter().filter_map(|name| Some((name, about(name)?))).collect();
        if lines.is_empty() {
            continue;
        }
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{title}:");
        for (name, about) in lines {
            let _ = writeln!(text, "  {name:<18} {about}");
        }
    }
    text
}

/// Short options by the table above, values that may be negative, and long texts that wrap, here
/// and in all subcommands.
fn uniform(command: Command) -> Command {
    let long = command.get_long_about().map(|text| flowing(&text.to_string()));
    let command = command.mut_args(|arg: Arg| {
        let takes = arg.get_action().takes_values();
        let short = arg.get_long().and_then(|long| SHORT.iter().find(|(name, _)| *name == long));
        let arg = match short {
            Some((_, short)) => arg.short(*short),
            None => arg,
        };
        // `--gain -1` is a gain, wherever it comes: whether it may be negative is said by whoever
        // reads it, in words.
        arg.allow_negative_numbers(takes)
    });
    let command = match long {
        Some(long) => command.long_about(long),
        None => command,
    };
    command.mut_subcommands(uniform)
}

/// Text whose paragraphs are one line each, for the terminal to wrap. Lines that begin with a space
/// are examples and stay; where a remark behind one is too far to the right, it stands above.
fn flowing(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    let mut in_paragraph = false;
    for line in text.lines() {
        if line.starts_with(' ') {
            match line.split_once(" # ") {
                Some((example, remark)) if line.len() > EXAMPLE => {
                    lines.push(format!("  # {}", remark.trim()));
                    lines.push(example.trim_end().to_owned());
                }
                _ => lines.push(line.to_owned()),
            }
            in_paragraph = false;
        } else if line.is_empty() {
            lines.push(String::new());
            in_paragraph = false;
        } else if let Some(last) = lines.last_mut().filter(|_| in_paragraph) {
            last.push(' ');
            last.push_str(line);
        } else {
            lines.push(line.to_owned());
            in_paragraph = true;
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_flow_and_examples_stay() {
        let text = "One\ntwo.\n\nThree:\n\n  frictionlab run   # short\n  frictionlab monte-carlo --plant all --model lugre,gms,xiong,proposed --draws 100     # far away\n";
        assert_eq!(
            flowing(text),
            "One two.\n\nThree:\n\n  frictionlab run   # short\n  # far away\n  frictionlab monte-carlo --plant all --model lugre,gms,xiong,proposed --draws 100"
        );
    }
}
