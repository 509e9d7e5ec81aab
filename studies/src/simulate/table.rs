//! The rows of a simulation, and where they go: into a CSV table, or into columns in memory.

use std::io::{self, Write};

use friction_model::load_dependent::loaded;
use friction_model::{ContinuousState, FrictionModel, Regime, State};

use super::{Done, Halvings, SimulateError, Stopped};
use recording::AxisKind;
use recording::trajectory::Point;

/// Where the rows of a result go.
pub trait Rows {
    /// The names of the columns, before the first row.
    fn begin(&mut self, names: &[String]);

    /// A row: the numbers that stand before the regime, the regime, the numbers behind it.
    ///
    /// # Errors
    /// The row cannot be written.
    fn row(&mut self, before: &[f64], regime: Regime, behind: &[f64]) -> io::Result<()>;

    /// After the last row.
    ///
    /// # Errors
    /// What is left cannot be written.
    fn end(&mut self) -> io::Result<()>;
}

/// Rows as CSV.
pub(super) struct Csv<'a> {
    out: &'a mut dyn Write,
    /// What is not written yet.
    text: Vec<u8>,
    number: zmij::Buffer,
}

impl<'a> Csv<'a> {
    pub fn new(out: &'a mut dyn Write) -> Self {
        Self { out, text: Vec::new(), number: zmij::Buffer::new() }
    }

    /// The shortest text that reads back as this value, and a comma.
    fn cell(&mut self, value: f64) {
        let text = self.number.format(value);
        self.text.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
        self.text.push(b',');
    }
}

impl Rows for Csv<'_> {
    fn begin(&mut self, names: &[String]) {
        self.text.extend_from_slice(names.join(",").as_bytes());
        self.text.push(b'\n');
    }

    fn row(&mut self, before: &[f64], regime: Regime, behind: &[f64]) -> io::Result<()> {
        before.iter().for_each(|value| self.cell(*value));
        self.text.extend_from_slice(match regime {
            Regime::Stick => b"stick,",
            Regime::Slip => b"slip,",
        });
        behind.iter().for_each(|value| self.cell(*value));
        // The last comma ends the row.
        if let Some(last) = self.text.last_mut() {
            *last = b'\n';
        }
        if self.text.len() >= AT_ONCE { self.end() } else { Ok(()) }
    }

    fn end(&mut self) -> io::Result<()> {
        self.out.write_all(&self.text)?;
        self.text.clear();
        Ok(())
    }
}

/// Rows as columns in memory.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct InMemory {
    /// Names and values of the columns but the regime, in the order of the CSV table.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Whether the contact slips, row by row.
    pub slips: Vec<bool>,
}

impl Rows for InMemory {
    fn begin(&mut self, names: &[String]) {
        let numbers = names.iter().filter(|name| *name != REGIME);
        self.columns = numbers.map(|name| (name.clone(), Vec::new())).collect();
    }

    fn row(&mut self, before: &[f64], regime: Regime, behind: &[f64]) -> io::Result<()> {
        let values = before.iter().chain(behind);
        for ((_, column), value) in self.columns.iter_mut().zip(values) {
            column.push(*value);
        }
        self.slips.push(regime == Regime::Slip);
        Ok(())
    }

    fn end(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Name of the column with the regime.
const REGIME: &str = "regime";

/// The result as it comes about.
pub(super) struct Table<'a> {
    out: &'a mut dyn Rows,
    /// The row at hand, before and behind its regime.
    row: [Vec<f64>; 2],
    load_gain: Option<f64>,
    energy: bool,
    /// Speeds up to this one count as standing still.
    band: Option<f64>,
    done: Done,
}

/// How much is written at once \[bytes\].
const AT_ONCE: usize = 1 << 16;

impl<'a> Table<'a> {
    pub fn new<M: FrictionModel>(
        model: &M,
        rest: &State<M::Continuous, M::Memory>,
        axis: AxisKind,
        load_gain: Option<f64>,
        out: &'a mut dyn Rows,
    ) -> Self {
        let [velocity, loads, force, deflection, gamma] = match axis {
            AxisKind::Rotary => {
                ["velocity_rad_s", "load_Nm", "torque_Nm", "deflection_rad", "gamma_Nm"]
            }
            AxisKind::Linear => ["velocity_m_s", "load_N", "force_N", "deflection_m", "gamma_N"],
        };
        let energy = model.stored_energy(rest).is_some();
        let mut names = vec!["t_s".to_owned(), velocity.to_owned()];
        names.extend(load_gain.map(|_| loads.to_owned()));
        names.extend([force, deflection, gamma, REGIME].map(str::to_owned));
        names.extend(energy.then(|| "stored_energy_J".to_owned()));
        let mut count = 0;
        rest.continuous.each(&mut |_| {
            count += 1;
            names.push(format!("state_{count}"));
        });
        let band = model.holding(0.0).map(|holding| holding.band);
        out.begin(&names);
        let (row, done) = ([Vec::new(), Vec::new()], Done::default());
        Self { out, row, load_gain, energy, band, done }
    }

    /// Adds a row: the contact in `state` at a point of the motion.
    pub fn row<M: FrictionModel>(
        &mut self,
        model: &M,
        point: Point,
        state: &State<M::Continuous, M::Memory>,
        force: f64,
    ) -> Result<(), Stopped> {
        let Point { time, velocity, load } = point;
        let under = |gain| loaded(force, model.viscous(velocity), gain, load.abs());
        let force = self.load_gain.map_or(force, under);
        let inner = model.internals(state, velocity);
        for (what, value) in
            [("force", force), ("deflection", inner.deflection), ("level", inner.gamma)]
        {
            if !value.is_finite() {
                return Err(SimulateError::NotFinite { what, value, time }.into());
            }
        }
        self.done.rows += 1;
        self.done.held += u64::from(self.band.is_some_and(|band| velocity.abs() <= band));
        let [before, behind] = &mut self.row;
        before.clear();
        before.extend([time, velocity]);
        before.extend(self.load_gain.map(|_| load));
        before.extend([force, inner.deflection, inner.gamma]);
        behind.clear();
        if self.energy {
            behind.push(model.stored_energy(state).unwrap_or_default());
        }
        state.continuous.each(&mut |value| behind.push(value));
        Ok(self.out.row(before, inner.regime, behind)?)
    }

    /// Writes what is left, and tells what was done.
    pub fn finish(self, halvings: Halvings) -> Result<Done, Stopped> {
        self.out.end()?;
        Ok(Done { halvings, ..self.done })
    }
}
