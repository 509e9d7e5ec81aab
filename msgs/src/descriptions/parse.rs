//! The lines of a definition.

use super::DefinitionError;
use crate::type_description_interfaces::{Field, FieldType};

/// Number of a field that is another type (REP 2016).
pub(super) const NESTED: u8 = 1;
const BOUNDED_STRING: u8 = 21;
const BOUNDED_WSTRING: u8 = 22;
/// What an array adds to the number of its elements' type, a sequence with a bound, and one
/// without.
const ARRAY: u8 = 48;
pub(super) const BOUNDED_SEQUENCE: u8 = 96;
const SEQUENCE: u8 = 144;

/// The number of a type that is no other definition.
fn primitive(name: &str) -> Option<u8> {
    Some(match name {
        "int8" => 2,
        // What ROS calls a `char` is a number without a sign.
        "uint8" | "char" => 3,
        "int16" => 4,
        "uint16" => 5,
        "int32" => 6,
        "uint32" => 7,
        "int64" => 8,
        "uint64" => 9,
        "float32" => 10,
        "float64" => 11,
        "bool" => 15,
        "byte" => 16,
        "string" => 17,
        "wstring" => 18,
        _ => return None,
    })
}

/// The fields of a definition of `package`, in order. One without fields has the one that ROS gives
/// it.
pub(super) fn fields(package: &str, text: &str) -> Result<Vec<Field>, DefinitionError> {
    let mut fields = Vec::new();
    for line in text.lines() {
        let error = |why| DefinitionError::Line { line: line.trim().to_owned(), why };
        let statement = line.split('#').next().unwrap_or_default().trim();
        if statement.is_empty() {
            continue;
        }
        let (kind, rest) =
            statement.split_once(char::is_whitespace).ok_or(error("a field has a name"))?;
        let rest = rest.trim_start();
        let name = rest.split([' ', '\t', '=']).next().unwrap_or_default();
        if !is_name(name) {
            return Err(error("a name is made of letters, digits and underscores"));
        }
        let after = rest[name.len()..].trim_start();
        if after.starts_with('=') {
            continue;
        }
        let r#type = field_type(package, kind).map_err(error)?;
        let default_value = default_value(&r#type, after);
        fields.push(Field { name: name.to_owned(), r#type, default_value });
    }
    if fields.is_empty() {
        let r#type = field_type(package, "uint8")
            .map_err(|why| DefinitionError::Line { line: String::new(), why })?;
        let name = "structure_needs_at_least_one_member".to_owned();
        fields.push(Field { name, r#type, default_value: String::new() });
    }
    Ok(fields)
}

fn is_name(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// A field that is another type.
pub(super) fn nested(name: &str, kind: String) -> Field {
    let r#type = FieldType { type_id: NESTED, nested_type_name: kind, ..FieldType::default() };
    Field { name: name.to_owned(), r#type, default_value: String::new() }
}

/// As it is told: the generators of ROS read it by Python.
fn default_value(kind: &FieldType, written: &str) -> String {
    match (kind.type_id, written) {
        (15, "true" | "1") => "True".to_owned(),
        (15, "false" | "0") => "False".to_owned(),
        _ => written.trim_matches(['"', '\'']).to_owned(),
    }
}

fn number(text: &str) -> Result<u64, &'static str> {
    text.parse().map_err(|_| "a length is a whole number")
}

fn field_type(package: &str, kind: &str) -> Result<FieldType, &'static str> {
    let (element, length) = match kind.split_once('[') {
        None => (kind, None),
        Some((element, length)) => {
            let length = length.strip_suffix(']').ok_or("a bracket is not closed")?;
            (element, Some(length))
        }
    };
    let (offset, capacity) = match length {
        None => (0, 0),
        Some("") => (SEQUENCE, 0),
        Some(length) => match length.strip_prefix("<=") {
            Some(bound) => (BOUNDED_SEQUENCE, number(bound)?),
            None => (ARRAY, number(length)?),
        },
    };
    let (element, bound) = match element.split_once("<=") {
        None => (element, None),
        Some((element, bound)) => (element, Some(number(bound)?)),
    };
    let (id, nested_type_name) = match (primitive(element), bound) {
        (Some(17), Some(_)) => (BOUNDED_STRING, String::new()),
        (Some(18), Some(_)) => (BOUNDED_WSTRING, String::new()),
        (_, Some(_)) => return Err("only strings have a bound without brackets"),
        (Some(id), None) => (id, String::new()),
        (None, None) => (NESTED, full_name(package, element)?),
    };
    Ok(FieldType {
        type_id: id + offset,
        capacity,
        string_capacity: bound.unwrap_or(0),
        nested_type_name,
    })
}

/// `Name`, `package/Name` or `package/msg/Name` in full.
fn full_name(package: &str, written: &str) -> Result<String, &'static str> {
    if !written.split('/').all(is_name) {
        return Err("a type is made of letters, digits and underscores");
    }
    match written.split('/').collect::<Vec<_>>()[..] {
        [name] => Ok(format!("{package}/msg/{name}")),
        [package, name] => Ok(format!("{package}/msg/{name}")),
        [_, _, _] => Ok(written.to_owned()),
        _ => Err("a type is `package/Name`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(text: &str) -> Field {
        let mut fields = fields("own", text).expect("a definition");
        assert_eq!(fields.len(), 1, "{text}");
        fields.remove(0)
    }

    #[test]
    fn every_kind_of_field_has_the_number_of_rep_2016() {
        for (text, id, capacity, bound, nested) in [
            ("int8 a", 2, 0, 0, ""),
            ("char[16]  a # many", 51, 16, 0, ""),
            ("byte[] a", 160, 0, 0, ""),
            ("float32[<=3] a", 106, 3, 0, ""),
            ("wstring a", 18, 0, 0, ""),
            ("string<=255 a", 21, 0, 255, ""),
            ("wstring<=5[<=4] a", 118, 4, 5, ""),
            ("Other a", 1, 0, 0, "own/msg/Other"),
            ("foreign/Other[2] a", 49, 2, 0, "foreign/msg/Other"),
            ("foreign/srv/Other_Request[] a", 145, 0, 0, "foreign/srv/Other_Request"),
        ] {
            let kind = one(text).r#type;
            let seen = (kind.type_id, kind.capacity, kind.string_capacity, &*kind.nested_type_name);
            assert_eq!(seen, (id, capacity, bound, nested), "{text}");
        }
    }

    #[test]
    fn constants_are_no_fields_and_defaults_are_told() {
        let text = "int8 ONE=1\nint8 TWO  = 2 # two\nstring<=9 s \"x\"\nbool b true\nint8 n\t-1\n";
        let fields = fields("own", text).expect("a definition");
        let seen: Vec<_> = fields.iter().map(|f| (&*f.name, &*f.default_value)).collect();
        assert_eq!(seen, [("s", "x"), ("b", "True"), ("n", "-1")]);
        assert_eq!(one("# nothing\n").name, "structure_needs_at_least_one_member");
    }

    #[test]
    fn what_is_no_definition_is_refused_with_its_line() {
        for text in
            ["int8", "int8 1a", "int8[ a", "int8[x] a", "int8<=2 a", "a/b/c/d e", "a//b c", "ä b"]
        {
            let error = fields("own", text).expect_err(text).to_string();
            assert!(error.contains(text), "{error}");
        }
    }
}
