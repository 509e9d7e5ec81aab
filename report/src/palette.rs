//! One look a series name, the same in every figure of a page; one look a friction model, the same
//! on every page.

use std::collections::{BTreeMap, BTreeSet};

use friction_model::ModelName;

use super::figure::{Block, Page, Panel, Trace};

/// Colours of the palette: Okabe and Ito's, which colour-blind readers tell apart, less black and
/// yellow, with a brown and a violet (`--c0` .. in `report.css`).
const COLOURS: usize = 8;

/// Strokes in which each colour comes (`DASHES` in `report.js`).
const STROKES: usize = 6;

/// Strokes that models use; the other series have the rest for themselves.
const MODEL_STROKES: usize = 3;

/// What a series is drawn in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Look {
    /// The colour of the text: references, targets and limits, against which the rest is seen.
    Ink,
    /// The n-th of the looks; every one has its own pair of colour and stroke, and of colour and
    /// marker.
    Number(usize),
}

impl Look {
    /// The slot of the palette, or -1 for ink.
    pub(super) fn colour(self) -> i32 {
        match self {
            Look::Ink => -1,
            Look::Number(number) => (number % COLOURS) as i32,
        }
    }

    /// The stroke, where the line has none of its own.
    pub(super) fn stroke(self) -> usize {
        match self {
            Look::Ink => 0,
            Look::Number(number) => number / COLOURS % STROKES,
        }
    }

    /// The marker: among the strokes of one colour no two have the same one.
    pub(super) fn marker(self) -> usize {
        match self {
            Look::Ink => 0,
            Look::Number(number) => (number % COLOURS + 3 * self.stroke()) % COLOURS,
        }
    }

    /// The look of a friction model, by its place in the catalogue. The bristle models, which are
    /// compared most, have the unbroken line.
    fn of_model(place: usize) -> Self {
        Look::Number((place / COLOURS + 1) % MODEL_STROKES * COLOURS + place % COLOURS)
    }
}

/// Series name to look, for a whole page.
#[derive(Debug, Default)]
pub(super) struct Palette(BTreeMap<String, Look>);

impl Palette {
    /// Gives every name of `page` a look: a model its own, any other name, in order of appearance,
    /// the first one that no model of the page and no series of a shared figure has.
    pub(super) fn of(page: &Page) -> Self {
        let figures: Vec<Vec<&str>> = page
            .blocks
            .iter()
            .filter_map(|block| match block {
                Block::Figure(figure) => Some(figure.panels.iter().flat_map(series).collect()),
                _ => None,
            })
            .collect();
        let names: Vec<&str> = figures.iter().flatten().copied().collect();
        let mut given: BTreeMap<String, Look> = names
            .iter()
            .filter_map(|&name| Some((name.to_owned(), Look::of_model(place_of_model(name)?))))
            .collect();
        let of_models: BTreeSet<Look> = given.values().copied().collect();
        for name in names {
            if given.contains_key(name) {
                continue;
            }
            let look = if is_reference(name) {
                Look::Ink
            } else {
                first_free(name, &figures, &given, &of_models)
            };
            given.insert(name.to_owned(), look);
        }
        Palette(given)
    }

    /// The look of a series; ink for a name the page does not have.
    pub(super) fn look(&self, name: &str) -> Look {
        self.0.get(name).copied().unwrap_or(Look::Ink)
    }
}

/// The place in the catalogue of the model that a series is named after.
fn place_of_model(name: &str) -> Option<usize> {
    ModelName::ALL.iter().position(|model| model.as_str() == name || model.title() == name)
}

/// The name under which each trace of a panel has its look. A band is that of the curve drawn over
/// it: it has the colour of the next line, if there is one.
pub(super) fn series(panel: &Panel) -> impl Iterator<Item = &str> {
    panel.traces.iter().enumerate().map(|(i, trace)| match trace {
        Trace::Band { name, .. } => panel.traces[i..]
            .iter()
            .find_map(|later| match later {
                Trace::Line { name, .. } => Some(name),
                _ => None,
            })
            .unwrap_or(name),
        other => other.name(),
    })
}

fn is_reference(name: &str) -> bool {
    let name = name.to_lowercase();
    ["reference", "target", "set point", "setpoint", "limit"].iter().any(|word| name.contains(word))
}

fn first_free(
    name: &str,
    figures: &[Vec<&str>],
    given: &BTreeMap<String, Look>,
    of_models: &BTreeSet<Look>,
) -> Look {
    let taken: BTreeSet<Look> = figures
        .iter()
        .filter(|names| names.contains(&name))
        .flatten()
        .filter_map(|neighbour| given.get(*neighbour).copied())
        .chain(of_models.iter().copied())
        .collect();
    let colours: BTreeSet<i32> = taken.iter().map(|look| look.colour()).collect();
    let looks = || (0..COLOURS * STROKES).map(Look::Number);
    // An unbroken line in a colour of its own; else a stroke that models do not have; else any that
    // is left.
    looks()
        .take(COLOURS)
        .find(|look| !colours.contains(&look.colour()))
        .or_else(|| looks().take(COLOURS).find(|look| !taken.contains(look)))
        .or_else(|| looks().skip(COLOURS * MODEL_STROKES).find(|look| !taken.contains(look)))
        .or_else(|| looks().find(|look| !taken.contains(look)))
        .unwrap_or(Look::Number(taken.len() % (COLOURS * STROKES)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, LineStyle};

    fn page(figures: &[&[&str]]) -> Page {
        let line = |name: &&str| Trace::Line {
            name: (*name).to_owned(),
            x: vec![],
            y: vec![],
            style: LineStyle::Solid,
        };
        let figure = |names: &&[&str]| {
            let panel = Panel { y_label: String::new(), traces: names.iter().map(line).collect() };
            Block::Figure(Figure { panels: vec![panel], ..Figure::default() })
        };
        Page { blocks: figures.iter().map(figure).collect(), ..Page::default() }
    }

    fn all_differ(looks: &[Look]) {
        let different = |of: &dyn Fn(&Look) -> (i32, usize)| {
            looks.iter().map(of).collect::<BTreeSet<_>>().len()
        };
        assert_eq!(
            different(&|look| (look.colour(), look.stroke())),
            looks.len(),
            "colour and stroke"
        );
        assert_eq!(
            different(&|look| (look.colour(), look.marker())),
            looks.len(),
            "colour and marker"
        );
    }

    #[test]
    fn no_two_of_the_models_look_alike_on_any_page() {
        let titles: Vec<&str> = ModelName::ALL.iter().map(|model| model.title()).collect();
        let palette = Palette::of(&page(&[&titles]));
        let looks: Vec<Look> = titles.iter().map(|title| palette.look(title)).collect();
        all_differ(&looks);
        // By its short name, with other series, on another page: the same.
        for (model, look) in ModelName::ALL.iter().zip(looks) {
            let other = Palette::of(&page(&[&["measured", "none", model.as_str()]]));
            assert_eq!(other.look(model.as_str()), look, "{model}");
            all_differ(&["measured", "none", model.as_str()].map(|name| other.look(name)));
        }
    }

    #[test]
    fn names_keep_their_look_and_neighbours_differ() {
        let palette = Palette::of(&page(&[&["a", "b"], &["c", "b"], &["reference", "a", "c"]]));
        assert_eq!(palette.look("a"), Look::Number(0));
        assert_eq!(palette.look("b"), Look::Number(1));
        // "c" meets both "b" (second figure) and "a" (third), though never in the same one.
        assert_eq!(palette.look("c"), Look::Number(2));
        assert_eq!(palette.look("reference"), Look::Ink);
    }

    #[test]
    fn a_band_has_the_look_of_its_curve() {
        let band =
            |name: &str| Trace::Band { name: name.into(), x: vec![], lower: vec![], upper: vec![] };
        let line = |name: &str| Trace::Line {
            name: name.into(),
            x: vec![],
            y: vec![],
            style: LineStyle::Solid,
        };
        let traces = vec![band("95 %"), line("fit a"), band("95 %"), line("fit b"), band("alone")];
        let panel = Panel { y_label: String::new(), traces };
        assert_eq!(
            series(&panel).collect::<Vec<_>>(),
            ["fit a", "fit a", "fit b", "fit b", "alone"]
        );
    }

    #[test]
    fn as_many_series_as_there_are_looks_all_differ() {
        let names: Vec<String> = (0..COLOURS * STROKES).map(|i| format!("s{i}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let palette = Palette::of(&page(&[&names]));
        all_differ(&names.iter().map(|name| palette.look(name)).collect::<Vec<_>>());
        // All models and a dozen other series in one figure.
        let mut many: Vec<&str> = ModelName::ALL.iter().map(|model| model.title()).collect();
        many.extend(&names[..12]);
        let palette = Palette::of(&page(&[&many]));
        all_differ(&many.iter().map(|name| palette.look(name)).collect::<Vec<_>>());
    }
}
