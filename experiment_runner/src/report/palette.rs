//! One colour a series name, the same in every figure of a page.

use std::collections::{BTreeMap, BTreeSet};

use super::figure::{Block, Page, Panel, Trace};

/// Colours of the palette: Okabe and Ito's, which colour-blind readers tell apart, less black and yellow
/// (`--c0` .. in `report.css`).
pub(crate) const COLOURS: usize = 6;

/// What a series is drawn in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Colour {
    /// The colour of the text: references, targets and limits, against which the rest is seen.
    Ink,
    /// The n-th colour of the palette.
    Slot(usize),
}

impl Colour {
    /// As the page's script reads it: the slot, or -1 for ink.
    pub(super) fn code(self) -> i32 {
        match self {
            Colour::Ink => -1,
            Colour::Slot(slot) => slot as i32,
        }
    }
}

/// Series name to colour, for a whole page.
#[derive(Debug, Default)]
pub(super) struct Palette(BTreeMap<String, Colour>);

impl Palette {
    /// Gives every name of `page` a colour, in order of appearance: the first one that no series of
    /// a shared figure has, or, in a figure of many series, the one its neighbours use least.
    pub(super) fn of(page: &Page) -> Self {
        let figures: Vec<Vec<&str>> = page
            .blocks
            .iter()
            .filter_map(|block| match block {
                Block::Figure(figure) => Some(figure.panels.iter().flat_map(series).collect()),
                _ => None,
            })
            .collect();
        let mut given = BTreeMap::new();
        for name in figures.iter().flatten() {
            if given.contains_key(*name) {
                continue;
            }
            let colour = if is_reference(name) {
                Colour::Ink
            } else {
                Colour::Slot(least_used(name, &figures, &given))
            };
            given.insert((*name).to_owned(), colour);
        }
        Palette(given)
    }

    /// The colour of a series; ink for a name the page does not have.
    pub(super) fn colour(&self, name: &str) -> Colour {
        self.0.get(name).copied().unwrap_or(Colour::Ink)
    }
}

/// The name under which each trace of a panel has its colour. A band is that of the curve drawn over it:
/// it has the colour of the next line, if there is one.
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

fn least_used(name: &str, figures: &[Vec<&str>], given: &BTreeMap<String, Colour>) -> usize {
    let neighbours: BTreeSet<&str> =
        figures.iter().filter(|names| names.contains(&name)).flatten().copied().collect();
    let mut uses = [0usize; COLOURS];
    for neighbour in neighbours {
        if let Some(Colour::Slot(slot)) = given.get(neighbour) {
            uses[*slot] += 1;
        }
    }
    (0..COLOURS).min_by_key(|&slot| uses[slot]).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::{Figure, LineStyle};

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

    #[test]
    fn names_keep_their_colour_and_neighbours_differ() {
        let palette = Palette::of(&page(&[&["a", "b"], &["c", "b"], &["reference", "a", "c"]]));
        assert_eq!(palette.colour("a"), Colour::Slot(0));
        assert_eq!(palette.colour("b"), Colour::Slot(1));
        // "c" meets both "b" (second figure) and "a" (third), though never in the same one.
        assert_eq!(palette.colour("c"), Colour::Slot(2));
        assert_eq!(palette.colour("reference"), Colour::Ink);
    }

    #[test]
    fn a_band_has_the_colour_of_its_curve() {
        let band = |name: &str| Trace::Band { name: name.into(), x: vec![], lower: vec![], upper: vec![] };
        let line =
            |name: &str| Trace::Line { name: name.into(), x: vec![], y: vec![], style: LineStyle::Solid };
        let traces = vec![band("95 %"), line("fit a"), band("95 %"), line("fit b"), band("alone")];
        let panel = Panel { y_label: String::new(), traces };
        assert_eq!(series(&panel).collect::<Vec<_>>(), ["fit a", "fit a", "fit b", "fit b", "alone"]);
    }

    #[test]
    fn more_series_than_colours_share_them_evenly() {
        let names: Vec<String> = (0..2 * COLOURS).map(|i| format!("s{i}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let palette = Palette::of(&page(&[&names]));
        for slot in 0..COLOURS {
            assert_eq!(names.iter().filter(|n| palette.colour(n) == Colour::Slot(slot)).count(), 2);
        }
    }
}
