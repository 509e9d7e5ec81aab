//! Which model compensates best, as a distribution over the draws.

use std::collections::BTreeSet;

use friction_model::ModelName;
use serde::Serialize;

use super::{Cell, Study};
use experiment_runner::compensation::{Arm, Means};

/// How a model stands among those that the same technique was tried with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Standing {
    /// The model.
    pub model: ModelName,
    /// Share of the draws in which its mean square is the least.
    pub first: f64,
    /// Standard error of that share over the draws.
    pub first_error: f64,
    /// Mean place, from 1.
    pub place: f64,
    /// Median over the draws of its mean square divided by the least one of the draw.
    pub behind: f64,
}

/// The models of one technique in one cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranking {
    /// The technique.
    pub means: Means,
    /// One entry a model, in the order of the arms.
    pub standings: Vec<Standing>,
    /// How many different orders occurred.
    pub orders: usize,
    /// Draws.
    pub draws: usize,
}

impl Study {
    /// The rankings of a cell: one for each technique that was tried with two models or more.
    #[must_use]
    pub fn rankings(&self, cell: &Cell) -> Vec<Ranking> {
        let mut techniques: Vec<Means> = Vec::new();
        for means in self.arms.iter().filter_map(Arm::means) {
            if means.needs_model() && !techniques.contains(&means) {
                techniques.push(means);
            }
        }
        techniques
            .into_iter()
            .map(|means| self.ranking(cell, means))
            .filter(|ranking| ranking.standings.len() > 1 && ranking.draws > 0)
            .collect()
    }

    fn ranking(&self, cell: &Cell, means: Means) -> Ranking {
        let models: Vec<(usize, ModelName)> = self
            .arms
            .iter()
            .enumerate()
            .filter(|(_, arm)| arm.means() == Some(means))
            .filter_map(|(index, arm)| Some((index, arm.model()?)))
            .collect();
        let mut firsts = vec![0usize; models.len()];
        let mut places = vec![0usize; models.len()];
        let mut behind = vec![Vec::with_capacity(cell.draws.len()); models.len()];
        let mut orders = BTreeSet::new();
        for trials in &cell.draws {
            let mse = |model: usize| trials[models[model].0].mse;
            let mut order: Vec<usize> = (0..models.len()).collect();
            order.sort_by(|&a, &b| mse(a).total_cmp(&mse(b)));
            for (place, &model) in order.iter().enumerate() {
                firsts[model] += usize::from(place == 0);
                places[model] += place + 1;
                behind[model].push(mse(model) / mse(order[0]));
            }
            orders.insert(order);
        }
        let n = cell.draws.len() as f64;
        let standings = models
            .iter()
            .enumerate()
            .map(|(i, &(_, model))| {
                let first = firsts[i] as f64 / n;
                Standing {
                    model,
                    first,
                    first_error: (first * (1.0 - first) / n).sqrt(),
                    place: places[i] as f64 / n,
                    behind: super::worth::Percentiles::of(behind[i].iter().copied()).median,
                }
            })
            .collect();
        Ranking { means, standings, orders: orders.len(), draws: cell.draws.len() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monte_carlo::{BeliefErrors, Setting, Sharing, Task, Trial};

    #[test]
    fn places_and_orders_are_counted() {
        let trial = |mse: f64| Trial { mse, max_error: 1.0, effort: 1.0 };
        let draws: Vec<Vec<Trial>> = [
            [9.0, 1.0, 2.0, 4.0],
            [9.0, 3.0, 2.0, 4.0],
            [9.0, 1.0, 3.0, 5.0],
            [9.0, 1.0, 2.0, 6.0],
        ]
        .iter()
        .map(|row| row.iter().map(|&mse| trial(mse)).collect())
        .collect();
        let arms = vec![
            Arm::None,
            Arm::observer(ModelName::LuGre),
            Arm::observer(ModelName::Proposed),
            Arm::Model(Means::Feedforward, ModelName::Dahl),
        ];
        let cell = Cell {
            task: Task::PositionTracking,
            plant: ModelName::LuGre,
            floor: trial(1.0),
            draws,
        };
        let study = Study {
            program_version: String::new(),
            arms,
            draws: 4,
            errors: BeliefErrors { fraction: 0.2, sharing: Sharing::Common, seed: 1 },
            setting: Setting::Physical,
            cells: vec![],
            stopped: false,
        };
        // Feedforward has one model only: nothing to rank.
        let [ranking] = study.rankings(&cell).try_into().unwrap();
        assert_eq!((ranking.means, ranking.orders, ranking.draws), (Means::Feedback, 2, 4));
        let [lugre, proposed] = ranking.standings.try_into().unwrap();
        assert_eq!((lugre.first, lugre.place, lugre.behind), (0.75, 1.25, 1.0));
        assert_eq!((proposed.first, proposed.place, proposed.behind), (0.25, 1.75, 2.0));
        assert!((lugre.first_error - (0.75f64 * 0.25 / 4.0).sqrt()).abs() < 1e-15);
        assert_eq!(cell.worth(1).mse_ratio.median, 9.0);
        assert_eq!(cell.ceiling(), 9.0);
    }
}
