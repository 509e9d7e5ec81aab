//! `.mat` files of version 5 to 7: the variables of a MATLAB workspace.
//!
//! Source: The MathWorks, "MAT-File Format", level 5. Structures are flattened by dots, as in
//! `data.q`. The crates that read it leave structures out.

mod element;

use super::{Contents, Variable};
use element::{Element, Elements, Order, inflated};

/// Structures within structures.
const DEEPEST: usize = 16;
/// Length of the text above the data.
const HEADER: usize = 128;

const COMPRESSED: u32 = 15;
const MATRIX: u32 = 14;

/// All variables of a file.
pub(super) fn read(bytes: &[u8]) -> Result<Contents, String> {
    let order = match bytes.get(126..HEADER) {
        Some(b"IM") => Order::Little,
        Some(b"MI") => Order::Big,
        _ => return Err("its header is damaged".to_owned()),
    };
    let mut found = Contents::default();
    let mut elements = Elements { rest: bytes.get(HEADER..).unwrap_or_default(), order };
    while let Some(element) = elements.next()? {
        match element.kind {
            COMPRESSED => {
                let inner = inflated(element.data)?;
                let mut inner = Elements { rest: &inner, order };
                while let Some(element) = inner.next()? {
                    if element.kind == MATRIX {
                        variable(element.data, order, Name::Own, 0, &mut found)?;
                    }
                }
            }
            MATRIX => variable(element.data, order, Name::Own, 0, &mut found)?,
            _ => {}
        }
    }
    Ok(found)
}

/// What a variable is called.
enum Name {
    /// As it says itself.
    Own,
    /// A field of a structure.
    Given(String),
}

/// Adds a variable, or what it holds.
fn variable(
    data: &[u8],
    order: Order,
    name: Name,
    depth: usize,
    found: &mut Contents,
) -> Result<(), String> {
    const DAMAGED: &str = "a variable of it is damaged";
    if data.is_empty() {
        return Ok(());
    }
    let mut parts = Elements { rest: data, order };
    let flags = parts.next()?.ok_or(DAMAGED)?.integers(order)?;
    let flags = *flags.first().ok_or(DAMAGED)?;
    let (class, complex) = (flags & 0xff, flags & 0x0800 != 0);
    // Functions and objects have another form.
    if !(1..=15).contains(&class) {
        let name = match name {
            Name::Given(name) => name,
            Name::Own => parts.next()?.map(|name| name.text()).unwrap_or_default(),
        };
        found.leave_out(&name, "it is an object, as a table or timetable is");
        return Ok(());
    }
    let shape = parts.next()?.ok_or(DAMAGED)?.integers(order)?;
    let own = parts.next()?.ok_or(DAMAGED)?.text();
    let name = match name {
        Name::Given(name) => name,
        Name::Own => own,
    };
    let length = |k: usize| {
        shape.get(k).map_or(Ok(1), |&n| usize::try_from(n).map_err(|_| DAMAGED.to_owned()))
    };
    let (rows, columns) = (length(0)?, length(1)?);
    match class {
        2 => return structure(&mut parts, order, &name, (rows, columns), depth, found),
        1 => found.leave_out(&name, "it is a cell array"),
        3 => found.leave_out(&name, "it is an object"),
        4 => found.leave_out(&name, "it is text"),
        5 => found.leave_out(&name, "it is a sparse matrix"),
        _ if complex => found.leave_out(&name, "its numbers are complex"),
        _ if shape.len() > 2 && shape.iter().skip(2).any(|n| *n != 1) => {
            found.leave_out(&name, &format!("it has {} dimensions", shape.len()));
        }
        _ => {
            let count = found.expect(rows, columns)?;
            let part = parts.next()?.ok_or(DAMAGED)?;
            let values = part.numbers(order, class == 15)?;
            if values.len() != count {
                return Err(format!("`{name}` has {} numbers, not {count}", values.len()));
            }
            found.variables.push(Variable { name, unit: None, rows, columns, values });
        }
    }
    Ok(())
}

/// Adds the fields of a structure; those of several structures have a number.
fn structure(
    parts: &mut Elements<'_>,
    order: Order,
    name: &str,
    (rows, columns): (usize, usize),
    depth: usize,
    found: &mut Contents,
) -> Result<(), String> {
    const DAMAGED: &str = "a structure of it is damaged";
    if depth >= DEEPEST {
        return Err(format!("its structures lie more than {DEEPEST} deep in each other"));
    }
    let width = parts.next()?.ok_or(DAMAGED)?.integers(order)?;
    let width = width.first().and_then(|&n| usize::try_from(n).ok()).filter(|n| *n > 0);
    let names = parts.next()?.ok_or(DAMAGED)?.data;
    let fields: Vec<String> =
        names.chunks_exact(width.ok_or(DAMAGED)?).map(element::word).collect();
    let count = rows.checked_mul(columns).ok_or(DAMAGED)?;
    for index in 0..count {
        for field in &fields {
            // A count that is not true ends with the bytes.
            let Some(Element { data, .. }) = parts.next()? else { return Ok(()) };
            let called = if count == 1 {
                format!("{name}.{field}")
            } else {
                format!("{name}({}).{field}", index + 1)
            };
            variable(data, order, Name::Given(called), depth + 1, found)?;
        }
        if fields.is_empty() {
            break;
        }
    }
    Ok(())
}
