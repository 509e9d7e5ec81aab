//! The tables: what agrees, what is held out, what was refused or warned of.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use super::pairs::Pair;
use super::said::Said;
use super::{Halved, HeldOut};
use crate::strangers::peer;

/// Everything, as Markdown.
pub fn render(halved: &[Halved], held_out: &[HeldOut]) -> String {
    let parts = [
        halves(halved),
        by_parameter(halved),
        summary(halved),
        apart(halved),
        errors(held_out),
        sentences(halved, held_out),
    ];
    parts.concat()
}

fn percent(part: usize, whole: usize) -> String {
    if whole == 0 { "-".to_owned() } else { format!("{:.0} %", 100.0 * part as f64 / whole as f64) }
}

/// How many of some pairs agree.
struct Count {
    pairs: usize,
    agree: usize,
    overlap: usize,
}

impl Count {
    fn of<'a>(pairs: impl Iterator<Item = &'a Pair>) -> Self {
        let mut count = Self { pairs: 0, agree: 0, overlap: 0 };
        for pair in pairs {
            count.pairs += 1;
            count.agree += usize::from(pair.agrees());
            count.overlap += usize::from(pair.overlap);
        }
        count
    }
}

/// Parameters that are told, and those of them that are called identified, without a warning.
fn told<'a>(halves: impl Iterator<Item = &'a Said>) -> [usize; 2] {
    let mut count = [0; 2];
    for model in halves.flat_map(|said| &said.models) {
        count[0] += model.parameters.len();
        if model.warnings.is_empty() {
            count[1] += model.parameters.iter().filter(|told| told.identified).count();
        }
    }
    count
}

fn halves(halved: &[Halved]) -> String {
    let mut text = String::from(
        "| recording | halves | model chosen | pairs | agree | overlap | called identified | warned |\n|---|---|---|---|---|---|---|---|\n",
    );
    for Halved { recording, split, halves, pairs } in halved {
        let count = Count::of(pairs.iter().filter(|pair| pair.trusted()));
        let chosen = |said: &Said| match (&said.refused, said.chosen()) {
            (Some(_), _) => "refused".to_owned(),
            (None, chosen) => chosen.map_or("-".to_owned(), |model| model.name.clone()),
        };
        let chosen: Vec<String> = halves.iter().map(chosen).collect();
        let warned = halves
            .iter()
            .filter(|said| said.chosen().is_some_and(|model| !model.warnings.is_empty()));
        let [all, identified] = told(halves.iter());
        let _ = writeln!(
            text,
            "| {recording} | {split} | {} | {} | {} | {} | {identified}/{all} | {}/{} |",
            chosen.join("; "),
            count.pairs,
            count.agree,
            count.overlap,
            warned.count(),
            halves.len(),
        );
    }
    text
}

fn by_parameter(halved: &[Halved]) -> String {
    let mut named: BTreeMap<(bool, &str), Vec<&Pair>> = BTreeMap::new();
    for pair in halved.iter().flat_map(|halved| &halved.pairs) {
        named.entry((pair.model == "servo", &pair.parameter)).or_default().push(pair);
    }
    let mut text = String::from(
        "\n| parameter | told by both | pairs: identified by both, no warning | agree | overlap |\n|---|---|---|---|---|\n",
    );
    for ((_, name), pairs) in named {
        let count = Count::of(pairs.iter().copied().filter(|pair| pair.trusted()));
        let all = pairs.len();
        let Count { pairs, agree, overlap } = count;
        let _ = writeln!(text, "| {name} | {all} | {pairs} | {agree} | {overlap} |");
    }
    text
}

fn summary(halved: &[Halved]) -> String {
    let mut text = String::new();
    let plain = |pair: &&Pair| matches!(pair.model, "symmetric" | "asymmetric");
    let chosen = |pair: &&Pair| pair.model == "structure";
    let servo = |pair: &&Pair| pair.model == "servo";
    let all = || halved.iter().flat_map(|halved| &halved.pairs);
    let mut line = |what: &str, count: Count| {
        let Count { pairs, agree, overlap } = count;
        if pairs == 0 {
            return;
        }
        let _ = writeln!(
            text,
            "{what}: {pairs} pairs, {agree} ({}) agree, {overlap} ({}) overlap",
            percent(agree, pairs),
            percent(overlap, pairs)
        );
    };
    line("\nidentified by both halves, no warning", Count::of(all().filter(|pair| pair.trusted())));
    for (what, of) in [
        ("- the plain models", &plain as &dyn Fn(&&Pair) -> bool),
        ("- the structure chosen", &chosen),
        ("- servos", &servo),
    ] {
        line(what, Count::of(all().filter(|pair| pair.trusted()).filter(of)));
    }
    line(
        "identified, but a warning says not to trust the model",
        Count::of(all().filter(|pair| pair.identified() && pair.warned)),
    );
    line("all that both tell, identified or not", Count::of(all()));
    let [told, identified] = told(halved.iter().flat_map(|halved| &halved.halves));
    let _ = writeln!(
        text,
        "called identified without a warning: {identified} of {told} parameters ({})",
        percent(identified, told)
    );
    text
}

/// The pairs that should agree and do not.
fn apart(halved: &[Halved]) -> String {
    let mut text = String::new();
    for Halved { recording, split, pairs, .. } in halved {
        for pair in pairs.iter().filter(|pair| pair.trusted() && !pair.agrees()) {
            let told = |told: &super::said::Told| match told.interval {
                Some([low, high]) => format!("{:.4} [{low:.4}, {high:.4}]", told.value),
                None => format!("{:.4}", told.value),
            };
            let Pair { model, first, second, apart, .. } = pair;
            let _ = writeln!(
                text,
                "| {recording} | {split} | {model} | {} | {} | {} | {apart:.2} |",
                first.name,
                told(first),
                told(second)
            );
        }
    }
    if text.is_empty() {
        return text;
    }
    format!(
        "\nDo not agree:\n\n| recording | halves | model | parameter | first | second | difference over its 95 % |\n|---|---|---|---|---|---|---|\n{text}"
    )
}

fn errors(held_out: &[HeldOut]) -> String {
    if held_out.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "\n| recording | fitted to | model chosen | held out [%] | SciPy's best [%] | ratio | warned |\n|---|---|---|---|---|---|---|\n",
    );
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.2}"));
    for held in held_out {
        let HeldOut { recording, fitted, said, peer, .. } = held;
        let chosen = match (&said.refused, said.chosen()) {
            (Some(_), _) => "refused",
            (None, chosen) => chosen.map_or("-", |model| &model.name),
        };
        let best =
            peer::best(peer).map_or("-".to_owned(), |(name, error)| format!("{error:.2} ({name})"));
        let warned = said.chosen().is_some_and(|model| !model.warnings.is_empty());
        let _ = writeln!(
            text,
            "| {recording} | {fitted} | {chosen} | {} | {best} | {} | {} |",
            number(said.held_out),
            number(held.ratio()),
            if warned { "yes" } else { "no" },
        );
    }
    let mut ratios: Vec<f64> = held_out.iter().filter_map(HeldOut::ratio).collect();
    ratios.sort_by(f64::total_cmp);
    if let (Some(middle), Some(largest)) = (ratios.get(ratios.len() / 2), ratios.last()) {
        let _ = writeln!(
            text,
            "\nheld-out error over the best of SciPy: median {middle:.3}, largest {largest:.3}"
        );
    }
    text
}

/// Refusals and warnings, each once.
fn sentences(halved: &[Halved], held_out: &[HeldOut]) -> String {
    let mut said: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let of_halves = halved.iter().flat_map(|halved| {
        let place =
            |(half, said)| (format!("{}, {}, half {}", halved.recording, halved.split, half), said);
        (1..).zip(&halved.halves).map(place)
    });
    let of_held_out = held_out.iter().map(|held| {
        (format!("{}, {} tried on the other", held.recording, held.fitted), &held.said)
    });
    for (place, answer) in of_halves.chain(of_held_out) {
        let warnings = answer.models.iter().flat_map(|model| &model.warnings);
        for sentence in answer.refused.iter().chain(warnings) {
            said.entry(place.clone()).or_default().insert(sentence.clone());
        }
    }
    if said.is_empty() {
        return "\nNothing was refused or warned of.\n".to_owned();
    }
    let mut text = String::from("\nRefused or warned of:\n\n");
    for (place, sentences) in said {
        for sentence in sentences {
            let _ = writeln!(text, "* {place}: {sentence}");
        }
    }
    text
}
