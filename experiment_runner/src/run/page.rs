//! The report of a run: what was measured, what was found, what it is worth.

use friction_ident::StribeckFit;
use friction_ident::statistics::Sample;
use friction_model::ModelName;

use super::Compensators;
use super::comparison_page::{comparison_table, tracking_figure};
use super::results::{Identification, RunResults, Status};
use super::trace::Trace;
use crate::characterise::Measured;
use crate::compensation::Arm;
use crate::constant_velocity::SteadyRun;
use crate::protocol::{ConstantVelocityProtocol, ProtocolFile};
use report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace as Drawn};
use report::numbers;
use rig_setup::RigChoice;

/// The whole page.
pub(super) fn build(
    results: &RunResults,
    models: &Compensators,
    traces: &[(String, Vec<(Arm, Trace)>)],
    own: Vec<Block>,
) -> Page {
    let options = &results.options;
    let mut blocks = vec![summary(results)];
    if results.status == Status::Interrupted {
        let why = results
            .ended
            .as_ref()
            .map_or("This run was stopped before its end.".to_owned(), |why| {
                format!("This run ended early: {why}.")
            });
        let note = format!("{why} What is shown is whole; what is missing was not measured.");
        blocks.push(Block::Note(note));
    }
    blocks.extend(results.repeated().map(Block::Note));
    blocks.extend(results.resumed().map(Block::Note));
    if !results.constant_velocity.is_empty() {
        blocks.push(Block::Heading("Friction at constant velocity".to_owned()));
        blocks.extend(results.identification.as_ref().map(parameter_table).map(Block::Table));
        blocks.push(Block::Figure(stribeck_figure(results)));
        blocks.extend(results.added_to_points().map(Block::Note));
    }
    blocks.extend(super::characterisation_page::blocks(
        &results.characterisation,
        options.torque.source,
    ));
    blocks.extend(options.sequence.iter().flat_map(|protocol| {
        super::sequence_page::blocks(
            &protocol.name,
            protocol.repetitions,
            &results.characterisation,
        )
    }));
    for (name, comparison) in results.comparisons() {
        let title = capitalised(name);
        let of_task =
            traces.iter().find(|(other, _)| other == name).map_or(&[][..], |(_, traces)| traces);
        blocks.push(Block::Heading(title.clone()));
        blocks.push(Block::Table(comparison_table(&title, comparison)));
        blocks.push(Block::Figure(tracking_figure(&title, comparison.mode, of_task)));
    }
    blocks.extend(own);
    blocks.extend(results.thesis_tables.iter().flat_map(|found| found.blocks.clone()));
    blocks.push(Block::Heading("How this was made".to_owned()));
    blocks.push(Block::Text(how(results)));
    blocks.push(Block::Table(model_table(results, models)));
    blocks.push(Block::Note(options.record.describe().to_owned()));
    Page {
        title: "Friction laboratory".to_owned(),
        subtitle: format!(
            "frictionlab run {}, {}, torque from {}, version {}",
            options.experiment.as_str(),
            match options.rig {
                RigChoice::Simulated => format!(
                    "simulated SRV-02 test bed with {} friction, seed {}",
                    options.test_bed.friction.name(),
                    options.seed
                ),
                RigChoice::Nodes { .. } => "the loop of the running ROS 2 nodes".to_owned(),
                ref real => format!("rig {real}"),
            },
            options.torque.source.name(),
            results.program_version
        ),
        blocks,
    }
}

/// With a capital letter first.
fn capitalised(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// The run in a few sentences.
fn summary(results: &RunResults) -> Block {
    let mut text = String::new();
    if let Some(found) = &results.identification {
        let p = &found.fit.parameters;
        text += &format!(
            "Friction slides at {:.4} N m, breaks away at {:.4} N m and grows by {:.4} N m per rad/s. ",
            p.f_c, p.f_s, p.f_v
        );
    }
    for (name, comparison) in results.comparisons() {
        let Some(best) = comparison.best().map(|index| &comparison.rows[index]) else { continue };
        text += &match best.arm {
            Arm::None => format!("No compensation improved {name}. "),
            arm => format!(
                "In {name} {arm} does best: mean square error {}, largest error {} that of the linear controller alone. ",
                below(best.mse_improvement),
                below(best.max_error_improvement)
            ),
        };
    }
    text +=
        &format!("{}.", numbers::rig_time(results.timing.rig_seconds, results.timing.wall_seconds));
    Block::Text(text)
}

/// An improvement in words: `12.0 % below`, `3.1 % above`, `as large as`.
fn below(percent: f64) -> String {
    match numbers::smaller_by(percent) {
        same if same == "0.0" => "as large as".to_owned(),
        worse if worse.ends_with("larger") => format!("{worse} than"),
        worse if worse.starts_with('-') => format!("{} % above", worse.trim_start_matches('-')),
        better => format!("{better} % below"),
    }
}

fn parameter_table(found: &Identification) -> Table {
    let rows = found
        .parameters
        .iter()
        .map(|p| {
            let estimate = &p.estimate;
            let (number, error) = numbers::value_and_error(
                estimate.value,
                estimate.standard_error.unwrap_or(f64::NAN),
            );
            let error = if error.is_empty() { "-".to_owned() } else { error };
            let interval =
                estimate.interval.map_or("-".to_owned(), |(a, b)| format!("{a:.5} to {b:.5}"));
            let value = match estimate.unidentifiable {
                Some(reason) => format!("not identifiable: {reason}"),
                None => number,
            };
            let deviation = match (p.truth, estimate.unidentifiable) {
                (Some(truth), None) => {
                    // Rounded first, so that nothing reads "-0.00".
                    let hundredths = (1e4 * (estimate.value / truth - 1.0)).round() + 0.0;
                    format!("{:+.2} %", 0.01 * hundredths)
                }
                _ => "-".to_owned(),
            };
            let truth = p.truth.map_or("-".to_owned(), |truth| format!("{truth:.5}"));
            vec![p.name.to_owned(), p.unit.to_owned(), value, error, interval, truth, deviation]
        })
        .collect();
    let plant = if found.parameters.iter().any(|p| p.truth.is_some()) {
        " The plant's own values are known because the rig is simulated."
    } else {
        ""
    };
    let validation = found.mse_validation.map_or(String::new(), |mse| {
        format!(" On the other set, which the fit has not seen, it is {mse:.3e} (N m)².")
    });
    Table {
        title: "Stribeck parameters".to_owned(),
        caption: format!(
            "Nonlinear least squares over {} points of the first set; mean square residual {:.3e} (N m)².{validation}{plant}",
            found.fit.points, found.mse_identification
        ),
        columns: [
            "parameter",
            "unit",
            "value",
            "standard error",
            "95 % interval",
            "plant",
            "deviation",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        highlight: None,
    }
}

/// Points of both sets, the fitted curve with its band, and the truth; below, the same without the
/// viscous part.
fn stribeck_figure(results: &RunResults) -> Figure {
    let points = "Mean friction torque against mean velocity, with half the distance of the quartiles of the repetitions";
    let mut panels =
        vec![Panel { y_label: "friction [N m]".to_owned(), traces: stribeck_traces(results, 0.0) }];
    let caption = match &results.identification {
        Some(found) => {
            let f_v = found.fit.parameters.f_v;
            let traces = stribeck_traces(results, f_v);
            panels.push(Panel { y_label: "friction - f_v v [N m]".to_owned(), traces });
            format!(
                "{points}; the fitted curve and where it lies with 95 % confidence. Below without the viscous part f_v v, with the fitted f_v = {f_v:.5} N m s/rad: the \
                 fall from static to kinetic friction."
            )
        }
        None => format!("{points}. No curve was fitted."),
    };
    Figure {
        title: "Stribeck curve".to_owned(),
        caption,
        x_label: "velocity [rad/s]".to_owned(),
        log_x: true,
        panels,
    }
}

/// The curve and its points with `viscous` times the velocity taken off.
fn stribeck_traces(results: &RunResults, viscous: f64) -> Vec<Drawn> {
    let mut traces = Vec::new();
    let fit = results.identification.as_ref().map(|found| &found.fit);
    if let Some(fit) = fit {
        let grid = speeds(fit);
        let (lower, upper) = grid
            .iter()
            .map(|&v| {
                let (lower, upper) = fit.band(v);
                (lower - viscous * v, upper - viscous * v)
            })
            .unzip();
        traces.push(Drawn::Band {
            name: "95 % confidence of the curve".to_owned(),
            x: grid,
            lower,
            upper,
        });
    }
    let protocol = &results.options.constant_velocity;
    for set in 0..protocol.sets {
        let (x, mut y, error) = means(&results.constant_velocity, set, &protocol.velocities);
        for (torque, v) in y.iter_mut().zip(&x) {
            *torque -= viscous * v;
        }
        let name = match set {
            _ if fit.is_none() => format!("set {}", set + 1),
            0 => "set 1: identification".to_owned(),
            _ => format!("set {}: validation", set + 1),
        };
        traces.push(Drawn::Points { name, x, y, error: Some(error) });
    }
    if let Some(fit) = fit {
        let grid = speeds(fit);
        let y = grid.iter().map(|&v| fit.torque(v) - viscous * v).collect();
        traces.push(Drawn::Line {
            name: "fit".to_owned(),
            x: grid.clone(),
            y,
            style: LineStyle::Solid,
        });
        let plant = &results.options.test_bed.friction;
        let y = grid.iter().map(|&v| plant.steady_state(v) - viscous * v).collect();
        traces.push(Drawn::Line { name: "plant".to_owned(), x: grid, y, style: LineStyle::Dashed });
    }
    traces
}

/// A grid over the measured speeds, even on the logarithmic axis.
fn speeds(fit: &StribeckFit) -> Vec<f64> {
    let (slowest, fastest) = fit.speeds;
    (0..=300).map(|i| slowest * (fastest / slowest).powf(f64::from(i) / 300.0)).collect()
}

/// Mean velocity, mean torque and half the distance of its quartiles over the repetitions, for each
/// velocity of the grid.
fn means(runs: &[SteadyRun], set: u32, grid: &[f64]) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let (mut x, mut y, mut error) = (vec![], vec![], vec![]);
    for &reference in grid {
        let of_point: Vec<_> =
            runs.iter().filter(|run| run.set == set && run.reference == reference).collect();
        let torques: Vec<_> =
            of_point.iter().map(|run| (run.torque, run.torque_systematic)).collect();
        let Some(torque) = Measured::of(&torques) else { continue };
        x.push(Sample::of(of_point.iter().map(|run| run.velocity)).mean);
        y.push(torque.mean);
        error.push(torque.half_spread());
    }
    (x, y, error)
}

fn how(results: &RunResults) -> String {
    let options = &results.options;
    let simulation = &options.test_bed.simulation;
    let p = &options.constant_velocity;
    let mut text = format!(
        "Rig: geared DC servo, K = {:.4} rad/s per V, T = {:.5} s, friction enters at {:.4} V per N m, voltage limit {} V, loop at {:.0} Hz. ",
        simulation.drive.gain(),
        simulation.drive.time_constant(),
        simulation.friction_coupling.volts_per_newton_metre(&simulation.drive),
        numbers::plain(simulation.voltage_limit, 6),
        1.0 / simulation.period
    );
    if options.experiment.includes(ConstantVelocityProtocol::NAME) {
        text += &format!(
            "Constant velocities: {} from {} to {} rad/s, {} s each of which {} s count, {}, {}. ",
            p.velocities.len(),
            numbers::plain(p.velocities.first().copied().unwrap_or_default(), 6),
            numbers::plain(p.velocities.last().copied().unwrap_or_default(), 6),
            numbers::plain(p.duration, 6),
            numbers::plain(p.duration - p.drop_first - p.drop_last, 6),
            numbers::count(p.repetitions as usize, "repetition"),
            numbers::count(p.sets as usize, "set")
        );
    }
    let compensated = results.comparisons().next().is_some();
    text += match (&results.identification, compensated) {
        (Some(_), true) => {
            "The observers compensate with the static parameters identified above; stiffness, damping and lag, which constant velocities do not \
             show, are those the run was given. "
        }
        (None, true) => "The observers compensate with the parameters that the run was given. ",
        (None, false) if options.experiment.includes(ConstantVelocityProtocol::NAME) => {
            "Nothing was identified. "
        }
        _ => "",
    };
    text += "Sensors have noise and converter steps; the observers run on the tachometer.";
    text
}

/// Parameters of the observers that were compared.
fn model_table(results: &RunResults, models: &Compensators) -> Table {
    let rows = results
        .options
        .models
        .iter()
        .map(|&name: &ModelName| {
            let parameters = serde_json::to_value(models.get(name)).unwrap_or_default();
            let text = parameters[name.as_str()].as_object().map_or(String::new(), |map| {
                map.iter()
                    .map(|(key, value)| {
                        format!("{key} = {}", numbers::plain(value.as_f64().unwrap_or(f64::NAN), 6))
                    })
                    .collect::<Vec<_>>()
                    .join(", ")
            });
            vec![name.to_string(), text]
        })
        .collect();
    Table {
        title: "Observers".to_owned(),
        caption:
            "Parameters in N m, rad and s, as in parameters.yaml, which says where each comes from."
                .to_owned(),
        columns: vec!["model".to_owned(), "parameters".to_owned()],
        rows,
        highlight: None,
    }
}
