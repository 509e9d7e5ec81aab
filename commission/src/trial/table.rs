//! The table of a trial.

use std::fmt;

use serde::Serialize;

use super::told::{PartTable, parts};
use super::{Case, Commissioned, Held, Protocol};
use crate::friction::wanted::CurveParameter;

/// What came of all machines.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// Machines.
    pub machines: usize,
    /// Share that was commissioned, of those whose user's file contradicts nothing.
    pub commissioned: f64,
    /// Machines whose user's file does, and those that were refused for that before anything moved.
    pub contradicting: (usize, usize),
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
    /// What was told of the structure.
    pub parts: Vec<PartTable>,
    /// What ended the others: machine, stage, words.
    pub refused: Vec<(String, String, String)>,
    /// The fixed protocol and the commission on the machines that were driven by both.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beside: Option<Beside>,
}

/// What a way of measuring came to on many machines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reached {
    /// Rig time to the curve, median \[s\].
    pub seconds: f64,
    /// Half widths of the intervals over the values, medians: f_c, f_s, v_s, slope.
    pub widths: [f64; 4],
    /// Share of the parameters that lie in their intervals, and their number.
    pub held: (f64, usize),
}

/// The fixed protocol beside the commission.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Beside {
    /// Machines that were driven by both.
    pub machines: usize,
    /// Of these, on how many the fixed protocol told a curve.
    pub told: usize,
    /// The commission as a whole, proof included.
    pub commission: Reached,
    /// The fixed protocol.
    pub protocol: Reached,
}

impl Reached {
    fn of(seconds: Vec<f64>, held: &[&Held]) -> Self {
        let width = |parameter| {
            let half = |held: &&&Held| held.parameter == parameter;
            let share = |held: &&Held| {
                let (low, high) = held.interval?;
                Some((0.5 * (high - low) / held.value).abs())
            };
            quantiles(held.iter().filter(half).filter_map(share).collect()).0
        };
        let holds = held.iter().filter(|held| held.holds).count();
        Self {
            seconds: quantiles(seconds).0,
            widths: [
                width(CurveParameter::FC),
                width(CurveParameter::FS),
                width(CurveParameter::VS),
                width(CurveParameter::Slope),
            ],
            held: (share(holds, held.len()), held.len()),
        }
    }
}

/// Both ways beside each other, over the same machines.
fn beside(done: &[&Commissioned]) -> Option<Beside> {
    let both: Vec<(&Commissioned, &Protocol)> =
        done.iter().filter_map(|case| Some((*case, case.protocol.as_ref()?))).collect();
    if both.is_empty() {
        return None;
    }
    let designed: Vec<&Held> = both.iter().flat_map(|(case, _)| &case.held).collect();
    let fixed: Vec<&Held> = both.iter().flat_map(|(_, protocol)| &protocol.held).collect();
    Some(Beside {
        machines: both.len(),
        told: both.iter().filter(|(_, protocol)| protocol.told).count(),
        commission: Reached::of(both.iter().map(|(case, _)| case.seconds).collect(), &designed),
        protocol: Reached::of(both.iter().map(|(_, protocol)| protocol.seconds).collect(), &fixed),
    })
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
        commissioned: share(
            cases.iter().filter(|case| !case.cannot && case.commissioned.is_some()).count(),
            cases.iter().filter(|case| !case.cannot).count(),
        ),
        contradicting: (
            cases.iter().filter(|case| case.cannot).count(),
            cases.iter().filter(|case| case.rightly).count(),
        ),
        held: (share(held.iter().filter(|held| **held).count(), held.len()), held.len()),
        seconds: quantiles(done.iter().map(|case| case.seconds).collect()),
        error: quantiles(done.iter().filter_map(|case| over_oracle(case)).collect()),
        broken: cases.iter().filter(|case| case.broke_limits()).count(),
        hunting: (
            done.iter().filter(|case| hunts(case.handed_over.as_ref())).count(),
            done.iter().filter(|case| hunts(case.oracle.as_ref())).count(),
        ),
        parts: parts(done.iter().flat_map(|case| &case.told)),
        refused: cases.iter().filter_map(refused).collect(),
        beside: beside(&done),
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
        let (cannot, rightly) = self.contradicting;
        writeln!(f, "machines                    {}", self.machines)?;
        let can = self.machines - cannot;
        writeln!(f, "commissioned                {} of {can}", percent(self.commissioned))?;
        writeln!(f, "refused with right reason   {rightly} of {cannot} contradicting files")?;
        writeln!(f, "parameters in their 95 %    {} of {}", percent(self.held.0), self.held.1)?;
        writeln!(f, "rig time, median            {:.0} s", self.seconds.0)?;
        writeln!(f, "rig time, 95th percentile   {:.0} s", self.seconds.1)?;
        writeln!(f, "error over oracle, median   {:.2}", self.error.0)?;
        writeln!(f, "error over oracle, 95th     {:.2}", self.error.1)?;
        writeln!(f, "limits broken               {}", self.broken)?;
        writeln!(f, "hunting, and the oracle     {}, {}", self.hunting.0, self.hunting.1)?;
        for part in &self.parts {
            writeln!(f, "{part}")?;
        }
        if let Some(beside) = &self.beside {
            write!(f, "{beside}")?;
        }
        for (name, stage, why) in &self.refused {
            writeln!(f, "refused: {name}, {stage}: {why}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Beside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| match share.is_finite() {
            true => report::numbers::percent(100.0 * share, 2),
            false => "-".to_owned(),
        };
        writeln!(f, "{:<28}{:<14}fixed protocol", "beside each other", "commission")?;
        let mut row = |name: &str, of: &dyn Fn(&Reached) -> String| {
            writeln!(f, "{name:<28}{:<14}{}", of(&self.commission), of(&self.protocol))
        };
        row("  rig time, median", &|reached| format!("{:.0} s", reached.seconds))?;
        for (i, name) in ["f_c", "f_s", "v_s", "slope"].into_iter().enumerate() {
            row(&format!("  {name}, half width, median"), &|reached| percent(reached.widths[i]))?;
        }
        row("  parameters in their 95 %", &|reached| percent(reached.held.0))?;
        writeln!(f, "  the fixed protocol told a curve of {} of {}", self.told, self.machines)
    }
}
