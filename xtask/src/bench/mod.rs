//! `cargo xtask bench`: is a control step in Rust as fast as the same step in plain C, and what
//! does choosing the model while the program runs cost?
//!
//! Both programs take the same velocities and parameters, time themselves in processor time
//! (neither starting a process nor other programs count), and print the sum of all forces: a
//! comparison is only honest if both computed the same. They run in turns, model by model, and what
//! counts is the median of the ratios of neighbouring runs, because a machine's speed drifts more
//! over a minute than the two differ.

mod programs;
mod statistics;
mod table;

use std::io::Write;

use anyhow::{Result, ensure};
use friction_model::ModelName;

use programs::Programs;
use statistics::{Comparison, Rounds};
use table::Table;

/// Models that have to keep up with C, in every scheme; the others are reported.
const HELD: [ModelName; 5] =
    [ModelName::Dahl, ModelName::LuGre, ModelName::Gms, ModelName::Xiong, ModelName::Proposed];

/// Options of `cargo xtask bench`.
#[derive(Debug, Clone, clap::Args)]
pub struct Bench {
    /// Rounds; each runs both programs once for every model.
    #[arg(long, default_value_t = 21, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Steps of each model and scheme in one run.
    #[arg(long, default_value_t = 500_000, value_parser = clap::value_parser!(u64).range(10..))]
    steps: u64,
    /// Models to measure, separated by commas; all if left out.
    #[arg(long = "model", value_name = "MODEL", value_delimiter = ',')]
    models: Vec<ModelName>,
    /// Largest accepted ratio of Rust's time to C's.
    #[arg(long, default_value_t = 1.2)]
    bar: f64,
    /// Largest accepted cost of choosing the model while the program runs [ns a step].
    #[arg(long, default_value_t = 2.0)]
    choice_bar: f64,
    /// Print the tables in Markdown.
    #[arg(long)]
    markdown: bool,
}

impl Bench {
    /// Builds both programs for this processor, runs them in turns and prints the tables.
    ///
    /// # Errors
    /// When a program cannot be built or run, when the sums of forces differ, or when a figure is
    /// above its bar.
    pub fn run(&self) -> Result<()> {
        let programs = Programs::build()?;
        let models =
            if self.models.is_empty() { ModelName::ALL.to_vec() } else { self.models.clone() };

        // Apart from the tables, which may go into a file.
        writeln!(
            std::io::stderr(),
            "{} rounds of {} steps a model and scheme ...\n",
            self.rounds,
            self.steps
        )?;
        let mut rounds = Rounds::default();
        for round in 0..self.rounds {
            for &model in &models {
                // Who goes first changes, so that neither always finds the warmer machine.
                let (rust, c) = programs.in_turns(model, self.steps, round % 2 == 0)?;
                rounds.add(model, rust, c)?;
            }
        }

        let mut out = std::io::stdout().lock();
        let comparisons = rounds.comparisons()?;
        let bar = |row: &Comparison| HELD.contains(&row.model).then_some(self.bar);
        writeln!(out, "{}", Table::of_comparisons(&comparisons, bar).render(self.markdown))?;
        let choices = rounds.choices()?;
        writeln!(out, "{}", Table::of_choices(&choices, self.choice_bar).render(self.markdown))?;

        let slow = comparisons.iter().filter(|row| bar(row).is_some_and(|bar| !row.keeps(bar)));
        let slow = slow.map(|row| format!("{} ({})", row.model, row.scheme));
        let dear = choices.iter().filter(|row| !row.keeps(self.choice_bar));
        let dear = dear.map(|row| format!("{} (chosen)", row.model));
        let above: Vec<String> = slow.chain(dear).collect();
        ensure!(above.is_empty(), "above the bar: {}", above.join(", "));
        Ok(())
    }
}
