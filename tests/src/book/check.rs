//! Commands that are not run must still be commands that there are: the programs of this project
//! are asked by their own definition, what cargo is asked for must be in the workspace, and of other
//! programs the names are known.

use std::fs;
use std::process::Stdio;

use crate::{checkout, frictionlab, rig_emulator};

/// Programs of others, and words of the shell.
const OTHERS: [&str; 17] = [
    "ros2", "colcon", "cmake", "cc", "pip", "rerun", "jq", "mkdir", "ln", "cd", "source", "export",
    "kill", "for", "do", "done", "apt-get",
];

/// The commands of a block, one a line, as words: lines that end in a backslash are joined, and
/// what is behind `#`, `|`, `>`, `&` and `;` is cut off or a command of its own.
#[must_use]
pub fn commands(text: &str) -> Vec<Vec<String>> {
    let mut found = vec![Vec::new()];
    let mut word = String::new();
    let mut quote: Option<char> = None;
    let (mut comment, mut redirected) = (false, false);
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match (quote, letter) {
            (_, '\n') if quote.is_none() => comment = false,
            _ if comment => continue,
            (Some(end), _) => {
                if letter == end {
                    quote = None;
                } else {
                    word.push(letter);
                }
                continue;
            }
            (None, '\'' | '"') => {
                quote = Some(letter);
                continue;
            }
            (None, '\\') if letters.peek() == Some(&'\n') => {
                letters.next();
                continue;
            }
            (None, '#') if word.is_empty() => comment = true,
            _ => {}
        }
        let ends_word = comment || " \t\n|>&;".contains(letter);
        if !ends_word {
            word.push(letter);
            continue;
        }
        if !word.is_empty() {
            let word = std::mem::take(&mut word);
            if !std::mem::take(&mut redirected) {
                found.last_mut().expect("never empty").push(word);
            }
        }
        match letter {
            '>' => redirected = true,
            '\n' | '|' | '&' | ';' if !found.last().is_some_and(Vec::is_empty) => {
                found.push(Vec::new());
            }
            _ => {}
        }
    }
    found.last_mut().expect("never empty").extend((!word.is_empty()).then_some(word));
    found.retain(|words| !words.is_empty());
    found
}

/// Checks one command.
///
/// # Errors
/// What is wrong with it.
pub fn check(words: &[String]) -> Result<(), String> {
    // Variables that are set for the command stand before it.
    let is_set = |word: &&&str| {
        word.split_once('=').is_some_and(|(name, _)| {
            !name.is_empty() && name.chars().all(|c| c.is_ascii_uppercase() || c == '_')
        })
    };
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let variables = words.iter().take_while(is_set).count();
    match &words[variables..] {
        ["frictionlab", rest @ ..] | ["cargo", "run", "--release", "--", rest @ ..] => {
            ours(frictionlab(), rest)
        }
        ["rig_emulator", rest @ ..] => ours(rig_emulator(), rest),
        // The tasks are held to their own definition by a test of xtask.
        ["cargo", "xtask", ..] => Ok(()),
        // Without `--locked`, cargo takes the newest version of all that the program stands on.
        ["cargo", "install", "--locked", "--path", folder, rest @ ..] => {
            let known = folder.starts_with('$') || has_program(folder);
            let rest = rest.iter().all(|word| *word == "--no-default-features");
            (known && rest).then_some(()).ok_or(format!("{folder} has no program to install"))
        }
        ["cargo", "build" | "test" | "run", rest @ ..] => cargo(rest),
        [
            name @ ("friction-plot" | "friction-table" | "friction-live" | "friction-run"
            | "friction-fleet"),
            rest @ ..,
        ] => python(name, rest),
        // The command that is done in shares stands behind two dashes.
        ["friction-search", rest @ ..] => {
            let own = rest.iter().take_while(|word| **word != "--").count();
            python("friction-search", &rest[..own])?;
            check(&owned(rest.get(own + 1..).unwrap_or_default()))
        }
        ["ros2", rest @ ..] => ros2(rest),
        ["cd", "python"] => Ok(()),
        ["do", rest @ ..] if !rest.is_empty() => check(&owned(rest)),
        ["pytest" | "mypy" | "ruff", ..] => Ok(()),
        [name, ..] if OTHERS.contains(name) => Ok(()),
        [name, ..] => Err(format!("`{name}` is a program that no test knows")),
        [] => Ok(()),
    }
}

fn owned(words: &[&str]) -> Vec<String> {
    words.iter().map(ToString::to_string).collect()
}

/// Asks one of our programs: it reads the line up to `--help`, refuses what it does not know, and
/// does nothing else. Arguments of ROS, and what a node reads itself, are left out.
fn ours(mut program: std::process::Command, words: &[&str]) -> Result<(), String> {
    let own = match words {
        ["node", node, ..] => &["node", node][..],
        _ => words.split(|word| *word == "--ros-args").next().unwrap_or_default(),
    };
    let output = program.args(own).arg("--help").stdin(Stdio::null()).output();
    let output = output.map_err(|error| format!("it does not start: {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    output.status.success().then_some(()).ok_or(said.into_owned())
}

/// Whether a folder is a package with a program.
fn has_program(folder: &str) -> bool {
    let manifest = fs::read_to_string(checkout().join(folder).join("Cargo.toml"));
    let program = checkout().join(folder).join("src/main.rs").is_file();
    manifest.is_ok_and(|text| program || text.contains("[[bin]]"))
}

/// Packages, examples, tests and features that cargo is asked for must be there.
fn cargo(words: &[&str]) -> Result<(), String> {
    let mut packages = Vec::new();
    let mut parts = words.iter().take_while(|word| **word != "--");
    while let Some(word) = parts.next() {
        let Some(value) = (match *word {
            "-p" | "--package" | "--example" | "--test" | "--features" => parts.next(),
            // A part of a test's name.
            filter if !filter.starts_with('-') => continue,
            "--release" | "--lib" | "--workspace" | "--locked" | "--all-targets" => continue,
            other => return Err(format!("`{other}` is a word of cargo that no test knows")),
        }) else {
            return Err(format!("`{word}` says nothing"));
        };
        let in_one = |file: &str| {
            packages.iter().any(|package| checkout().join(package).join(file).exists())
        };
        let there = match *word {
            "-p" | "--package" => {
                packages.push(*value);
                checkout().join(value).join("Cargo.toml").is_file()
            }
            "--example" => {
                in_one(&format!("examples/{value}.rs")) || in_one(&format!("examples/{value}"))
            }
            "--test" => {
                in_one(&format!("tests/{value}.rs")) || in_one(&format!("tests/{value}/main.rs"))
            }
            _ => packages.is_empty() || in_one("Cargo.toml"),
        };
        if !there {
            return Err(format!("there is no {word} {value}"));
        }
    }
    Ok(())
}

/// Options of the Python commands stand in their sources.
fn python(name: &str, words: &[&str]) -> Result<(), String> {
    let modules: &[&str] = match name {
        "friction-plot" => &["friction_analysis/figures.py"],
        "friction-table" => &["friction_analysis/table.py"],
        "friction-live" => &["friction_analysis/live.py"],
        "friction-fleet" => &["frictionlab/fleet/cli.py"],
        // The options of engines are those of a fleet.
        "friction-search" => &["frictionlab/fleet/search/cli.py", "frictionlab/fleet/cli.py"],
        _ => &["friction_analysis/experiment.py"],
    };
    let read = |module: &&str| fs::read_to_string(checkout().join("python").join(module));
    let sources: Vec<String> =
        modules.iter().map(read).collect::<Result<_, _>>().map_err(|error| error.to_string())?;
    let known = |word: &str| sources.iter().any(|source| source.contains(&format!("\"{word}\"")));
    let unknown = words.iter().find(|word| word.starts_with("--") && !known(word));
    unknown.map_or(Ok(()), |word| Err(format!("{name} has no {word}")))
}

/// What of ROS is ours must be there: launch files, messages, services and actions.
fn ros2(words: &[&str]) -> Result<(), String> {
    let launch = checkout().join("launch_configs/launch");
    if let ["launch", "friction_bringup", file, ..] = words
        && !launch.join(file).is_file()
    {
        return Err(format!("friction_bringup has no {file}"));
    }
    for (package, kind) in words.iter().filter_map(|word| word.split_once('/')) {
        let file = checkout()
            .join("msgs/friction_msgs")
            .join(kind)
            .with_extension(kind.split('/').next().unwrap_or_default());
        if package == "friction_msgs" && !file.is_file() {
            return Err(format!("there is no {package}/{kind}"));
        }
    }
    Ok(())
}
