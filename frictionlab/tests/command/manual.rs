//! Completions and manual pages speak of every command.

use std::collections::BTreeSet;
use std::fs;
use std::process::{Command, Output};

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frictionlab")).args(args).output().unwrap()
}

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The commands that the help lists, below a command.
fn listed(command: &[&str]) -> BTreeSet<String> {
    let help = text(&run(&[command, &["--help"]].concat()));
    // They stand in one list, or in groups between the usage and the options.
    let list = match help.split_once("\nCommands:\n") {
        Some((_, list)) => list.split("\n\n").next(),
        None if command.is_empty() => {
            help.split("Usage:").nth(1).and_then(|rest| rest.split("Options:").next())
        }
        None => None,
    };
    let name = |line: &str| {
        let name = line.strip_prefix("  ").filter(|line| !line.starts_with(' '))?;
        name.split(' ').next().filter(|word| *word != "help").map(str::to_owned)
    };
    list.unwrap_or_default().lines().filter_map(name).collect()
}

#[test]
fn each_shell_completes_every_command() {
    let commands = listed(&[]);
    assert!(commands.len() > 15, "{commands:?}");
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = text(&run(&["completions", shell]));
        for command in &commands {
            assert!(script.contains(command.as_str()), "{shell} does not know {command}");
        }
        assert!(script.contains("--rig-file") || script.contains("rig-file"), "{shell}");
    }
    assert_eq!(run(&["completions", "tcsh"]).status.code(), Some(2));
}

#[test]
fn bash_completes_commands_options_and_values() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("frictionlab.bash");
    fs::write(&script, run(&["completions", "bash"]).stdout).unwrap();
    let complete = |words: &str, last: usize| {
        let asked = format!(
            "source {}; COMP_WORDS=({words}); COMP_CWORD={last}; COMP_LINE='{words}'; \
             _frictionlab frictionlab \"${{COMP_WORDS[{last}]}}\" \"${{COMP_WORDS[{last}-1]}}\"; \
             echo \"${{COMPREPLY[@]}}\"",
            script.display()
        );
        let said = Command::new("bash").args(["-c", &asked]).output().expect("bash starts");
        String::from_utf8_lossy(&said.stdout).trim().to_owned()
    };
    assert_eq!(complete("frictionlab mod", 1), "models");
    assert_eq!(complete("frictionlab rig cal", 2), "calibrate");
    assert_eq!(complete("frictionlab run --rig-f", 2), "--rig-file");
    assert_eq!(complete("frictionlab run pre-s", 2), "pre-sliding");
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("man1");
    let named = pages.to_str().unwrap();
    text(&run(&["manual", named]));
    let mut expected = BTreeSet::from(["frictionlab.1".to_owned()]);
    for command in listed(&[]) {
        expected.insert(format!("frictionlab-{command}.1"));
        let beneath = listed(&[&command]);
        if ["bag", "design", "node", "rig", "runs", "security"].contains(&command.as_str()) {
            assert!(!beneath.is_empty(), "{command}");
            expected.extend(beneath.iter().map(|word| format!("frictionlab-{command}-{word}.1")));
        }
    }
    let written: BTreeSet<String> = fs::read_dir(&pages)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(written, expected);
    let page = fs::read_to_string(pages.join("frictionlab-rig-check.1")).unwrap();
    assert!(page.contains(".TH") && page.contains("rig\\-file"), "{page}");
    // What is there is not replaced unasked.
    assert_eq!(run(&["manual", named]).status.code(), Some(2));
    text(&run(&["manual", named, "--force"]));
}
