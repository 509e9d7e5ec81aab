//! The page around the figures and tables.

use std::fmt::Write;

use super::figure::{Block, Figure, FileLink, Page};
use super::html::{escape, escape_json, prose};
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
const HINT: &str = "<p class=\"hint\">In every figure: drag to zoom, double-click to reset, point to read values, \
                    click a legend entry to hide or show it. A series looks the same throughout: colour, stroke and marker.</p>\n\
                    <noscript><p class=\"note\">The figures are drawn by a script inside this file; \
                    scripts are switched off in this browser.</p></noscript>\n";

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
    let mut body = Body::default();
    for block in &page.blocks {
        body.block(block, &palette);
    }
    let title = escape(&page.title);
    let mut out = String::with_capacity(PLOTLY.len() + body.html.len() + 40_000);
    // Writing to a String cannot fail, hence the results are let go here and below.
    let _ = write!(
        out,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta name=\"generator\" content=\"frictionlab {version}\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <a class=\"skip\" href=\"#content\">Skip to the results</a>\n\
         <header><h1>{title}</h1>\n<p class=\"subtitle\">{subtitle}</p></header>\n",
        version = env!("CARGO_PKG_VERSION"),
        subtitle = escape(&page.subtitle),
    );
    out.push_str(&body.contents());
    out.push_str("<main id=\"content\">\n");
    out.push_str(&body.html);
    let _ = write!(
        out,
        "</main>\n<footer>Made by frictionlab {}. This file is complete: it needs no network{}.</footer>\n",
        env!("CARGO_PKG_VERSION"),
        if body.figures > 0 { "; figures by plotly.js (MIT)" } else { "" },
    );
    if body.figures + body.tables > 0 {
        let _ = write!(out, "<script>\n{CSV}</script>\n");
    }
    if body.figures > 0 {
        let _ = write!(
            out,
            "<script>\n/* plotly.js is distributed under this licence:\n{PLOTLY_LICENSE}\n*/\n{PLOTLY}</script>\n\
             <script>\n{SCRIPT}</script>\n"
        );
    }
    out.push_str("</body>\n</html>\n");
    out
}

/// The blocks so far.
#[derive(Default)]
struct Body {
    html: String,
    headings: Vec<String>,
    figures: usize,
    tables: usize,
}

impl Body {
    fn block(&mut self, block: &Block, palette: &Palette) {
        match block {
            Block::Heading(text) => {
                self.headings.push(prose(text));
                let _ = writeln!(
                    self.html,
                    "<h2 id=\"section-{}\">{}</h2>",
                    self.headings.len(),
                    prose(text)
                );
            }
            Block::Text(text) => {
                let _ = writeln!(self.html, "<p class=\"text\">{}</p>", prose(text));
            }
            Block::Note(text) => {
                let _ = writeln!(self.html, "<p class=\"note\" role=\"note\">{}</p>", prose(text));
            }
            Block::Figure(figure) => self.figure(figure, palette),
            Block::Table(t) => {
                self.tables += 1;
                self.html.push_str(&table::render(t, self.tables));
            }
            Block::Files(files) => self.files(files),
        }
    }

    fn files(&mut self, files: &[FileLink]) {
        self.html.push_str("<ul class=\"files\" aria-label=\"Files beside this page\">\n");
        for file in files {
            let _ = writeln!(
                self.html,
                "<li><a href=\"{}\">{}</a> {}</li>",
                escape(&address(&file.path)),
                escape(&file.path),
                prose(&file.what)
            );
        }
        self.html.push_str("</ul>\n");
    }

    fn figure(&mut self, figure: &Figure, palette: &Palette) {
        self.figures += 1;
        let number = self.figures;
        if number == 1 {
            self.html.push_str(HINT);
        }
        let plot = Plot::of(figure, palette);
        let remarks: String = plot
            .remarks
            .iter()
            .map(|r| format!(" <span class=\"remark\">{}</span>", escape(r)))
            .collect();
        let _ = write!(
            self.html,
            "<figure id=\"figure-{number}\" aria-labelledby=\"caption-{number}\">\n\
             <div class=\"plot\" id=\"plot-{number}\" style=\"height:{height}px\" role=\"img\" aria-label=\"{label}\">\
             </div>\n\
             <figcaption id=\"caption-{number}\"><b>Figure {number}. {title}.</b> {caption}{remarks} \
             <button type=\"button\" class=\"csv\" data-figure=\"{number}\">Save as CSV</button></figcaption>\n\
             <script type=\"application/json\" id=\"data-{number}\">{json}</script>\n</figure>\n",
            height = height(figure.panels.len()),
            label = escape(&plot.description()),
            title = prose(figure.title.trim_end_matches('.')),
            caption = prose(&figure.caption),
            json = escape_json(&plot.json()),
        );
    }

    /// The table of contents of a long page; nothing on a short one.
    fn contents(&self) -> String {
        if self.headings.len() < HEADINGS_FOR_CONTENTS {
            return String::new();
        }
        let mut out = String::from("<nav aria-label=\"Contents\"><h2>Contents</h2><ol>\n");
        for (i, heading) in self.headings.iter().enumerate() {
            let _ = writeln!(out, "<li><a href=\"#section-{}\">{heading}</a></li>", i + 1);
        }
        out.push_str("</ol></nav>\n");
        out
    }
}

/// A relative path as an address: what stands for something else in one is encoded.
fn address(path: &str) -> String {
    let mut out = String::from("./");
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte) {
            out.push(char::from(byte));
        } else {
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
    use crate::figure::{LineStyle, Panel, Table, Trace};

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
        let figure = Figure {
            title: text(),
            caption: text(),
            x_label: text(),
            log_x: false,
            panels: vec![Panel { y_label: text(), traces: vec![line] }],
        };
        let table = Table {
            title: text(),
            caption: text(),
            columns: vec![text()],
            rows: vec![vec![text()]],
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
                Block::Figure(figure),
                Block::Table(table),
            ],
        }
    }

    #[test]
    fn no_text_becomes_markup() {
        let html = render_page(&nasty_page());
        assert!(!html.contains("<img"), "an element got through");
        // Data, library, our scripts: each opened and closed once, none closed by a label.
        assert_eq!(html.matches("<script").count(), 4);
        assert_eq!(html.matches("</script").count(), 4);
        assert_eq!(html.matches("&lt;/script&gt;").count(), html.matches("&lt;img").count());
        assert!(html.matches("&lt;img").count() >= 13);
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
        assert!(!html.contains("<script"));
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
        assert!(html.contains("role=\"img\" aria-label=\"Plot of "));
    }
}
