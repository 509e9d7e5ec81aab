//! What a run leaves in its folder.

use std::path::Path;
use std::time::Instant;

use friction_model::ModelName;
use recording::csv_table::CsvTable;
use report::{linked, render_page};
use work::progress::Progress;

use super::{BAG, Measured};
use crate::constant_velocity::SteadyRun;
use crate::run::experiment::Found;
use crate::run::recorder::Recorder;
use crate::run::results::{BagFigures, Reconnection, RunResults, Session, Status, Timing};
use crate::run::{CHARACTERISE, RunError, RunOptions, page, parameter_file};
use files::write_all;

/// How a run ended.
pub(super) struct Ending {
    /// Why the rig ended it, if it did.
    pub(super) ended: Option<String>,
    pub(super) reconnections: Vec<Reconnection>,
    pub(super) sessions: Vec<Session>,
    pub(super) started: Instant,
}

/// Closes the bag and writes the results beside it.
pub(super) fn write_results(
    folder: &Path,
    options: &RunOptions,
    progress: &Progress,
    mut recorder: Recorder,
    measured: Measured,
    ending: Ending,
) -> Result<RunResults, RunError> {
    let Measured { status, rig_seconds, models, found, tables, unfit } = measured;
    let Ending { ended, reconnections, sessions, started } = ending;
    let ended = ended.or(unfit);
    let unrecorded = recorder.drain()?;
    if unrecorded > 0 {
        progress.line(&format!("{unrecorded} cycles are not in the bag: the disk did not keep up"));
    }
    progress.stage("report");
    let chosen = options.models.last().copied().unwrap_or(ModelName::Proposed);
    let name = format!("`run {}` in {}", options.experiment.as_str(), folder.display());
    let parameters =
        parameter_file::render(options, &models, chosen, found.identification.as_ref(), &name)?;
    let (parameters, origin) = (parameters.text, parameters.origins);
    recorder.attach("parameters.yaml", "application/yaml", &parameters)?;
    let bag = recorder.finish()?;
    let wall_seconds = started.elapsed().as_secs_f64();
    let Found { steady, identification, characterisation, tracked, own, blocks, tables: of_own } =
        found;
    let results = RunResults {
        program_version: env!("CARGO_PKG_VERSION"),
        status: if ended.is_some() { Status::Interrupted } else { status },
        ended,
        reconnections,
        sessions: if sessions.len() > 1 { sessions } else { Vec::new() },
        options: options.clone(),
        origin,
        constant_velocity: steady,
        identification,
        characterisation,
        velocity_tracking: tracked.velocity,
        position_tracking: tracked.position,
        compensation: tracked.tasks,
        thesis_tables: tables,
        own,
        bag: BagFigures {
            folder: BAG,
            messages: bag.messages,
            bytes: bag.bytes,
            recorded: options.record.describe(),
        },
        timing: Timing { wall_seconds, rig_seconds, times_real_time: rig_seconds / wall_seconds },
    };
    let json = serde_json::to_string_pretty(&results)
        .map_err(|e| RunError::Describe { what: "JSON", detail: e.to_string() })?;
    let mut files = vec![("parameters.yaml", parameters), ("run.json", json)];
    let tables = &results.characterisation.records;
    files.extend(tables.iter().map(|(name, record)| (name.as_str(), record.csv())));
    files.extend(of_own.iter().map(|(name, table)| (name.as_str(), table.clone())));
    if options.experiment.as_str() == CHARACTERISE && !results.constant_velocity.is_empty() {
        files.push(("steady_points.csv", steady_points(&results.constant_velocity)));
    }
    let page = page::build(&results, &models, &tracked.traces, blocks);
    let report =
        render_page(&linked(page, std::iter::once(BAG).chain(files.iter().map(|file| file.0))));
    files.push(("report.html", report));
    write_all(folder, &files)?;
    Ok(results)
}

/// The steady points as comma-separated values.
fn steady_points(runs: &[SteadyRun]) -> String {
    let with_current = runs.iter().all(|run| run.current.is_some());
    let mut columns = vec!["set", "repetition", "velocity_rad_s", "voltage_V"];
    columns.extend(with_current.then_some("current_A"));
    columns.extend(["torque_Nm", "torque_deviation_Nm"]);
    let mut table = CsvTable::new(columns);
    for run in runs {
        let SteadyRun { set, repetition, velocity, voltage, torque, torque_deviation, .. } = run;
        table.cell(set + 1);
        table.cell(repetition + 1);
        table.cell(format_args!("{velocity:.8}"));
        table.cell(format_args!("{voltage:.7}"));
        if let Some(amperes) = run.current.filter(|_| with_current) {
            table.cell(format_args!("{amperes:.7}"));
        }
        table.cell(format_args!("{torque:.8}"));
        table.cell(format_args!("{torque_deviation:.6}"));
        table.end_row();
    }
    table.text()
}
