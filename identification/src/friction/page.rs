//! `identification.html` of friction models as data: tables and pictures for
//! [`report::render_page`].

use super::{Errors, FrictionIdentification, KINDS, ModelResult, Source, pictures, wording};
use report::figure::{Block, Page, Table};

/// Reads the column `from the drive`.
const FROM_DRIVE: &str = " From the drive: the standard deviation that the errors of the drive's constants add, in the same unit. The standard errors and \
                          intervals beside it do not contain it.";

/// Samples of a list that are shown one by one.
const SHOWN: usize = 20;

/// The page, with what somebody has `beside` it.
pub fn page(found: &FrictionIdentification, beside: Vec<Block>) -> Page {
    let mut blocks = vec![Block::Heading("Which model".to_owned())];
    if found.interrupted {
        blocks.push(Block::Note(
            "This identification was stopped before its end: the parameters are the best found by then."
                .to_owned(),
        ));
    }
    blocks.extend(found.warnings.iter().map(|said| Block::Note(format!("WARNING: {said}"))));
    blocks.extend(found.notes.iter().cloned().map(Block::Note));
    blocks.push(Block::Table(comparison(found)));
    blocks.push(Block::Table(by_kind(found)));
    blocks.extend(wording::simpler(found).map(Block::Text));
    blocks.extend(pictures::errors(found).map(Block::Figure));
    blocks.push(Block::Heading("The recordings and what the models make of them".to_owned()));
    blocks.extend(pictures::steady(found).map(Block::Figure));
    blocks.extend(pictures::dynamic(found).into_iter().map(Block::Figure));
    blocks.extend(pictures::residuals(found).map(Block::Figure));
    blocks.push(Block::Heading("The parameters".to_owned()));
    for result in &found.models {
        blocks.push(Block::Table(parameters(result)));
        blocks.extend(result.found.notes.iter().cloned().map(Block::Note));
        blocks.extend(correlation(result).map(Block::Table));
        blocks.push(Block::Table(stages(found, result)));
    }
    blocks.extend(beside);
    blocks.push(Block::Heading("How it was done".to_owned()));
    blocks.push(Block::Text(how(found)));
    blocks.push(Block::Table(files(found)));
    blocks.extend(outliers(found).map(Block::Table));
    Page {
        title: "Identified friction".to_owned(),
        subtitle: format!(
            "{}; frictionlab {}",
            found
                .files
                .iter()
                .map(|file| file.path.display().to_string())
                .collect::<Vec<_>>()
                .join(", "),
            env!("CARGO_PKG_VERSION")
        ),
        blocks,
    }
}

fn comparison(found: &FrictionIdentification) -> Table {
    let unit = found.settings.axis.force_unit();
    let mut columns =
        vec!["model".to_owned(), "free parameters".to_owned(), format!("fit [{unit}]")];
    columns.extend(found.held_out.as_ref().map(|_| format!("held out [{unit}]")));
    columns.extend(["AIC", "BIC", "place"].map(str::to_owned));
    let row = |(place, result): (usize, &ModelResult)| {
        let information = result.found.information;
        let mut row = vec![
            result.found.name.to_string(),
            result.found.free_parameters.to_string(),
            wording::significant(result.fit.all),
        ];
        row.extend(result.held_out.map(|errors| wording::significant(errors.all)));
        row.push(wording::significant(information.aic));
        row.push(wording::significant(information.bic));
        row.push(wording::place(found, place, result));
        row
    };
    Table {
        title: "The models in order".to_owned(),
        caption: format!(
            "{} Errors are root mean squares of predicted minus measured friction.",
            wording::criterion(found)
        ),
        columns,
        rows: found.models.iter().enumerate().map(row).collect(),
        highlight: found.chosen,
    }
}

/// The errors on each kind of recording.
fn by_kind(found: &FrictionIdentification) -> Table {
    type Of = fn(&ModelResult) -> Option<Errors>;
    let sets: [(&str, Of); 2] =
        [("fit", |result| Some(result.fit)), ("held out", |result| result.held_out)];
    // A column for each kind that either has.
    let columns: Vec<(String, Of, usize)> = sets
        .into_iter()
        .flat_map(|(name, of)| {
            (0..KINDS.len()).map(move |k| (format!("{name}, {}", KINDS[k].describe()), of, k))
        })
        .filter(|(_, of, k)| {
            found.models.iter().any(|r| of(r).is_some_and(|errors| errors.kinds[*k].is_some()))
        })
        .collect();
    let cell = |result: &ModelResult, of: Of, k: usize| {
        of(result).and_then(|errors| errors.kinds[k]).map_or(String::new(), wording::significant)
    };
    let row = |result: &ModelResult| {
        std::iter::once(result.found.name.to_string())
            .chain(columns.iter().map(|(_, of, k)| cell(result, *of, *k)))
            .collect()
    };
    Table {
        title: format!("Errors on each kind of recording [{}]", found.settings.axis.force_unit()),
        caption: "Root mean square of predicted minus measured friction.".to_owned(),
        rows: found.models.iter().map(row).collect(),
        columns: std::iter::once("model".to_owned())
            .chain(columns.iter().map(|(name, ..)| name.clone()))
            .collect(),
        highlight: found.chosen,
    }
}

fn parameters(result: &ModelResult) -> Table {
    let driven = result.from_drive.is_some();
    let mut columns = vec!["parameter", "value", "standard error", "95 % interval"];
    columns.extend(driven.then_some("from the drive"));
    columns.extend(["unit", "what the data say"]);
    let columns = columns.into_iter().map(str::to_owned).collect();
    let rows = result
        .found
        .estimates
        .parameters
        .iter()
        .map(|estimate| {
            let (value, error) = wording::value(estimate);
            let mut row = vec![estimate.id.to_string(), value, error, wording::interval(estimate)];
            if driven {
                row.push(wording::from_drive(result, estimate));
            }
            row.extend([estimate.unit.to_owned(), wording::verdict(estimate)]);
            row
        })
        .collect();
    Table {
        title: format!("{}: parameters", result.found.name),
        caption: format!(
            "Standard errors along recordings are those of a sandwich covariance with cosine weights (Lazarus, Lewis, Stock and Watson 2018), which counts \
             coloured residuals and what the model lacks; steady points count as independent. A parameter that is not identifiable has a number that is safe \
             to compute with, and no more.{}",
            if driven { FROM_DRIVE } else { "" }
        ),
        columns,
        rows,
        highlight: None,
    }
}

/// Correlations of the last fit of several parameters.
fn correlation(result: &ModelResult) -> Option<Table> {
    let stage =
        result.found.stages.iter().rev().find(|stage| stage.estimates.parameters.len() > 1)?;
    let names: Vec<String> = stage.estimates.parameters.iter().map(|p| p.id.to_string()).collect();
    let rows = names
        .iter()
        .zip(&stage.estimates.correlation)
        .enumerate()
        .map(|(row, (name, values))| {
            let cells = values.iter().enumerate().map(|(column, value)| {
                if column > row { String::new() } else { format!("{value:.2}") }
            });
            std::iter::once(name.clone()).chain(cells).collect()
        })
        .collect();
    Some(Table {
        title: format!("{}: correlation", result.found.name),
        caption: format!(
            "Of the {}. Near 1 or -1 two parameters can hardly be told apart.",
            stage.stage.describe()
        ),
        columns: std::iter::once("parameter".to_owned()).chain(names).collect(),
        rows,
        highlight: None,
    })
}

fn stages(found: &FrictionIdentification, result: &ModelResult) -> Table {
    let rows = result
        .found
        .stages
        .iter()
        .map(|stage| {
            let values: Vec<String> = stage
                .estimates
                .parameters
                .iter()
                .map(|estimate| format!("{} {}", estimate.id, wording::value(estimate).0))
                .collect();
            let used = stage.samples > 0;
            vec![
                stage.stage.describe().to_owned(),
                if used { stage.samples.to_string() } else { String::new() },
                if used { wording::significant(stage.rms) } else { String::new() },
                values.join(", "),
            ]
        })
        .collect();
    Table {
        title: format!("{}: stage by stage", result.found.name),
        caption: "What each stage estimated; a later stage has the last word.".to_owned(),
        columns: vec![
            "stage".to_owned(),
            "points and samples".to_owned(),
            format!("rms [{}]", found.settings.axis.force_unit()),
            "parameters".to_owned(),
        ],
        rows,
        highlight: None,
    }
}

fn how(found: &FrictionIdentification) -> String {
    let staged = &found.settings.staged;
    let damping = match staged.inertia {
        Some(inertia) => format!(
            "the micro-damping from an inertia of {} {} and a damping ratio of {}, unless the recordings contradict that",
            inertia.value,
            found.settings.axis.inertia_unit(),
            staged.damping_ratio
        ),
        None => "the micro-damping as the recordings show it (no inertia was given)".to_owned(),
    };
    format!(
        "Friction is {}. The static characteristic comes from constant velocities, the stiffness from pre-sliding, {damping}, the lag from velocity that \
         varies one way{}. Each model runs in its fixed-step form along the measured motion.",
        found.settings.preparation.torque.describe(),
        if staged.joint {
            "; then all parameters are refined together over all recordings"
        } else {
            ""
        }
    )
}

fn files(found: &FrictionIdentification) -> Table {
    let row = |use_: &str, source: &Source| {
        vec![
            source.path.display().to_string(),
            use_.to_owned(),
            source.samples.to_string(),
            source.points.to_string(),
            source.stretches.to_string(),
            source.outliers.len().to_string(),
            source.irregularities.too_short.to_string(),
        ]
    };
    let fitted = found.files.iter().map(|source| row("fitted", source));
    let tried = found.validation.iter().map(|source| row("held out", source));
    Table {
        title: "The files".to_owned(),
        caption: "A run at a constant velocity counts as one steady point; its first fifth and last tenth are left out.".to_owned(),
        columns: ["file", "use", "samples", "steady points", "other stretches", "samples replaced", "pieces left out"]
            .map(str::to_owned)
            .to_vec(),
        rows: fitted.chain(tried).collect(),
        highlight: None,
    }
}

fn outliers(found: &FrictionIdentification) -> Option<Table> {
    let all: Vec<Vec<String>> = found
        .files
        .iter()
        .chain(&found.validation)
        .flat_map(|source| {
            source.outliers.iter().map(|outlier| {
                vec![
                    source.path.display().to_string(),
                    outlier.channel.to_owned(),
                    format!("{:.4}", outlier.time),
                    wording::significant(outlier.measured),
                    wording::significant(outlier.by),
                ]
            })
        })
        .collect();
    (!all.is_empty()).then(|| Table {
        title: "Samples that were not believed".to_owned(),
        caption: format!(
            "{} in all; the first {} are shown, identification.json has every one.",
            all.len(),
            all.len().min(SHOWN)
        ),
        columns: ["file", "channel", "time [s]", "measured", "replaced by"]
            .map(str::to_owned)
            .to_vec(),
        rows: all.into_iter().take(SHOWN).collect(),
        highlight: None,
    })
}
