//! Parts of a matrix become one.

use friction_ident::truth_matrix::Trial;
use friction_model::ModelName;
use work::BadInput;
use work::part::{Found, Parts};

use super::{Matrix, MatrixOptions, Row};

/// Adds the trials of a truth under its next seed.
pub(super) fn add(rows: &mut Vec<Row>, truth: ModelName, trials: Vec<Trial>) {
    match rows.last_mut().filter(|row| row.truth == truth) {
        Some(row) => row.trials.push(trials),
        None => rows.push(Row { truth, trials: vec![trials] }),
    }
}

impl MatrixOptions {
    /// Joins parts of this matrix: what comes of all of them is what one process finds. Where parts
    /// are missing it counts as stopped.
    ///
    /// # Errors
    /// [`BadInput`] for a part of another matrix, and for one that was stopped.
    pub fn join(&self, parts: &Parts<Matrix>) -> Result<Matrix, BadInput> {
        let mut rows = Vec::new();
        for part in &parts.found {
            self.check(part)?;
            for row in &part.result.rows {
                for trials in &row.trials {
                    add(&mut rows, row.truth, trials.clone());
                }
            }
        }
        Ok(Matrix {
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            models: self.ordered(),
            noise: self.noise,
            seeds: self.seeds,
            rows,
            stopped: !parts.complete(),
        })
    }

    /// Whether a part is one of this matrix, and whole.
    fn check(&self, part: &Found<Matrix>) -> Result<(), BadInput> {
        let matrix = &part.result;
        let same = matrix.models == self.ordered()
            && (matrix.noise, matrix.seeds) == (self.noise, self.seeds);
        if !same {
            let why = "it is a part of a matrix with other options; --join needs them as they were with --part";
            return Err(part.refused(why));
        }
        let pieces = part.part.range(self.pieces());
        let expected = self.jobs().skip(pieces.start as usize).take(pieces.len());
        let truths = expected.map(|(truth, _)| truth);
        let found = matrix.rows.iter().flat_map(|row| row.trials.iter().map(|_| row.truth));
        if matrix.stopped || !found.eq(truths) {
            let why = format!("part {} was stopped before its end; make it anew", part.part);
            return Err(part.refused(why));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use work::part::{Part, document, read};
    use work::progress::Progress;

    use super::super::{compute, page, summary};
    use super::*;

    fn part(options: &MatrixOptions, part: Part) -> Matrix {
        let progress = Progress::counting(4, "fits", true);
        compute(options, part.range(options.pieces()), &progress, &AtomicBool::new(false)).unwrap()
    }

    #[test]
    fn parts_that_are_joined_are_the_matrix_of_one_process_bit_for_bit() {
        let models = vec![ModelName::Stribeck, ModelName::CoulombViscous];
        let asked = MatrixOptions { models, noise: 1e-3, seeds: 2, workers: 1 };
        let folder = tempfile::tempdir().unwrap();
        // The second part begins in the middle of a row.
        for number in ["1/3", "2/3", "3/3"] {
            let number: Part = number.parse().unwrap();
            let text = document("truth-matrix", number, &part(&asked, number)).unwrap();
            let name = number.to_string().replace('/', "-of-");
            std::fs::write(folder.path().join(name).with_extension("json"), text).unwrap();
        }
        let join =
            |asked: &MatrixOptions| asked.join(&read(folder.path(), "truth-matrix").unwrap());
        let (whole, joined) = (part(&asked, Part::WHOLE), join(&asked).unwrap());
        let text = |matrix: &Matrix| serde_json::to_string(matrix).unwrap();
        assert_eq!(text(&joined), text(&whole));
        assert_eq!(summary(&joined), summary(&whole));
        assert_eq!(report::render_page(&page(&joined)), report::render_page(&page(&whole)));
        let other = MatrixOptions { noise: 2e-3, ..asked.clone() };
        assert!(join(&other).unwrap_err().to_string().contains("other options"));
        std::fs::remove_file(folder.path().join("2-of-3.json")).unwrap();
        assert!(join(&asked).unwrap().stopped);
    }
}
