//! What somebody may have meant by a word that there is not.

use clap::Command;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// The name that is nearest to a word: at most a third of its letters wrong, missing, too many or
/// swapped with the next.
#[must_use]
pub fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    let distance = |name: &'a str| (strsim::damerau_levenshtein(&word, name), name);
    let allowed = (word.chars().count() / 3).max(1);
    names
        .into_iter()
        .map(distance)
        .filter(|(wrong, _)| *wrong <= allowed)
        .min()
        .map(|(_, name)| name)
}

/// The same as the end of a sentence, with what is before it; nothing where no name is near.
#[must_use]
pub fn did_you_mean<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    nearest(word, names).map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

/// Adds to clap's error the name that was meant, where clap has found none.
#[must_use]
pub fn with_suggestion(mut error: clap::Error, command: &Command) -> clap::Error {
    let (given, known, suggested) = match error.kind() {
        ErrorKind::InvalidSubcommand => {
            (ContextKind::InvalidSubcommand, None, ContextKind::SuggestedSubcommand)
        }
        ErrorKind::InvalidValue => {
            (ContextKind::InvalidValue, Some(ContextKind::ValidValue), ContextKind::SuggestedValue)
        }
        _ => return error,
    };
    if error.get(suggested).is_some() {
        return error;
    }
    let Some(ContextValue::String(word)) = error.get(given) else { return error };
    let names: Vec<String> = match known.map(|known| error.get(known)) {
        Some(Some(ContextValue::Strings(names))) => names.clone(),
        Some(_) => return error,
        None => command.get_subcommands().map(|command| command.get_name().to_owned()).collect(),
    };
    let Some(name) = nearest(word, names.iter().map(String::as_str)).map(str::to_owned) else {
        return error;
    };
    let value = match suggested {
        ContextKind::SuggestedValue => ContextValue::String(name),
        _ => ContextValue::Strings(vec![name]),
    };
    error.insert(suggested, value);
    error
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_that_is_near_is_suggested_and_no_other() {
        let names = ["run", "rig", "lugre", "proposed", "identify", "identify-drive"];
        for (word, meant) in [
            ("rnu", Some("run")),
            ("lugree", Some("lugre")),
            ("LuGri", Some("lugre")),
            ("propsed", Some("proposed")),
            ("indentify", Some("identify")),
            ("newton", None),
            ("x", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, names), meant, "{word}");
        }
        assert_eq!(did_you_mean("rnu", names), "; did you mean `run`?");
    }
}
