//! Whether two halves tell the same of a parameter.

use serde::Serialize;

use super::said::{Model, Said, Told};

/// Parts of a wave mean something only together with their period and the place where it begins.
const OF_A_WAVE: [&str; 2] = ["harmonic_cos", "harmonic_sin"];
/// What is said relative to the middle and the length of the travel that was recorded, in a
/// structure that varies along the axis.
const OF_THE_TRAVEL: [&str; 6] = ["f_c", "f_s", "offset", "spring", "f_c_slope", "f_c_curvature"];

/// A parameter that both halves have.
#[derive(Debug, Clone, Serialize)]
pub struct Pair {
    pub model: &'static str,
    /// Its name, without a direction.
    pub parameter: String,
    pub first: Told,
    pub second: Told,
    /// Why the program does not want its models trusted as a whole.
    pub warned: bool,
    /// The difference over half the width of its own 95 % interval: agreement is at most 1.
    pub apart: f64,
    /// Whether the two intervals overlap.
    pub overlap: bool,
}

impl Pair {
    /// Both halves call it identified.
    pub fn identified(&self) -> bool {
        self.first.identified && self.second.identified
    }

    /// Both halves call it identified, and neither warns of its model.
    pub fn trusted(&self) -> bool {
        self.identified() && !self.warned
    }

    /// The difference lies within its own 95 % interval.
    pub fn agrees(&self) -> bool {
        self.apart <= 1.0
    }
}

/// The parameters that both halves tell, model by model.
pub fn pairs(first: &Said, second: &Said) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for one in &first.models {
        if let Some(other) = second.models.iter().find(|other| other.kind == one.kind) {
            pairs.extend(one.parameters.iter().filter_map(|told| pair(one, other, told)));
        }
    }
    pairs
}

/// None where the other half has no such parameter, or means something else by it.
fn pair(one: &Model, other: &Model, first: &Told) -> Option<Pair> {
    let bare = first.name.split('.').next().unwrap_or_default();
    let along = |model: &Model| model.name.split('+').any(|part| part == "position");
    let moves = along(one) != along(other) && OF_THE_TRAVEL.contains(&bare);
    if moves || OF_A_WAVE.contains(&bare) {
        return None;
    }
    let second = other.parameters.iter().find(|told| told.name == first.name)?;
    let towards = |told: &Told, value: f64| {
        let half = |[low, high]: [f64; 2]| {
            if value < told.value { told.value - low } else { high - told.value }
        };
        told.interval.map_or(f64::INFINITY, half)
    };
    let (a, b) = (towards(first, second.value), towards(second, first.value));
    let apart = (first.value - second.value).abs();
    Some(Pair {
        model: one.kind,
        parameter: bare.trim_end_matches("_positive").trim_end_matches("_negative").to_owned(),
        first: first.clone(),
        second: second.clone(),
        warned: !(one.warnings.is_empty() && other.warnings.is_empty()),
        apart: if apart == 0.0 { 0.0 } else { apart / a.hypot(b) },
        overlap: apart <= a + b,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(chosen: &str, name: &str, value: f64, half: f64) -> Said {
        let interval = Some([value - half, value + half]);
        let told = Told { name: name.to_owned(), value, interval, identified: true };
        let model = Model {
            kind: "structure",
            name: chosen.to_owned(),
            parameters: vec![told],
            warnings: vec![],
        };
        Said { models: vec![model], ..Said::default() }
    }

    #[test]
    fn a_difference_within_its_own_interval_agrees() {
        let of = |value| {
            let (a, b) = (said("symmetric", "f_c", 1.0, 0.3), said("symmetric", "f_c", value, 0.4));
            pairs(&a, &b).remove(0)
        };
        assert!(of(1.49).agrees() && !of(1.51).agrees());
        assert!(of(1.69).overlap && !of(1.71).overlap);
    }

    #[test]
    fn what_means_something_else_is_no_pair() {
        let (a, b) =
            (said("symmetric+position", "f_c", 1.0, 0.3), said("symmetric", "f_c", 1.0, 0.3));
        assert!(pairs(&a, &b).is_empty());
        let wave = said("symmetric+harmonic", "harmonic_cos", 1.0, 0.3);
        assert!(pairs(&wave, &wave).is_empty());
    }
}
