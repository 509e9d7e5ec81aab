//! Pictures as data: what is drawn, in which units; nothing about how.

use serde::{Deserialize, Serialize};

/// One picture with its title and caption. Panels are stacked and share the horizontal axis.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Figure {
    /// Short title.
    pub title: String,
    /// What the reader should see in it, one or two sentences.
    pub caption: String,
    /// Label of the shared horizontal axis with its unit, as in `time [s]`.
    pub x_label: String,
    /// Logarithmic horizontal axis.
    pub log_x: bool,
    /// The stacked panels, top first.
    pub panels: Vec<Panel>,
}

/// One pair of axes.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Panel {
    /// Label of the vertical axis with its unit, as in `torque [N m]`.
    pub y_label: String,
    /// What is drawn, bottom first.
    pub traces: Vec<Trace>,
}

/// One thing drawn in a panel. `x`, `y`, ... have the same length.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Trace {
    /// A line through the points; long ones are thinned by keeping each bucket's extremes.
    Line {
        /// Legend.
        name: String,
        /// Horizontal values.
        x: Vec<f64>,
        /// Vertical values; a value that is not finite breaks the line.
        y: Vec<f64>,
        /// Stroke.
        style: LineStyle,
    },
    /// Markers, with error bars where given.
    Points {
        /// Legend.
        name: String,
        /// Horizontal values.
        x: Vec<f64>,
        /// Vertical values.
        y: Vec<f64>,
        /// Half length of each error bar.
        error: Option<Vec<f64>>,
    },
    /// A path that is gone through once in its order, a loop above all: a thin line with arrows in
    /// its direction.
    Loop {
        /// Legend.
        name: String,
        /// Horizontal values.
        x: Vec<f64>,
        /// Vertical values; a value that is not finite breaks the path.
        y: Vec<f64>,
    },
    /// Values of categories, side by side with those of the panel's other series. The figure's
    /// horizontal axis has the names of all categories, in the order in which they come first.
    Categories {
        /// Legend.
        name: String,
        /// The category of each value.
        x: Vec<String>,
        /// The values; one that is not finite is not drawn.
        y: Vec<f64>,
        /// How they are drawn.
        mark: Mark,
    },
    /// A filled band between two curves.
    Band {
        /// Legend.
        name: String,
        /// Horizontal values.
        x: Vec<f64>,
        /// Lower edge.
        lower: Vec<f64>,
        /// Upper edge.
        upper: Vec<f64>,
    },
}

/// How a value of a category is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// A bar from zero.
    #[default]
    Bar,
    /// A marker, where zero is not on the axis.
    Marker,
}

/// Stroke of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LineStyle {
    /// The series' own stroke, continuous for most.
    #[default]
    Solid,
    /// Dashed: references and targets.
    Dashed,
    /// Dotted: limits.
    Dotted,
    /// Thin and pale: raw, noisy signals behind others.
    Faint,
}

/// A table of text cells; numbers are formatted by whoever knows their precision.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Table {
    /// Short title.
    pub title: String,
    /// What the reader should see in it.
    pub caption: String,
    /// Column heads, with units.
    pub columns: Vec<String>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<String>>,
    /// Index of a row to set apart (the best one).
    pub highlight: Option<usize>,
}

/// One part of a page, in reading order.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "block", rename_all = "snake_case")]
pub enum Block {
    /// A heading that starts a section.
    Heading(String),
    /// A paragraph of plain text.
    Text(String),
    /// A paragraph set apart: something the reader must not miss.
    Note(String),
    /// A picture.
    Figure(Figure),
    /// A table.
    Table(Table),
    /// Links to files beside the page.
    Files(Vec<FileLink>),
}

/// A file or folder beside the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileLink {
    /// Its path from the page's folder.
    pub path: String,
    /// What it holds.
    pub what: String,
}

/// A whole page.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Page {
    /// Title of the page.
    pub title: String,
    /// One line under it: what was run, when, with which seed.
    pub subtitle: String,
    /// The content.
    pub blocks: Vec<Block>,
}

impl Trace {
    /// The legend entry. Series of one name have one look on the whole page and, within a figure,
    /// one entry that shows and hides them together.
    pub fn name(&self) -> &str {
        match self {
            Trace::Line { name, .. }
            | Trace::Points { name, .. }
            | Trace::Loop { name, .. }
            | Trace::Categories { name, .. }
            | Trace::Band { name, .. } => name,
        }
    }
}
