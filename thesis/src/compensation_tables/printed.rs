//! Tables 5.1, 5.2 and 6.2 to 6.7 as the thesis prints them.

use friction_model::ModelName;
use serde::Serialize;

/// What a row is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// The linear controller without friction.
    NoFriction,
    /// The linear controller with friction.
    Linear,
    /// An observer over the model.
    Observer(ModelName),
}

/// One printed row; what a table does not print is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PrintedRow {
    /// What it is about.
    pub scheme: Scheme,
    /// First column as printed.
    pub label: &'static str,
    /// Mean square error, in the table's unit.
    pub mse: f64,
    /// Largest error, in the table's unit.
    pub max_error: Option<f64>,
    /// Improvement over the linear controller [%].
    pub improvement: Option<f64>,
}

/// What a table's improvement is of; its head does not say so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ImprovementOf {
    /// The table has no such column.
    Nothing,
    /// The largest error.
    MaxError,
    /// The mean square error.
    Mse,
}

/// A printed table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PrintedTable {
    /// Its number.
    pub number: &'static str,
    /// Its title.
    pub title: &'static str,
    /// Unit of the mean square error as a power of ten.
    pub mse_exponent: i32,
    /// Unit of the largest error as a power of ten.
    pub max_exponent: i32,
    /// What its improvement is of.
    pub improvement_of: ImprovementOf,
    /// Its rows.
    pub rows: &'static [PrintedRow],
}

const fn row(
    scheme: Scheme,
    label: &'static str,
    mse: f64,
    max_error: Option<f64>,
    improvement: Option<f64>,
) -> PrintedRow {
    PrintedRow { scheme, label, mse, max_error, improvement }
}

const PROPOSED: Scheme = Scheme::Observer(ModelName::Proposed);
const LUGRE: Scheme = Scheme::Observer(ModelName::LuGre);
const GMS: Scheme = Scheme::Observer(ModelName::Gms);
const XIONG: Scheme = Scheme::Observer(ModelName::Xiong);

/// Every table, in the thesis's order.
pub const PRINTED: [PrintedTable; 8] = [
    PrintedTable {
        number: "5.1",
        title: "control schemes under velocity control",
        mse_exponent: -6,
        max_exponent: -4,
        improvement_of: ImprovementOf::Nothing,
        rows: &[
            row(Scheme::NoFriction, "PI no Friction", 1.7187, Some(47.0), None),
            row(Scheme::Linear, "PI with Friction", 101.42, Some(543.0), None),
            row(PROPOSED, "proposed model observer", 1.0855, Some(25.0), None),
            row(LUGRE, "LuGre model observer", 1.3738, Some(47.0), None),
            row(GMS, "GMS model observer", 1.6553, Some(50.0), None),
            row(XIONG, "Xiong model observer", 1.6322, Some(48.0), None),
        ],
    },
    PrintedTable {
        number: "5.2",
        title: "control schemes under position control",
        mse_exponent: -4,
        max_exponent: 0,
        improvement_of: ImprovementOf::Nothing,
        rows: &[
            row(Scheme::NoFriction, "PID no Friction (printed PI)", 67.0, None, None),
            row(Scheme::Linear, "PID with Friction (printed PI)", 441.0, None, None),
            row(PROPOSED, "proposed model observer", 30.0, None, None),
            row(LUGRE, "LuGre model observer", 41.0, None, None),
            row(GMS, "GMS model observer", 44.0, None, None),
            row(XIONG, "Xiong model observer", 65.0, None, None),
        ],
    },
    PrintedTable {
        number: "6.2",
        title: "velocity tracking experiment",
        mse_exponent: -5,
        max_exponent: -4,
        improvement_of: ImprovementOf::MaxError,
        rows: &[
            row(Scheme::Linear, "PID only", 1.8279, Some(275.0), None),
            row(PROPOSED, "Proposed model", 1.2806, Some(239.0), Some(13.1)),
            row(LUGRE, "LuGre model", 1.3177, Some(248.0), Some(9.82)),
            row(GMS, "GMS model", 1.4749, Some(253.0), Some(8.0)),
            row(XIONG, "Xiong model", 1.4384, Some(249.0), Some(9.45)),
        ],
    },
    PrintedTable {
        number: "6.3",
        title: "velocity regulation experiment",
        mse_exponent: -4,
        max_exponent: -4,
        improvement_of: ImprovementOf::MaxError,
        rows: &[
            row(Scheme::Linear, "PID only", 9.6548, Some(5474.0), None),
            row(PROPOSED, "Proposed new model", 9.4329, Some(5432.0), Some(0.77)),
            row(LUGRE, "LuGre model", 9.4808, Some(5438.0), Some(0.66)),
            // The errors give 0.548 %.
            row(GMS, "GMS model", 9.4554, Some(5444.0), Some(0.48)),
            row(XIONG, "Xiong model", 9.4757, Some(5452.0), Some(0.40)),
        ],
    },
    PrintedTable {
        number: "6.4",
        title: "position tracking experiment",
        mse_exponent: -4,
        max_exponent: -4,
        improvement_of: ImprovementOf::MaxError,
        rows: &[
            row(Scheme::Linear, "PID only", 4.2465, Some(1203.0), None),
            row(PROPOSED, "Proposed new model", 2.2029, Some(899.0), Some(25.27)),
            row(LUGRE, "LuGre model", 2.1074, Some(901.0), Some(25.10)),
            row(GMS, "GMS model", 2.7844, Some(962.0), Some(20.03)),
            row(XIONG, "Xiong model", 2.2430, Some(903.0), Some(24.94)),
        ],
    },
    PrintedTable {
        number: "6.5",
        title: "velocity tracking simulation",
        mse_exponent: -5,
        max_exponent: -4,
        improvement_of: ImprovementOf::MaxError,
        rows: &[
            row(Scheme::Linear, "PID", 1.2664, Some(165.0), None),
            row(PROPOSED, "Proposed new model observer", 0.4994, Some(36.0), Some(78.2)),
        ],
    },
    PrintedTable {
        number: "6.6",
        title: "velocity regulation simulation",
        mse_exponent: -4,
        max_exponent: 0,
        improvement_of: ImprovementOf::Mse,
        rows: &[
            row(Scheme::Linear, "Linear controller", 1.1182, Some(1.0), None),
            row(PROPOSED, "Proposed model observer", 0.9434, Some(1.0), Some(15.6)),
        ],
    },
    PrintedTable {
        number: "6.7",
        title: "position tracking and control simulation",
        mse_exponent: -4,
        max_exponent: -4,
        improvement_of: ImprovementOf::MaxError,
        rows: &[
            row(Scheme::Linear, "PID only", 2.9779, Some(567.0), None),
            row(PROPOSED, "Proposed model observer", 1.4854, Some(432.0), Some(23.8)),
        ],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The improvements follow from the errors beside them, but for the one misprint.
    #[test]
    fn printed_improvements_follow_from_the_printed_errors() {
        for table in &PRINTED {
            let first = table.rows.iter().find(|row| row.scheme == Scheme::Linear).unwrap();
            for row in table.rows {
                let Some(printed) = row.improvement else { continue };
                let found = match table.improvement_of {
                    ImprovementOf::MaxError => {
                        1.0 - row.max_error.unwrap() / first.max_error.unwrap()
                    }
                    ImprovementOf::Mse => 1.0 - row.mse / first.mse,
                    ImprovementOf::Nothing => panic!("{}", table.number),
                };
                let misprint = table.number == "6.3" && row.scheme == GMS;
                assert_eq!(
                    (100.0 * found - printed).abs() > 0.06,
                    misprint,
                    "{} {row:?}",
                    table.number
                );
            }
        }
    }
}
