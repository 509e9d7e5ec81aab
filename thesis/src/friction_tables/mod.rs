//! The tables of the thesis's chapter 4 (4.2 to 4.11 and 4.13 to 4.16): its printed figures beside
//! those found.

mod printed;

use friction_ident::staged::rms_of_kind;
use friction_ident::{ParameterId, Stage, StretchKind};

use identification::friction::{FrictionIdentification, ModelResult, wording};
use report::figure::{Block, Table};

pub use printed::{PRINTED, Printed, Row};

/// The tables under their heading, for the page of an identification.
#[must_use]
pub fn blocks(found: &FrictionIdentification) -> Vec<Block> {
    let heading = Block::Heading("Beside the thesis".to_owned());
    let text = Block::Text(
        "The tables of the thesis's chapter 4 in their own layout, with its printed figures and those found here. Where a printed figure contradicts \
         the thesis's own text or another table, the row says which is consistent."
            .to_owned(),
    );
    [heading, text].into_iter().chain(tables(found).into_iter().map(Block::Table)).collect()
}

/// The tables of the models that were identified.
pub fn tables(found: &FrictionIdentification) -> Vec<Table> {
    PRINTED
        .iter()
        .filter_map(|printed| Some(table(found, found.model(printed.model)?, printed)))
        .collect()
}

fn table(found: &FrictionIdentification, result: &ModelResult, printed: &Printed) -> Table {
    let mut rows: Vec<Vec<String>> = printed
        .rows
        .iter()
        .map(|row| {
            vec![
                row.symbol.to_owned(),
                row.printed.to_owned(),
                ours(result, printed.stage, row.name.into()),
                row.remark.to_owned(),
            ]
        })
        .collect();
    if let (Some(stage), Some((estimation, validation))) = (printed.stage, printed.mean_squares) {
        let kind = kind_of(stage);
        let rms =
            result.found.stages.iter().find(|found| found.stage == stage).map(|found| found.rms);
        let tried = found
            .held_out
            .as_ref()
            .and_then(|data| rms_of_kind(&result.found.predictor(), data, kind));
        let square = |rms: Option<f64>| {
            rms.map_or("not in these recordings".to_owned(), |rms| format!("{:.4e}", rms * rms))
        };
        rows.push(vec![
            "mse, estimation".to_owned(),
            estimation.to_owned(),
            square(rms),
            String::new(),
        ]);
        rows.push(vec![
            "mse, validation".to_owned(),
            validation.to_owned(),
            if found.held_out.is_some() {
                square(tried)
            } else {
                "no recording was held out".to_owned()
            },
            String::new(),
        ]);
    }
    Table {
        title: format!("Thesis table {}: {}", printed.number, printed.title),
        caption: match printed.stage {
            Some(stage) => format!(
                "Here: what the {} found; the mean square on validation is the final model's.",
                stage.describe()
            ),
            None => "Here: the final parameters.".to_owned(),
        },
        columns: ["parameter", "printed", "found", "remark"].map(str::to_owned).to_vec(),
        rows,
        highlight: None,
    }
}

fn kind_of(stage: Stage) -> StretchKind {
    match stage {
        Stage::PreSliding => StretchKind::PreSliding,
        Stage::Lag => StretchKind::Lag,
        _ => StretchKind::Steady,
    }
}

/// What that stage found, or where it did not estimate the number what the model has in the end.
fn ours(result: &ModelResult, stage: Option<Stage>, id: ParameterId) -> String {
    let of_stage = stage.and_then(|stage| {
        result.found.stages.iter().find(|found| found.stage == stage)?.estimates.get(id)
    });
    match of_stage.or_else(|| result.found.estimates.get(id)) {
        Some(estimate) => {
            let (value, error) = wording::value(estimate);
            let plus = if error.is_empty() { String::new() } else { format!(" ± {error}") };
            let doubt = if estimate.is_identified() { "" } else { " (not identified)" };
            let held =
                if stage.is_some() && of_stage.is_none() { " (not of this stage)" } else { "" };
            format!("{value}{plus}{doubt}{held}")
        }
        // The last share is what the others leave.
        None => match last_share(result, id) {
            Some(share) => format!("{} (what the others leave)", wording::significant(share)),
            None => "the model has none".to_owned(),
        },
    }
}

fn last_share(result: &ModelResult, id: ParameterId) -> Option<f64> {
    result.found.model.parameters().values(id.name).get(id.element?).copied()
}

#[cfg(test)]
mod tests {
    use friction_model::AnyModel;

    use super::*;

    #[test]
    fn every_printed_row_names_a_number_of_its_model() {
        for table in PRINTED {
            let parameters = AnyModel::test_bed(table.model).parameters();
            for row in table.rows {
                let id = ParameterId::from(row.name);
                assert!(
                    parameters.values(id.name).len() > id.index(),
                    "table {}: {}",
                    table.number,
                    row.name
                );
                assert!(
                    row.printed.parse::<f64>().is_ok(),
                    "table {}: {}",
                    table.number,
                    row.printed
                );
            }
        }
        let numbers: Vec<_> = PRINTED.iter().map(|table| table.number).collect();
        assert_eq!(numbers.len(), 14);
        assert!(
            numbers.is_sorted_by_key(|number| number[2..].parse::<u32>().unwrap()),
            "{numbers:?}"
        );
    }
}
