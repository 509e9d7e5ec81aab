//! A row of units below the names, as measuring programs write it: `t,q,tau` and then `s,rad,Nm`.

use csv::StringRecord;

use crate::units;

/// The unit of each column, if the row holds units; none for a column without one.
pub(super) fn units(names: &[String], row: &StringRecord) -> Option<Vec<Option<String>>> {
    if row.len() != names.len() {
        return None;
    }
    let mut known = 0;
    let units: Option<Vec<Option<String>>> = row
        .iter()
        .map(|cell| {
            let bare = cell.trim().trim_matches('"').trim();
            let inner = ['[', '(', '{']
                .iter()
                .zip([']', ')', '}'])
                .find_map(|(open, close)| bare.strip_prefix(*open)?.strip_suffix(close));
            let unit = inner.unwrap_or(bare).trim();
            if ["", "-", "1", "none", "n/a"].iter().any(|none| unit.eq_ignore_ascii_case(none)) {
                return Some(None);
            }
            // A number is a value.
            if unit.parse::<f64>().is_ok() {
                return None;
            }
            let is_unit = units::unit_of(unit).is_some();
            known += usize::from(is_unit);
            (is_unit || inner.is_some()).then(|| Some(unit.to_owned()))
        })
        .collect();
    units.filter(|_| known > 0)
}
