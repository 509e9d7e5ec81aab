//! What a stage found, in a few rows for people.

use report::numbers::{percent, significant};

use crate::control::Control;
use crate::drive::Drive;
use crate::friction::{Curve, Friction};
use crate::hand_over::{arm, fed_back, proved};
use crate::meet::Met;
use crate::model::Chosen;
use crate::proof::Proof;

/// What can be told of what a stage found.
pub(crate) trait Rows {
    /// Name and value of each thing.
    fn rows(&self) -> Vec<(String, String)>;
}

fn rows(all: impl IntoIterator<Item = (&'static str, String)>) -> Vec<(String, String)> {
    all.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

impl Rows for Met {
    fn rows(&self) -> Vec<(String, String)> {
        let volts = |volts: f64| format!("{} V", significant(volts, 3));
        let shows = |shows: bool| if shows { "shows the motion" } else { "not used" }.to_owned();
        let travel = self.sought.as_ref().map(|sought| ("travel", sought.to_string()));
        let looked = self.noticed.iter().map(|said| ("look at this", said.clone()));
        let put_right = self.corrected.iter().map(|said| ("put right", said.clone()));
        rows(
            [
                ("moves at", volts(self.deadband)),
                ("tachometer", shows(self.tachometer)),
                ("torque sensor", shows(self.torque)),
            ]
            .into_iter()
            .chain(travel)
            .chain(looked)
            .chain(put_right),
        )
    }
}

impl Rows for Drive {
    fn rows(&self) -> Vec<(String, String)> {
        rows([
            ("gain", self.gain.said("rad/s per V")),
            ("time constant", self.time_constant.said("s")),
            ("delay", self.delay_said()),
        ])
    }
}

impl Rows for Friction {
    fn rows(&self) -> Vec<(String, String)> {
        let change =
            self.change.map(|change| ("change while measured", percent(100.0 * change, 1)));
        let Curve { f_c, f_s, v_s, .. } = &self.curve;
        rows(
            [("f_c", f_c.said("V")), ("f_s", f_s.said("V")), ("v_s", v_s.said("rad/s"))]
                .into_iter()
                .chain([("blocks", self.blocks.len().to_string())])
                .chain(change),
        )
    }
}

impl Rows for Chosen {
    fn rows(&self) -> Vec<(String, String)> {
        rows([
            ("curve", self.kind.to_string()),
            ("f_c", self.curve.f_c.said("V")),
            ("f_s", self.curve.f_s.said("V")),
        ])
    }
}

impl Rows for Control {
    fn rows(&self) -> Vec<(String, String)> {
        rows([
            (
                "loop",
                format!(
                    "natural frequency {} rad/s, sensitivity peak {}",
                    significant(self.design.natural_frequency, 3),
                    significant(self.design.sensitivity_peak, 3)
                ),
            ),
            ("fed forward", arm(self.arm).to_owned()),
            ("fed back", fed_back(self)),
        ])
    }
}

impl Rows for Proof {
    fn rows(&self) -> Vec<(String, String)> {
        rows([("proof", proved(self))])
    }
}
