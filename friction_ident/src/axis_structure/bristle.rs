//! A bristle along a recording: Dahl's, whose limit is constant, and LuGre's, whose limit falls with
//! the velocity.

use std::ops::Range;

use super::dip::dip;
use super::shape::Shape;
use crate::conditioning::Conditioned;

/// A bristle at each sample of a recording, in units of its limit, of LuGre's of the limit far from
/// rest.
#[derive(Debug, Clone, Default)]
pub(super) struct Bristle {
    /// Its deflection.
    pub sign: Vec<f64>,
    /// Derivative of that with respect to the displacement.
    pub sign_slope: Vec<f64>,
    /// Rate of the deflection \[m/s or rad/s\]; empty without damping.
    pub rate: Vec<f64>,
    /// Derivative of that with respect to the displacement.
    pub rate_slope: Vec<f64>,
    /// What is left of a deflection by one limit at the start of its stretch.
    pub left: Vec<f64>,
    /// Derivative of that with respect to the displacement.
    pub left_slope: Vec<f64>,
}

/// How the deflection of LuGre's bristle hangs on the Stribeck curve that is its limit.
#[derive(Debug, Clone, Default)]
pub(super) struct Lag {
    /// Level at rest over the kinetic one.
    pub ratio: f64,
    /// Derivative of the deflection with respect to the ratio.
    pub by_ratio: Vec<f64>,
    /// The same with respect to the Stribeck velocity.
    pub by_velocity: Vec<f64>,
    /// And of the rate of the deflection; empty without damping.
    pub rate_by_velocity: Vec<f64>,
    /// The same with respect to the ratio.
    pub rate_by_ratio: Vec<f64>,
    /// Damping over the kinetic level \[s/m or s/rad\].
    damped: f64,
}

impl Lag {
    /// Derivative of the force over the kinetic level with respect to the ratio.
    pub fn force_by_ratio(&self) -> Vec<f64> {
        if self.rate_by_ratio.is_empty() {
            return self.by_ratio.clone();
        }
        let both = self.by_ratio.iter().zip(&self.rate_by_ratio);
        both.map(|(bent, rate)| bent + self.damped * rate).collect()
    }
}

impl Bristle {
    /// Nothing yet, with room for every sample of a recording.
    fn with_room(recording: &Conditioned, damping: bool) -> Self {
        let room = || Vec::with_capacity(recording.velocity.len());
        let rate = || if damping { room() } else { Vec::new() };
        Self {
            sign: room(),
            sign_slope: room(),
            rate: rate(),
            rate_slope: rate(),
            left: room(),
            left_slope: room(),
        }
    }

    /// The deflection over its limit of Dahl's (1968) bristle, `z' = (v - |v| z) / displacement`,
    /// solved exactly along the [`legs`] between two samples, its mean rate around each, and their
    /// derivatives with respect to the displacement. It keeps its deflection while the axis stands.
    pub fn dahl(recording: &Conditioned, displacement: f64, damping: bool) -> Self {
        let mut made = Self::with_room(recording, damping);
        let step = |[z, slope, left, left_slope]: [f64; 4], v: f64, dt: f64| {
            let limit = v.signum();
            let way = v.abs() * dt / displacement;
            let kept = (-way).exp();
            let by = kept * way / displacement;
            [
                limit + (z - limit) * kept,
                slope * kept + (z - limit) * by,
                left * kept,
                left_slope * kept + left * by,
            ]
        };
        through(recording, [0.0, 0.0, 1.0, 0.0], step, |before, [z, slope, left, left_slope]| {
            made.sign.push(z);
            made.sign_slope.push(slope);
            made.left.push(left);
            made.left_slope.push(left_slope);
            if damping {
                let moved = [z - before[0], slope - before[1]].map(|by| by / recording.time_step);
                made.rate.push(displacement * moved[0]);
                made.rate_slope.push(moved[0] + displacement * moved[1]);
            }
        });
        around(recording, &mut [&mut made.rate, &mut made.rate_slope]);
        made
    }

    /// The deflection of LuGre's bristle (Canudas de Wit et al. 1995), `z' = (v - |v| z / limit) /
    /// displacement` with `limit = 1 + (ratio - 1) exp(-(v/v_s)^2)`, solved exactly along the same
    /// legs, each with its mean velocity, with its derivatives. It begins as Dahl's does.
    pub fn lugre(recording: &Conditioned, shape: &Shape, damping: bool) -> (Self, Lag) {
        let &Shape { v_s, displacement, ratio, damped, .. } = shape;
        let mut made = Self::with_room(recording, damping);
        let [by_ratio, by_velocity] =
            [(); 2].map(|()| Vec::with_capacity(recording.velocity.len()));
        let mut lag = Lag { ratio, damped, by_ratio, by_velocity, ..Lag::default() };
        // The deflection and its derivatives: displacement, ratio, Stribeck velocity. Then what is left
        // of the start and its derivative with respect to the displacement.
        let step = |[z, by_displacement, by_ratio, by_velocity, start, start_slope]: [f64; 6],
                    v: f64,
                    dt: f64| {
            let (near, near_slope) = dip(v, v_s);
            let limit = 1.0 + (ratio - 1.0) * near;
            let end = v.signum() * limit;
            let way = v.abs() * dt / (displacement * limit);
            let kept = (-way).exp();
            let left = (z - end) * kept;
            let of_limit = |slope: f64, limit_slope: f64| {
                slope * kept + (v.signum() * (1.0 - kept) + left * way / limit) * limit_slope
            };
            [
                end + left,
                by_displacement * kept + left * way / displacement,
                of_limit(by_ratio, near),
                of_limit(by_velocity, (ratio - 1.0) * near_slope),
                start * kept,
                (start_slope + start * way / displacement) * kept,
            ]
        };
        let begin = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        through(recording, begin, step, |before, now| {
            made.sign.push(now[0]);
            made.sign_slope.push(now[1]);
            lag.by_ratio.push(now[2]);
            lag.by_velocity.push(now[3]);
            made.left.push(now[4]);
            made.left_slope.push(now[5]);
            if damping {
                let moved = |k: usize| (now[k] - before[k]) / recording.time_step;
                made.rate.push(displacement * moved(0));
                made.rate_slope.push(moved(0) + displacement * moved(1));
                lag.rate_by_ratio.push(displacement * moved(2));
                lag.rate_by_velocity.push(displacement * moved(3));
            }
        });
        let Lag { rate_by_ratio, rate_by_velocity, .. } = &mut lag;
        let Self { rate, rate_slope, .. } = &mut made;
        around(recording, &mut [rate, rate_slope, rate_by_ratio, rate_by_velocity]);
        (made, lag)
    }
}

/// Makes of rates over the way to each sample those over both ways around it: the first are those of
/// half a sample before, and a delay and the damping took up the half sample that the force of the
/// damping came late by.
fn around(recording: &Conditioned, rates: &mut [&mut Vec<f64>]) {
    for rate in rates {
        for piece in &recording.pieces {
            let own = rate.get_mut(piece.kept.clone()).unwrap_or_default();
            for k in 1..own.len() {
                own[k - 1] = 0.5 * (own[k - 1] + own[k]);
            }
        }
    }
}

/// The ways between two samples on which the axis does not turn, each with its mean velocity and its
/// duration, where the velocity is a straight line from one to the other: two where it turns in
/// between. A bristle that is taken from one sample to the next at one velocity is half a sample
/// early, and of a reversal between the samples it sees the difference of two ways, not both.
fn legs(from: f64, to: f64, dt: f64) -> [(f64, f64); 2] {
    if from * to < 0.0 {
        let turn = dt * from / (from - to);
        [(0.5 * from, turn), (0.5 * to, dt - turn)]
    } else {
        [(0.5 * (from + to), dt), (0.0, 0.0)]
    }
}

/// Takes the state of a bristle through a recording: of each stretch from the first recorded sample,
/// at its limit in the direction of its first motion, on; what is kept begins later, when most of
/// that is forgotten. `begin` is the state where its first motion is not known. `step` takes the
/// state, with the deflection first, on at one velocity for a time; `keep` gets the state before and
/// at each sample that is kept.
fn through<const N: usize>(
    recording: &Conditioned,
    begin: [f64; N],
    step: impl Fn([f64; N], f64, f64) -> [f64; N],
    mut keep: impl FnMut([f64; N], [f64; N]),
) {
    let Conditioned { lived, pieces, time_step, .. } = recording;
    let mut state = begin;
    let mut last = None;
    let mut at: Option<(usize, usize)> = None;
    for piece in pieces {
        let Range { start, end } = piece.origin;
        let from = match at {
            Some((stretch, done)) if stretch == piece.stretch => done,
            _ => {
                state = begin;
                state[0] = piece.way;
                last = None;
                piece.begin
            }
        };
        for (k, &v) in lived.iter().enumerate().take(end).skip(from) {
            let before = state;
            let [first, second] = legs(last.unwrap_or(v), v, *time_step);
            state = step(state, first.0, first.1);
            if second.1 > 0.0 {
                state = step(state, second.0, second.1);
            }
            last = Some(v);
            if k >= start {
                keep(before, state);
            }
        }
        at = Some((piece.stretch, end));
    }
}
