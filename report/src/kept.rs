//! A page that can be read again: what it is made of stands in it, beside the data of its figures.
//!
//! So a report of an earlier version gets the looks of this one, and two reports can be compared,
//! without the recordings that they were made of.

use serde::{Deserialize, Serialize};

use super::figure::{Block, Figure, FileLink, LineStyle, Mark, Page, Panel, Table, Trace};
use super::palette::Palette;
use super::plot::Plot;

/// Name of the element that holds the page as data.
pub(super) const ELEMENT: &str = "page-data";

const FORMAT: &str = "frictionlab-report";
const FORMAT_VERSION: u32 = 1;

/// A page that was read again.
#[derive(Debug, Clone)]
pub struct Kept {
    /// The version of the program that made it.
    pub program_version: String,
    /// The page. Its figures have the points that were drawn; what was said of the drawing stands
    /// in their captions.
    pub page: Page,
}

/// Why a page cannot be read again.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NotKept {
    /// It is no report, or one of before this could be done.
    #[error("it holds no page as data: it is no report, or of an earlier version")]
    NoReport,
    /// It is cut off or was changed.
    #[error("its data cannot be read: {0}")]
    Damaged(String),
    /// It is of a later version.
    #[error("it is of version {0} of the format, and this program reads {FORMAT_VERSION}")]
    Newer(u32),
}

#[derive(Serialize, Deserialize)]
struct Document {
    format: String,
    format_version: u32,
    program_version: String,
    title: String,
    subtitle: String,
    blocks: Vec<Part>,
}

/// A block; what a figure draws stands in an element of its own.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Part {
    Heading(String),
    Text(String),
    Note(String),
    Figure { title: String, caption: String, remarks: Vec<String> },
    Table(Table),
    Files(Vec<FileLink>),
}

/// The page as data, but for what its figures draw.
pub(super) fn json(page: &Page, palette: &Palette) -> String {
    let part = |block: &Block| match block {
        Block::Heading(text) => Part::Heading(text.clone()),
        Block::Text(text) => Part::Text(text.clone()),
        Block::Note(text) => Part::Note(text.clone()),
        Block::Figure(figure) => Part::Figure {
            title: figure.title.clone(),
            caption: figure.caption.clone(),
            remarks: Plot::of(figure, palette).remarks,
        },
        Block::Table(table) => Part::Table(table.clone()),
        Block::Files(links) => Part::Files(links.clone()),
    };
    let document = Document {
        format: FORMAT.to_owned(),
        format_version: FORMAT_VERSION,
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        title: page.title.clone(),
        subtitle: page.subtitle.clone(),
        blocks: page.blocks.iter().map(part).collect(),
    };
    // Cannot fail: text and lists of text, and the writer is memory.
    serde_json::to_string(&document).expect("a page is plain data")
}

/// Reads a report again.
///
/// # Errors
/// [`NotKept`] says why it cannot be.
pub fn read_page(html: &str) -> Result<Kept, NotKept> {
    let text = element(html, ELEMENT).ok_or(NotKept::NoReport)?;
    let Version { format_version } = parsed(text)?;
    if format_version > FORMAT_VERSION {
        return Err(NotKept::Newer(format_version));
    }
    let document: Document = parsed(text)?;
    if document.format != FORMAT {
        return Err(NotKept::NoReport);
    }
    let mut figures = 0;
    let blocks = document
        .blocks
        .into_iter()
        .map(|part| {
            Ok(match part {
                Part::Heading(text) => Block::Heading(text),
                Part::Text(text) => Block::Text(text),
                Part::Note(text) => Block::Note(text),
                Part::Table(table) => Block::Table(table),
                Part::Files(links) => Block::Files(links),
                Part::Figure { title, caption, remarks } => {
                    figures += 1;
                    let caption = [vec![caption], remarks].concat().join(" ");
                    Block::Figure(figure(html, figures, title, caption)?)
                }
            })
        })
        .collect::<Result<_, NotKept>>()?;
    let Document { title, subtitle, program_version, .. } = document;
    Ok(Kept { program_version, page: Page { title, subtitle, blocks } })
}

#[derive(Deserialize)]
struct Version {
    format_version: u32,
}

fn parsed<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, NotKept> {
    serde_json::from_str(text).map_err(|error| NotKept::Damaged(error.to_string()))
}

/// The text of a script element with that name.
fn element<'a>(html: &'a str, id: &str) -> Option<&'a str> {
    let opened = format!("<script type=\"application/json\" id=\"{id}\">");
    let (_, rest) = html.split_once(&opened)?;
    rest.split_once("</script>").map(|(text, _)| text)
}

/// A figure as it was drawn.
#[derive(Deserialize)]
struct Drawn {
    x_label: String,
    log_x: bool,
    y_labels: Vec<String>,
    categories: Vec<String>,
    traces: Vec<DrawnTrace>,
}

#[derive(Deserialize)]
struct DrawnTrace {
    kind: Kind,
    panel: usize,
    name: String,
    #[serde(default)]
    style: LineStyle,
    x: Vec<Option<f64>>,
    y: Vec<Option<f64>>,
    error: Option<Vec<Option<f64>>>,
    upper: Option<Vec<Option<f64>>>,
    width: Option<f64>,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Line,
    Points,
    Loop,
    Bars,
    Band,
}

fn figure(html: &str, number: usize, title: String, caption: String) -> Result<Figure, NotKept> {
    let text = element(html, &format!("data-{number}"))
        .ok_or_else(|| NotKept::Damaged(format!("figure {number} has no data")))?;
    let Drawn { x_label, log_x, y_labels, categories, traces } = parsed(text)?;
    let mut panels: Vec<Panel> =
        y_labels.into_iter().map(|y_label| Panel { y_label, traces: Vec::new() }).collect();
    for trace in traces {
        let panel = panels
            .get_mut(trace.panel)
            .ok_or_else(|| NotKept::Damaged(format!("figure {number} lacks a panel")))?;
        panel.traces.push(trace.undrawn(&categories));
    }
    Ok(Figure { title, caption, x_label, log_x, panels })
}

impl DrawnTrace {
    fn undrawn(self, categories: &[String]) -> Trace {
        let numbers = |list: Vec<Option<f64>>| -> Vec<f64> {
            list.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect()
        };
        let Self { kind, name, style, x, y, error, upper, width, .. } = self;
        let of_categories = width.is_some();
        match kind {
            Kind::Bars | Kind::Points if of_categories => Trace::Categories {
                name,
                // Values stand beside the middle of their category.
                x: x.into_iter()
                    .map(|at| {
                        let place = at.map_or(0, |at| at.round().max(0.0) as usize);
                        categories.get(place).cloned().unwrap_or_default()
                    })
                    .collect(),
                y: numbers(y),
                mark: if kind == Kind::Bars { Mark::Bar } else { Mark::Marker },
            },
            Kind::Points | Kind::Bars => {
                Trace::Points { name, x: numbers(x), y: numbers(y), error: error.map(numbers) }
            }
            Kind::Line => Trace::Line { name, x: numbers(x), y: numbers(y), style },
            Kind::Loop => Trace::Loop { name, x: numbers(x), y: numbers(y) },
            Kind::Band => Trace::Band {
                name,
                x: numbers(x),
                lower: numbers(y),
                upper: upper.map(numbers).unwrap_or_default(),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render_page;

    fn page() -> Page {
        let long: Vec<f64> = (0..9000).map(f64::from).collect();
        let traces = vec![
            Trace::Band { name: "95 %".into(), x: vec![0.0], lower: vec![-1.0], upper: vec![1.0] },
            Trace::Line {
                name: "</script>".into(),
                y: long.iter().map(|x| if *x == 7.0 { f64::NAN } else { x.sin() }).collect(),
                x: long,
                style: LineStyle::Dashed,
            },
            Trace::Points { name: "p".into(), x: vec![1.0], y: vec![2.0], error: Some(vec![0.5]) },
            Trace::Loop { name: "l".into(), x: vec![0.0, 1.0, 0.0], y: vec![0.0, 1.0, 2.0] },
        ];
        let bars = |name: &str, mark| Trace::Categories {
            name: name.into(),
            x: vec!["slow".into(), "fast".into()],
            y: vec![1.0, f64::NAN],
            mark,
        };
        let figure = |traces| Figure {
            title: "t".into(),
            caption: "c".into(),
            x_label: "time [s]".into(),
            log_x: false,
            panels: vec![Panel { y_label: "y".into(), traces }],
        };
        let table = Table {
            columns: vec!["a".into()],
            rows: vec![vec!["1".into()]],
            highlight: Some(0),
            ..Table::default()
        };
        Page {
            title: "A <b>page</b>".into(),
            subtitle: "of now".into(),
            blocks: vec![
                Block::Heading("h".into()),
                Block::Figure(figure(traces)),
                Block::Figure(figure(vec![bars("x", Mark::Bar), bars("y", Mark::Marker)])),
                Block::Table(table),
                Block::Text("x".into()),
                Block::Note("y".into()),
                Block::Files(vec![FileLink { path: "a".into(), what: "b".into() }]),
            ],
        }
    }

    #[test]
    fn a_page_that_is_read_again_is_drawn_as_before() {
        let html = render_page(&page());
        let again = render_page(&read_page(&html).unwrap().page);
        for figure in ["data-1", "data-2"] {
            assert_eq!(element(&html, figure).unwrap(), element(&again, figure).unwrap());
        }
        // What was said of the drawing is said in the caption, and all else is as it was.
        let plain = |html: &str| {
            let shown = html.split("<script").next().unwrap_or_default();
            shown.replace(" <span class=\"remark\">", " ").replace("</span>", "")
        };
        assert!(html.contains("<span class=\"remark\">Drawn thinned"));
        assert_eq!(plain(&html), plain(&again));
        assert_eq!(again, render_page(&read_page(&again).unwrap().page));
    }

    #[test]
    fn what_is_no_whole_report_is_told() {
        let html = render_page(&page());
        assert_eq!(read_page("<html></html>").unwrap_err(), NotKept::NoReport);
        assert_eq!(read_page(&html[..html.len() / 2]).unwrap_err(), NotKept::NoReport);
        let without = html.replacen("id=\"data-1\"", "id=\"other\"", 1);
        assert!(matches!(read_page(&without).unwrap_err(), NotKept::Damaged(_)));
        let lost = html.replace("\"panel\":0", "\"panel\":9");
        assert!(matches!(read_page(&lost).unwrap_err(), NotKept::Damaged(_)));
        let newer = html.replace("\"format_version\":1", "\"format_version\":7");
        assert_eq!(read_page(&newer).unwrap_err(), NotKept::Newer(7));
    }
}
