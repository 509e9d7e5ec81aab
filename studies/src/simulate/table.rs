//! The result of a simulation as CSV.

use std::io::{self, Write};

use friction_model::load_dependent::loaded;
use friction_model::{ContinuousState, FrictionModel, Regime, State};

use super::{Done, Halvings, SimulateError, Stopped};
use recording::AxisKind;
use recording::trajectory::Point;

/// The result as it is written.
pub(super) struct Table<'a> {
    out: &'a mut dyn Write,
    /// What is not written yet.
    text: Vec<u8>,
    number: zmij::Buffer,
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
        out: &'a mut dyn Write,
    ) -> io::Result<Self> {
        let [velocity, loads, force, deflection, gamma] = match axis {
            AxisKind::Rotary => {
                ["velocity_rad_s", "load_Nm", "torque_Nm", "deflection_rad", "gamma_Nm"]
            }
            AxisKind::Linear => ["velocity_m_s", "load_N", "force_N", "deflection_m", "gamma_N"],
        };
        let energy = model.stored_energy(rest).is_some();
        let mut names = vec!["t_s".to_owned(), velocity.to_owned()];
        names.extend(load_gain.map(|_| loads.to_owned()));
        names.extend([force, deflection, gamma, "regime"].map(str::to_owned));
        names.extend(energy.then(|| "stored_energy_J".to_owned()));
        let mut count = 0;
        rest.continuous.each(&mut |_| {
            count += 1;
            names.push(format!("state_{count}"));
        });
        let band = model.holding(0.0).map(|holding| holding.band);
        let mut text = names.join(",").into_bytes();
        text.push(b'\n');
        let (number, done) = (zmij::Buffer::new(), Done::default());
        Ok(Self { out, text, number, load_gain, energy, band, done })
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
        self.cell(time);
        self.cell(velocity);
        if self.load_gain.is_some() {
            self.cell(load);
        }
        self.cell(force);
        self.cell(inner.deflection);
        self.cell(inner.gamma);
        self.text.extend_from_slice(match inner.regime {
            Regime::Stick => b"stick,",
            Regime::Slip => b"slip,",
        });
        if self.energy {
            self.cell(model.stored_energy(state).unwrap_or_default());
        }
        state.continuous.each(&mut |value| self.cell(value));
        // The last comma ends the row.
        if let Some(last) = self.text.last_mut() {
            *last = b'\n';
        }
        if self.text.len() >= AT_ONCE {
            self.pass_on()?;
        }
        Ok(())
    }

    /// The shortest text that reads back as this value, and a comma.
    fn cell(&mut self, value: f64) {
        let text = self.number.format(value);
        self.text.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
        self.text.push(b',');
    }

    fn pass_on(&mut self) -> io::Result<()> {
        self.out.write_all(&self.text)?;
        self.text.clear();
        Ok(())
    }

    /// Writes what is left, and tells what was done.
    pub fn finish(mut self, halvings: Halvings) -> Result<Done, Stopped> {
        self.pass_on()?;
        Ok(Done { halvings, ..self.done })
    }
}
