//! Parameter files as text, with a comment behind each value.

use std::fmt::Write;

use serde::Serialize;

use crate::ParameterValue;

/// A parameter file in the making: nodes, their parameters, and what is said of each.
///
/// ```
/// use parameters::{ParameterValue, file::Writer};
///
/// let mut file = Writer::default();
/// file.comment("Designed for 10 rad/s.");
/// file.node("/controller");
/// file.value("pi.k_p", ParameterValue::Double(2.0), "given");
/// file.value("pi.k_i", ParameterValue::Double(30.0), "");
/// assert_eq!(
///     file.text(),
///     "# Designed for 10 rad/s.\n/controller:\n  ros__parameters:\n    pi:\n      \
///      k_p: 2.0  # given\n      k_i: 30.0\n"
/// );
/// ```
#[derive(Debug, Clone, Default)]
pub struct Writer {
    text: String,
    name: String,
    node: Vec<Entry>,
}

#[derive(Debug, Clone)]
struct Entry {
    key: String,
    content: Content,
}

#[derive(Debug, Clone)]
enum Content {
    Value(String, String),
    Map(Vec<Entry>),
}

impl Writer {
    /// A line of comment, at the beginning or between nodes.
    pub fn comment(&mut self, line: &str) {
        self.end_node();
        self.text += &format!("# {}\n", one_line(line));
    }

    /// A node by its absolute name; the values that follow are its own. One without values is left
    /// out.
    pub fn node(&mut self, name: &str) {
        self.end_node();
        name.clone_into(&mut self.name);
    }

    /// A parameter of the node. Dots in its name part maps; what is said stands behind the value,
    /// nothing where it is empty.
    pub fn value(&mut self, name: &str, value: ParameterValue, comment: &str) {
        let mut entries = &mut self.node;
        let mut parts = name.split('.').peekable();
        while let Some(part) = parts.next() {
            if parts.peek().is_none() {
                let content = Content::Value(scalar(&value), one_line(comment));
                entries.push(Entry { key: part.to_owned(), content });
                return;
            }
            let known = entries
                .iter()
                .position(|entry| entry.key == part && matches!(entry.content, Content::Map(_)));
            let at = known.unwrap_or_else(|| {
                let content = Content::Map(Vec::new());
                entries.push(Entry { key: part.to_owned(), content });
                entries.len() - 1
            });
            let Content::Map(inner) = &mut entries[at].content else { return };
            entries = inner;
        }
    }

    /// The file.
    #[must_use]
    pub fn text(mut self) -> String {
        self.end_node();
        self.text
    }

    fn end_node(&mut self) {
        if self.node.is_empty() {
            return;
        }
        self.text += &format!("{}:\n  {}:\n", word(&self.name), super::PARAMETERS);
        block(&mut self.text, &std::mem::take(&mut self.node), 4);
    }
}

fn block(text: &mut String, entries: &[Entry], indent: usize) {
    for Entry { key, content } in entries {
        // Writing to a string cannot fail.
        let _ = match content {
            Content::Value(value, said) if said.is_empty() => {
                writeln!(text, "{:indent$}{key}: {value}", "")
            }
            Content::Value(value, said) => {
                writeln!(text, "{:indent$}{key}: {value}  # {said}", "")
            }
            Content::Map(inner) => {
                let begun = writeln!(text, "{:indent$}{key}:", "");
                block(text, inner, indent + 2);
                begun
            }
        };
    }
}

/// A value as text; lists stand on one line, so that a comment can stand behind them.
#[must_use]
pub fn scalar(value: &ParameterValue) -> String {
    fn list<T>(all: &[T], one: impl Fn(&T) -> String) -> String {
        format!("[{}]", all.iter().map(one).collect::<Vec<_>>().join(", "))
    }
    match value {
        ParameterValue::NotSet => "~".to_owned(),
        ParameterValue::Boolean(value) => value.to_string(),
        ParameterValue::Integer(value) => value.to_string(),
        ParameterValue::Double(value) => number(*value),
        ParameterValue::String(text) => word(text),
        ParameterValue::ByteArray(all) => list(all, ToString::to_string),
        ParameterValue::BooleanArray(all) => list(all, ToString::to_string),
        ParameterValue::IntegerArray(all) => list(all, ToString::to_string),
        ParameterValue::DoubleArray(all) => list(all, |value| number(*value)),
        ParameterValue::StringArray(all) => list(all, |text| word(text)),
    }
}

/// A number that every YAML reader, ROS's included, takes for a double: always with a point.
#[must_use]
pub fn number(value: f64) -> String {
    yaml(&value)
}

/// A text that every YAML reader takes for a text: in quotes where it looks like anything else.
#[must_use]
pub fn word(text: &str) -> String {
    // In a list a comma parts, and rcl has more spellings of numbers than YAML has.
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./@".contains(c);
    if text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '/') && text.chars().all(plain) {
        yaml(&text)
    } else {
        let mut quoted = String::from("\"");
        for c in text.chars() {
            match c {
                '"' | '\\' => quoted.extend(['\\', c]),
                // Writing to a string cannot fail.
                c if c.is_control() => _ = write!(quoted, "\\U{:08x}", u32::from(c)),
                c => quoted.push(c),
            }
        }
        quoted + "\""
    }
}

fn yaml<T: Serialize>(value: &T) -> String {
    let options = serde_saphyr::ser_options! { prefer_block_scalars: false };
    // Writing to a string cannot fail.
    let mut text = String::new();
    let _ = serde_saphyr::to_fmt_writer_with_options(&mut text, value, options);
    text.trim_end().to_owned()
}

/// What must not end the comment it stands in.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Parameters, parse_value};
    use super::*;
    use ParameterValue as V;

    #[test]
    fn numbers_always_have_a_point() {
        for (value, text) in [(20.0, "20.0"), (0.0403, "0.0403"), (1e-7, "1.0e-7"), (0.0, "0.0")] {
            assert_eq!(number(value), text);
            assert_eq!(text.parse::<f64>(), Ok(value));
        }
    }

    #[test]
    fn whatever_is_written_reads_back() {
        let text = |text: &str| V::String(text.to_owned());
        for value in [
            V::Boolean(false),
            V::Integer(-3),
            V::Double(0.1 + 0.2),
            V::Double(1e300),
            V::Double(f64::MIN_POSITIVE),
            V::DoubleArray(vec![1.0, 1e-7]),
            V::IntegerArray(vec![1, 2]),
            V::StringArray(vec!["a, b".into(), "on".into()]),
            text("some_model"),
            text("off"),
            text("n"),
            text(""),
            text("~"),
            text("010"),
            text("1e3"),
            text(".inf"),
            text("inf"),
            text("serial:/dev/ttyACM0@115200"),
            text("a: #b"),
            text("it's \"so\"\\\n\t"),
            text("ä*&"),
            text(&"long ".repeat(40)),
        ] {
            let written = scalar(&value);
            assert_eq!(parse_value(&written).unwrap(), value, "{written}");
            let mut file = Writer::default();
            file.comment("two\nlines");
            file.node("/**/n");
            file.value("a.b", value.clone(), "said\nof it");
            file.value("c", V::Integer(1), "");
            let file = file.text();
            let found = Parameters::parse(&file).unwrap().of_node("/x/n");
            assert_eq!((&found["a.b"], &found["c"]), (&value, &V::Integer(1)), "{file}");
        }
    }
}
