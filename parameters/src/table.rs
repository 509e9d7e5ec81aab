//! Declarations as Markdown, for the documentation.

use crate::{Declaration, ParameterValue};

/// A table with a line for each declaration: name, type, default, what it is, what it may be.
#[must_use]
pub fn markdown_table(declared: &[Declaration]) -> String {
    let mut text =
        String::from("| parameter | type | default | what | allowed |\n|---|---|---|---|---|\n");
    for parameter in declared {
        let default = match parameter.default_value() {
            ParameterValue::Boolean(value) => value.to_string(),
            ParameterValue::Integer(value) => value.to_string(),
            ParameterValue::Double(value) => format!("{value:?}"),
            ParameterValue::String(value) => value.clone(),
            other => format!("{other:?}"),
        };
        let kind = parameter.default_value().kind();
        let fixed = if parameter.is_read_only() { "; only when the program starts" } else { "" };
        let allowed = format!("{}{fixed}", parameter.allowed());
        text += &format!(
            "| `{}` | {kind} | {default} | {} | {} |\n",
            parameter.name(),
            parameter.description(),
            allowed.trim_start_matches("; ")
        );
    }
    text
}
