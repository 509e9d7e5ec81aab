//! What the README shows of a command's output is what the command prints.
//!
//! A line `<!-- prints: run characterise -->` before a block of the README names the words behind `frictionlab`; all commands run in one folder, in their
//! order, so that later ones find what earlier ones wrote. Every line of the block must be a line of the output, in the same order; the block may leave
//! lines out. `UPDATE_DOCS=1` writes lines anew that differ in their figures only.

use std::{fs, path::Path};

use tests::{checkout, frictionlab, shared_data, skip};

/// A block and what makes it.
struct Shown<'a> {
    words: Vec<&'a str>,
    lines: Vec<&'a str>,
}

/// Recordings that are not part of the project, by the names that the README's commands have for them.
const RECORDINGS: [(&str, &str); 4] = [
    ("estimation.csv", "emps/estimation.csv"),
    ("validation.csv", "emps/validation.csv"),
    ("episode_1.csv", "qube_servo/episode_1.csv"),
    ("episode_2.csv", "qube_servo/episode_2.csv"),
];

fn blocks(page: &str) -> Vec<Shown<'_>> {
    let mut lines = page.lines();
    let mut found = Vec::new();
    while let Some(line) = lines.next() {
        let Some(words) = line.strip_prefix("<!-- prints: ").and_then(|rest| rest.strip_suffix(" -->")) else {
            continue;
        };
        assert!(
            lines.next().is_some_and(|line| line.starts_with("```")),
            "behind `{line}` a block was expected"
        );
        let shown = lines.by_ref().take_while(|line| !line.starts_with("```")).collect();
        found.push(Shown { words: words.split_whitespace().collect(), lines: shown });
    }
    found
}

/// A line without its figures and the blanks that depend on their widths.
fn wording(line: &str) -> String {
    let is_figure = |word: &str| word.chars().any(|c| c.is_ascii_digit());
    line.split_whitespace().filter(|word| !is_figure(word)).collect::<Vec<_>>().join(" ")
}

/// The lines as the output has them now, or the first that it has not.
fn renewed<'a>(shown: &[&'a str], output: &'a str) -> Result<Vec<&'a str>, &'a str> {
    let mut printed = output.lines().map(str::trim_end);
    let mut renewed = Vec::new();
    for line in shown {
        let alike = printed.clone().find(|other| other == line);
        let alike = alike.or_else(|| printed.clone().find(|other| wording(other) == wording(line))).ok_or(*line)?;
        renewed.push(alike);
        let _ = printed.find(|other| *other == alike);
    }
    Ok(renewed)
}

fn recordings(folder: &Path) -> bool {
    let Some(data) = shared_data() else { return false };
    RECORDINGS.iter().all(|(name, file)| fs::copy(data.join(file), folder.join(name)).is_ok())
}

#[test]
fn the_readme_shows_what_its_commands_print() {
    let path = checkout().join("README.md");
    let page = fs::read_to_string(&path).expect("the README");
    let blocks = blocks(&page);
    assert!(!blocks.is_empty(), "the README shows no output");
    let folder = tempfile::tempdir().expect("a folder");
    let recorded = recordings(folder.path());
    let update = std::env::var_os("UPDATE_DOCS").is_some();
    let mut anew = page.clone();
    for Shown { words, lines } in &blocks {
        let command = words.join(" ");
        if !recorded && RECORDINGS.iter().any(|(name, _)| words.contains(name)) {
            skip(&format!("`frictionlab {command}`: the recordings are not at hand"));
            continue;
        }
        let output = frictionlab().args(words).current_dir(folder.path()).output().expect("it starts");
        let (printed, said) =
            (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success(), "frictionlab {command}: {said}");
        let renewed = renewed(lines, &printed);
        let now = renewed.unwrap_or_else(|line| panic!("`frictionlab {command}` has no line\n{line}\nbut\n{printed}"));
        if update {
            anew = anew.replacen(&lines.join("\n"), &now.join("\n"), 1);
        } else {
            assert_eq!(lines, &now, "`frictionlab {command}` prints other figures: run the test with UPDATE_DOCS=1");
        }
    }
    if update {
        fs::write(&path, anew).expect("the README can be written");
    }
}

#[test]
fn another_figure_is_found_and_a_missing_line_named() {
    let output = "Stribeck curve\n  f_s  0.09932 ± 8e-5 N m\n  f_c  0.09248 ± 4e-5 N m\nReport  x\n";
    let shown = ["  f_s  0.0994 ± 9e-5 N m", "  f_c  0.09248 ± 4e-5 N m"];
    assert_eq!(renewed(&shown, output), Ok(vec!["  f_s  0.09932 ± 8e-5 N m", shown[1]]));
    assert_eq!(renewed(&["  f_v  0.04 N m s/rad"], output), Err("  f_v  0.04 N m s/rad"));
    // The order is that of the output.
    assert_eq!(renewed(&[shown[1], shown[0]], output), Err(shown[0]));
}
