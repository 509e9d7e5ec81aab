//! The result of a simulation as CSV.

use std::fmt::Write;

use friction_model::load_dependent::loaded;
use friction_model::{ContinuousState, FrictionModel, Regime, State};

use recording::AxisKind;

/// The result as it grows.
pub(super) struct Table<'a> {
    text: String,
    load: Option<(f64, &'a [f64])>,
    energy: bool,
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
        let mut names = vec!["t_s", velocity];
        names.extend(load.map(|_| loads));
        names.extend([force, deflection, gamma, "regime"]);
        names.extend(energy.then_some("stored_energy_J"));
        let mut text = names.join(",");
        let mut count = 0;
        rest.continuous.each(&mut |_| {
            count += 1;
            let _ = write!(text, ",state_{count}");
        });
        text.push('\n');
        Self { text, load, energy }
    }

    /// Adds a row: the contact in `state` at a time and velocity.
    pub fn row<M: FrictionModel>(
        &mut self,
        model: &M,
        row: usize,
        [t, v]: [f64; 2],
        state: &State<M::Continuous, M::Memory>,
        force: f64,
    ) {
        let load = self.load.and_then(|(gain, loads)| Some((gain, *loads.get(row)?)));
        let force =
            load.map_or(force, |(gain, load)| loaded(force, model.viscous(v), gain, load.abs()));
        let inner = model.internals(state, v);
        let text = &mut self.text;
        push(text, t);
        let shown = [
            Some(v),
            load.map(|(_, load)| load),
            Some(force),
            Some(inner.deflection),
            Some(inner.gamma),
        ];
        for value in shown.into_iter().flatten() {
            text.push(',');
            push(text, value);
        }
        text.push_str(match inner.regime {
            Regime::Stick => ",stick",
            Regime::Slip => ",slip",
        });
        if self.energy {
            text.push(',');
            push(text, model.stored_energy(state).unwrap_or_default());
        }
        state.continuous.each(&mut |value| {
            text.push(',');
            push(text, value);
        });
        text.push('\n');
    }

    /// The table as text.
    pub fn finish(self) -> String {
        self.text
    }
}

/// The shortest text that reads back as `value`. Writing to a string cannot fail.
fn push(text: &mut String, value: f64) {
    let _ = if value != 0.0 && !(1e-5..1e15).contains(&value.abs()) {
        write!(text, "{value:e}")
    } else {
        write!(text, "{value}")
    };
}
