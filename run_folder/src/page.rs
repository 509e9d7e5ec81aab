//! The page of a run made anew.

use std::fs;
use std::path::Path;

use report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace};
use report::{Kept, linked, read_page};
use serde_json::Value;

use crate::contents::Contents;
use crate::kind::Kind;
use crate::run::{NoRun, REPORT, Run, State};

/// A page, and what it is made of.
#[derive(Debug, Clone)]
pub struct Remade {
    /// The run.
    pub run: Run,
    /// The page.
    pub page: Page,
    /// What was missing, a sentence each: none where the page is whole.
    pub missing: Vec<String>,
    /// Whether there is a report that has more than this page.
    pub poorer: bool,
}

/// Most settings that are shown: of more the document tells.
const MOST_SETTINGS: usize = 60;

impl Run {
    /// The page of the run in `folder`, made anew: of what its report keeps, with the looks of this
    /// program; where that cannot be read, of its document, with what is missing. `recorded` makes
    /// blocks of its bag then.
    ///
    /// # Errors
    /// [`NoRun`] where it is no folder of a run.
    pub fn page(
        folder: &Path,
        recorded: impl FnOnce(&Path) -> Result<Vec<Block>, String>,
    ) -> Result<Remade, NoRun> {
        let (run, document) = Self::open_with(folder)?;
        let unread = match run.report.as_deref().map(kept) {
            Some(Ok(Kept { page, .. })) => {
                return Ok(Remade { run, page, missing: Vec::new(), poorer: false });
            }
            Some(Err(why)) => {
                format!("{REPORT}, in which pictures were kept, cannot be read again: {why}")
            }
            None => format!("{REPORT}, in which pictures were kept, is not there"),
        };
        let mut missing = vec![unread];
        if run.state == State::Unfinished {
            missing.push(format!("{} is not there: {}", run.kind.document(), run.said));
        }
        let mut blocks = vec![Block::Text(format!("{}: {}.", run.title(), run.said))];
        let contents = Contents::of(run.kind, &document);
        blocks.extend(parameters(&contents));
        blocks.extend(steady(&document).map(Block::Figure));
        match run.bag.as_deref().map(recorded) {
            Some(Ok(of_bag)) => blocks.extend(of_bag),
            Some(Err(why)) => missing.push(format!("the bag cannot be read: {why}")),
            None if run.kind == Kind::Run => missing.push("the bag is not there".to_owned()),
            None => {}
        }
        blocks.extend(figures(&contents));
        blocks.extend(settings(&contents, run.kind.document()));
        let said = missing.iter().map(|what| format!("Missing: {what}."));
        blocks.splice(1..1, said.map(Block::Note));
        let version = run.program_version.as_deref().unwrap_or("-");
        let page = Page {
            title: format!("frictionlab {}", run.title()),
            subtitle: format!(
                "{}, {}, version {version}; made anew of what its folder holds",
                run.folder.display(),
                run.made.as_deref().unwrap_or("at an unknown time")
            ),
            blocks,
        };
        let names = names(folder);
        let page = linked(page, names.iter().map(String::as_str));
        Ok(Remade { poorer: run.report.is_some(), run, page, missing })
    }
}

fn kept(file: &Path) -> Result<Kept, String> {
    let bytes = files::input::table(file).map_err(|error| error.to_string())?;
    let html = String::from_utf8(bytes).map_err(|error| error.to_string())?;
    read_page(&html).map_err(|error| error.to_string())
}

/// Names in the folder, in order.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    names
}

fn parameters(contents: &Contents) -> Vec<Block> {
    let mut blocks = Vec::new();
    if !contents.parameters.is_empty() {
        let number = |value: Option<f64>| {
            value.map_or("-".to_owned(), |value| report::numbers::significant(value, 4))
        };
        let rows = contents.parameters.iter().map(|(place, one)| {
            let unit = one.unit.clone().unwrap_or_default();
            vec![place.clone(), number(one.value), number(one.low), number(one.high), unit]
        });
        blocks.push(Block::Heading("Parameters".to_owned()));
        blocks.push(Block::Table(Table {
            title: "Parameters with their 95 % intervals".to_owned(),
            caption: "By their places in the document.".to_owned(),
            columns: ["parameter", "value", "from", "to", "unit"].map(str::to_owned).to_vec(),
            rows: rows.collect(),
            highlight: None,
        }));
    }
    blocks
}

fn figures(contents: &Contents) -> Vec<Block> {
    let mut blocks = Vec::new();
    if !contents.figures.is_empty() {
        let rows = contents
            .figures
            .iter()
            .map(|(place, value)| vec![place.clone(), report::numbers::significant(*value, 4)]);
        blocks.push(Block::Heading("Figures".to_owned()));
        blocks.push(Block::Table(Table {
            title: "Figures".to_owned(),
            caption: "By their places in the document.".to_owned(),
            columns: ["figure", "value"].map(str::to_owned).to_vec(),
            rows: rows.collect(),
            highlight: None,
        }));
    }
    blocks
}

/// Steady points of a run, with the curve through them.
fn steady(document: &Value) -> Option<Figure> {
    let points = document["constant_velocity"].as_array()?;
    let column = |name: &str| -> Vec<f64> {
        points.iter().map(|point| point[name].as_f64().unwrap_or(f64::NAN)).collect()
    };
    let (x, y) = (column("velocity"), column("torque"));
    let curve = document.pointer("/identification/fit/parameters").and_then(|fit| {
        let of = |name: &str| fit[name].as_f64();
        let (f_s, f_c, v_s, f_v) = (of("f_s")?, of("f_c")?, of("v_s")?, of("f_v")?);
        let delta = of("delta").unwrap_or(2.0);
        let last = x.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
        let xs: Vec<f64> = (0..=300).map(|k| last * f64::from(k) / 300.0).collect();
        let y = xs
            .iter()
            .map(|v| f_c + (f_s - f_c) * (-(v / v_s).abs().powf(delta)).exp() + f_v * v)
            .collect();
        Some(Trace::Line { name: "Stribeck fit".into(), x: xs, y, style: LineStyle::Solid })
    });
    let measured = Trace::Points { name: "measured".to_owned(), x, y, error: None };
    (!points.is_empty()).then(|| Figure {
        title: "Friction against velocity".to_owned(),
        caption: "The steady points of the document, and the curve that was fitted.".to_owned(),
        x_label: "velocity [rad/s]".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: "friction torque [N m]".to_owned(),
            traces: [measured].into_iter().chain(curve).collect(),
        }],
    })
}

fn settings(contents: &Contents, document: &str) -> Vec<Block> {
    match contents.settings.len() {
        0 => return Vec::new(),
        1..=MOST_SETTINGS => {}
        many => {
            let said = format!("{many} settings are in {document}.");
            return vec![Block::Heading("Settings".to_owned()), Block::Text(said)];
        }
    }
    let rows = contents.settings.iter().map(|(place, value)| vec![place.clone(), value.clone()]);
    vec![
        Block::Heading("Settings".to_owned()),
        Block::Table(Table {
            title: "Settings".to_owned(),
            caption: "What was asked for.".to_owned(),
            columns: ["setting", "value"].map(str::to_owned).to_vec(),
            rows: rows.collect(),
            highlight: None,
        }),
    ]
}
