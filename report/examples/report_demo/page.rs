//! A page of made-up results: every kind of block, trace and oddity that a report can have.

use friction_model::ModelName;
use report::figure::{Block, Figure, FileLink, LineStyle, Mark, Page, Panel, Table, Trace};

/// Parameters of the thesis's test bed: static and kinetic friction [N m], Stribeck velocity
/// [rad/s], viscous friction [N m s/rad].
const F_S: f64 = 0.0994;
const F_C: f64 = 0.0925;
const V_S: f64 = 0.1407;
const F_V: f64 = 0.0403;

/// The whole page.
pub fn demonstration() -> Page {
    Page {
        title: "Friction of the test bed, and what compensating it buys".into(),
        subtitle: "Demonstration with made-up numbers · seed 1 · nothing here was measured".into(),
        blocks: vec![
            Block::Heading("Friction at constant velocity".into()),
            Block::Text(
                "The axis ran at 80 velocities, ten times each; every point is the mean torque of one run's \
                 steady part, its bar twice the standard deviation over the repetitions."
                    .into(),
            ),
            Block::Figure(stribeck()),
            Block::Table(parameters()),
            Block::Heading("Tracking".into()),
            Block::Figure(tracking()),
            Block::Table(comparison()),
            Block::Note(
                "The bag keeps every tenth sample of the repetitions after the first; \
                 --record full keeps all of them."
                    .into(),
            ),
            Block::Heading("Hysteresis".into()),
            Block::Figure(hysteresis()),
            Block::Heading("Frequency response".into()),
            Block::Figure(frequency_response()),
            Block::Heading("Every model".into()),
            Block::Text("`frictionlab models` lists them; no two look alike.".into()),
            Block::Figure(every_model()),
            Block::Figure(categories()),
            Block::Table(wide()),
            Block::Files(vec![
                FileLink { path: "bag/".into(), what: "the recording: `ros2 bag` opens it".into() },
                FileLink { path: "odd name #1.csv".into(), what: "a table".into() },
            ]),
        ],
    }
}

/// Noise without a dependency: -1..1, the same every time.
fn noise(seed: usize) -> f64 {
    let bits = (seed as u64)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .rotate_left(31)
        .wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn friction(v: f64) -> f64 {
    v.signum() * (F_C + (F_S - F_C) * (-(v / V_S).powi(2)).exp()) + F_V * v
}

fn stribeck() -> Figure {
    let v: Vec<f64> = (0..80)
        .map(|i| if i < 30 { 0.03 + 0.0162 * i as f64 } else { 0.55 + 0.0704 * (i - 30) as f64 })
        .collect();
    let fine: Vec<f64> = (1..=400).map(|i| 0.01 * i as f64).collect();
    let half = |v: f64| 0.002 + 0.004 * (-v / 0.2).exp();
    Figure {
        title: "Friction against velocity".into(),
        caption:
            "Steady friction torque with the fitted curve; the band holds the curve with 95 % confidence."
                .into(),
        x_label: "velocity [rad/s]".into(),
        panels: vec![
            Panel {
                y_label: "torque [N m]".into(),
                traces: vec![
                    Trace::Band {
                        name: "95 % confidence".into(),
                        x: fine.clone(),
                        lower: fine.iter().map(|&v| friction(v) - half(v)).collect(),
                        upper: fine.iter().map(|&v| friction(v) + half(v)).collect(),
                    },
                    Trace::Points {
                        name: "measured".into(),
                        x: v.clone(),
                        y: v.iter().enumerate().map(|(i, &v)| friction(v) + 0.004 * noise(i)).collect(),
                        error: Some(
                            v.iter().enumerate().map(|(i, _)| 0.006 + 0.001 * noise(i + 99)).collect(),
                        ),
                    },
                    Trace::Line {
                        name: "Stribeck fit".into(),
                        y: fine.iter().map(|&v| friction(v)).collect(),
                        x: fine,
                        style: LineStyle::Solid,
                    },
                ],
            },
            Panel {
                y_label: "residual [N m]".into(),
                traces: vec![Trace::Points {
                    name: "residual".into(),
                    y: (0..v.len()).map(|i| 0.004 * noise(i)).collect(),
                    x: v,
                    error: None,
                }],
            },
        ],
        ..Figure::default()
    }
}

fn tracking() -> Figure {
    let t: Vec<f64> = (0..15_000).map(|k| 1e-3 * k as f64).collect();
    let reference = |t: f64| 1.0 - 0.95 * (2.0 * t).cos();
    let response = |t: f64| reference(t - 0.02) - 0.01 * (8.0 * t).sin();
    let line =
        |name: &str, style, y: Vec<f64>| Trace::Line { name: name.into(), x: t.clone(), y, style };
    let each = |f: &dyn Fn(usize, f64) -> f64| {
        t.iter().enumerate().map(|(k, &t)| f(k, t)).collect::<Vec<_>>()
    };
    Figure {
        title: "Velocity tracking, without and with compensation".into(),
        caption: "The sensor was off between 6 and 7 s, and a single sample near 10 s is a spike."
            .into(),
        x_label: "time [s]".into(),
        panels: vec![
            Panel {
                y_label: "velocity [rad/s]".into(),
                traces: vec![
                    line(
                        "measured velocity",
                        LineStyle::Faint,
                        each(&|k, t| response(t) + 0.05 * noise(k)),
                    ),
                    line("response", LineStyle::Solid, each(&|_, t| response(t))),
                    line("reference", LineStyle::Dashed, each(&|_, t| reference(t))),
                ],
            },
            Panel {
                y_label: "error [rad/s]".into(),
                traces: vec![
                    line("none", LineStyle::Solid, each(&|_, t| reference(t) - response(t))),
                    line(
                        "LuGre",
                        LineStyle::Solid,
                        each(&|_, t| 0.4 * (reference(t) - response(t))),
                    ),
                    line(
                        "Proposed",
                        LineStyle::Solid,
                        each(&|_, t| 0.3 * (reference(t) - response(t))),
                    ),
                    line("limit", LineStyle::Dotted, each(&|_, _| 0.04)),
                ],
            },
            Panel {
                y_label: "friction [N m]".into(),
                traces: vec![
                    line(
                        "measured",
                        LineStyle::Faint,
                        each(&|k, t| match k {
                            6000..7000 => f64::NAN,
                            10_011 => 0.35,
                            _ => friction(response(t)) + 0.01 * noise(k),
                        }),
                    ),
                    line("estimated", LineStyle::Solid, each(&|_, t| friction(response(t)))),
                ],
            },
        ],
        ..Figure::default()
    }
}

fn hysteresis() -> Figure {
    let path: Vec<f64> =
        (0..2000).map(|k| 0.006 * (k as f64 * 0.0063).sin() * (1.0 - k as f64 / 2400.0)).collect();
    let force = path.windows(2).scan(0.0, |f: &mut f64, w| {
        let dz = w[1] - w[0];
        *f += 25.0 * dz * (1.0 - dz.signum() * *f / F_S);
        Some(*f)
    });
    let force: Vec<f64> = std::iter::once(0.0).chain(force).collect();
    Figure {
        title: "Pre-sliding loops".into(),
        caption: "Torque against bristle deflection for a swing that dies away.".into(),
        x_label: "deflection [rad]".into(),
        panels: vec![Panel {
            y_label: "torque [N m]".into(),
            traces: vec![Trace::Loop { name: "Proposed".into(), x: path, y: force }],
        }],
        ..Figure::default()
    }
}

fn frequency_response() -> Figure {
    let w: Vec<f64> = (0..200).map(|i| 10f64.powf(-1.0 + 0.02 * i as f64)).collect();
    let gain = |w: f64| -10.0 * (1.0 + (w / 40.0).powi(2)).log10();
    let phase = |w: f64| -(w / 40.0).atan().to_degrees();
    let line = |y: Vec<f64>| Trace::Line {
        name: "closed loop".into(),
        x: w.clone(),
        y,
        style: LineStyle::Solid,
    };
    Figure {
        title: "Closed loop".into(),
        caption: "From reference to velocity.".into(),
        x_label: "angular frequency [rad/s]".into(),
        log_x: true,
        panels: vec![
            Panel {
                y_label: "gain [dB]".into(),
                traces: vec![line(w.iter().map(|&w| gain(w)).collect())],
            },
            Panel {
                y_label: "phase [°]".into(),
                traces: vec![line(w.iter().map(|&w| phase(w)).collect())],
            },
        ],
    }
}

fn every_model() -> Figure {
    let x: Vec<f64> = (0..60).map(|i| 0.05 * f64::from(i)).collect();
    let curve =
        |place: usize| x.iter().map(|x| place as f64 + (x + 0.2 * place as f64).sin()).collect();
    let traces = ModelName::ALL.iter().enumerate().map(|(place, model)| Trace::Line {
        name: model.title().into(),
        x: x.clone(),
        y: curve(place),
        style: LineStyle::Solid,
    });
    Figure {
        title: "All models at once".into(),
        caption: "Made-up curves.".into(),
        x_label: "time [s]".into(),
        panels: vec![Panel { y_label: "friction [N m]".into(), traces: traces.collect() }],
        ..Figure::default()
    }
}

fn categories() -> Figure {
    let bars = |name: &str, y: [f64; 3], mark| Trace::Categories {
        name: name.into(),
        x: ["slow, \"creeping\"", "fast", "reversing"].map(String::from).to_vec(),
        y: y.to_vec(),
        mark,
    };
    Figure {
        title: "Errors by kind of motion".into(),
        caption: "Made-up errors.".into(),
        x_label: "kind of motion".into(),
        panels: vec![
            Panel {
                y_label: "rms [N m]".into(),
                traces: vec![
                    bars("LuGre", [0.1, 0.2, 0.4], Mark::Bar),
                    bars("Proposed", [0.1, 0.15, f64::NAN], Mark::Bar),
                ],
            },
            Panel {
                y_label: "share [%]".into(),
                traces: vec![
                    bars("LuGre", [40.0, 41.0, 42.0], Mark::Marker),
                    bars("Proposed", [60.0, 59.0, 58.0], Mark::Marker),
                ],
            },
        ],
        ..Figure::default()
    }
}

/// More columns than a sheet of paper is wide, with heads of many words.
fn wide() -> Table {
    let names = ModelName::ALL.map(|model| format!("root mean square of {} [N m]", model.title()));
    Table {
        title: "A table wider than the page".into(),
        caption: "Its first column stands in each part.".into(),
        columns: std::iter::once("plant".to_owned()).chain(names).collect(),
        rows: ["LuGre", "a plant with a comma, and a long name"]
            .map(|plant| {
                let cells =
                    (0..ModelName::ALL.len()).map(|i| format!("{:.4e}", 1e-3 * (i + 1) as f64));
                std::iter::once(plant.to_owned()).chain(cells).collect()
            })
            .to_vec(),
        highlight: None,
    }
}

fn rows(rows: &[&[&str]]) -> Vec<Vec<String>> {
    rows.iter().map(|row| row.iter().map(|cell| (*cell).to_owned()).collect()).collect()
}

fn parameters() -> Table {
    Table {
        title: "Stribeck parameters".into(),
        caption: "Estimates with their standard errors.".into(),
        columns: ["parameter", "unit", "estimate", "standard error", "relative error [%]"]
            .map(String::from)
            .to_vec(),
        rows: rows(&[
            &["static friction f_s", "N m", "0.0994", "0.00065", "0.65"],
            &["kinetic friction f_c", "N m", "0.0925", "0.00025", "0.27"],
            &["Stribeck velocity v_s", "rad/s", "0.141", "0.0153", "10.9"],
            &["viscous friction f_v", "N m s/rad", "0.0403", "0.00011", "0.27"],
        ]),
        highlight: None,
    }
}

fn comparison() -> Table {
    Table {
        title: "Compensation".into(),
        caption: "Error of velocity tracking over all repetitions; the best is set apart.".into(),
        columns: ["compensation", "mse [rad²/s²]", "maximum error [rad/s]", "better by [%]"]
            .map(String::from)
            .to_vec(),
        rows: rows(&[
            &["none", "8.64e-4", "0.0491", "-"],
            &["LuGre", "1.38e-4", "0.0196", "84.0"],
            &["Proposed", "7.8e-5", "0.0147", "91.0"],
        ]),
        highlight: Some(2),
    }
}
