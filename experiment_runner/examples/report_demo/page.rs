//! A page of made-up results: every kind of block, trace and oddity that a report can have.

use experiment_runner::report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace};

/// Parameters of the thesis's test bed: static and kinetic friction [N m], Stribeck velocity [rad/s],
/// viscous friction [N m s/rad].
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
        ],
    }
}

/// Noise without a dependency: -1..1, the same every time.
fn noise(seed: usize) -> f64 {
    let bits =
        (seed as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(31).wrapping_mul(0xbf58_476d_1ce4_e5b9);
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
    let line = |name: &str, style, y: Vec<f64>| Trace::Line { name: name.into(), x: t.clone(), y, style };
    let each =
        |f: &dyn Fn(usize, f64) -> f64| t.iter().enumerate().map(|(k, &t)| f(k, t)).collect::<Vec<_>>();
    Figure {
        title: "Velocity tracking, without and with compensation".into(),
        caption: "The sensor was off between 6 and 7 s, and a single sample near 10 s is a spike.".into(),
        x_label: "time [s]".into(),
        panels: vec![
            Panel {
                y_label: "velocity [rad/s]".into(),
                traces: vec![
                    line("measured velocity", LineStyle::Faint, each(&|k, t| response(t) + 0.05 * noise(k))),
                    line("response", LineStyle::Solid, each(&|_, t| response(t))),
                    line("reference", LineStyle::Dashed, each(&|_, t| reference(t))),
                ],
            },
            Panel {
                y_label: "error [rad/s]".into(),
                traces: vec![
                    line("none", LineStyle::Solid, each(&|_, t| reference(t) - response(t))),
                    line("LuGre", LineStyle::Solid, each(&|_, t| 0.4 * (reference(t) - response(t)))),
                    line("Proposed", LineStyle::Solid, each(&|_, t| 0.3 * (reference(t) - response(t)))),
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
            traces: vec![Trace::Line { name: "Proposed".into(), x: path, y: force, style: LineStyle::Solid }],
        }],
        ..Figure::default()
    }
}

fn frequency_response() -> Figure {
    let w: Vec<f64> = (0..200).map(|i| 10f64.powf(-1.0 + 0.02 * i as f64)).collect();
    let gain = |w: f64| -10.0 * (1.0 + (w / 40.0).powi(2)).log10();
    let phase = |w: f64| -(w / 40.0).atan().to_degrees();
    let line =
        |y: Vec<f64>| Trace::Line { name: "closed loop".into(), x: w.clone(), y, style: LineStyle::Solid };
    Figure {
        title: "Closed loop".into(),
        caption: "From reference to velocity.".into(),
        x_label: "angular frequency [rad/s]".into(),
        log_x: true,
        panels: vec![
            Panel { y_label: "gain [dB]".into(), traces: vec![line(w.iter().map(|&w| gain(w)).collect())] },
            Panel { y_label: "phase [°]".into(), traces: vec![line(w.iter().map(|&w| phase(w)).collect())] },
        ],
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
