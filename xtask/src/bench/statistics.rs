//! What the rounds say: medians and quartiles, over the pairs of neighbouring runs.

use std::collections::BTreeMap;

use anyhow::{Result, ensure};
use friction_ident::statistics::{quantile, sorted};
use friction_model::ModelName;

use super::programs::{Run, Scheme, Timing};

/// First quartile, median and third quartile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quartiles(pub [f64; 3]);

impl Quartiles {
    /// Interpolated; `values` is not empty.
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let values = sorted(values);
        Self([0.25, 0.5, 0.75].map(|share| quantile(&values, share).unwrap_or(f64::NAN)))
    }

    pub const fn median(self) -> f64 {
        self.0[1]
    }
}

/// A model and scheme in Rust and in C.
#[derive(Debug, PartialEq)]
pub struct Comparison {
    pub model: ModelName,
    pub scheme: Scheme,
    /// \[ns\]
    pub rust: Quartiles,
    /// None where C has no peer.
    pub beside: Option<Beside>,
}

#[derive(Debug, PartialEq)]
pub struct Beside {
    /// \[ns\]
    pub c: Quartiles,
    /// Rust's time over C's.
    pub ratio: Quartiles,
    /// Largest relative difference of the sums of forces.
    pub difference: f64,
}

impl Comparison {
    /// Whether the median of the ratio is at most `bar`; never where there is nothing to compare
    /// with.
    pub fn keeps(&self, bar: f64) -> bool {
        self.beside.as_ref().is_some_and(|beside| beside.ratio.median() <= bar)
    }
}

/// A model known at compile time, and chosen while the program runs \[ns\].
#[derive(Debug, PartialEq)]
pub struct Choice {
    pub model: ModelName,
    pub known: Quartiles,
    pub chosen: Quartiles,
    pub difference: Quartiles,
}

impl Choice {
    pub fn keeps(&self, bar: f64) -> bool {
        self.difference.median() <= bar
    }
}

/// The timings of a round: Rust's, and C's where it has a peer.
type Pair = (Timing, Option<Timing>);

/// All rounds so far.
#[derive(Debug, Default)]
pub struct Rounds(BTreeMap<(ModelName, Scheme), Vec<Pair>>);

impl Rounds {
    /// Takes in a round of one model.
    ///
    /// # Errors
    /// When C has a scheme that Rust has not.
    pub fn add(&mut self, model: ModelName, rust: Run, mut c: Run) -> Result<()> {
        for (scheme, timing) in rust {
            self.0.entry((model, scheme)).or_default().push((timing, c.remove(&scheme)));
        }
        ensure!(c.is_empty(), "{model}: C has more schemes than Rust");
        Ok(())
    }

    /// Rust beside C.
    ///
    /// # Errors
    /// When the sums of forces differ.
    pub fn comparisons(&self) -> Result<Vec<Comparison>> {
        let compared =
            self.0.iter().filter(|((_, scheme), _)| matches!(scheme, Scheme::Exact | Scheme::Rk4));
        compared
            .map(|(&(model, scheme), pairs)| {
                let rust = Quartiles::of(pairs.iter().map(|(rust, _)| rust.nanoseconds));
                let pairs: Vec<_> =
                    pairs.iter().filter_map(|&(rust, c)| Some((rust, c?))).collect();
                let beside =
                    if pairs.is_empty() { None } else { Some(beside(model, scheme, &pairs)?) };
                Ok(Comparison { model, scheme, rust, beside })
            })
            .collect()
    }

    /// What choosing the model while the program runs costs.
    ///
    /// # Errors
    /// When the chosen model does not compute what the known one does.
    pub fn choices(&self) -> Result<Vec<Choice>> {
        let known = self.0.iter().filter(|((_, scheme), _)| *scheme == Scheme::Known);
        let pairs = known.filter_map(|(&(model, _), known)| {
            self.0.get(&(model, Scheme::Chosen)).map(|chosen| (model, known, chosen))
        });
        pairs
            .map(|(model, known, chosen)| {
                let pairs =
                    || known.iter().zip(chosen).map(|((known, _), (chosen, _))| (known, chosen));
                let same = pairs().all(|(known, chosen)| known.sum == chosen.sum);
                ensure!(same, "{model}: the chosen model does not compute what the known one does");
                Ok(Choice {
                    model,
                    known: Quartiles::of(pairs().map(|(known, _)| known.nanoseconds)),
                    chosen: Quartiles::of(pairs().map(|(_, chosen)| chosen.nanoseconds)),
                    difference: Quartiles::of(
                        pairs().map(|(known, chosen)| chosen.nanoseconds - known.nanoseconds),
                    ),
                })
            })
            .collect()
    }
}

/// `pairs` is not empty.
fn beside(model: ModelName, scheme: Scheme, pairs: &[(Timing, Timing)]) -> Result<Beside> {
    let differences = pairs.iter().map(|(rust, c)| ((rust.sum - c.sum) / c.sum).abs());
    let difference = differences
        .fold(0.0, |worst: f64, d| if d.is_nan() { f64::INFINITY } else { worst.max(d) });
    ensure!(
        difference <= 1e-9,
        "{model} ({scheme}): the sums of forces differ by {difference:.1e}; the two sides do not compute the same"
    );
    Ok(Beside {
        c: Quartiles::of(pairs.iter().map(|(_, c)| c.nanoseconds)),
        ratio: Quartiles::of(pairs.iter().map(|(rust, c)| rust.nanoseconds / c.nanoseconds)),
        difference,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODEL: ModelName = ModelName::LuGre;

    fn run(scheme: Scheme, nanoseconds: f64, sum: f64) -> Run {
        Run::from([(scheme, Timing { nanoseconds, sum })])
    }

    fn rounds(pairs: &[(Run, Run)]) -> Rounds {
        let mut rounds = Rounds::default();
        for (rust, c) in pairs {
            rounds.add(MODEL, rust.clone(), c.clone()).unwrap();
        }
        rounds
    }

    #[test]
    fn medians_and_quartiles() {
        let quartiles = |values: &[f64]| Quartiles::of(values.iter().copied()).0;
        assert_eq!(quartiles(&[3.0, 1.0, 2.0, 5.0, 4.0]), [2.0, 3.0, 4.0]);
        assert_eq!(quartiles(&[1.0, 2.0]), [1.25, 1.5, 1.75]);
        assert_eq!(quartiles(&[7.0]), [7.0; 3]);
    }

    #[test]
    fn the_ratio_is_the_median_over_rounds() {
        let pair = |rust, c| (run(Scheme::Rk4, rust, 1.0), run(Scheme::Rk4, c, 1.0));
        // One disturbed round does not matter.
        let rows =
            rounds(&[pair(11.0, 10.0), pair(22.0, 20.0), pair(90.0, 10.0)]).comparisons().unwrap();
        assert!((rows[0].beside.as_ref().unwrap().ratio.median() - 1.1).abs() < 1e-12);
        assert!(rows[0].keeps(1.11) && !rows[0].keeps(1.09));
    }

    #[test]
    fn different_sums_are_no_comparison() {
        let compare = |rust, c| {
            rounds(&[(run(Scheme::Exact, 1.0, rust), run(Scheme::Exact, 1.0, c))]).comparisons()
        };
        let message = compare(1.0, 1.0 + 1e-8).unwrap_err().to_string();
        assert!(message.contains("do not compute the same"), "{message}");
        assert!(compare(f64::NAN, 1.0).is_err());
        assert!(compare(1.0, 1.0 + 1e-10).is_ok());
    }

    #[test]
    fn a_model_without_a_peer_is_reported_and_keeps_no_bar() {
        let rows = rounds(&[(run(Scheme::Exact, 5.0, 1.0), Run::new())]).comparisons().unwrap();
        assert_eq!(rows[0].beside, None);
        assert!(!rows[0].keeps(f64::INFINITY));
        let extra = Rounds::default().add(MODEL, Run::new(), run(Scheme::Rk4, 1.0, 1.0));
        assert!(extra.unwrap_err().to_string().contains("more schemes"));
    }

    #[test]
    fn choosing_costs_the_median_of_the_differences() {
        let round = |known, chosen, sum| {
            let mut run = run(Scheme::Known, known, 1.0);
            run.insert(Scheme::Chosen, Timing { nanoseconds: chosen, sum });
            (run, Run::new())
        };
        let rounds_of =
            |sum| rounds(&[round(5.0, 6.0, sum), round(8.0, 9.5, sum), round(5.0, 50.0, sum)]);
        let rows = rounds_of(1.0).choices().unwrap();
        assert_eq!(rows[0].difference.median(), 1.5);
        assert!(rows[0].keeps(1.5) && !rows[0].keeps(1.4));
        assert!(rounds_of(1.0).comparisons().unwrap().is_empty());
        assert!(rounds_of(1.1).choices().unwrap_err().to_string().contains("does not compute"));
    }
}
