//! Do two identifications differ? Parameter by parameter, and as torque over the speeds of both.
//!
//! Both posteriors are sampled, and every difference is taken in units of its own standard
//! deviation. Parameters and torques are judged together: the largest of these numbers that chance
//! alone would give is known from the samples (the max-t method of Westfall and Young 1993,
//! Resampling-based multiple testing). So two reports of one joint are called different in 5 % of
//! the cases, however many parameters they have.

use friction_ident::statistics::{quantile, sorted};
use friction_model::{AnyModel, ModelName};
use serde::Serialize;
use work::BadInput;

use super::reported::{Report, Reported};
use super::samples::samples;

/// Samples of each posterior.
const SAMPLES: usize = 4000;
/// Speeds at which the torque is compared, in each direction.
const SPEEDS: usize = 25;

/// What two identifications say of one model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The two documents.
    pub reports: [String; 2],
    /// The model.
    pub model: ModelName,
    /// Whether anything differs by more than chance explains.
    pub differ: bool,
    /// How often chance alone would give as large a difference.
    pub probability_of_chance: f64,
    /// A parameter of both a row.
    pub parameters: Vec<Difference>,
    /// The steady friction at speeds of both, from backward to forward.
    pub torque: Vec<TorqueDifference>,
    /// What must be known to read it.
    pub notes: Vec<String>,
}

/// What two identifications say of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Both estimates.
    pub values: [f64; 2],
    /// The second less the first.
    pub difference: f64,
    /// Its standard deviation.
    pub standard_error: f64,
    /// Ends of the interval that holds the differences of all rows at once in 95 % of the cases.
    pub interval_95: [f64; 2],
    /// Whether it differs. None where one of the two does not tell it.
    pub differs: Option<bool>,
}

/// What two identifications say of the friction at a velocity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TorqueDifference {
    /// \[rad/s or m/s\]
    pub velocity: f64,
    /// The friction of both \[N m or N\].
    pub values: [f64; 2],
    /// The second less the first \[N m or N\].
    pub difference: f64,
    /// Its standard deviation \[N m or N\].
    pub standard_error: f64,
    /// Ends of the interval that holds the differences of all rows at once in 95 % of the cases.
    pub interval_95: [f64; 2],
    /// Whether it differs.
    pub differs: bool,
}

/// Compares a model of two identifications over these speeds \[rad/s or m/s\], of both where none are
/// given.
///
/// # Errors
/// [`BadInput`] where they have no model, parameter or speed in common.
pub fn compare(
    [a, b]: [&Report; 2],
    model: Option<ModelName>,
    speeds: Option<[f64; 2]>,
    seed: u64,
) -> Result<Comparison, BadInput> {
    let first = a.model(model)?;
    let second = b.model(Some(first.model))?;
    let names = common(first, second);
    if names.is_empty() {
        return Err(BadInput(format!("{} and {} have no parameter in common", a.name, b.name)));
    }
    let mut notes = Vec::new();
    let velocities = velocities([a, b], speeds, &mut notes)?;
    let of = |reported: &Reported, seed: u64| -> Result<(Vec<f64>, Vec<Vec<f64>>), BadInput> {
        let drawn = samples(reported, SAMPLES, seed)?;
        let values: Vec<f64> = reported.rows.iter().map(|row| row.value).collect();
        let best = reported.with(&values).map_err(BadInput)?;
        let row = |values: &[f64], model: &AnyModel| -> Vec<f64> {
            let place = |name: &&str| drawn.names.iter().position(|other| other == name);
            let parameters = names.iter().filter_map(place).map(|at| values[at]);
            parameters.chain(velocities.iter().map(|v| model.steady_state(*v))).collect()
        };
        let rows = drawn.rows.iter().zip(&drawn.models).map(|(values, model)| row(values, model));
        Ok((row(&values, &best), rows.collect()))
    };
    let (found_a, drawn_a) = of(first, seed)?;
    let (found_b, drawn_b) = of(second, seed.wrapping_add(1))?;
    let difference: Vec<f64> = found_a.iter().zip(&found_b).map(|(a, b)| b - a).collect();
    // How far chance moves each difference from where it is.
    let scatter: Vec<Vec<f64>> = drawn_a
        .iter()
        .zip(&drawn_b)
        .map(|(a, b)| a.iter().zip(b).zip(&difference).map(|((a, b), d)| b - a - d).collect())
        .collect();
    let deviation: Vec<f64> = (0..difference.len())
        .map(|at| {
            let squares = scatter.iter().map(|row| row[at] * row[at]);
            (squares.sum::<f64>() / scatter.len() as f64).sqrt()
        })
        .collect();
    let told = |name: &str| {
        let of = |reported: &Reported| reported.row(name).is_some_and(|row| row.identified);
        of(first) && of(second)
    };
    let counts = |at: usize| deviation[at] > 0.0 && names.get(at).is_none_or(|name| told(name));
    let judged: Vec<usize> = (0..difference.len()).filter(|at| counts(*at)).collect();
    let largest =
        |row: &[f64]| judged.iter().map(|at| (row[*at] / deviation[*at]).abs()).fold(0.0, f64::max);
    let by_chance = sorted(scatter.iter().map(|row| largest(row)));
    let limit = quantile(&by_chance, 0.95).unwrap_or(f64::INFINITY);
    let most = largest(&difference);
    let as_large = by_chance.iter().filter(|chance| **chance >= most).count();
    let band = |at: usize| {
        let half = limit * deviation[at];
        [difference[at] - half, difference[at] + half]
    };
    let beyond = |at: usize| difference[at].abs() > limit * deviation[at];
    let parameters = names.iter().enumerate().map(|(at, name)| Difference {
        name: (*name).to_owned(),
        unit: first.row(name).map_or_else(String::new, |row| row.unit.clone()),
        values: [found_a[at], found_b[at]],
        difference: difference[at],
        standard_error: deviation[at],
        interval_95: band(at),
        differs: counts(at).then(|| beyond(at)),
    });
    let torque = velocities.iter().enumerate().map(|(k, velocity)| {
        let at = names.len() + k;
        TorqueDifference {
            velocity: *velocity,
            values: [found_a[at], found_b[at]],
            difference: difference[at],
            standard_error: deviation[at],
            interval_95: band(at),
            differs: counts(at) && beyond(at),
        }
    });
    Ok(Comparison {
        reports: [a.name.clone(), b.name.clone()],
        model: first.model,
        differ: most > limit,
        probability_of_chance: (as_large + 1) as f64 / (SAMPLES + 1) as f64,
        parameters: parameters.collect(),
        torque: torque.collect(),
        notes,
    })
}

/// Parameters that both have, with an error in one at least.
fn common<'a>(a: &'a Reported, b: &Reported) -> Vec<&'a str> {
    let rows = a.rows.iter().filter(|row| {
        b.row(&row.name)
            .is_some_and(|other| row.standard_error.is_some() || other.standard_error.is_some())
    });
    rows.map(|row| row.name.as_str()).collect()
}

/// The speeds that both were identified over, evenly in each direction.
fn velocities(
    reports: [&Report; 2],
    speeds: Option<[f64; 2]>,
    notes: &mut Vec<String>,
) -> Result<Vec<f64>, BadInput> {
    let [low, high] = match (speeds, reports.map(|report| report.speeds)) {
        (Some(asked), _) => asked,
        (None, [Some(a), Some(b)]) => {
            let both = [a[0].max(b[0]), a[1].min(b[1])];
            if both[0] >= both[1] {
                return Err(BadInput(format!(
                    "the recordings have no speeds in common: {} to {} and {} to {}; give --speeds LOW:HIGH",
                    a[0], a[1], b[0], b[1]
                )));
            }
            both
        }
        (None, _) => {
            return Err(BadInput(
                "a document does not say at which speeds it was identified; give --speeds LOW:HIGH"
                    .to_owned(),
            ));
        }
    };
    if !(low >= 0.0 && high > low && high.is_finite()) {
        return Err(BadInput(format!(
            "the speeds must be finite, from zero or more to a higher one, but are {low} to {high}"
        )));
    }
    notes
        .push(format!("The torque is compared at speeds from {low} to {high}, in steady sliding."));
    // Nothing slides at rest.
    let low = low.max(1e-3 * high);
    let at = |k: usize| low + (high - low) * k as f64 / (SPEEDS - 1) as f64;
    let backward = (0..SPEEDS).rev().map(|k| -at(k));
    Ok(backward.chain((0..SPEEDS).map(at)).collect())
}

impl Comparison {
    /// The plain answer.
    #[must_use]
    pub fn answer(&self) -> String {
        let worst =
            self.torque.iter().max_by(|a, b| a.difference.abs().total_cmp(&b.difference.abs()));
        let Some(worst) = worst else { return String::new() };
        let level = worst.values[0].abs();
        let percent = 100.0 * worst.difference.abs() / level;
        let chance = 100.0 * self.probability_of_chance;
        let half = |of: &TorqueDifference| 0.5 * (of.interval_95[1] - of.interval_95[0]);
        let seen = self.torque.iter().map(|of| half(of) / of.values[0].abs()).fold(0.0, f64::max);
        if !self.differ {
            return format!(
                "They cannot be told apart ({}): chance alone would give as much in {chance:.2} % of the cases. A difference of the friction of {:.1} % would have been seen at every speed.",
                self.model.title(),
                100.0 * seen
            );
        }
        let named = self.parameters.iter().filter(|of| of.differs == Some(true));
        let named: Vec<_> = named.map(|of| of.name.as_str()).collect();
        let slides = self.torque.iter().any(|of| of.differs);
        let torque = format!(
            "the friction differs most at {:.3} by {:.3e}, {percent:.1} % of it there",
            worst.velocity, worst.difference
        );
        let said = match (&named[..], slides) {
            ([], _) => torque,
            (_, true) => format!("{}; {torque}", named.join(", ")),
            (_, false) => format!("{}; not the friction in steady sliding", named.join(", ")),
        };
        format!(
            "They differ ({}): {said}. Chance alone would give as much in {chance:.2} % of the cases.",
            self.model.title()
        )
    }

    /// The answer, then a table of the parameters and one of the torque.
    #[must_use]
    pub fn terminal(&self) -> String {
        let verdict = |differs: Option<bool>| match differs {
            Some(true) => "differs",
            Some(false) => "",
            None => "not told",
        };
        let mut text = format!("{}\n\n", self.answer());
        let mut line = |cells: [String; 6]| {
            let [first, rest @ ..] = cells;
            text += &format!("{first:<20}");
            for cell in &rest[..4] {
                text += &format!("{cell:>14}");
            }
            text += &format!("  {}\n", rest[4]);
        };
        let head = ["first", "second", "difference", "within +-", ""];
        let numbers = |values: [f64; 2], difference: f64, band: [f64; 2]| {
            [values[0], values[1], difference, 0.5 * (band[1] - band[0])]
                .map(|value| format!("{value:.4e}"))
        };
        line([
            "parameter".to_owned(),
            head[0].into(),
            head[1].into(),
            head[2].into(),
            head[3].into(),
            String::new(),
        ]);
        for of in &self.parameters {
            let [a, b, d, w] = numbers(of.values, of.difference, of.interval_95);
            line([
                format!("{} [{}]", of.name, of.unit),
                a,
                b,
                d,
                w,
                verdict(of.differs).to_owned(),
            ]);
        }
        line([
            "velocity".to_owned(),
            head[0].into(),
            head[1].into(),
            head[2].into(),
            head[3].into(),
            String::new(),
        ]);
        for of in self.torque.iter().step_by(4) {
            let [a, b, d, w] = numbers(of.values, of.difference, of.interval_95);
            line([format!("{:.4}", of.velocity), a, b, d, w, verdict(Some(of.differs)).to_owned()]);
        }
        for note in &self.notes {
            text += &format!("\n{note}\n");
        }
        text
    }
}
