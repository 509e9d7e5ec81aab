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
}

impl Bristle {
    /// The deflection over its limit of Dahl's (1968) bristle, `z' = (v - |v| z) / displacement`,
    /// solved exactly over a sample of constant velocity, its mean rate over the sample, and their
    /// derivatives with respect to the displacement. It keeps its deflection while the axis stands.
    pub fn dahl(recording: &Conditioned, displacement: f64, damping: bool) -> Self {
        let time_step = recording.time_step;
        let mut made = Self::default();
        through(recording, |state: &mut [f64; 2], v, is_kept| {
            let before = *state;
            let limit = v.signum();
            let way = v.abs() * time_step / displacement;
            let kept = (-way).exp();
            let slope = (before[1] + (before[0] - limit) * way / displacement) * kept;
            let z = limit + (before[0] - limit) * kept;
            *state = [z, slope];
            if !is_kept {
                return;
            }
            made.sign.push(z);
            made.sign_slope.push(slope);
            if damping {
                let moved = [z - before[0], slope - before[1]].map(|by| by / time_step);
                made.rate.push(displacement * moved[0]);
                made.rate_slope.push(moved[0] + displacement * moved[1]);
            }
        });
        made
    }

    /// The deflection of LuGre's bristle (Canudas de Wit et al. 1995), `z' = (v - |v| z / limit) /
    /// displacement` with `limit = 1 + (ratio - 1) exp(-(v/v_s)^2)`, solved exactly over a sample of
    /// constant velocity, with its derivatives. It begins as Dahl's does.
    pub fn lugre(recording: &Conditioned, shape: &Shape, damping: bool) -> (Self, Lag) {
        let &Shape { v_s, displacement, ratio, .. } = shape;
        let mut made = Self::default();
        let mut lag = Lag { ratio, ..Lag::default() };
        // The deflection and its derivatives: displacement, ratio, Stribeck velocity.
        let step = |[z, by_displacement, by_ratio, by_velocity]: [f64; 4], v: f64, dt: f64| {
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
            ]
        };
        through(recording, |state: &mut [f64; 4], v, is_kept| {
            let before = *state;
            let now = step(before, v, recording.time_step);
            *state = now;
            if !is_kept {
                return;
            }
            made.sign.push(now[0]);
            made.sign_slope.push(now[1]);
            lag.by_ratio.push(now[2]);
            lag.by_velocity.push(now[3]);
            if damping {
                let moved = |k: usize| (now[k] - before[k]) / recording.time_step;
                made.rate.push(displacement * moved(0));
                made.rate_slope.push(moved(0) + displacement * moved(1));
                lag.rate_by_velocity.push(displacement * moved(3));
            }
        });
        (made, lag)
    }
}

/// Takes the state of a bristle through a recording: of each stretch from the first recorded sample,
/// at its limit in the direction of its first motion, on; what is kept begins later, when most of
/// that is forgotten. `step` gets the state with the deflection first, the velocity, and whether the
/// sample is kept.
fn through<const N: usize>(
    recording: &Conditioned,
    mut step: impl FnMut(&mut [f64; N], f64, bool),
) {
    let Conditioned { lived, pieces, .. } = recording;
    let mut state = [0.0; N];
    let mut at: Option<(usize, usize)> = None;
    for piece in pieces {
        let Range { start, end } = piece.origin;
        let from = match at {
            Some((stretch, done)) if stretch == piece.stretch => done,
            _ => {
                state = [0.0; N];
                state[0] = piece.way;
                piece.begin
            }
        };
        for (k, v) in lived.iter().enumerate().take(end).skip(from) {
            step(&mut state, *v, k >= start);
        }
        at = Some((piece.stretch, end));
    }
}
