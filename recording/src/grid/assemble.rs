//! Columns of one length from the arrays of a file.

use std::collections::BTreeMap;

use super::{Contents, Form, Grid, GridColumn, Variable};
use crate::column::Channel;

/// Arrays with more columns than this are no joints.
const MOST_JOINTS: usize = 256;

/// The columns. The length of the time is that of the recording; where none is called so, the one
/// that most arrays have, and of equals the longest.
pub(super) fn assemble(form: Form, contents: Contents) -> Result<Grid, String> {
    let Contents { variables, mut left_out, .. } = contents;
    let Some(rows) = usual_length(&variables) else {
        return Err(format!("it holds no vector of numbers{}", told(&left_out)));
    };
    let mut columns = Vec::new();
    for variable in variables {
        let (name, across) = (variable.name.clone(), variable.rows != rows);
        let unit = variable.unit.clone();
        let (length, joints) = if across {
            (variable.columns, variable.rows)
        } else {
            (variable.rows, variable.columns)
        };
        if length != rows || joints > MOST_JOINTS {
            if variable.rows * variable.columns > 1 {
                left_out.push(format!(
                    "`{name}` is left out: it is {} by {}, where the others have {rows} rows",
                    variable.rows, variable.columns
                ));
            }
            continue;
        }
        if joints == 1 {
            columns.push(GridColumn { stem: name, label: None, unit, values: variable.values });
            continue;
        }
        for joint in 0..joints {
            let values = if across {
                variable.values.iter().copied().skip(joint).step_by(joints).collect()
            } else {
                variable.values.get(joint * rows..(joint + 1) * rows).unwrap_or_default().to_vec()
            };
            let label = Some(joint.to_string());
            columns.push(GridColumn { stem: name.clone(), label, unit: unit.clone(), values });
        }
    }
    Ok(Grid { form, columns, left_out })
}

fn usual_length(variables: &[Variable]) -> Option<usize> {
    of_time(variables).or_else(|| of_most(variables))
}

/// The length of the longest vector that is called a time.
fn of_time(variables: &[Variable]) -> Option<usize> {
    let is_time = |variable: &&Variable| {
        let own = variable.name.rsplit_once('.').map_or(variable.name.as_str(), |(_, own)| own);
        variable.rows.min(variable.columns) == 1
            && Channel::Time.recognise(&[own.to_owned()]).is_some()
    };
    let length = |variable: &Variable| variable.rows.max(variable.columns);
    variables.iter().filter(is_time).map(length).filter(|length| *length > 1).max()
}

/// The length that most arrays have.
fn of_most(variables: &[Variable]) -> Option<usize> {
    let mut count: BTreeMap<usize, usize> = BTreeMap::new();
    for Variable { rows, columns, .. } in variables {
        for length in [*rows, *columns].into_iter().filter(|length| *length > 1) {
            *count.entry(length).or_default() += 1;
        }
        if rows == columns && *rows > 1 {
            *count.entry(*rows).or_default() -= 1;
        }
    }
    // Of equals the last one, which is the longest.
    count.into_iter().max_by_key(|(_, count)| *count).map(|(length, _)| length)
}

fn told(left_out: &[String]) -> String {
    if left_out.is_empty() { String::new() } else { format!("; {}", left_out.join("; ")) }
}
