//! Recordings of friction sorted by what they show, and how they weigh.

use friction_model::AnyModel;

use crate::output_error::predict;
use crate::position_load::PositionLoad;
use crate::rest::{at_rest, holds};
use crate::steady_point::SteadyPoint;
use crate::stretch::{Stretch, StretchKind};

/// Recordings of friction, sorted by what they show.
#[derive(Debug, Clone, Default)]
pub struct FrictionData {
    /// Steady points: those given, and one for each stretch at constant velocity.
    pub points: Vec<SteadyPoint>,
    /// Pre-sliding.
    pub pre_sliding: Vec<Stretch>,
    /// Velocity that varies one way.
    pub lag: Vec<Stretch>,
    /// Everything else.
    pub mixed: Vec<Stretch>,
}

impl FrictionData {
    /// Sorts. `reach` is how far the contact bends before it slides \[m or rad\], if that is known;
    /// otherwise a stretch that moves less than a thousandth of the longest one counts as
    /// pre-sliding.
    pub fn sort(points: Vec<SteadyPoint>, stretches: Vec<Stretch>, reach: Option<f64>) -> Self {
        let longest = stretches.iter().map(Stretch::range).fold(0.0, f64::max);
        let reach = reach.unwrap_or(0.5e-3 * longest);
        let mut data = Self { points, ..Self::default() };
        for stretch in stretches {
            match stretch.kind(Some(reach)) {
                StretchKind::Steady => data.points.push(stretch.steady_point()),
                StretchKind::PreSliding => data.pre_sliding.push(stretch),
                StretchKind::Lag => data.lag.push(stretch),
                StretchKind::Mixed => data.mixed.push(stretch),
            }
        }
        // Either all points have a deviation of their own or none.
        if data.points.iter().any(|point| point.deviation.is_none()) {
            data.points.iter_mut().for_each(|point| point.deviation = None);
        }
        data
    }

    /// The recordings without a force that acts beside friction.
    #[must_use]
    pub fn without(&self, load: &PositionLoad) -> Self {
        let taken = |all: &[Stretch]| all.iter().map(|one| load.taken_from(one)).collect();
        Self {
            points: self.points.iter().map(|point| load.taken_from_point(point)).collect(),
            pre_sliding: taken(&self.pre_sliding),
            lag: taken(&self.lag),
            mixed: taken(&self.mixed),
        }
    }

    /// The stretches of a kind.
    pub fn stretches(&self, kind: StretchKind) -> &[Stretch] {
        match kind {
            StretchKind::Steady => &[],
            StretchKind::PreSliding => &self.pre_sliding,
            StretchKind::Lag => &self.lag,
            StretchKind::Mixed => &self.mixed,
        }
    }

    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
            && self.pre_sliding.is_empty()
            && self.lag.is_empty()
            && self.mixed.is_empty()
    }

    /// Whether there are steady points enough for the static stage.
    pub(super) fn has_steady_points(&self) -> bool {
        self.points.len() >= FEWEST_POINTS
    }

    /// Steady points for the static stage: those of constant velocities, or where they are too few,
    /// what slow enough sliding shows.
    pub(super) fn static_points(&self) -> Vec<SteadyPoint> {
        if self.has_steady_points() {
            return self.points.clone();
        }
        let mut points: Vec<SteadyPoint> =
            self.points.iter().map(|point| SteadyPoint { deviation: None, ..*point }).collect();
        points.extend(
            self.lag
                .iter()
                .chain(&self.mixed)
                .flat_map(|stretch| binned(stretch, self.reach_hint())),
        );
        points
    }

    pub(super) fn reach_hint(&self) -> f64 {
        let range = |stretch: &Stretch| {
            let travel = stretch.travel();
            travel.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                - travel.iter().copied().fold(f64::INFINITY, f64::min)
        };
        self.pre_sliding.iter().map(range).fold(0.0, f64::max)
    }
}

/// Points below which sliding that is not steady is used for the static characteristic too.
const FEWEST_POINTS: usize = 8;

/// Mean friction over velocity in bins, from samples that slid since the last reversal by more than
/// `reach`.
fn binned(stretch: &Stretch, reach: f64) -> Vec<SteadyPoint> {
    const BINS: usize = 40;
    let fastest = stretch.velocity.iter().fold(0.0f64, |fastest, v| fastest.max(v.abs()));
    let mut sums = vec![(0.0, 0.0, 0usize); 2 * BINS];
    let travel = stretch.travel();
    let mut turned = travel.first().copied().unwrap_or(0.0);
    let mut before = 0.0;
    let rest = at_rest(stretch);
    let samples = stretch.velocity.iter().zip(&stretch.friction).zip(&travel).zip(&rest);
    for (((&v, &friction), &at), &still) in samples {
        if v * before <= 0.0 {
            turned = at;
        }
        before = v;
        let slid = !still && (at - turned).abs() > reach;
        if slid && v.abs() > 0.01 * fastest {
            let bin = ((v.abs() / fastest * BINS as f64) as usize).min(BINS - 1)
                + if v > 0.0 { BINS } else { 0 };
            let (velocities, frictions, count) = &mut sums[bin];
            (*velocities, *frictions, *count) =
                (*velocities + v, *frictions + friction, *count + 1);
        }
    }
    let mean = |&(v, f, n): &(f64, f64, usize)| SteadyPoint::new(v / n as f64, f / n as f64);
    sums.iter().filter(|(_, _, n)| *n >= 5).map(mean).collect()
}

/// The stretch with the deviation that the model leaves on it.
pub(super) fn weighted(stretch: &Stretch, model: &AnyModel) -> Stretch {
    let predicted = predict(model, stretch);
    let mut squares: Vec<f64> =
        predicted.iter().zip(&stretch.friction).map(|(p, f)| (p - f).powi(2)).collect();
    if holds(model) {
        // What it predicts a range for, and is not fitted to.
        let mut rest = at_rest(stretch).into_iter();
        squares.retain(|_| rest.next() != Some(true));
    }
    let largest = stretch.friction.iter().fold(0.0f64, |largest, f| largest.max(f.abs()));
    // Exact data leave nothing: then all count alike.
    let deviation =
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt().max(1e-9 * largest);
    Stretch { deviation: Some(deviation), ..stretch.clone() }
}

/// Points with the deviation that the model leaves on them, so that they weigh rightly beside
/// single samples.
pub(super) fn weighted_points(points: &[SteadyPoint], model: &AnyModel) -> Vec<SteadyPoint> {
    let off = |point: &SteadyPoint| model.steady_state(point.velocity) - point.torque;
    let largest = points.iter().fold(0.0f64, |largest, point| largest.max(point.torque.abs()));
    let scale = points
        .iter()
        .map(|point| (off(point) / point.deviation.unwrap_or(1.0)).powi(2))
        .sum::<f64>();
    let scale = (scale / points.len().max(1) as f64).sqrt();
    points
        .iter()
        .map(|point| {
            let deviation = (scale * point.deviation.unwrap_or(1.0)).max(1e-9 * largest);
            SteadyPoint { deviation: Some(deviation), ..*point }
        })
        .collect()
}
