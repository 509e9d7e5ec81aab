//! The hash of a type's structure (REP 2016).

use std::fmt::Write as _;

use sha2::{Digest, Sha256};

use crate::type_description_interfaces::{IndividualTypeDescription, TypeDescription};

/// `RIHS01_` and the SHA-256 of the description as JSON, without the values that fields have where
/// nothing is said.
pub(super) fn of(description: &TypeDescription) -> String {
    let own = individual(&description.type_description);
    let referenced: Vec<_> =
        description.referenced_type_descriptions.iter().map(individual).collect();
    let json = format!(
        "{{\"type_description\": {own}, \"referenced_type_descriptions\": [{}]}}",
        referenced.join(", ")
    );
    let mut hash = "RIHS01_".to_owned();
    for byte in Sha256::digest(json.as_bytes()) {
        // Writing to a string cannot fail.
        let _ = write!(hash, "{byte:02x}");
    }
    hash
}

/// Names need no escapes: they are letters, digits, underscores and slashes.
fn individual(described: &IndividualTypeDescription) -> String {
    let fields: Vec<_> = described
        .fields
        .iter()
        .map(|field| {
            let kind = &field.r#type;
            format!(
                "{{\"name\": \"{}\", \"type\": {{\"type_id\": {}, \"capacity\": {}, \
                 \"string_capacity\": {}, \"nested_type_name\": \"{}\"}}}}",
                field.name,
                kind.type_id,
                kind.capacity,
                kind.string_capacity,
                kind.nested_type_name
            )
        })
        .collect();
    format!("{{\"type_name\": \"{}\", \"fields\": [{}]}}", described.type_name, fields.join(", "))
}
