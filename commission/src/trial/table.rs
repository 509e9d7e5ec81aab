//! The table of a trial.

use std::fmt;

use serde::Serialize;

use super::Case;

/// What came of all machines.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// Machines.
    pub machines: usize,
    /// Share that was commissioned.
    pub commissioned: f64,
    /// Share of the parameters that lie in their 95 % intervals, and their number.
    pub held: (f64, usize),
    /// Rig time: median, 95th percentile \[s\].
    pub seconds: (f64, f64),
    /// Final error over that of whoever knows the plant, of the machines on which the safety layer
    /// let that one end: median, 95th percentile.
    pub error: (f64, f64),
    /// Machines whose limits were broken.
    pub broken: usize,
    /// Machines that hunt after the hand-over, and those that do under whoever knows the plant.
    pub hunting: (usize, usize),
    /// What ended the others: machine, stage, words.
    pub refused: Vec<(String, String, String)>,
}

/// Puts it together.
#[must_use]
pub fn table(cases: &[Case]) -> Table {
    let done: Vec<_> = cases.iter().filter_map(|case| case.commissioned.as_ref()).collect();
    let held: Vec<bool> = done.iter().flat_map(|c| c.held.iter().map(|held| held.holds)).collect();
    let refused = |case: &Case| {
        let (stage, why) = case.refused.clone()?;
        Some((case.name.clone(), stage.to_string(), why))
    };
    Table {
        machines: cases.len(),
        commissioned: share(done.len(), cases.len()),
        held: (share(held.iter().filter(|held| **held).count(), held.len()), held.len()),
        seconds: quantiles(done.iter().map(|case| case.seconds).collect()),
        error: quantiles(done.iter().filter_map(|case| over_oracle(case)).collect()),
        broken: cases.iter().filter(|case| case.broke_limits()).count(),
        hunting: (
            done.iter().filter(|case| hunts(case.handed_over.as_ref())).count(),
            done.iter().filter(|case| hunts(case.oracle.as_ref())).count(),
        ),
        refused: cases.iter().filter_map(refused).collect(),
    }
}

/// A loop that the safety layer had to stop does not rest.
fn hunts(finish: Option<&super::Finish>) -> bool {
    finish.is_none_or(|finish| finish.hunts)
}

/// The final error over the oracle's: infinite where the safety layer had to stop what was handed
/// over, none where it had to stop the oracle, which is no measure then.
fn over_oracle(case: &super::Commissioned) -> Option<f64> {
    let oracle = case.oracle?.error;
    Some(case.handed_over.map_or(f64::INFINITY, |handed_over| handed_over.error / oracle))
}

/// Median and 95th percentile.
fn quantiles(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    (quantile(&values, 0.5), quantile(&values, 0.95))
}

fn share(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

/// The value below which that share of the sorted values lies.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    sorted[(share * last as f64).round() as usize]
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| report::numbers::percent(100.0 * share, 1);
        writeln!(f, "machines                    {}", self.machines)?;
        writeln!(f, "commissioned                {}", percent(self.commissioned))?;
        writeln!(f, "parameters in their 95 %    {} of {}", percent(self.held.0), self.held.1)?;
        writeln!(f, "rig time, median            {:.0} s", self.seconds.0)?;
        writeln!(f, "rig time, 95th percentile   {:.0} s", self.seconds.1)?;
        writeln!(f, "error over oracle, median   {:.2}", self.error.0)?;
        writeln!(f, "error over oracle, 95th     {:.2}", self.error.1)?;
        writeln!(f, "limits broken               {}", self.broken)?;
        writeln!(f, "hunting, and the oracle     {}, {}", self.hunting.0, self.hunting.1)?;
        for (name, stage, why) in &self.refused {
            writeln!(f, "refused: {name}, {stage}: {why}")?;
        }
        Ok(())
    }
}
