//! One pass over the recordings: states, their derivatives with respect to the unknowns, and the
//! normal equations.
//!
//! With `q = (f_s - f_c) p`, `p = exp(-|v / v_s|^delta)` and `e = b - f_c`, each element obeys
//! `e' = (r u / g) (q - e)`. In fast sliding `p` and `e` vanish, and so do all derivatives: such
//! samples are known from the sums over the whole recording and cost nothing.

use std::ops::{Add, Div, Mul, Sub};

use nalgebra::{SMatrix, SVector};
use wide::f64x4;

use super::track::{Track, Tracks};

/// Unknowns: f_s - f_c, f_c, ln v_s, f_v, ln rate, and LuGre's damping.
pub(super) const UNKNOWNS: usize = 6;
/// Exponent of the Stribeck curve beyond which the dip counts as gone, and the state that no longer
/// counts, as a share of the level.
const GONE: f64 = 34.0;
const SILENT: f64 = 1e-15;

/// Elements side by side.
pub(super) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    const COUNT: usize;
    fn from_fn(f: impl FnMut(usize) -> f64) -> Self;
    fn splat(x: f64) -> Self;
    fn sum(self) -> f64;
}

impl Lanes for f64 {
    const COUNT: usize = 1;
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        f(0)
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        self
    }
}

impl Lanes for f64x4 {
    const COUNT: usize = 4;
    #[inline(always)]
    fn from_fn(f: impl FnMut(usize) -> f64) -> Self {
        Self::from(std::array::from_fn::<f64, 4, _>(f))
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self::splat(x)
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        self.reduce_add()
    }
}

/// One element: share, rate per unit of the rate's unknown, and micro-damping likewise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element {
    pub alpha: f64,
    pub rate: f64,
    pub damping: f64,
}

/// The unknowns and what belongs to them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial {
    pub x: [f64; UNKNOWNS],
    pub delta: f64,
    pub lugre: bool,
    pub from_rest: bool,
    /// What was taken off the torque: `f_c`, `f_v`.
    pub baseline: [f64; 2],
}

/// Normal equations of a pass; `gradient` is `J^T (y - F)`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Normal {
    pub matrix: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    pub gradient: SVector<f64, UNKNOWNS>,
    pub sum: f64,
    /// Sum of squares of the torque less the baseline: the scale of the rounding.
    pub scale: f64,
}

/// What one sample says to every element.
#[derive(Clone, Copy, Default)]
struct Sample {
    v: f64,
    y: f64,
    p: f64,
    q: f64,
    /// Derivative of q with respect to ln v_s.
    by_v_s: f64,
    inverse_g: f64,
    /// u / g, its square and its derivative in time, and u / g times the derivative of q in time.
    kappa: f64,
    square: f64,
    slope: f64,
    drive: f64,
}

/// States of a group of elements with their derivatives with respect to f_s - f_c, ln v_s and ln
/// rate. That with respect to f_c follows, because the state is homogeneous of first degree in f_s
/// - f_c, f_c and the rate.
#[derive(Clone, Copy)]
struct Group<L> {
    alpha: L,
    rate: L,
    damping: L,
    e: L,
    by: [L; 3],
    /// What the present sample leaves for the next step: its part of the decay and of the input,
    /// and the inputs of the derivatives.
    decay: L,
    input: L,
    inputs: [L; 3],
}

impl<L: Lanes> Group<L> {
    /// `rate` and `damping` are those of the trial; for GMS the damping is the rate.
    fn new(elements: &[Element], rate: f64, lugre: Option<f64>) -> Self {
        // Lanes without an element have no share.
        let get = |lane: usize, f: fn(&Element) -> f64| elements.get(lane).map_or(0.0, f);
        let first = elements.first().map_or(0.0, |element| element.rate);
        let zero = L::splat(0.0);
        Self {
            alpha: L::from_fn(|lane| get(lane, |element| element.alpha)),
            rate: L::from_fn(|lane| {
                rate * elements.get(lane).map_or(first, |element| element.rate)
            }),
            damping: lugre.map_or_else(
                || L::from_fn(|lane| rate * get(lane, |element| element.damping)),
                L::splat,
            ),
            e: zero,
            by: [zero; 3],
            decay: zero,
            input: zero,
            inputs: [zero; 3],
        }
    }

    /// Sets out at a sample with the given state.
    fn set_out(&mut self, sample: &Sample, half: f64, e: f64, by: [f64; 3]) {
        (self.e, self.by) = (L::splat(e), by.map(L::splat));
        let [linear, bend, cross] = self.coefficients(sample, half);
        self.leave(sample, linear - bend, cross);
        self.inputs = self.inputs(sample);
    }

    #[inline(always)]
    /// Half the period times r u / g, the second derivative's share, and what it adds to the input.
    fn coefficients(&self, s: &Sample, half: f64) -> [L; 3] {
        let splat = L::splat;
        let twelfth = half * half / 3.0;
        let second = self.rate * splat(twelfth);
        let linear = self.rate * splat(half * s.kappa);
        let bend = second * (self.rate * splat(s.square) - splat(s.slope));
        [linear, bend, second * splat(s.drive)]
    }

    #[inline(always)]
    fn leave(&mut self, sample: &Sample, minus: L, cross: L) {
        self.decay = L::splat(1.0) - minus;
        self.input = L::splat(sample.q) * minus + cross;
    }

    #[inline(always)]
    fn inputs(&self, sample: &Sample) -> [L; 3] {
        let splat = L::splat;
        let free = self.rate * splat(sample.kappa);
        let pull = free * (splat(sample.q) - self.e);
        let through = free - pull * splat(sample.inverse_g);
        [through * splat(sample.p), through * splat(sample.by_v_s), pull]
    }

    /// To the next sample; `half` is half the period.
    #[inline(always)]
    fn advance(&mut self, next: &Sample, half: f64) {
        let [linear, bend, cross] = self.coefficients(next, half);
        let one = L::splat(1.0);
        let plus = linear + bend;
        let inverse = one / (one + plus);
        let decay = self.decay * inverse;
        self.e = decay * self.e + inverse * (self.input + L::splat(next.q) * plus - cross);
        self.leave(next, linear - bend, cross);
        let gain = L::splat(half) * inverse;
        let inputs = self.inputs(next);
        for ((by, before), after) in self.by.iter_mut().zip(self.inputs).zip(inputs) {
            *by = decay * *by + gain * (before + after);
        }
        self.inputs = inputs;
    }

    fn is_silent(&self, level: f64) -> bool {
        let below = |x: L, limit: f64| (x * x).sum() < limit * limit;
        let [by_dip, by_v_s, by_rate] = self.by;
        let limit = SILENT * level;
        below(self.e, limit)
            && below(by_dip, SILENT)
            && below(by_v_s, limit)
            && below(by_rate, limit)
    }
}

impl Trial {
    /// The sample of a row, without a dip where that is gone.
    #[inline(always)]
    fn sample(&self, row: &[f64; 4], inverse: f64) -> Sample {
        let &[v, power, log_slope, y] = row;
        let [dip, f_c, ..] = self.x;
        let exponent = power * inverse;
        let p = if exponent > GONE { 0.0 } else { (-exponent).exp() };
        let q = dip * p;
        let by_v_s = self.delta * exponent * q;
        let inverse_g = 1.0 / (f_c + q);
        let (u, u_slope) = if self.lugre { (v, v * log_slope) } else { (1.0, 0.0) };
        let q_slope = -by_v_s * log_slope;
        let kappa = u * inverse_g;
        let slope = (u_slope - kappa * q_slope) * inverse_g;
        let (square, drive) = (kappa * kappa, kappa * q_slope);
        Sample { v, y, p, q, by_v_s, inverse_g, kappa, square, slope, drive }
    }

    /// Runs over all recordings. `moving` receives what the lag adds to `f_c + f_v v` at every
    /// fitted sample.
    ///
    /// `None` where the unknowns are not allowed.
    pub fn pass<L: Lanes>(
        &self,
        tracks: &Tracks,
        elements: &[Element],
        moving: &mut Vec<f64>,
    ) -> Option<Normal> {
        let [dip, f_c, ln_v_s, f_v, ln_rate, damping] = self.x;
        if !(f_c > 0.0 && f_c + dip > 0.0 && self.x.iter().all(|x| x.is_finite())) {
            return None;
        }
        let inverse = (-self.delta * ln_v_s).exp();
        let damping = self.lugre.then_some(damping);
        let mut groups: Vec<Group<L>> = elements
            .chunks(L::COUNT)
            .map(|chunk| Group::new(chunk, ln_rate.exp(), damping))
            .collect();
        moving.clear();
        let mut sums = Sums::default();
        for track in &tracks.all {
            match groups.as_mut_slice() {
                // The usual case without a loop.
                [one] => self.run(track, inverse, std::slice::from_mut(one), &mut sums, moving),
                all => self.run(track, inverse, all, &mut sums, moving),
            }
        }
        let offset = [f_c - self.baseline[0], f_v - self.baseline[1]];
        Some(sums.close(&tracks.totals, offset))
    }

    #[inline(always)]
    fn run<L: Lanes>(
        &self,
        track: &Track,
        inverse: f64,
        groups: &mut [Group<L>],
        sums: &mut Sums,
        moving: &mut Vec<f64>,
    ) {
        let [dip, f_c, _, f_v, ..] = self.x;
        let offset = [f_c - self.baseline[0], f_v - self.baseline[1]];
        let half = 0.5 * track.dt;
        let damping: f64 = groups.iter().map(|group| group.damping.sum()).sum();
        let Some(first) = track.rows.first() else { return };
        let mut now = self.sample(first, inverse);
        let (e, by) =
            if self.from_rest { (dip, [1.0, 0.0, 0.0]) } else { (now.q, [now.p, now.by_v_s, 0.0]) };
        groups.iter_mut().for_each(|group| group.set_out(&now, half, e, by));
        let mut before = first;
        let mut silent = false;
        for (k, row) in track.rows.iter().enumerate() {
            if silent && row[1] * inverse > GONE {
                before = row;
                if k >= track.settle {
                    moving.push(0.0);
                }
                continue;
            }
            if silent {
                let sample = self.sample(before, inverse);
                groups.iter_mut().for_each(|group| group.set_out(&sample, half, 0.0, [0.0; 3]));
            }
            if k > 0 {
                now = self.sample(row, inverse);
                groups.iter_mut().for_each(|group| group.advance(&now, half));
            }
            before = row;
            if k >= track.settle {
                let zero = L::splat(0.0);
                let (mut held, mut damped, mut through) = (zero, zero, [zero; 3]);
                for group in groups.iter() {
                    held = held + group.alpha * group.e;
                    damped = damped + group.damping * group.e;
                    let share = group.alpha - group.damping * L::splat(now.kappa);
                    for (through, by) in through.iter_mut().zip(group.by) {
                        *through = *through + share * by;
                    }
                }
                let (held, damped) = (held.sum(), damped.sum());
                // Damping times u (1 - b / g).
                let slip = now.kappa * (damping * now.q - damped);
                let force = held + slip;
                let [by_dip, by_v_s, by_rate] = through.map(L::sum);
                let by_f_c = (held - now.kappa * damped - dip * by_dip - by_rate) / f_c
                    - slip * now.inverse_g;
                let kept = damping * now.kappa - slip * now.inverse_g;
                let (by_rate, by_damping) = if self.lugre {
                    let state = groups.first().map_or(0.0, |group| group.e.sum());
                    (by_rate, now.kappa * (now.q - state))
                } else {
                    (by_rate + slip, 0.0)
                };
                moving.push(force);
                let left = now.y - offset[0] - offset[1] * now.v - force;
                let (by_dip, by_v_s) = (by_dip + kept * now.p, by_v_s + kept * now.by_v_s);
                sums.add(
                    &[by_dip, 1.0 + by_f_c, by_v_s, now.v, by_rate, by_damping, left, 0.0],
                    &now,
                );
            }
            // Gone here, and nothing left of it in the states.
            silent = now.p == 0.0 && groups.iter().all(|group| group.is_silent(f_c));
        }
    }
}

/// Products of the columns and the residual, and the totals of the samples that were not silent.
struct Sums {
    products: [[f64x4; 2]; UNKNOWNS + 1],
    seen: [f64; 6],
}

impl Default for Sums {
    fn default() -> Self {
        Self { products: [[f64x4::splat(0.0); 2]; UNKNOWNS + 1], seen: [0.0; 6] }
    }
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, columns: &[f64; 8], sample: &Sample) {
        let [a, b, c, d, e, f, g, h] = *columns;
        let row = [f64x4::from([a, b, c, d]), f64x4::from([e, f, g, h])];
        for (i, (sums, column)) in self.products.iter_mut().zip(columns).enumerate() {
            let column = f64x4::splat(*column);
            // Symmetric: the left half of the lower rows is known.
            if i < 4 {
                sums[0] += column * row[0];
            }
            sums[1] += column * row[1];
        }
        let (v, y) = (sample.v, sample.y);
        let terms = [1.0, v, v * v, y, v * y, y * y];
        self.seen.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }

    /// With the silent samples, where the torque is `f_c + f_v v`.
    fn close(&self, totals: &[f64; 6], offset: [f64; 2]) -> Normal {
        let mut full = [[0.0; 8]; UNKNOWNS + 1];
        for (row, sums) in full.iter_mut().zip(&self.products) {
            let (left, right) = (sums[0].to_array(), sums[1].to_array());
            row.iter_mut().zip(left.into_iter().chain(right)).for_each(|(to, from)| *to = from);
        }
        let at = |i: usize, j: usize| full[i.min(j)][i.max(j)];
        let mut matrix = SMatrix::from_fn(at);
        let mut gradient = SVector::from_fn(|i, _| at(i, UNKNOWNS));
        let silent: [f64; 6] = std::array::from_fn(|i| totals[i] - self.seen[i]);
        let [n, v, vv, y, vy, yy] = silent;
        let [a, b] = offset;
        for (i, j, value) in [(1, 1, n), (1, 3, v), (3, 1, v), (3, 3, vv)] {
            matrix[(i, j)] += value;
        }
        let (left, left_v) = (y - a * n - b * v, vy - a * v - b * vv);
        gradient[1] += left;
        gradient[3] += left_v;
        let sum = at(UNKNOWNS, UNKNOWNS) + (yy - a * y - b * vy - a * left - b * left_v);
        Normal { matrix, gradient, sum: sum.max(0.0), scale: totals[5] }
    }
}
