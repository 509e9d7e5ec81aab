//! The commands on the pages work, and print what the pages show.
//!
//! Blocks of commands are run or checked, as their fences say (`tests::book`).
//!
//! A line `<!-- prints: run characterise -->` before a block names the words behind `frictionlab`.
//! Every line of the block must be a line of the output, in the same order, its figures equal to
//! one unit of their last digit (another processor rounds otherwise); the block may leave lines
//! out. `UPDATE_DOCS=1` writes lines anew that differ in their figures only.
//!
//! A line `<!-- figures of: identify recording.csv -->` before a table does the same for the rows
//! that begin with "this program": each number in them must be one of the output's, to the digits
//! that the table has.

use std::collections::BTreeMap;
use std::fs;

use tests::book::{Page, Treatment, check, pages, script::Ran};
use tests::{checkout, frictionlab};

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

/// Compares what a page shows with what its commands print; writes it anew with `UPDATE_DOCS=1`.
fn hold(page: &Page, ran: &Ran) {
    let name = page.path.display();
    let update = std::env::var_os("UPDATE_DOCS").is_some();
    let mut anew = page.source.clone();
    for Shown { words, lines } in &blocks(&page.source) {
        let (command, Some(output)) = (words.join(" "), ran.printed(page, words)) else {
            continue;
        };
        let now = renewed(lines, &output).unwrap_or_else(|line| {
            panic!("{name}: `frictionlab {command}` has no line\n{line}\nbut\n{output}")
        });
        if update {
            anew = anew.replacen(&lines.join("\n"), &now.join("\n"), 1);
        } else {
            let other = lines.iter().zip(&now).find(|(line, now)| !alike(line, now));
            assert!(
                other.is_none(),
                "{name}: `frictionlab {command}` prints other figures, {other:?}: run the test with UPDATE_DOCS=1"
            );
        }
    }
    for Shown { words, lines } in rows(&page.source) {
        let Some(output) = ran.printed(page, &words) else { continue };
        for line in lines {
            let missing = missing(line, &output);
            assert!(
                missing.is_none(),
                "{name}: {missing:?} of the row\n{line}\nis not in\n{output}"
            );
        }
    }
    if update && anew != page.source {
        fs::write(checkout().join(&page.path), anew).expect("the page can be written");
    }
}

/// Whether the commands of a page are ours to run: the README's and the book's.
fn is_of_the_book(page: &Page) -> bool {
    page.path.starts_with("docs") || page.path.as_os_str() == "README.md"
}

#[test]
fn the_commands_of_the_pages_work_and_print_what_is_shown() {
    let pages: Vec<Page> = pages().into_iter().filter(is_of_the_book).collect();
    let shown: usize = pages.iter().map(|page| blocks(&page.source).len()).sum();
    assert!(shown > 5, "the pages show {shown} outputs only");
    // Their commands have threads of their own: more than a page at once gains nothing.
    let mut known = BTreeMap::new();
    for page in &pages {
        let ran = Ran::new(page, &known);
        hold(page, &ran);
        known = ran.independent();
    }
}

#[test]
fn commands_that_are_not_run_are_commands_that_there_are() {
    let mut faults = Vec::new();
    let mut checked = 0;
    for page in pages() {
        let blocks = page.blocks.iter().filter(|block| {
            let of_shell = block.treatment().expect("the words behind a fence");
            of_shell.is_some_and(|treatment| !matches!(treatment, Treatment::Run { .. }))
        });
        // Within a line, a command with a placeholder says too little to be checked.
        let whole = |span: &&String| {
            let ours = ["frictionlab ", "cargo test -p ", "cargo install "];
            let placeholder = |word: &str| {
                word.contains("...")
                    || word.len() > 2 && word.chars().all(|c| c.is_ascii_uppercase())
            };
            ours.iter().any(|start| span.starts_with(start))
                && !span.split([' ', '=']).any(placeholder)
        };
        // An option that stands there to be named has no value.
        let named = |span: &String| match span.rsplit_once(" --") {
            Some((before, option)) if !option.contains(' ') => before.to_owned(),
            _ => span.clone(),
        };
        let spans = page.spans.iter().filter(whole).map(named);
        for text in blocks.map(|block| block.text.clone()).chain(spans) {
            for words in check::commands(&text) {
                checked += 1;
                if let Err(fault) = check::check(&words) {
                    faults.push(format!("{}: {}: {fault}", page.path.display(), words.join(" ")));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(checked > 60, "only {checked} commands were found");
}

#[test]
fn a_command_that_there_is_not_is_found() {
    for command in [
        "frictionlab run --rig-flie rig.yaml",
        "frictionlab rnu",
        "frictionlab run pre-slidng",
        "cargo test -p tests --test nothing",
        "cargo install --locked --path docs",
        "cargo install --path frictionlab",
        "friction-plot --nothing",
        "ros2 launch friction_bringup nothing.launch.py",
        "ros2 topic pub /reference friction_msgs/msg/Nothing",
        "frictionlabs run",
    ] {
        let words = check::commands(command);
        assert!(check::check(&words[0]).is_err(), "{command}");
    }
    let text =
        "frictionlab run \\\n  --quick # quickly\nkill %1; frictionlab models 'a b' > x | jq .\n";
    let words: Vec<String> = check::commands(text).iter().map(|words| words.join("+")).collect();
    let expected = ["frictionlab+run+--quick", "kill+%1", "frictionlab+models+a b", "jq+."];
    assert_eq!(words, expected);
}

#[test]
fn the_page_of_the_commands_is_what_they_say() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = folder.path().join("made");
    let mut manual = frictionlab();
    let output = manual.args(["manual", "--format", "markdown"]).arg(&made).output();
    let output = output.expect("frictionlab starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = checkout().join("docs/reference/commands.md");
    let made = fs::read_to_string(made.join("commands.md")).expect("the page");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&page, &made).expect("the page can be written");
    }
    let disk = fs::read_to_string(&page).unwrap_or_default();
    let line = made.lines().zip(disk.lines()).find(|(made, disk)| made != disk);
    assert!(
        made == disk,
        "docs/reference/commands.md is not what the commands say ({line:?}): run `cargo build`, then `cargo xtask book`"
    );
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
