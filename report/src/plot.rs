//! From a figure to what the page's script draws.

use serde::Serialize;

use super::figure::{Figure, LineStyle, Mark, Trace};
use super::palette::{self, Palette};
use super::{path, thin};

/// Most points drawn of one trace: several for each pixel column of a wide figure, so that some
/// zooming shows more, while a page of many figures stays quick.
const MOST_POINTS: usize = 4000;

/// A figure in the form that `report.js` reads.
#[derive(Debug, Serialize)]
pub(super) struct Plot<'a> {
    x_label: &'a str,
    log_x: bool,
    /// The curve runs back and forth in x (a closed loop): one vertical readout would make no
    /// sense.
    back_and_forth: bool,
    y_labels: Vec<&'a str>,
    /// Names on the horizontal axis, where it has categories; their values are at 0, 1, ...
    categories: Vec<&'a str>,
    traces: Vec<Drawn<'a>>,
    /// What the reader must know about the drawing itself.
    #[serde(skip)]
    pub(super) remarks: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Drawn<'a> {
    kind: &'static str,
    panel: usize,
    name: &'a str,
    colour: i32,
    stroke: usize,
    marker: usize,
    style: LineStyle,
    x: Vec<f64>,
    /// The line; the lower edge of a band.
    y: Vec<f64>,
    /// Half lengths of error bars.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<Vec<f64>>,
    /// The upper edge of a band.
    #[serde(skip_serializing_if = "Option::is_none")]
    upper: Option<Vec<f64>>,
    /// Places of a path's arrows: those before and those at the tips.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    arrows: Vec<[[f64; 2]; 2]>,
    /// Width of a bar, as a share of a category.
    #[serde(skip_serializing_if = "Option::is_none")]
    width: Option<f64>,
}

/// Share of a category that its values take up together.
const FILLED: f64 = 0.8;

impl<'a> Plot<'a> {
    pub(super) fn of(figure: &'a Figure, palette: &Palette) -> Self {
        let mut plot = Plot {
            x_label: &figure.x_label,
            log_x: figure.log_x,
            back_and_forth: figure.panels.iter().flat_map(|p| &p.traces).any(runs_back),
            y_labels: figure.panels.iter().map(|p| p.y_label.as_str()).collect(),
            categories: categories(figure),
            traces: Vec::new(),
            remarks: Vec::new(),
        };
        let mut longest = None;
        let traces = figure.panels.iter().enumerate().flat_map(|(number, panel)| {
            panel
                .traces
                .iter()
                .zip(palette::series(panel))
                .map(move |(trace, series)| (number, trace, series))
        });
        for (panel, trace, series) in traces {
            let look = palette.look(series);
            let (colour, stroke, marker) = (look.colour(), look.stroke(), look.marker());
            if let Trace::Categories { x, y, mark, .. } = trace {
                let (x, width) = plot.side_by_side(figure, trace, x);
                plot.traces.push(Drawn {
                    kind: match mark {
                        Mark::Bar => "bars",
                        Mark::Marker => "points",
                    },
                    x,
                    y: y.iter().map(|&value| rounded(value, 7)).collect(),
                    width: Some(width),
                    ..Drawn::of(panel, trace, (colour, stroke, marker))
                });
                continue;
            }
            let (kind, style, columns) = columns(trace);
            let n = columns.iter().map(|c| c.len()).min().unwrap_or(0);
            if columns.iter().any(|c| c.len() != n) {
                let lengths: Vec<String> = columns.iter().map(|c| c.len().to_string()).collect();
                plot.remarks.push(format!(
                    "The columns of “{}” have different lengths ({}); only the first {n} points are drawn.",
                    trace.name(),
                    lengths.join(", ")
                ));
            }
            let mut columns: Vec<&[f64]> = columns.iter().map(|c| &c[..n]).collect();
            let thinned = thin::keep(&columns, MOST_POINTS);
            if let Some(kept) = &thinned {
                longest = longest.max(Some((n, kept.len())));
            }
            let pick = |column: &[f64], digits| -> Vec<f64> {
                match &thinned {
                    Some(kept) => kept.iter().map(|&i| rounded(column[i], digits)).collect(),
                    None => column.iter().map(|&v| rounded(v, digits)).collect(),
                }
            };
            let third = (columns.len() > 2).then(|| pick(columns.remove(2), 7));
            let (error, upper) = if kind == "band" { (None, third) } else { (third, None) };
            // Horizontal values are often a small stretch far from zero, so they keep more digits.
            let (x, y) = (pick(columns[0], 10), pick(columns[1], 7));
            let arrows = if kind == "loop" { path::arrows(&x, &y) } else { Vec::new() };
            let arrows =
                arrows.into_iter().map(|(from, to)| [[x[from], y[from]], [x[to], y[to]]]).collect();
            let drawn = Drawn::of(panel, trace, (colour, stroke, marker));
            plot.traces.push(Drawn { kind, style, x, y, error, upper, arrows, ..drawn });
        }
        if let Some((from, to)) = longest {
            plot.remarks.push(format!(
                "Drawn thinned: of up to {from} samples a series {to} are shown, each stretch by its extremes."
            ));
        }
        plot
    }

    /// Horizontal places of the values of a categorical trace, beside those of the other series,
    /// and their width. Where no category has two series, each has its place to itself.
    fn side_by_side(&self, figure: &Figure, trace: &Trace, names: &[String]) -> (Vec<f64>, f64) {
        let mut series: Vec<&str> = Vec::new();
        let mut taken: Vec<(&str, &str)> = Vec::new();
        let mut shared = false;
        for other in figure.panels.iter().flat_map(|panel| &panel.traces) {
            let Trace::Categories { name: own, x, .. } = other else { continue };
            if !series.contains(&own.as_str()) {
                series.push(own);
            }
            for category in x {
                shared |= taken.iter().any(|(one, by)| one == category && by != own);
                taken.push((category, own));
            }
        }
        if !shared {
            series.clear();
        }
        let width = FILLED / series.len().max(1) as f64;
        let own = series.iter().position(|name| *name == trace.name()).unwrap_or(0) as f64;
        let shift = (own + 0.5) * width - 0.5 * FILLED;
        let place = |name: &String| self.categories.iter().position(|known| known == name);
        let places = names.iter().map(|name| place(name).map_or(f64::NAN, |at| at as f64 + shift));
        (places.map(|place| rounded(place, 7)).collect(), width)
    }

    /// The figure in words, for those who cannot see it.
    pub(super) fn description(&self) -> String {
        let mut names: Vec<&str> = Vec::new();
        for trace in &self.traces {
            if !names.contains(&trace.name) {
                names.push(trace.name);
            }
        }
        format!(
            "Plot of {} against {}. Series: {}.",
            self.y_labels.join(", "),
            self.x_label,
            names.join(", ")
        )
    }

    /// The figure as JSON. Numbers that are not finite become `null`, which the page draws as gaps.
    pub(super) fn json(&self) -> String {
        // Cannot fail: no maps with odd keys, no foreign serialisers, and the writer is memory.
        serde_json::to_string(self).expect("a figure is plain data")
    }
}

impl<'a> Drawn<'a> {
    /// A trace without its points.
    fn of(panel: usize, trace: &'a Trace, (colour, stroke, marker): (i32, usize, usize)) -> Self {
        Drawn {
            kind: "line",
            panel,
            name: trace.name(),
            colour,
            stroke,
            marker,
            style: LineStyle::Solid,
            x: Vec::new(),
            y: Vec::new(),
            error: None,
            upper: None,
            arrows: Vec::new(),
            width: None,
        }
    }
}

/// All categories of a figure, in the order in which they come first.
fn categories(figure: &Figure) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for trace in figure.panels.iter().flat_map(|panel| &panel.traces) {
        if let Trace::Categories { x, .. } = trace {
            for name in x {
                if !names.contains(&name.as_str()) {
                    names.push(name);
                }
            }
        }
    }
    names
}

/// Kind, style and columns of a trace: x, y and, where there is one, error or upper edge.
fn columns(trace: &Trace) -> (&'static str, LineStyle, Vec<&[f64]>) {
    match trace {
        Trace::Line { x, y, style, .. } => ("line", *style, vec![x, y]),
        Trace::Points { x, y, error, .. } => {
            let mut columns: Vec<&[f64]> = vec![x, y];
            columns.extend(error.as_deref());
            ("points", LineStyle::Solid, columns)
        }
        Trace::Loop { x, y, .. } => ("loop", LineStyle::Solid, vec![x, y]),
        // Their horizontal values are names; see `side_by_side`.
        Trace::Categories { y, .. } => ("bars", LineStyle::Solid, vec![y, y]),
        Trace::Band { x, lower, upper, .. } => ("band", LineStyle::Solid, vec![x, lower, upper]),
    }
}

fn runs_back(trace: &Trace) -> bool {
    let (Trace::Line { x, .. } | Trace::Loop { x, .. }) = trace else { return false };
    !x.iter().filter(|v| v.is_finite()).is_sorted()
}

/// `value` with so many significant digits: a drawing needs no more, and the file is half as large.
fn rounded(value: f64, digits: usize) -> f64 {
    if !value.is_finite() || value == 0.0 {
        return value;
    }
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Block, Page, Panel};

    fn figure(traces: Vec<Trace>) -> Figure {
        Figure {
            title: "t".into(),
            x_label: "time [s]".into(),
            panels: vec![Panel { y_label: "torque [N m]".into(), traces }],
            ..Figure::default()
        }
    }

    fn line(x: Vec<f64>, y: Vec<f64>) -> Trace {
        Trace::Line { name: "a".into(), x, y, style: LineStyle::Solid }
    }

    fn plot(figure: &Figure) -> (serde_json::Value, Vec<String>) {
        let page = Page { blocks: vec![Block::Figure(figure.clone())], ..Page::default() };
        let plot = Plot::of(figure, &Palette::of(&page));
        (serde_json::from_str(&plot.json()).unwrap(), plot.remarks)
    }

    #[test]
    fn what_is_not_finite_becomes_a_gap() {
        let (json, remarks) = plot(&figure(vec![line(
            vec![0.0, 1.0, 2.0, 3.0],
            vec![1.0, f64::NAN, f64::INFINITY, 2.5],
        )]));
        assert_eq!(json["traces"][0]["y"], serde_json::json!([1.0, null, null, 2.5]));
        assert!(remarks.is_empty());
    }

    #[test]
    fn different_lengths_are_drawn_as_far_as_they_go_and_said() {
        let (json, remarks) = plot(&figure(vec![line(vec![0.0, 1.0, 2.0], vec![1.0, 2.0])]));
        assert_eq!(json["traces"][0]["x"], serde_json::json!([0.0, 1.0]));
        assert!(remarks[0].contains("different lengths (3, 2)"), "{remarks:?}");
    }

    #[test]
    fn long_lines_are_thinned_and_said() {
        let x: Vec<f64> = (0..20_000).map(f64::from).collect();
        let (json, remarks) = plot(&figure(vec![line(x.clone(), x)]));
        assert!(json["traces"][0]["x"].as_array().unwrap().len() <= MOST_POINTS);
        assert!(remarks[0].contains("20000 samples"), "{remarks:?}");
    }

    #[test]
    fn bands_and_error_bars_keep_their_third_column() {
        let band = Trace::Band {
            name: "b".into(),
            x: vec![0.0, 1.0],
            lower: vec![-1.0, -2.0],
            upper: vec![1.0, 2.0],
        };
        let points =
            Trace::Points { name: "p".into(), x: vec![0.0], y: vec![3.0], error: Some(vec![0.25]) };
        let (json, _) = plot(&figure(vec![band, points]));
        assert_eq!(json["traces"][0]["upper"], serde_json::json!([1.0, 2.0]));
        assert_eq!(json["traces"][0]["y"], serde_json::json!([-1.0, -2.0]));
        assert_eq!(json["traces"][1]["error"], serde_json::json!([0.25]));
    }

    #[test]
    fn a_loop_is_told_from_a_signal() {
        let signal = plot(&figure(vec![line(vec![0.0, f64::NAN, 0.0, 1.0], vec![0.0; 4])])).0;
        assert_eq!(signal["back_and_forth"], false);
        let hysteresis = plot(&figure(vec![line(vec![0.0, 1.0, 0.0], vec![0.0; 3])])).0;
        assert_eq!(hysteresis["back_and_forth"], true);
    }

    #[test]
    fn a_path_has_arrows_in_its_direction() {
        let x: Vec<f64> = (0..=200).map(|i| (f64::from(i) * 0.0314).cos()).collect();
        let y: Vec<f64> = (0..=200).map(|i| (f64::from(i) * 0.0314).sin()).collect();
        let path = Trace::Loop { name: "loop".into(), x, y };
        let (json, _) = plot(&figure(vec![path, line(vec![0.0], vec![0.0])]));
        assert_eq!(json["back_and_forth"], true);
        assert!(json["traces"][0]["arrows"].as_array().unwrap().len() > 2);
        assert!(json["traces"][1]["arrows"].is_null(), "a line has none");
    }

    #[test]
    fn categories_stand_side_by_side() {
        let bars = |name: &str, x: &[&str], mark| Trace::Categories {
            name: name.into(),
            x: x.iter().map(|&name| name.to_owned()).collect(),
            y: vec![1.0; x.len()],
            mark,
        };
        let (json, _) = plot(&figure(vec![
            bars("a", &["slow", "fast"], Mark::Bar),
            bars("b", &["fast", "back"], Mark::Marker),
        ]));
        assert_eq!(json["categories"], serde_json::json!(["slow", "fast", "back"]));
        assert_eq!(json["traces"][0]["x"], serde_json::json!([-0.2, 0.8]));
        assert_eq!(json["traces"][1]["x"], serde_json::json!([1.2, 2.2]));
        assert_eq!(json["traces"][0]["kind"], "bars");
        assert_eq!(json["traces"][1]["kind"], "points");
        let (json, _) =
            plot(&figure(vec![bars("a", &["slow"], Mark::Bar), bars("b", &["fast"], Mark::Bar)]));
        assert_eq!(json["traces"][0]["x"], serde_json::json!([0.0]));
        assert_eq!(json["traces"][1]["x"], serde_json::json!([1.0]));
    }

    #[test]
    fn rounding_keeps_the_asked_digits() {
        assert_eq!(rounded(0.123456789, 7), 0.1234568);
        assert_eq!(rounded(-1234567.89, 7), -1234568.0);
        assert_eq!(rounded(0.0, 7), 0.0);
        assert!(rounded(f64::NAN, 7).is_nan());
    }
}
