//! What each technique is worth at equal robustness: table, picture and words.

use std::collections::BTreeSet;

use report::figure::{Block, Figure, LineStyle, Panel, Table, Trace};
use report::numbers::significant;

use crate::control::Control;
use crate::pareto::Tried;

/// Table and picture; nothing where nothing was tried.
pub(super) fn blocks(control: &Control) -> Vec<Block> {
    if control.tried.is_empty() {
        return Vec::new();
    }
    vec![
        Block::Text(why(control)),
        Block::Table(table(&control.tried)),
        Block::Figure(figure(&control.tried)),
    ]
}

/// Why it was chosen, in words.
pub(super) fn why(control: &Control) -> String {
    let equal = || control.tried.iter().filter(|tried| tried.equal);
    let best = |fed: bool| {
        equal()
            .filter(|tried| tried.fed_back.is_some() == fed && tried.hunts == Some(false))
            .min_by(|a, b| a.error.total_cmp(&b.error))
    };
    let said = |tried: &Tried| {
        format!("{} leaves {} mrad", tried.name(), significant(1e3 * tried.error, 3))
    };
    let compared = match (best(false), best(true)) {
        (Some(forward), Some(back)) => format!(
            "In simulation on the identified plant, at equal robustness, the best that is fed forward ({}) and the best that is fed back ({})",
            said(forward),
            said(back)
        ),
        (_, None) => {
            "In simulation nothing that is fed back comes to rest at equal robustness".to_owned()
        }
        (None, Some(back)) => {
            format!("In simulation only what is fed back comes to rest ({})", said(back))
        }
    };
    let chosen = match (&control.fed_back, &control.fed_back_errors) {
        (Some(fed), _) => format!("{} is fed back: on the rig it was clearly better too", fed.kind),
        (None, Some((fed, _))) => format!(
            "{} was tried on the rig, where it was not clearly better or did not come to rest: nothing is fed back",
            fed.kind
        ),
        (None, None) => {
            "nothing is fed back: it is not clearly better, or no rig time was left to try it"
                .to_owned()
        }
    };
    format!("{compared}. Chosen: {chosen}.")
}

fn table(tried: &[Tried]) -> Table {
    let row = |tried: &Tried| {
        let strength = tried.fed_back.map_or("".to_owned(), |fed| significant(fed.strength, 2));
        vec![
            tried.name(),
            strength,
            significant(1e3 * tried.error, 3),
            significant(tried.peak, 3),
            significant(1e3 * tried.noise, 3),
            significant(1e3 * tried.chatter, 3),
            tried.gain_margin.map_or("".to_owned(), |margin| significant(margin, 2)),
            match tried.hunts {
                Some(true) => "hunts",
                Some(false) => "rests",
                None => "",
            }
            .to_owned(),
        ]
    };
    let columns = [
        "technique",
        "strength",
        "error [mrad]",
        "peak of the sensitivity",
        "noise [mV]",
        "chattering [mV]",
        "gain may grow by",
        "after a move",
    ];
    Table {
        title: "Each technique at equal robustness".to_owned(),
        caption: "In simulation on the identified plant, with friction as it was found, a tenth less and a tenth more. Under what is fed back the linear gains are lowered until peak and noise are those of the linear loop. Chattering is the voltage's change from cycle to cycle, root mean square.".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: tried.iter().filter(|tried| tried.equal).map(row).collect(),
        highlight: None,
    }
}

/// One line a technique, of the strength that is best at equal robustness, over its loops: few
/// enough to be told apart.
fn figure(tried: &[Tried]) -> Figure {
    let names: BTreeSet<String> = tried.iter().map(Tried::name).collect();
    let lines: Vec<(String, Vec<&Tried>)> = names
        .into_iter()
        .filter_map(|name| {
            let own = || tried.iter().filter(|tried| tried.name() == name);
            let best =
                own().filter(|tried| tried.equal).min_by(|a, b| a.error.total_cmp(&b.error))?;
            let strength = |tried: &Tried| tried.fed_back.map(|fed| fed.strength);
            let mut line: Vec<&Tried> =
                own().filter(|tried| strength(tried) == strength(best)).collect();
            // The quietest loop is the slowest.
            line.sort_by(|a, b| a.noise.total_cmp(&b.noise));
            Some((name, line))
        })
        .collect();
    let error = |tried: &&Tried| 1e3 * tried.error;
    let panel = |y_label: &str, y: fn(&Tried) -> f64| Panel {
        y_label: y_label.to_owned(),
        traces: lines
            .iter()
            .flat_map(|(name, line)| {
                let x: Vec<f64> = line.iter().map(error).collect();
                let y: Vec<f64> = line.iter().map(|tried| y(tried)).collect();
                [
                    Trace::Line {
                        name: name.clone(),
                        x: x.clone(),
                        y: y.clone(),
                        style: LineStyle::Faint,
                    },
                    Trace::Points { name: name.clone(), x, y, error: None },
                ]
            })
            .collect(),
    };
    Figure {
        title: "Error against robustness and noise".to_owned(),
        caption: "One line a technique, of the strength that is best at equal robustness, over a fast, a slower and a slow linear loop. Left and low is good.".to_owned(),
        x_label: "error [mrad]".to_owned(),
        log_x: true,
        panels: vec![
            panel("peak of the sensitivity", |tried| tried.peak),
            panel("noise of the voltage [mV]", |tried| 1e3 * tried.noise),
        ],
    }
}
