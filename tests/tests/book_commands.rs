//! What the README shows of a command's output is what the command prints.
//!
//! A line `<!-- prints: run characterise -->` before a block of the README names the words behind
//! `frictionlab`; all commands run in one folder, in their order, so that later ones find what
//! earlier ones wrote. Every line of the block must be a line of the output, in the same order, its
//! figures equal to one unit of their last digit (another processor rounds otherwise); the block
//! may leave lines out. `UPDATE_DOCS=1` writes lines anew that differ in their figures only.
//!
//! A line `<!-- figures of: identify recording.csv -->` before a table does the same for the rows
//! that begin with "this program": each number in them must be one of the output's, to the digits
//! that the table has.

use std::{fs, path::Path};

use tests::{checkout, frictionlab, shared_data, skip};

/// A block and what makes it.
struct Shown<'a> {
    words: Vec<&'a str>,
    lines: Vec<&'a str>,
}

/// Rows of tables with the words of the command that prints their figures.
fn rows(page: &str) -> Vec<Shown<'_>> {
    let mut lines = page.lines();
    let mut found = Vec::new();
    while let Some(line) = lines.next() {
        let Some(words) =
            line.strip_prefix("<!-- figures of: ").and_then(|rest| rest.strip_suffix(" -->"))
        else {
            continue;
        };
        let table = lines.by_ref().take_while(|line| line.starts_with('|'));
        let ours: Vec<&str> = table.filter(|line| line.starts_with("| this program")).collect();
        assert!(!ours.is_empty(), "behind `{line}` a table with rows of this program was expected");
        found.push(Shown { words: words.split_whitespace().collect(), lines: ours });
    }
    found
}

/// The decimal numbers of a text, as they are written.
fn numbers(text: &str) -> Vec<&str> {
    let in_number = |c: char| c.is_ascii_digit() || ".-e".contains(c);
    let words =
        text.split(|c: char| !in_number(c)).map(|word| word.trim_end_matches(['.', 'e', '-']));
    words.filter(|word| word.contains('.') && word.parse::<f64>().is_ok()).collect()
}

/// The first number of `row` that `output` does not have to as many digits.
fn missing<'a>(row: &'a str, output: &str) -> Option<&'a str> {
    let printed: Vec<f64> =
        numbers(output).iter().filter_map(|number| number.parse().ok()).collect();
    numbers(row).into_iter().find(|number| {
        let digits = number.rsplit('.').next().map_or(0, str::len);
        let written: f64 = number.parse().unwrap_or(f64::NAN);
        !printed.iter().any(|value| {
            (value - written).abs() <= 0.5001 * 10f64.powi(-i32::try_from(digits).unwrap_or(0))
        })
    })
}

/// Recordings that are not part of the project, by the names that the README's commands have for
/// them.
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
        let Some(words) =
            line.strip_prefix("<!-- prints: ").and_then(|rest| rest.strip_suffix(" -->"))
        else {
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
        let alike = alike
            .or_else(|| printed.clone().find(|other| wording(other) == wording(line)))
            .ok_or(*line)?;
        renewed.push(alike);
        let _ = printed.find(|other| *other == alike);
    }
    Ok(renewed)
}

/// Whether two lines of the same wording have the same figures, to one unit of the last digit.
fn alike(one: &str, other: &str) -> bool {
    let figures = |line: &str| -> Vec<(f64, f64)> {
        let words = line.split(|c: char| !(c.is_ascii_digit() || ".-e".contains(c)));
        words.filter_map(|word| Some((word.parse().ok()?, unit_of_last_digit(word)))).collect()
    };
    let (one, other) = (figures(one), figures(other));
    one.len() == other.len()
        && one
            .iter()
            .zip(&other)
            .all(|((a, unit), (b, other))| (a - b).abs() <= 1.001 * unit.max(*other))
}

/// 0.001 for `1.234`, 1e-5 for `8e-5`.
fn unit_of_last_digit(number: &str) -> f64 {
    let (mantissa, exponent) = number.split_once('e').unwrap_or((number, "0"));
    let digits = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len());
    10f64.powi(exponent.parse::<i32>().unwrap_or(0) - i32::try_from(digits).unwrap_or(0))
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
    std::os::unix::fs::symlink(checkout().join("docs"), folder.path().join("docs"))
        .expect("a link");
    let printed = |words: &[&str]| {
        let command = words.join(" ");
        if !recorded && RECORDINGS.iter().any(|(name, _)| words.contains(name)) {
            skip(&format!("`frictionlab {command}`: the recordings are not at hand"));
            return None;
        }
        let output =
            frictionlab().args(words).current_dir(folder.path()).output().expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "frictionlab {command}: {said}");
        Some(String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let update = std::env::var_os("UPDATE_DOCS").is_some();
    let mut anew = page.clone();
    for Shown { words, lines } in &blocks {
        let (command, Some(output)) = (words.join(" "), printed(words)) else { continue };
        let now = renewed(lines, &output).unwrap_or_else(|line| {
            panic!("`frictionlab {command}` has no line\n{line}\nbut\n{output}")
        });
        if update {
            anew = anew.replacen(&lines.join("\n"), &now.join("\n"), 1);
        } else {
            let other = lines.iter().zip(&now).find(|(line, now)| !alike(line, now));
            assert!(
                other.is_none(),
                "`frictionlab {command}` prints other figures, {other:?}: run the test with UPDATE_DOCS=1"
            );
        }
    }
    for Shown { words, lines } in rows(&page) {
        let Some(output) = printed(&words) else { continue };
        for line in lines {
            let missing = missing(line, &output);
            assert!(missing.is_none(), "{missing:?} of the row\n{line}\nis not in\n{output}");
        }
    }
    if update {
        fs::write(&path, anew).expect("the README can be written");
    }
}

#[test]
fn another_figure_is_found_and_a_missing_line_named() {
    let output =
        "Stribeck curve\n  f_s  0.09932 ± 8e-5 N m\n  f_c  0.09248 ± 4e-5 N m\nReport  x\n";
    let shown = ["  f_s  0.0994 ± 9e-5 N m", "  f_c  0.09248 ± 4e-5 N m"];
    assert_eq!(renewed(&shown, output), Ok(vec!["  f_s  0.09932 ± 8e-5 N m", shown[1]]));
    assert_eq!(renewed(&["  f_v  0.04 N m s/rad"], output), Err("  f_v  0.04 N m s/rad"));
    // The order is that of the output.
    assert_eq!(renewed(&[shown[1], shown[0]], output), Err(shown[0]));
    assert!(alike("f_s  0.0994 ± 9e-5 N m", "f_s  0.0995 ± 8e-5 N m"));
    assert!(!alike("f_s  0.0994 ± 9e-5 N m", "f_s  0.0996 ± 9e-5 N m"));
    assert!(!alike("area 1.2e-4 N m", "area 1.4e-4 N m") && !alike("7 loops", "9 loops"));
    let row = "| this program | 95.12 ± 0.1 | 5.953 % | |";
    assert_eq!(missing(row, "M 95.1193 ± 0.11 kg, cross-test 5.9530 %"), None);
    assert_eq!(missing(row, "M 95.1293 ± 0.11 kg, cross-test 5.9530 %"), Some("95.12"));
}
