//! What `frictionlab models` prints.

use std::fmt::Write;

use friction_model::{ModelName, Parameter, Range};
use serde_json::Value;

use super::{Preset, values};

/// Widest line.
const WIDTH: usize = 110;

/// Every model with its name and its parameters.
#[must_use]
pub fn list() -> String {
    let rows = ModelName::ALL.map(|name| {
        let names: Vec<_> =
            Preset::TestBed.parameters(name).table().iter().map(|row| row.name).collect();
        [name.as_str().to_owned(), name.title().to_owned(), names.join(", ")]
    });
    let mut text = columns(["NAME", "MODEL", "PARAMETERS"], &rows);
    text.push_str(
        "\nWhat the parameters are    frictionlab models NAME\n\
         A parameter file           frictionlab models NAME --yaml > params.yaml\n",
    );
    text
}

/// Models with their parameters and values, for programs.
#[must_use]
pub fn document(names: &[ModelName], preset: Preset) -> serde_json::Value {
    let model = |name: &ModelName| {
        let parameters = preset.parameters(*name);
        let values = values(&parameters);
        let rows: Vec<_> = parameters
            .table()
            .iter()
            .map(|row| {
                let (_, conditions) = explained(row.meaning);
                serde_json::json!({
                    "name": row.name,
                    "unit_rotary": row.unit.rotary(),
                    "unit_linear": row.unit.linear(),
                    "range": range(row, &conditions),
                    "value": values.get(row.name),
                    "meaning": row.meaning,
                })
            })
            .collect();
        serde_json::json!({"name": name.as_str(), "title": name.title(), "parameters": rows})
    };
    let models: Vec<_> = names.iter().map(model).collect();
    serde_json::json!({"format": "frictionlab-models", "format_version": 1, "models": models})
}

/// One model: each parameter with its units, range, value in `preset` and meaning.
#[must_use]
pub fn model(name: ModelName, preset: Preset) -> String {
    let parameters = preset.parameters(name);
    let values = values(&parameters);
    let rows: Vec<_> = parameters
        .table()
        .iter()
        .map(|row| {
            let (meaning, conditions) = explained(row.meaning);
            [
                row.name.to_owned(),
                unit(row.unit.rotary()),
                unit(row.unit.linear()),
                range(row, &conditions),
                values.get(row.name).map_or_else(|| "-".to_owned(), short),
                meaning,
            ]
        })
        .collect();
    let set = preset.title().to_uppercase();
    let mut text = format!("{} ({name})\n\n", name.title());
    text += &columns(["PARAMETER", "ROTARY", "LINEAR", "RANGE", &set, "MEANING"], &rows);
    let option = preset.option();
    let _ = write!(
        text,
        "\nParameter file    frictionlab models {name} --yaml{option} > params.yaml\n\
         Evaluate it       frictionlab simulate --params params.yaml --velocity IN.csv --out OUT.csv\n"
    );
    text
}

/// The text in columns under a head. The last one is wrapped to what is left of the width.
fn columns<const N: usize>(head: [&str; N], rows: &[[String; N]]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.chain([head[column].len()]).max().unwrap_or(0)
    };
    let widths: [usize; N] = std::array::from_fn(width);
    let indent: usize = widths[..N - 1].iter().map(|width| width + 2).sum();
    let mut text = String::new();
    for row in std::iter::once(&head.map(str::to_owned)).chain(rows) {
        let mut line = String::new();
        for (cell, width) in row[..N - 1].iter().zip(widths) {
            let _ = write!(line, "{cell:<width$}  ");
        }
        for (i, part) in
            wrapped(&row[N - 1], WIDTH.saturating_sub(indent).max(24)).iter().enumerate()
        {
            let start = if i == 0 { line.as_str() } else { &" ".repeat(indent) };
            text += format!("{start}{part}").trim_end();
            text.push('\n');
        }
    }
    text
}

/// The text in lines of at most `width` characters, broken between words; at least one line.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        let line = &mut lines[last];
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(word.to_owned());
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines
}

/// The meaning of a parameter without its unit and its range, and what of the range the table
/// cannot say: other parameters, and ends that are not allowed.
pub(super) fn explained(meaning: &str) -> (String, Vec<String>) {
    let meaning = meaning.trim().trim_end_matches('.');
    let without_unit = match (meaning.find(" ["), meaning.find(']')) {
        (Some(from), Some(to)) if from < to => [&meaning[..from], &meaning[to + 1..]].concat(),
        _ => meaning.to_owned(),
    };
    let mut kept = String::new();
    let mut conditions = Vec::new();
    let mut separator = None;
    for clause in without_unit.split_inclusive([',', ';']) {
        let said = clause.trim_end_matches([',', ';']).trim();
        if kept.is_empty() || !is_range(said) {
            kept.extend(separator.into_iter().flat_map(|separator| [separator, ' ']));
            kept.push_str(said);
        } else if said.contains('`') || said.starts_with("between ") || said.starts_with("neither ")
        {
            conditions.push(said.trim_start_matches("above zero and ").replace('`', ""));
        }
        separator = clause.chars().last();
    }
    (kept.replace('`', ""), conditions)
}

/// Whether a clause says which values are allowed.
fn is_range(clause: &str) -> bool {
    let starts = [
        "above ",
        "below ",
        "at least ",
        "at most ",
        "zero or ",
        "between ",
        "from ",
        "neither ",
        "of any ",
    ];
    starts.iter().any(|start| clause.starts_with(start))
}

/// The range in short, with the conditions between parameters.
pub(super) fn range(row: &Parameter, conditions: &[String]) -> String {
    let range = match row.range {
        Range::Any => "any".to_owned(),
        Range::Positive => "> 0".to_owned(),
        Range::NonNegative => ">= 0".to_owned(),
        Range::Within(low, high) => format!("> {low} and <= {high}"),
        Range::FromTo(low, high) => format!("{low} to {high}"),
        Range::Such(condition) => condition.to_owned(),
    };
    // Words about both ends say more than the table.
    let table = (!conditions.iter().any(|said| said.starts_with("between "))).then_some(range);
    table.into_iter().chain(conditions.iter().cloned()).collect::<Vec<_>>().join(", ")
}

fn unit(unit: &str) -> String {
    if unit.is_empty() { "-".to_owned() } else { unit.to_owned() }
}

/// A value in a few characters: six digits, and of a list its ends and its length.
fn short(value: &Value) -> String {
    match value {
        Value::Number(number) => number.as_f64().map_or_else(String::new, digits),
        Value::Array(list) => match &list[..] {
            [] => "none".to_owned(),
            [one] => short(one),
            [first, .., last] => format!("{} .. {} ({})", short(first), short(last), list.len()),
        },
        _ => "-".to_owned(),
    }
}

/// Six significant digits at most.
fn digits(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-4..1e7).contains(&f64::abs(rounded)) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_has_every_model_in_aligned_columns() {
        let text = list();
        let head = text.lines().next().unwrap();
        let (model, parameters) = (head.find("MODEL").unwrap(), head.find("PARAMETERS").unwrap());
        for name in ModelName::ALL {
            let line = text.lines().find(|line| line.starts_with(&format!("{name} "))).unwrap();
            assert!(line[model..].starts_with(name.title()), "{line}");
            let first = Preset::TestBed.parameters(name).table()[0].name;
            assert!(line[parameters..].starts_with(first), "{line}");
        }
    }

    #[test]
    fn every_model_has_a_sheet_with_every_parameter() {
        for name in ModelName::ALL {
            for preset in [Preset::TestBed, Preset::Chapter3] {
                let text = model(name, preset);
                assert!(text.starts_with(&format!("{} ({name})\n", name.title())));
                assert!(text.lines().all(|line| line.chars().count() <= WIDTH + 20), "{text}");
                for row in preset.parameters(name).table() {
                    let line = text
                        .lines()
                        .find(|line| line.starts_with(&format!("{} ", row.name)))
                        .unwrap();
                    assert!(
                        row.unit.rotary().is_empty() || line.contains(row.unit.rotary()),
                        "{line}"
                    );
                    assert!(!line.contains('['), "{line}");
                }
            }
        }
    }

    #[test]
    fn a_line_reads_as_it_should() {
        let text = model(ModelName::LuGre, Preset::TestBed);
        let words = |start: &str| {
            let line = text.lines().find(|line| line.starts_with(start)).unwrap();
            line.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        assert_eq!(words("f_s "), "f_s N m N > 0, at least f_c 0.0994 Static friction F_s");
        assert!(
            words("v_d ").starts_with("v_d rad/s m/s > 0 - Speed v_d at which"),
            "left out: a dash"
        );
        assert_eq!(
            words("delta "),
            "delta - - > 0 and <= 10 2 Shape exponent of the Stribeck curve; 2 if left out"
        );
        let eta = model(ModelName::BlimanSorine, Preset::TestBed);
        assert!(
            eta.contains(" between 0 and 1, neither allowed ") && !eta.contains("<= 1"),
            "{eta}"
        );
        assert!(words("PARAMETER ").contains("TEST BED"));
        assert!(model(ModelName::Proposed, Preset::Chapter3).contains(" 316.228 "));
    }

    #[test]
    fn meanings_lose_their_units_and_ranges_only() {
        for (meaning, kept, conditions) in [
            ("Kinetic friction F_c [N or N m], above zero.", "Kinetic friction F_c", &[][..]),
            (
                "Share of each element, above zero; they sum to 1.",
                "Share of each element; they sum to 1",
                &[],
            ),
            (
                "Ratio eta, between 0 and 1, neither allowed.",
                "Ratio eta",
                &["between 0 and 1", "neither allowed"],
            ),
            (
                "Deflection [m], above zero and below `f_c / sigma0`.",
                "Deflection",
                &["below f_c / sigma0"],
            ),
            ("Level [N], at most `f_s`, from rest.", "Level", &["at most f_s"]),
            ("First, and second [m]", "First, and second", &[]),
        ] {
            let (text, found) = explained(meaning);
            assert_eq!(
                (text.as_str(), found),
                (kept, conditions.iter().map(|&c| c.to_owned()).collect())
            );
        }
    }

    #[test]
    fn values_are_shown_in_a_few_characters() {
        let shown = |text: &str| short(&serde_json::from_str(text).unwrap());
        assert_eq!(shown("[7.9605, 4.9, 2.6, 1.029]"), "7.9605 .. 1.029 (4)");
        assert_eq!(
            (shown("20"), shown("20.0"), shown("null"), shown("[3.5]")),
            ("20".into(), "20".into(), "-".into(), "3.5".into())
        );
        assert_eq!(
            (shown("316.22776601683796"), shown("1e-5"), shown("0.0")),
            ("316.228".into(), "1e-5".into(), "0".into())
        );
    }
}
