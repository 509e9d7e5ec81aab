//! The known name that is meant by a misspelt one.

/// Likeness from which a known name is taken for the one that is meant, from 0 to 1.
const ALIKE: f64 = 0.7;
/// Letters from which a name says enough to be likened to another.
const TELLING: usize = 3;

/// The name among `known` that looks most like `given`; none if none looks much like it. Where the
/// last part of a dotted name fits a known one whole, as `k_p` does `pid.k_p`, that counts too.
///
/// ```
/// assert_eq!(parameters::nearest("compensaton", ["mode", "compensation"]), Some("compensation"));
/// assert_eq!(parameters::nearest("k_p", ["mode", "pid.k_p"]), Some("pid.k_p"));
/// assert_eq!(parameters::nearest("colour", ["mode", "pid.k_p"]), None);
/// assert_eq!(parameters::nearest("a", ["autostart"]), None);
/// ```
pub fn nearest<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let likeness = |name: &str| {
        let telling = given.chars().count() >= TELLING;
        let whole = if telling { strsim::jaro_winkler(given, name) } else { 0.0 };
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

/// What serde says of a key that it does not know, with the known key that is meant behind the
/// first line.
///
/// ```
/// let said = "unknown field `limit`, expected one of rig, limits, drive\n  --> 24:1";
/// let first = parameters::with_nearest(said).lines().next().map(str::to_owned);
/// assert!(first.unwrap().ends_with("drive; is `limits` meant?"));
/// let said = "unknown field `gian`, expected `gain` or `time`";
/// assert!(parameters::with_nearest(said).ends_with("; is `gain` meant?"));
/// ```
#[must_use]
pub fn with_nearest(said: &str) -> String {
    let (first, rest) = said.split_at(said.find('\n').unwrap_or(said.len()));
    let named = first.split_once("unknown field `").and_then(|(_, rest)| rest.split_once('`'));
    let known = named.map(|(_, known)| {
        let parts = known.split([',', ' ']).map(|part| part.trim_matches('`'));
        parts.filter(|part| !["", "expected", "one", "of", "or"].contains(part))
    });
    let nearest = named.zip(known).and_then(|((name, _), known)| nearest(name, known));
    nearest
        .map_or_else(|| said.to_owned(), |nearest| format!("{first}; is `{nearest}` meant?{rest}"))
}
