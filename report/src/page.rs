//! The page around the figures and tables.

use std::fmt::Write;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::figure::{Block, Figure, FileLink, Page};
use super::html::{json_element, prose};
use super::kept;
use super::palette::Palette;
use super::plot::Plot;
use super::table;

const STYLE: &str = include_str!("../assets/report.css");
const SCRIPT: &str = include_str!("../assets/report.js");
const CSV: &str = include_str!("../assets/csv.js");
const PLOTLY: &str = include_str!("../assets/plotly-basic.min.js");
const PLOTLY_LICENSE: &str = include_str!("../assets/plotly-LICENSE.txt");

/// Nothing may be fetched and nothing sent: the browser itself keeps the page offline. Pictures may
/// come from memory only, which saving a figure needs.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
                      img-src data: blob:; base-uri 'none'; form-action 'none'";

/// Stands before the first figure.
const HINT: &str = "In every figure: drag to zoom, double-click to reset, point to read values, \
                    click a legend entry to hide or show it. A series looks the same throughout: \
                    colour, stroke and marker.";

/// Stands there where scripts are off.
const NO_SCRIPT: &str = "The figures are drawn by a script inside this file; scripts are switched \
                         off in this browser.";

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// From this many headings on, the page starts with a table of contents.
const HEADINGS_FOR_CONTENTS: usize = 3;

/// The page as one HTML file that opens from disk in any current browser, without a network.
///
/// The same page gives the same bytes. Text is escaped wherever it comes from. Mistakes in the data
/// do not fail, they show: values that are not finite are gaps, a trace whose columns differ in
/// length is drawn as far as the shortest goes and its figure says so, a ragged table is shown
/// ragged.
pub fn render_page(page: &Page) -> String {
    let palette = Palette::of(page);
    let mut counted = Counted::default();
    let blocks: Vec<Markup> =
        page.blocks.iter().map(|block| counted.block(block, &palette)).collect();
    html! {
        (DOCTYPE)
        html lang="en" {
            (head(&page.title))
            body {
                a class="skip" href="#content" { "Skip to the results" }
                header {
                    h1 { (page.title) }
                    p class="subtitle" { (page.subtitle) }
                }
                (contents(&counted.headings))
                main id="content" { @for block in blocks { (block) "\n" } }
                footer {
                    "Made by frictionlab " (VERSION)
                    ". This file is complete: it needs no network"
                    @if counted.figures > 0 { "; figures by plotly.js (MIT)" }
                    "."
                }
                (scripts(&counted))
                script type="application/json" id=(kept::ELEMENT) {
                    (json_element(&kept::json(page, &palette)))
                }
            }
        }
    }
    .into_string()
}

fn head(title: &str) -> Markup {
    html! {
        head {
            meta charset="utf-8";
            meta http-equiv="Content-Security-Policy" content=(POLICY);
            meta name="viewport" content="width=device-width, initial-scale=1";
            meta name="color-scheme" content="light dark";
            meta name="generator" content={ "frictionlab " (VERSION) };
            title { (title) }
            style { (PreEscaped(STYLE)) }
        }
    }
}

/// The table of contents of a long page; nothing on a short one.
fn contents(headings: &[&str]) -> Markup {
    html! {
        @if headings.len() >= HEADINGS_FOR_CONTENTS {
            nav aria-label="Contents" {
                h2 { "Contents" }
                ol {
                    @for (i, heading) in headings.iter().enumerate() {
                        li { a href={ "#section-" (i + 1) } { (prose(heading)) } }
                    }
                }
            }
        }
    }
}

/// What the page's figures and tables need, the library last: our own text, which closes no
/// element.
fn scripts(counted: &Counted) -> Markup {
    html! {
        @if counted.figures + counted.tables > 0 {
            script { (PreEscaped(CSV)) }
        }
        @if counted.figures > 0 {
            script {
                "/* plotly.js is distributed under this licence:\n"
                (PreEscaped(PLOTLY_LICENSE)) "\n*/\n" (PreEscaped(PLOTLY))
            }
            script { (PreEscaped(SCRIPT)) }
        }
    }
}

/// The blocks so far.
#[derive(Default)]
struct Counted<'a> {
    headings: Vec<&'a str>,
    figures: usize,
    tables: usize,
}

impl<'a> Counted<'a> {
    fn block(&mut self, block: &'a Block, palette: &Palette) -> Markup {
        match block {
            Block::Heading(text) => {
                self.headings.push(text);
                html! { h2 id={ "section-" (self.headings.len()) } { (prose(text)) } }
            }
            Block::Text(text) => html! { p class="text" { (prose(text)) } },
            Block::Note(text) => html! { p class="note" role="note" { (prose(text)) } },
            Block::Figure(shown) => {
                self.figures += 1;
                figure(shown, self.figures, palette)
            }
            Block::Table(shown) => {
                self.tables += 1;
                table::render(shown, self.tables)
            }
            Block::Files(links) => files(links),
        }
    }
}

fn files(links: &[FileLink]) -> Markup {
    html! {
        ul class="files" aria-label="Files beside this page" {
            @for FileLink { path, what } in links {
                li { a href=(address(path)) { (path) } " " (prose(what)) }
            }
        }
    }
}

fn figure(figure: &Figure, number: usize, palette: &Palette) -> Markup {
    let plot = Plot::of(figure, palette);
    let height = height(figure.panels.len());
    let caption = format!("caption-{number}");
    html! {
        @if number == 1 {
            p class="hint" { (HINT) }
            noscript { p class="note" { (NO_SCRIPT) } }
        }
        figure id={ "figure-" (number) } aria-labelledby=(caption) {
            div class="plot" id={ "plot-" (number) } style={ "height:" (height) "px" }
                role="group" aria-label=(plot.description()) {}
            figcaption id=(caption) {
                b { "Figure " (number) ". " (prose(figure.title.trim_end_matches('.'))) "." }
                " " (prose(&figure.caption))
                @for remark in &plot.remarks { " " span class="remark" { (remark) } }
                " " button type="button" class="csv" data-figure=(number) { "Save as CSV" }
            }
            script type="application/json" id={ "data-" (number) } {
                (json_element(&plot.json()))
            }
        }
    }
}

/// A relative path as an address: what stands for something else in one is encoded.
fn address(path: &str) -> String {
    let mut out = String::from("./");
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte) {
            out.push(char::from(byte));
        } else {
            // Writing to a String cannot fail.
            let _ = write!(out, "%{byte:02X}");
        }
    }
    out
}

/// Height of a figure in pixels, fixed before it is drawn so that the page does not jump.
fn height(panels: usize) -> usize {
    match panels {
        0 | 1 => 400,
        2 => 520,
        n => 110 + 185 * n,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{LineStyle, Mark, Panel, Table, Trace};

    const NASTY: &str = "</script><img src=\"https://example.org/x.png\" onerror='alert(1)'>&";

    /// A page whose every text is an attack.
    fn nasty_page() -> Page {
        let text = || NASTY.to_owned();
        let line = Trace::Line {
            name: text(),
            x: vec![0.0, 1.0],
            y: vec![f64::NAN, 1.0],
            style: LineStyle::Solid,
        };
        let bars =
            Trace::Categories { name: text(), x: vec![text()], y: vec![1.0], mark: Mark::Bar };
        let figure = |trace| Figure {
            title: text(),
            caption: text(),
            x_label: text(),
            log_x: false,
            panels: vec![Panel { y_label: text(), traces: vec![trace] }],
        };
        let table = Table {
            title: text(),
            caption: text(),
            columns: vec![text(), format!("torque [{NASTY}]"), format!("`{NASTY}`")],
            rows: vec![vec![text(), format!("`{NASTY}`"), format!("1 ` {NASTY}")]],
            highlight: Some(0),
        };
        Page {
            title: text(),
            subtitle: text(),
            blocks: vec![
                Block::Heading(text()),
                Block::Heading(text()),
                Block::Heading(text()),
                Block::Text(text()),
                Block::Note(text()),
                Block::Figure(figure(line)),
                Block::Figure(figure(bars)),
                Block::Table(table),
                Block::Files(vec![FileLink { path: text(), what: text() }]),
            ],
        }
    }

    #[test]
    fn no_text_becomes_markup() {
        let html = render_page(&nasty_page());
        assert!(!html.contains("<img"), "an element got through");
        // Data, library, our scripts, the page as data: each opened and closed once, none closed by
        // a label.
        assert_eq!(html.matches("<script").count(), 6);
        assert_eq!(html.matches("</script").count(), 6);
        assert_eq!(html.matches("&lt;/script&gt;").count(), html.matches("&lt;img").count());
        // Page 3, sections 3 and their contents, paragraphs 2, figures 5 each, table 9 and its first
        // column twice, files 2.
        assert_eq!(html.matches("&lt;img").count(), 3 + 6 + 2 + 2 * 5 + 11 + 2);
        // An address has no quote that would end it.
        assert!(html.contains("href=\"./%3C/script%3E%3Cimg%20src%3D%22https%3A//"));
    }

    #[test]
    fn the_same_page_gives_the_same_bytes() {
        assert_eq!(render_page(&nasty_page()), render_page(&nasty_page()));
    }

    #[test]
    fn the_browser_is_told_to_stay_offline() {
        let html = render_page(&nasty_page());
        assert!(html.contains("Content-Security-Policy\" content=\"default-src 'none';"));
        for remote in ["<link", "src=\"http", "@import", "url("] {
            assert!([STYLE, SCRIPT, CSV].iter().all(|text| !text.contains(remote)), "{remote}");
        }
        assert!(!PLOTLY.contains("</script"), "the library would end its own element");
    }

    #[test]
    fn a_page_without_figures_carries_no_library() {
        let page =
            Page { title: "t".into(), blocks: vec![Block::Text("x".into())], ..Page::default() };
        let html = render_page(&page);
        assert_eq!(html.matches("<script").count(), 1, "the page as data");
        assert!(html.len() < 20_000);
    }

    #[test]
    fn files_are_linked_by_their_address() {
        let files = vec![FileLink { path: "odd \"name\"#1.csv".into(), what: "a `table`".into() }];
        let page = Page { title: "t".into(), blocks: vec![Block::Files(files)], ..Page::default() };
        let html = render_page(&page);
        assert!(
            html.contains(
                "<a href=\"./odd%20%22name%22%231.csv\">odd &quot;name&quot;#1.csv</a> a <code>table</code>"
            ),
            "{html}"
        );
    }

    #[test]
    fn contents_come_with_the_third_heading() {
        let page = |n: usize| Page {
            blocks: (0..n).map(|i| Block::Heading(format!("part {i}"))).collect(),
            ..Page::default()
        };
        assert!(!render_page(&page(2)).contains("<nav"));
        let html = render_page(&page(3));
        assert!(
            html.contains("<a href=\"#section-3\">part 2</a>") && html.contains("id=\"section-3\"")
        );
    }

    #[test]
    fn figures_and_tables_are_numbered_captioned_and_described() {
        let html = render_page(&nasty_page());
        assert!(html.contains("<b>Figure 1. "));
        assert!(html.contains("<b>Table 1. "));
        assert!(html.contains("aria-labelledby=\"caption-1\""));
        assert!(html.contains("role=\"group\" aria-label=\"Plot of "));
    }
}
