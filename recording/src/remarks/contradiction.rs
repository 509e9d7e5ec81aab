//! A position and a velocity that do not say the same: they stand on two sides of a gear, or one
//! has another unit or sign.

use friction_ident::statistics::{quantile, sorted, upper_median};
use serde::Serialize;

use super::{Both, Label, Used, exact, short};

/// Samples below which nothing is said.
const FEWEST: usize = 50;
/// Ratios that are as good as one.
const ALIKE: std::ops::Range<f64> = 0.8..1.25;
/// Correlation from which on two channels are of one motion.
const CORRELATION: f64 = 0.95;
/// How far apart the quartiles of the ratio may be, as a part of it.
const SPREAD: f64 = 0.2;

/// A position and a velocity that contradict each other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Contradiction {
    /// Column of the position.
    pub position: Label,
    /// Column of the velocity.
    pub velocity: Label,
    /// The velocity by the slope of the position.
    pub ratio: f64,
    /// Which is used.
    pub used: Used,
    /// A scale with which the position would fit.
    pub position_scale: f64,
    /// A scale with which the velocity would fit.
    pub velocity_scale: f64,
}

impl Contradiction {
    /// What a position and a velocity say of each other; none where they agree, or have little to
    /// do with each other.
    pub(super) fn of(time: &[f64], both: Both<'_>) -> Option<Self> {
        let Both { position, velocity, used } = both;
        let ratio = ratio(time, position.values, velocity.values)?;
        (!ALIKE.contains(&ratio)).then(|| Self {
            position: Label::of(position.name),
            velocity: Label::of(velocity.name),
            ratio,
            used,
            position_scale: position.scale * ratio,
            velocity_scale: velocity.scale / ratio,
        })
    }

    /// In words.
    pub(super) fn describe(self) -> String {
        let Self { position, velocity, ratio, used, .. } = self;
        let (to_position, to_velocity) = (exact(self.position_scale), exact(self.velocity_scale));
        let scale_position = format!("--position '{position}:{to_position}'");
        let scale_velocity = format!("--velocity '{velocity}:{to_velocity}'");
        let and_then = match used {
            Used::Position => format!(
                "The position is used. If the velocity is right, give {scale_position}, or --velocity '{velocity}' to use the velocity in its place"
            ),
            Used::Velocity => format!(
                "The velocity is used. If the position is right, give {scale_velocity}, or leave out --velocity"
            ),
            Used::Both => format!(
                "The velocity is used, with the position beside it. If the velocity is right, give {scale_position}; if the position is right, {scale_velocity}"
            ),
            Used::Message => {
                "The velocity is used: look which of both the node that publishes them has wrong"
                    .to_owned()
            }
        };
        format!(
            "`{velocity}` is {} times the velocity at which `{position}` moves: one of them stands behind a gear, or has another unit or sign{}. {and_then}",
            short(ratio),
            hint(ratio.abs())
        )
    }
}

/// What a ratio is usual for.
fn hint(ratio: f64) -> &'static str {
    const USUAL: [(f64, &str); 4] = [
        (57.2958, " (as degrees are to rad)"),
        (9.5493, " (as rpm are to rad/s)"),
        (std::f64::consts::TAU, " (as turns are to rad)"),
        (1e3, " (as thousandths are to the whole)"),
    ];
    let near =
        |usual: f64| [ratio / usual, ratio * usual].iter().any(|part| (part - 1.0).abs() < 0.02);
    USUAL.iter().find(|(usual, _)| near(*usual)).map_or("", |(_, words)| words)
}

/// The velocity by the slope of the position, over many samples each time so that the counts of an
/// encoder do not matter; none where they are not of one motion.
fn ratio(time: &[f64], position: &[f64], velocity: &[f64]) -> Option<f64> {
    let n = time.len().min(position.len()).min(velocity.len());
    if n < FEWEST {
        return None;
    }
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = upper_median(&mut steps)?;
    let length = (n / 100).clamp(5, 50);
    let ways = (0..n - length).step_by(length.div_ceil(2)).filter_map(|from| {
        let to = from + length;
        let way: f64 = (from..to)
            .map(|k| 0.5 * (velocity[k] + velocity[k + 1]) * (time[k + 1] - time[k]))
            .sum();
        let whole = time[to] - time[from] < 1.5 * usual * length as f64;
        let moved = position[to] - position[from];
        (whole && way.is_finite() && moved.is_finite()).then_some((moved, way))
    });
    let ways: Vec<(f64, f64)> = ways.collect();
    let (moved, way, common) = ways.iter().fold((0.0, 0.0, 0.0), |(moved, way, common), (x, y)| {
        (moved + x * x, way + y * y, common + x * y)
    });
    if !(moved > 0.0 && way > 0.0) || common.abs() < CORRELATION * (moved * way).sqrt() {
        return None;
    }
    let fast = 0.5 * (way / ways.len() as f64).sqrt();
    let ratios = ways.iter().filter(|(x, y)| y.abs() > fast && *x != 0.0).map(|(x, y)| y / x);
    let ratios = sorted(ratios);
    let (low, middle, high) =
        (quantile(&ratios, 0.25)?, quantile(&ratios, 0.5)?, quantile(&ratios, 0.75)?);
    (ratios.len() >= 5 && high - low < SPREAD * middle.abs()).then_some(middle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::remarks::Watched;

    fn found(ratio: f64, noise: f64, count: f64) -> Option<Contradiction> {
        let time: Vec<f64> = (0..3000).map(|k| 1e-3 * f64::from(k)).collect();
        let path: Vec<f64> =
            time.iter().map(|t| ((4.0 * t).sin() / count).floor() * count).collect();
        let speed = |(k, t): (usize, &f64)| {
            ratio * 4.0 * (4.0 * t).cos() + noise * ((k * k) as f64 * 0.7).sin()
        };
        let speed: Vec<f64> = time.iter().enumerate().map(speed).collect();
        let of = |name, scale, values| Watched { name, scale, unit: "", values };
        let position = of("position_deg", 0.017, &path[..]);
        let velocity = of("velocity_rpm", 0.1, &speed[..]);
        Contradiction::of(&time, Both { position, velocity, used: Used::Position })
    }

    /// A tester's position stood behind a gear, and the velocity before it.
    #[test]
    fn a_gear_another_unit_and_another_sign_are_told() {
        let gear = found(50.0, 0.0, 1e-3).unwrap();
        assert!((gear.ratio / 50.0 - 1.0).abs() < 0.03, "{gear:?}");
        assert!((gear.position_scale / 0.85 - 1.0).abs() < 0.03);
        let said = gear.describe();
        assert!(said.contains("The position is used") && said.contains("behind a gear"), "{said}");
        assert!(found(-1.0, 0.1, 1e-3).unwrap().ratio < -0.9);
        assert!(found(57.3, 1.0, 1e-3).unwrap().describe().contains("degrees"));
        assert!(found(0.5, 0.1, 1e-2).is_some());
    }

    #[test]
    fn what_agrees_or_has_nothing_in_common_is_not_told() {
        assert_eq!(found(1.0, 0.5, 1e-2), None);
        assert_eq!(found(1.1, 0.5, 1e-2), None);
        assert_eq!(found(0.0, 4.0, 1e-3), None);
        assert_eq!(found(3.0, f64::NAN, 1e-3), None);
    }
}
