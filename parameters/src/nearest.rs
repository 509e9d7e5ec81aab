//! The known name that is meant by a misspelt one.

/// Likeness from which a known name is taken for the one that is meant, from 0 to 1.
const ALIKE: f64 = 0.7;

/// The name among `known` that looks most like `given`; none if none looks much like it. Where the
/// last part of a dotted name fits a known one whole, as `k_p` does `pid.k_p`, that counts too.
///
/// ```
/// assert_eq!(parameters::nearest("compensaton", ["mode", "compensation"]), Some("compensation"));
/// assert_eq!(parameters::nearest("k_p", ["mode", "pid.k_p"]), Some("pid.k_p"));
/// assert_eq!(parameters::nearest("colour", ["mode", "pid.k_p"]), None);
/// ```
pub fn nearest<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let likeness = |name: &str| {
        let whole = strsim::jaro_winkler(given, name);
        let last = |name: &str| name.rsplit('.').next() == given.rsplit('.').next();
        if last(name) { whole.max(ALIKE) } else { whole }
    };
    known
        .into_iter()
        .map(|name| (likeness(name), name))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, name)| name)
}

/// What serde says of a key that it does not know, with the known key that is meant.
///
/// ```
/// let said = "unknown field `limit`, expected one of `rig`, `limits`, `drive`";
/// assert!(parameters::with_nearest(said).ends_with("; is `limits` meant?"));
/// ```
#[must_use]
pub fn with_nearest(said: &str) -> String {
    let unknown = said.split_once("unknown field `").and_then(|(_, rest)| rest.split_once('`'));
    let nearest =
        unknown.and_then(|(name, rest)| nearest(name, rest.split('`').skip(1).step_by(2)));
    nearest.map_or_else(|| said.to_owned(), |nearest| format!("{said}; is `{nearest}` meant?"))
}
