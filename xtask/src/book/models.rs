//! One page a friction model under `docs/reference/models/`.
//!
//! A page is made of what exists already: the text at the head of the model's source file, its
//! parameter table, and the figures that the tests of `friction_features` hold. A test here fails
//! when the pages on disk are not what would be made.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use friction_model::{AnyParameters, ModelName, Parameter};
use serde_json::Value;

/// Figures shown on a page: the name in the snapshot, what it is, its unit and the factor into it.
const FIGURES: &[(&str, &str, &str, f64)] = &[
    ("stick_slip.period", "Stick-slip, 1 kg on 2 N/m pulled at 0.1 m/s: period", "s", 1.0),
    ("stick_slip.velocity_max", "... largest velocity", "m/s", 1.0),
    ("stick_slip.spring_max", "... largest spring force", "N", 1.0),
    ("stick_slip.spring_min", "... smallest spring force", "N", 1.0),
    ("non_drift.drift_per_cycle", "Drift a cycle under 0.4 ± 0.2 N", "um", 1e6),
    ("non_local_memory.closure_gap", "Inner loop: closure gap over its height", "%", 100.0),
    ("non_local_memory.wiping_out_error", "... wiping-out error", "mN", 1e3),
    ("non_local_memory.congruency_error", "... congruency error over its height", "%", 100.0),
    ("breakaway[0.1].friction_max", "Breakaway at 0.1 N/s: largest friction", "N", 1.0),
    ("breakaway[0.1].displacement", "... displacement there", "mm", 1e3),
    ("breakaway[0.1].applied_at_threshold", "... applied force at 1 mm/s", "N", 1.0),
    ("test_bed_lag[1].area", "Frictional lag, test bed, 1 rad/s: area of the loop", "uW", 1e6),
    ("test_bed_lag[10].area", "... 10 rad/s", "uW", 1e6),
    ("steady_state.error", "Steady sliding: largest distance from its curve", "uN", 1e6),
    (
        "zero_crossing[0.1].displacement_to_zero",
        "Reversal at 0.1 m/s^2: travel to zero force",
        "mm",
        1e3,
    ),
    ("zero_crossing[0.1].displacement_to_sliding", "... travel to forward sliding", "mm", 1e3),
    ("sensitivity.rms_elasticity", "Root mean square elasticity of breakaway and lag", "-", 1.0),
];

/// Writes the pages.
///
/// # Errors
/// A source, the snapshot or a page that cannot be read or written.
pub fn write(root: &Path) -> Result<()> {
    let folder = root.join("docs/reference/models");
    fs::create_dir_all(&folder)?;
    for (file, text) in pages(root)? {
        fs::write(folder.join(&file), text).with_context(|| format!("cannot write {file}"))?;
    }
    Ok(())
}

/// All pages: file name and text.
fn pages(root: &Path) -> Result<Vec<(String, String)>> {
    let snapshot = root.join("friction_features/tests/snapshots/features.json");
    let text = fs::read_to_string(&snapshot)
        .with_context(|| format!("cannot read {}", snapshot.display()))?;
    let figures: Value =
        serde_json::from_str(&text).context("the snapshot of the features is no JSON")?;
    let mut pages = Vec::new();
    let mut index = String::from(
        "# Friction models\n\nOne page each, made by `cargo xtask book` from the source, the parameter table and the tested figures.\n\n\
         | model | name in files | what it is |\n|---|---|---|\n",
    );
    for name in ModelName::ALL {
        let file = ["", "/mod"].map(|end| format!("friction_model/src/{name}{end}.rs"));
        let file = file.into_iter().find(|file| root.join(file).exists()).unwrap_or_default();
        let source = root.join(&file);
        let text = fs::read_to_string(&source)
            .with_context(|| format!("cannot read {}", source.display()))?;
        let head = head(&text);
        ensure!(!head.trim().is_empty(), "{} has no text at its head", source.display());
        writeln!(
            index,
            "| [{}]({name}.md) | `{name}` | {} |",
            name.title(),
            first_sentence(&head)
        )?;
        pages.push((format!("{name}.md"), page(name, &file, &head, &figures[name.as_str()])?));
    }
    pages.push(("README.md".to_owned(), index));
    Ok(pages)
}

fn page(name: ModelName, file: &str, head: &str, figures: &Value) -> Result<String> {
    let mut page = format!(
        "<!-- Made by `cargo xtask book` from {file}; edit that file. -->\n\n# {}\n\n{head}\n",
        name.title()
    );
    page += "\n## Parameters in files\n\n| parameter | unit | range | test bed | chapter 3 |\n|---|---|---|---|---|\n";
    let (test_bed, chapter_3) = (AnyParameters::test_bed(name), AnyParameters::chapter_3(name));
    for row in test_bed.table() {
        let Parameter { name, unit, range, optional, .. } = row;
        let unit = match (unit.rotary(), unit.linear()) {
            ("", _) => "-".to_owned(),
            (rotary, linear) if rotary == linear => rotary.to_owned(),
            (rotary, linear) => format!("{rotary} or {linear}"),
        };
        let optional = if *optional { ", may be left out" } else { "" };
        let (a, b) = (values(&test_bed, name), values(&chapter_3, name));
        writeln!(page, "| `{name}` | {unit} | {range}{optional} | {a} | {b} |")?;
    }
    writeln!(page, "\n`frictionlab models {name} --yaml` prints a file to start from.\n")?;
    page += "## What it reproduces\n\n";
    if figures.is_null() {
        page += "Its figures are one draw of random numbers each. The tests hold its bound, its mean and its scatter instead; `frictionlab features` draws it.\n";
        return Ok(page);
    }
    page += "With the set of chapter 3, and of the test bed where it says so. The tests of `friction_features` compute these figures anew; \
             `frictionlab features` draws them.\n\n| experiment | value |\n|---|---|\n";
    for (figure, what, unit, factor) in FIGURES {
        let value = match figures[figure]["value"].as_f64() {
            Some(value) => with_unit(value * factor, unit),
            None => "none".to_owned(),
        };
        writeln!(page, "| {what} | {value} |")?;
    }
    Ok(page)
}

/// Five significant digits; what is only rounding is zero.
fn with_unit(value: f64, unit: &str) -> String {
    let unit = if unit == "-" { String::new() } else { format!(" {unit}") };
    if value.abs() < 1e-6 {
        return format!("0{unit}");
    }
    let digits = (4 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{value:.digits$}{unit}")
}

/// The numbers of a parameter as text.
fn values(parameters: &AnyParameters, name: &str) -> String {
    let mut list = Vec::new();
    parameters.each(name, &mut |value| list.push(short(value)));
    if list.is_empty() { "left out".to_owned() } else { list.join(", ") }
}

/// At most five significant digits.
fn short(value: f64) -> String {
    let exponent = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    if (-4..6).contains(&exponent) {
        let text = format!("{value:.*}", (4 - exponent).clamp(0, 9) as usize);
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        format!("{value:.4e}")
    }
}

/// The `//!` text at the head of a source file, with links to code as code and units as they are.
fn head(source: &str) -> String {
    let mut text = String::new();
    for line in source.lines().map_while(|line| line.strip_prefix("//!")) {
        text += line.strip_prefix(' ').unwrap_or(line);
        text.push('\n');
    }
    let text = text.replace("\\[", "[").replace("\\]", "]");
    text.replace("[`crate::", "[`").replace("[`", "`").replace("`]", "`").trim_end().to_owned()
}

/// The first sentence, on one line.
fn first_sentence(head: &str) -> String {
    let paragraph: Vec<&str> = head.lines().take_while(|line| !line.trim().is_empty()).collect();
    let text = paragraph.join(" ");
    text.split_inclusive(". ").next().unwrap_or(&text).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pages_on_disk_are_up_to_date() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        for (file, text) in pages(root).unwrap() {
            let path = root.join("docs/reference/models").join(&file);
            let disk = fs::read_to_string(&path).unwrap_or_default();
            assert!(
                disk == text,
                "docs/reference/models/{file} is not what its sources say: run `cargo xtask book`"
            );
        }
    }

    #[test]
    fn numbers_are_short_and_lose_nothing_that_matters() {
        for (value, text) in [
            (0.0994, "0.0994"),
            (1e5, "100000"),
            (316.227_766, "316.23"),
            (0.0, "0"),
            (7e-6, "7.0000e-6"),
        ] {
            assert_eq!(short(value), text);
        }
        assert_eq!(with_unit(7.927_48, "s"), "7.9275 s");
        assert_eq!(with_unit(-1e-12, "um"), "0 um");
        assert_eq!(with_unit(0.41, "-"), "0.41000");
    }

    #[test]
    fn the_head_of_a_file_is_its_text_without_links() {
        let source = "//! A model, see [`crate::Proposed`]. More.\n//!\n//! ```text\n//! F\n//! ```\n\nuse x;\n//! not this\n";
        let head = head(source);
        assert_eq!(head, "A model, see `Proposed`. More.\n\n```text\nF\n```");
        assert_eq!(first_sentence(&head), "A model, see `Proposed`.");
    }
}
