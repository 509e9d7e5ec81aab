//! Two runs beside each other as a page.

use std::fs;

use report::figure::{Block, Figure, Mark, Page, Panel, Table, Trace};
use report::read_page;

use crate::compare::{Compared, Comparison};
use crate::run::Run;

/// Most parameters that are drawn.
const MOST: usize = 40;

impl Comparison {
    /// The page; `beside` stands behind the parameters.
    ///
    /// Figures of the same title in both reports stand in it one after the other.
    #[must_use]
    pub fn page(&self, beside: Vec<Block>) -> Page {
        let mut blocks = vec![
            Block::Text("What two runs found, and in which settings they differ.".to_owned()),
            Block::Table(self.both()),
        ];
        blocks.push(Block::Heading("Parameters".to_owned()));
        if self.parameters.is_empty() {
            blocks.push(Block::Text("Neither has parameters with intervals.".to_owned()));
        } else {
            blocks.extend(self.drawn().map(Block::Figure));
            blocks.push(Block::Table(table(
                "Parameters with their 95 % intervals",
                "Two values differ where the difference is larger than both half widths together, as errors that are independent: of two that are equal, 5 % are called different.",
                ["parameter", "A", "B", "verdict"],
                self.parameters.iter().map(Compared::row),
            )));
        }
        blocks.extend(beside);
        blocks.push(Block::Heading("Settings that differ".to_owned()));
        if self.settings.is_empty() {
            blocks.push(Block::Text("None.".to_owned()));
        } else {
            let rows = self.settings.iter().map(|setting| {
                let [a, b] = setting.shown();
                vec![setting.place.clone(), a, b]
            });
            blocks.push(Block::Table(Table {
                title: "Settings".to_owned(),
                caption: "Their places in the documents of both runs.".to_owned(),
                columns: ["setting", "A", "B"].map(str::to_owned).to_vec(),
                rows: rows.collect(),
                highlight: None,
            }));
        }
        if !self.figures.is_empty() {
            blocks.push(Block::Heading("Figures that are not equal".to_owned()));
            blocks.push(Block::Table(table(
                "Figures",
                "Numbers without an interval, by their places in the documents.",
                ["figure", "A", "B", "B over A"],
                self.figures.iter().map(crate::compare::Unequal::row),
            )));
        }
        blocks.extend(self.pictures());
        let [a, b] = &self.runs;
        Page {
            title: "Two runs".to_owned(),
            subtitle: format!("A: {}; B: {}", a.folder.display(), b.folder.display()),
            blocks,
        }
    }

    fn both(&self) -> Table {
        let row = |what: &str, of: &dyn Fn(&Run) -> String| {
            let [a, b] = &self.runs;
            vec![what.to_owned(), of(a), of(b)]
        };
        let text = |value: &Option<String>| value.clone().unwrap_or_else(|| "-".to_owned());
        Table {
            title: "The runs".to_owned(),
            caption: String::new(),
            columns: ["what", "A", "B"].map(str::to_owned).to_vec(),
            rows: vec![
                row("folder", &|run| run.folder.display().to_string()),
                row("kind", &Run::title),
                row("made", &|run| text(&run.made)),
                row("how it ended", &|run| run.said.clone()),
                row("version", &|run| text(&run.program_version)),
            ],
            highlight: None,
        }
    }

    /// Parameters of both runs over those of A; nothing where none is in both.
    fn drawn(&self) -> Option<Figure> {
        let relative: Vec<(&str, f64)> = self
            .parameters
            .iter()
            .filter_map(|one| {
                let [Some(a), Some(b)] = &one.found else { return None };
                let ratio = b.value? / a.value?;
                ratio.is_finite().then_some((one.place.as_str(), 100.0 * (ratio - 1.0)))
            })
            .take(MOST)
            .collect();
        let bars = Trace::Categories {
            name: "B less A".to_owned(),
            x: relative.iter().map(|(place, _)| (*place).to_owned()).collect(),
            y: relative.iter().map(|(_, percent)| *percent).collect(),
            mark: Mark::Bar,
        };
        (!relative.is_empty()).then(|| Figure {
            title: "By how much parameters of B are larger".to_owned(),
            caption: "Of those that both runs have. Whether that means anything is in the table."
                .to_owned(),
            x_label: "parameter".to_owned(),
            log_x: false,
            panels: vec![Panel { y_label: "B less A [% of A]".to_owned(), traces: vec![bars] }],
        })
    }

    /// Figures that both reports have, those of A and of B in turn.
    fn pictures(&self) -> Vec<Block> {
        let [a, b] = self.runs.each_ref().map(figures_of);
        let mut blocks = Vec::new();
        for figure in a {
            let Some(other) = b.iter().find(|other| other.title == figure.title) else { continue };
            for (letter, figure) in [("A", &figure), ("B", other)] {
                let title = format!("{letter}: {}", figure.title);
                blocks.push(Block::Figure(Figure { title, ..figure.clone() }));
            }
        }
        if !blocks.is_empty() {
            blocks.insert(0, Block::Heading("Pictures of both reports".to_owned()));
        }
        blocks
    }
}

/// The figures of a run's report, as far as it can be read.
fn figures_of(run: &Run) -> Vec<Figure> {
    let html = run.report.as_ref().and_then(|file| fs::read_to_string(file).ok());
    let kept = html.and_then(|html| read_page(&html).ok());
    kept.into_iter()
        .flat_map(|kept| kept.page.blocks)
        .filter_map(|block| if let Block::Figure(figure) = block { Some(figure) } else { None })
        .collect()
}

fn table(
    title: &str,
    caption: &str,
    columns: [&str; 4],
    rows: impl Iterator<Item = [String; 4]>,
) -> Table {
    Table {
        title: title.to_owned(),
        caption: caption.to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: rows.map(Vec::from).collect(),
        highlight: None,
    }
}
