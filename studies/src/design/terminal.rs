//! An assessment in words and figures, for the terminal and for the tables of the page.

use controller::VelocityLaw;
use controller::design::LoopLaw;
use controller::design::frequency::Margins;
use controller::design::sector::UpperSlope;
use report::numbers::plain;

use super::worth::sentences;
use super::{Assessment, Tracked, Worth};

/// Gains with units, one a line.
pub(super) fn gains(law: &LoopLaw) -> Vec<[String; 2]> {
    let row = |name: &str, value: f64, unit: &str| [name.to_owned(), format!("{value:.5} {unit}")];
    match law {
        LoopLaw::Velocity(VelocityLaw::Lag(gains)) => {
            vec![
                row("K_p", gains.k_p, "V s/rad"),
                row("T_i", gains.t_i, "s"),
                row("gamma", gains.gamma, ""),
            ]
        }
        LoopLaw::Velocity(VelocityLaw::Pi(gains)) => {
            vec![row("K_p", gains.k_p, "V s/rad"), row("K_i", gains.k_i, "V/rad")]
        }
        LoopLaw::Position { gains, .. } => vec![
            row("K_p", gains.k_p, "V/rad"),
            row("K_i", gains.k_i, "V/(rad s)"),
            row("K_d", gains.k_d, "V s/rad"),
        ],
    }
}

/// What the law is called.
pub(super) const fn law_name(law: &LoopLaw) -> &'static str {
    match law {
        LoopLaw::Velocity(VelocityLaw::Lag(_)) => "lag compensator on velocity",
        LoopLaw::Velocity(VelocityLaw::Pi(_)) => "PI on velocity",
        LoopLaw::Position { .. } => "PID on position",
    }
}

fn or_none(value: Option<f64>, digits: usize, unit: &str) -> String {
    value.map_or("none".to_owned(), |value| format!("{value:.digits$}{unit}"))
}

/// Rows of the margins: name, continuous, sampled.
pub(super) fn margin_rows(found: &Assessment) -> Vec<[String; 3]> {
    let row = |name: &str, of: &dyn Fn(&Margins) -> String| {
        [name.to_owned(), of(&found.continuous), of(&found.sampled)]
    };
    vec![
        row("crossover", &|m| or_none(m.crossover, 2, " rad/s")),
        row("phase margin", &|m| or_none(m.phase_margin, 1, " degrees")),
        row("gain may grow by", &|m| {
            m.gain_margin.map_or("any factor".to_owned(), |f| format!("{f:.2}"))
        }),
        row("gain may fall to", &|m| {
            m.gain_reduction.map_or("any fraction".to_owned(), |f| format!("{f:.3}"))
        }),
        row("delay margin", &|m| or_none(m.delay_margin.map(|s| 1e3 * s), 2, " ms")),
        row("sensitivity peak", &|m| format!("{:.3}", m.sensitivity_peak)),
    ]
}

/// Rows of the step response: name and value.
pub(super) fn step_rows(found: &Assessment) -> Vec<[String; 2]> {
    let mut rows = Vec::new();
    if let Some((_, figures)) = found.figures.first() {
        rows.push(["overshoot".to_owned(), format!("{:.2} %", 100.0 * figures.overshoot)]);
        rows.push([
            "steady-state error".to_owned(),
            format!("{:.4} %", 100.0 * figures.steady_state_error),
        ]);
        rows.push([
            "largest voltage for a step of 1".to_owned(),
            format!("{:.2} V", figures.peak_voltage),
        ]);
    }
    for (definition, figures) in &found.figures {
        let (from, band) = (100.0 * definition.rise_from, 100.0 * definition.band);
        rows.push([
            format!("rise, {from:.0} to {:.0} %", 100.0 - from),
            or_none(figures.rise_time, 4, " s"),
        ]);
        rows.push([format!("settling, {band:.0} % band"), or_none(figures.settling_time, 4, " s")]);
    }
    rows
}

/// Rows of what it is worth on the rig: name, this design, the default gains.
pub(super) fn worth_rows(worth: &Worth) -> Vec<[String; 3]> {
    let row = |name: &str, of: &dyn Fn(&Tracked) -> String| {
        [name.to_owned(), of(&worth.designed), of(&worth.default)]
    };
    vec![
        row("mean square error", &|found| format!("{:.3e}", found.mse)),
        row("largest voltage", &|found| format!("{:.2} V", found.peak_voltage)),
        row("noise on the voltage", &|found| format!("{:.3} V", found.voltage_noise)),
    ]
}

/// What theory says, one sentence each.
pub(super) fn verdicts(found: &Assessment) -> Vec<String> {
    let sector = &found.sector;
    let mut said =
        vec![format!("From a braking torque to velocity the closed loop is {}.", found.realness)];
    if let Some(w) = found.theorem_fails_from {
        said.push(format!(
            "The hypothesis of the thesis's theorem 5.2 (position error under a braking torque positive real) is false, as for every PID: the real part is negative above {w:.1} rad/s."
        ));
    }
    said.push(match sector.upper_from_zero {
        Some(UpperSlope::Any) => "Circle criterion: any friction that brakes, however steep, is proven to come to rest.".to_owned(),
        Some(UpperSlope::Finite(slope)) => format!(
            "Circle criterion: friction that brakes with up to {slope:.4} N m s/rad is proven to come to rest; for steeper friction, such as Coulomb friction, nothing is proven: the integral may hunt."
        ),
        None => "Circle criterion: nothing is proven.".to_owned(),
    });
    if let Some(slope) = sector.lowest_with_any_upper {
        said.push(format!(
            "Friction may fall with velocity, or be over-compensated, by up to {:.4} N m s/rad and still be proven stable.",
            -slope
        ));
    }
    if sector.lowest_constant.is_finite() {
        said.push(format!(
            "A constant slope below {:.4} N m s/rad makes the loop unstable. Over-compensated Coulomb friction is below any slope at rest and hunts.",
            sector.lowest_constant
        ));
    }
    said
}

/// The assessment as text.
#[must_use]
pub fn summary(found: &Assessment) -> String {
    let drive = &found.options.linear.drive;
    let mut text = format!(
        "{} for K = {} rad/s per V, T = {} s, from {}\n",
        law_name(&found.options.linear.law),
        plain(drive.gain, 6),
        plain(drive.time_constant, 6),
        found.options.asked
    );
    for [name, value] in gains(&found.options.linear.law).iter().chain(&step_rows(found)) {
        text += &format!("  {name:<32} {value}\n");
    }
    let period = plain(found.options.period, 6);
    text += &format!("  {:<32} {:<18} sampled at {period} s\n", "margins", "continuous");
    for [name, continuous, sampled] in margin_rows(found) {
        text += &format!("  {name:<32} {continuous:<18} {sampled}\n");
    }
    if let Some(worth) = &found.worth {
        text += &format!(
            "  {:<32} {:<18} default gains\n",
            "a sine followed under friction", "this design"
        );
        for [name, designed, default] in worth_rows(worth) {
            text += &format!("  {name:<32} {designed:<18} {default}\n");
        }
    }
    for sentence in verdicts(found).into_iter().chain(sentences(found)) {
        text += &format!("{sentence}\n");
    }
    text
}
