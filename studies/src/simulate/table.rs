//! The result of a simulation as CSV.

use std::fmt;

use friction_model::load_dependent::loaded;
use friction_model::{ContinuousState, FrictionModel, Regime, State};

use super::{Done, Halvings, SimulateError};
use recording::AxisKind;
use recording::csv_table::CsvTable;

/// The result as it grows.
pub(super) struct Table<'a> {
    csv: CsvTable,
    load: Option<(f64, &'a [f64])>,
    energy: bool,
    /// Speeds up to this one count as standing still.
    band: Option<f64>,
    done: Done,
}

impl<'a> Table<'a> {
    pub fn new<M: FrictionModel>(
        model: &M,
        rest: &State<M::Continuous, M::Memory>,
        axis: AxisKind,
        load: Option<(f64, &'a [f64])>,
    ) -> Self {
        let [velocity, loads, force, deflection, gamma] = match axis {
            AxisKind::Rotary => {
                ["velocity_rad_s", "load_Nm", "torque_Nm", "deflection_rad", "gamma_Nm"]
            }
            AxisKind::Linear => ["velocity_m_s", "load_N", "force_N", "deflection_m", "gamma_N"],
        };
        let energy = model.stored_energy(rest).is_some();
        let mut names = vec!["t_s".to_owned(), velocity.to_owned()];
        names.extend(load.map(|_| loads.to_owned()));
        names.extend([force, deflection, gamma, "regime"].map(str::to_owned));
        names.extend(energy.then(|| "stored_energy_J".to_owned()));
        let mut count = 0;
        rest.continuous.each(&mut |_| {
            count += 1;
            names.push(format!("state_{count}"));
        });
        let band = model.holding(0.0).map(|holding| holding.band);
        Self { csv: CsvTable::new(names), load, energy, band, done: Done::default() }
    }

    /// Adds a row: the contact in `state` at a time and velocity.
    pub fn row<M: FrictionModel>(
        &mut self,
        model: &M,
        row: usize,
        [t, v]: [f64; 2],
        state: &State<M::Continuous, M::Memory>,
        force: f64,
    ) -> Result<(), SimulateError> {
        let load = self.load.and_then(|(gain, loads)| Some((gain, *loads.get(row)?)));
        let force =
            load.map_or(force, |(gain, load)| loaded(force, model.viscous(v), gain, load.abs()));
        let inner = model.internals(state, v);
        for (what, value) in
            [("force", force), ("deflection", inner.deflection), ("level", inner.gamma)]
        {
            if !value.is_finite() {
                return Err(SimulateError::NotFinite { what, value, time: t });
            }
        }
        self.done.rows += 1;
        self.done.held += u64::from(self.band.is_some_and(|band| v.abs() <= band));
        let csv = &mut self.csv;
        let shown = [
            Some(t),
            Some(v),
            load.map(|(_, load)| load),
            Some(force),
            Some(inner.deflection),
            Some(inner.gamma),
        ];
        shown.into_iter().flatten().for_each(|value| csv.cell(Shortest(value)));
        csv.cell(match inner.regime {
            Regime::Stick => "stick",
            Regime::Slip => "slip",
        });
        if self.energy {
            csv.cell(Shortest(model.stored_energy(state).unwrap_or_default()));
        }
        state.continuous.each(&mut |value| csv.cell(Shortest(value)));
        csv.end_row();
        Ok(())
    }

    /// The table as text, and what was done.
    pub fn finish(self, halvings: Halvings) -> (String, Done) {
        (self.csv.text(), Done { halvings, ..self.done })
    }
}

/// The shortest text that reads back as this value.
struct Shortest(f64);

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = self;
        if *value != 0.0 && !(1e-5..1e15).contains(&value.abs()) {
            write!(f, "{value:e}")
        } else {
            write!(f, "{value}")
        }
    }
}
