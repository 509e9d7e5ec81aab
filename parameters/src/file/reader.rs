//! YAML as `rcl_yaml_param_parser` reads it.

use std::collections::BTreeMap;

use granit_parser::{Event, Parser, ScalarStyle};

use super::{FileError, NodeParameters, PARAMETERS};
use crate::ParameterValue;

type Said<T> = Result<T, String>;

/// The nodes of a file, each as often as it stands there.
pub(super) fn parse(text: &str) -> Said<Vec<NodeParameters>> {
    let mut found = Vec::new();
    match Reader::new(text).document()? {
        Yaml::Map(entries) => nodes("", entries, &mut found)?,
        Yaml::Value(_, line) | Yaml::List(_, line) => return Err(expected(line)),
    }
    Ok(found)
}

/// Reads a single value, as behind `-p name:=`.
///
/// # Errors
/// [`FileError`] says what is wrong.
pub fn parse_value(text: &str) -> Result<ParameterValue, FileError> {
    match Reader::new(text).document().map_err(FileError)? {
        Yaml::Value(value, _) => Ok(value),
        Yaml::List(values, _) => list(&values).map_err(FileError),
        Yaml::Map(_) => Err(FileError(format!(
            "`{text}` is a map; give each of its values a parameter of its own, as in -p lag.k_p:=1.5"
        ))),
    }
}

fn expected(line: usize) -> String {
    format!(
        "line {line}: expected the name of a node with `{PARAMETERS}:` under it, and under that the parameters"
    )
}

/// The names of nodes down to `ros__parameters`.
fn nodes(
    namespace: &str,
    entries: Vec<(String, usize, Yaml)>,
    found: &mut Vec<NodeParameters>,
) -> Said<()> {
    for (key, line, value) in entries {
        let Yaml::Map(inner) = value else { return Err(expected(line)) };
        if key == PARAMETERS {
            if namespace.is_empty() {
                return Err(expected(line));
            }
            let mut values = BTreeMap::new();
            flatten("", inner, &mut values)?;
            found.push(NodeParameters { pattern: namespace.to_owned(), values });
        } else {
            let name = key.trim_matches('/');
            if name.is_empty() || name.split('/').any(|part| !is_pattern(part)) {
                return Err(format!("line {line}: `{key}` is no name of a node"));
            }
            nodes(&format!("{namespace}/{name}"), inner, found)?;
        }
    }
    Ok(())
}

fn is_pattern(part: &str) -> bool {
    part == "*"
        || part == "**"
        || part.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

fn flatten(
    prefix: &str,
    entries: Vec<(String, usize, Yaml)>,
    values: &mut BTreeMap<String, ParameterValue>,
) -> Said<()> {
    for (key, line, value) in entries {
        let name = if prefix.is_empty() { key } else { format!("{prefix}.{key}") };
        match value {
            Yaml::Value(value, _) => _ = values.insert(name, value),
            Yaml::List(items, line) => {
                let value = list(&items).map_err(|e| format!("line {line}: `{name}`: {e}"))?;
                values.insert(name, value);
            }
            Yaml::Map(inner) if inner.is_empty() => {
                return Err(format!("line {line}: `{name}` is an empty map; leave it out"));
            }
            Yaml::Map(inner) => flatten(&name, inner, values)?,
        }
    }
    Ok(())
}

/// The elements of a list, which have one type.
fn list(items: &[ParameterValue]) -> Said<ParameterValue> {
    macro_rules! of {
        ($kind:ident, $array:ident) => {
            items
                .iter()
                .map(|item| match item {
                    ParameterValue::$kind(value) => Some(value.clone()),
                    _ => None,
                })
                .collect::<Option<Vec<_>>>()
                .map(ParameterValue::$array)
        };
    }
    let value = match items.first() {
        // Of no type yet: the declaration decides.
        None => return Ok(ParameterValue::StringArray(Vec::new())),
        Some(ParameterValue::Boolean(_)) => of!(Boolean, BooleanArray),
        Some(ParameterValue::Integer(_)) => of!(Integer, IntegerArray),
        Some(ParameterValue::Double(_)) => of!(Double, DoubleArray),
        Some(_) => of!(String, StringArray),
    };
    value.ok_or_else(|| {
        "all elements of a list must have one type; write 1.0 and not 1 among doubles".to_owned()
    })
}

enum Yaml {
    Value(ParameterValue, usize),
    List(Vec<ParameterValue>, usize),
    Map(Vec<(String, usize, Yaml)>),
}

/// Deepest nesting that is read.
const DEEPEST: usize = 32;

struct Reader<'a> {
    events: Box<dyn Iterator<Item = Said<(Event<'a>, usize)>> + 'a>,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        let events = Parser::new_from_str(text)
            .filter(|next| !matches!(next, Ok((Event::Comment(..), _))))
            .map(|next| {
                next.map(|(event, span)| (written(event, &span), span.start.line()))
                    .map_err(|e| e.to_string())
            });
        Self { events: Box::new(events) }
    }

    fn next(&mut self) -> Said<(Event<'a>, usize)> {
        self.events.next().unwrap_or_else(|| Err("the text ends too early".to_owned()))
    }

    fn document(&mut self) -> Said<Yaml> {
        loop {
            match self.next()? {
                (Event::StreamStart | Event::DocumentStart(..), _) => {}
                (Event::StreamEnd, line) => {
                    return Err(format!("line {line}: there is nothing in it"));
                }
                (event, line) => {
                    let node = self.node(event, line, 0)?;
                    return match self.next()? {
                        (Event::DocumentEnd, _) => match self.next()? {
                            (Event::StreamEnd, _) => Ok(node),
                            (_, line) => Err(format!("line {line}: only one document is expected")),
                        },
                        (_, line) => Err(format!("line {line}: only one document is expected")),
                    };
                }
            }
        }
    }

    fn node(&mut self, event: Event<'a>, line: usize, depth: usize) -> Said<Yaml> {
        if depth > DEEPEST {
            return Err(format!("line {line}: nested deeper than {DEEPEST} levels"));
        }
        match event {
            Event::Scalar(text, style, _, tag) => {
                let tag = tag.as_deref().and_then(|tag| tag.core_suffix());
                scalar(&text, style == ScalarStyle::Plain, tag)
                    .map(|value| Yaml::Value(value, line))
                    .map_err(|e| format!("line {line}: {e}"))
            }
            Event::SequenceStart(..) => {
                let mut items = Vec::new();
                loop {
                    match self.next()? {
                        (Event::SequenceEnd, _) => return Ok(Yaml::List(items, line)),
                        (event, line) => match self.node(event, line, depth + 1)? {
                            Yaml::Value(value, _) => items.push(value),
                            _ => {
                                return Err(format!(
                                    "line {line}: a list may only hold plain values"
                                ));
                            }
                        },
                    }
                }
            }
            Event::MappingStart(..) => {
                let mut entries: Vec<(String, usize, Yaml)> = Vec::new();
                loop {
                    let (event, line) = self.next()?;
                    match event {
                        Event::MappingEnd => return Ok(Yaml::Map(entries)),
                        Event::Scalar(key, ..) => {
                            let (event, at) = self.next()?;
                            let value = self.node(event, at, depth + 1)?;
                            entries.push((key.into_owned(), line, value));
                        }
                        _ => return Err(format!("line {line}: a key must be a name")),
                    }
                }
            }
            Event::Alias(_) | Event::UnresolvedAlias(_) => {
                Err(format!("line {line}: aliases are not read; write the value out"))
            }
            _ => Err(format!("line {line}: not expected here")),
        }
    }
}

/// The event with the text that stands there: where nothing stands the parser says `~`.
fn written<'a>(event: Event<'a>, span: &granit_parser::Span) -> Event<'a> {
    match event {
        Event::Scalar(_, ScalarStyle::Plain, anchor, tag)
            if span.start.index() == span.end.index() =>
        {
            Event::Scalar("".into(), ScalarStyle::Plain, anchor, tag)
        }
        other => other,
    }
}

/// The value of a scalar by rcl's rules.
fn scalar(text: &str, plain: bool, tag: Option<&str>) -> Said<ParameterValue> {
    let wrong = |kind: &str| format!("`{text}` is no {kind}");
    match tag {
        Some("str") => return Ok(ParameterValue::String(text.to_owned())),
        Some("bool") => {
            return boolean(text).map(ParameterValue::Boolean).ok_or_else(|| wrong("boolean"));
        }
        Some("int") => {
            return integer(text).map(ParameterValue::Integer).ok_or_else(|| wrong("integer"));
        }
        Some("float") => {
            return double(text).map(ParameterValue::Double).ok_or_else(|| wrong("double"));
        }
        _ => {}
    }
    if !plain {
        return Ok(ParameterValue::String(text.to_owned()));
    }
    if text.is_empty() {
        return Err("there is no value".to_owned());
    }
    Ok(boolean(text)
        .map(ParameterValue::Boolean)
        .or_else(|| integer(text).map(ParameterValue::Integer))
        .or_else(|| double(text).map(ParameterValue::Double))
        .unwrap_or_else(|| ParameterValue::String(text.to_owned())))
}

fn boolean(text: &str) -> Option<bool> {
    match text {
        "Y" | "y" | "yes" | "Yes" | "YES" | "true" | "True" | "TRUE" | "on" | "On" | "ON" => {
            Some(true)
        }
        "N" | "n" | "no" | "No" | "NO" | "false" | "False" | "FALSE" | "off" | "Off" | "OFF" => {
            Some(false)
        }
        _ => None,
    }
}

/// As `strtol` with base 0: decimal, `0x` hexadecimal, leading 0 octal.
fn integer(text: &str) -> Option<i64> {
    let (sign, digits) = match text.as_bytes().first()? {
        b'-' => ("-", text.get(1..)?),
        b'+' => ("", text.get(1..)?),
        _ => ("", text),
    };
    let (digits, radix) =
        if let Some(hex) = digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")) {
            (hex, 16)
        } else if digits.len() > 1 && digits.starts_with('0') {
            (digits.get(1..)?, 8)
        } else {
            (digits, 10)
        };
    if !digits.starts_with(|c: char| c.is_digit(radix)) {
        return None;
    }
    i64::from_str_radix(&format!("{sign}{digits}"), radix).ok()
}

fn double(text: &str) -> Option<f64> {
    match text {
        ".nan" | ".NaN" | ".NAN" => return Some(f64::NAN),
        ".inf" | ".Inf" | ".INF" | "+.inf" | "+.Inf" | "+.INF" => return Some(f64::INFINITY),
        "-.inf" | "-.Inf" | "-.INF" => return Some(f64::NEG_INFINITY),
        _ => {}
    }
    let value: f64 = text.parse().ok()?;
    // A number too large to hold is text, as `strtod` reports it out of range.
    let spelled = text.trim_start_matches(['+', '-']).starts_with(['i', 'I']);
    (value.is_finite() || value.is_nan() || spelled).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ParameterValue as V;

    /// The kinds that rcl's `get_value` tells apart (`rcl_yaml_param_parser/src/parse.c`, and its
    /// `test_parse.cpp`).
    #[test]
    fn plain_text_has_the_type_that_rcl_gives_it() {
        for (text, value) in [
            ("yes", V::Boolean(true)),
            ("Off", V::Boolean(false)),
            ("n", V::Boolean(false)),
            ("yEs", V::String("yEs".into())),
            ("42", V::Integer(42)),
            ("-7", V::Integer(-7)),
            ("0x1F", V::Integer(31)),
            ("010", V::Integer(8)),
            ("0", V::Integer(0)),
            ("1.", V::Double(1.0)),
            (".5", V::Double(0.5)),
            ("1e3", V::Double(1000.0)),
            ("-.inf", V::Double(f64::NEG_INFINITY)),
            ("99999999999999999999", V::Double(1e20)),
            ("1e999", V::String("1e999".into())),
            ("08", V::Double(8.0)),
            ("velocity", V::String("velocity".into())),
            ("'1'", V::String("1".into())),
            ("\"true\"", V::String("true".into())),
            ("!!str 1", V::String("1".into())),
            ("!!float 1", V::Double(1.0)),
            ("[1, 2]", V::IntegerArray(vec![1, 2])),
            ("[1.0, 2.5]", V::DoubleArray(vec![1.0, 2.5])),
            ("[a, 'b']", V::StringArray(vec!["a".into(), "b".into()])),
            ("[on, no]", V::BooleanArray(vec![true, false])),
        ] {
            assert_eq!(parse_value(text).unwrap(), value, "{text}");
        }
        assert!(matches!(parse_value(".nan").unwrap(), V::Double(x) if x.is_nan()));
        for wrong in ["", "[1, 2.0]", "[[1], [2]]", "{a: 1}", "[1", "!!int x", "*a"] {
            assert!(parse_value(wrong).is_err(), "{wrong}");
        }
    }
}
