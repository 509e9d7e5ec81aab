//! One pass over the recordings: filter, and sum what the normal equations need.

use super::filter::{Step, TAPS, linear, step};
use super::{FEWEST, InitialLag, LagOptions, LagRecording};
use crate::IdentError;

/// Exponent of the Stribeck curve beyond which the dip counts as gone: exp(-42) is below the
/// rounding.
const GONE: f64 = 42.0;
/// State of the filter that no longer counts.
const SILENT: f64 = 1e-18;

/// Recordings made ready: forward motion, torques less the best Coulomb and viscous friction.
#[derive(Debug, Clone)]
pub(super) struct Prepared {
    pub recordings: Vec<Ready>,
    pub delta: f64,
    pub initial: InitialLag,
    pub settle: usize,
    /// What was taken off the torque: `f_c`, `f_v`.
    pub baseline: [f64; 2],
    /// Sums over all fitted samples of 1, v, v^2, and of y, v y, y^2 with what is left of the
    /// torque.
    pub totals: [f64; 6],
    /// Slowest and fastest speed.
    pub speeds: (f64, f64),
}

/// One recording.
#[derive(Debug, Clone)]
pub(super) struct Ready {
    pub speed: Vec<f64>,
    /// `|v|^delta`.
    pub power: Vec<f64>,
    pub torque: Vec<f64>,
    pub dt: f64,
}

impl Prepared {
    pub fn new(recordings: &[LagRecording], options: &LagOptions) -> Result<Self, IdentError> {
        if !(0.1..=10.0).contains(&options.delta) {
            return Err(IdentError::Exponent(options.delta));
        }
        if recordings.is_empty() {
            return Err(too_few(0));
        }
        let ready: Vec<Ready> = recordings
            .iter()
            .map(|recording| checked(recording, options))
            .collect::<Result<_, _>>()?;
        let fitted = || {
            let samples = |r: &Ready| {
                r.speed
                    .iter()
                    .copied()
                    .zip(r.torque.iter().copied())
                    .skip(options.settle)
                    .collect::<Vec<_>>()
            };
            ready.iter().flat_map(samples).collect::<Vec<_>>()
        };
        let samples = fitted();
        if samples.iter().all(|&(_, torque)| torque == 0.0) {
            return Err(IdentError::ZeroForce);
        }
        let speeds = samples
            .iter()
            .fold((f64::INFINITY, 0.0f64), |(low, high), &(v, _)| (low.min(v), high.max(v)));
        if speeds.1 <= 1.01 * speeds.0 {
            return Err(IdentError::TooFewSpeeds { needed: 5, found: 1 });
        }
        let n = samples.len() as f64;
        let mean = |f: fn(f64, f64) -> f64| samples.iter().map(|&(v, y)| f(v, y)).sum::<f64>() / n;
        let (mean_v, mean_y) = (mean(|v, _| v), mean(|_, y| y));
        let (mut spread, mut both) = (0.0, 0.0);
        for (v, y) in &samples {
            spread += (v - mean_v).powi(2);
            both += (v - mean_v) * (y - mean_y);
        }
        let slope = both / spread;
        let baseline = [mean_y - slope * mean_v, slope];
        let mut data = Self {
            recordings: ready,
            delta: options.delta,
            initial: options.initial,
            settle: options.settle,
            baseline,
            totals: [0.0; 6],
            speeds,
        };
        for recording in &mut data.recordings {
            let pairs = recording.torque.iter_mut().zip(&recording.speed);
            pairs.for_each(|(y, v)| *y -= baseline[0] + baseline[1] * v);
            for (&y, &v) in recording.torque.iter().zip(&recording.speed).skip(options.settle) {
                let terms = [1.0, v, v * v, y, v * y, y * y];
                data.totals.iter_mut().zip(terms).for_each(|(total, term)| *total += term);
            }
        }
        Ok(data)
    }

    /// Fitted samples.
    pub fn samples(&self) -> usize {
        self.totals[0] as usize
    }

    /// Range of `ln v_s` (0) or `ln tau` (1) that is searched.
    pub fn range(&self, which: usize) -> (f64, f64) {
        if which == 0 {
            return ((0.2 * self.speeds.0).ln(), (10.0 * self.speeds.1).ln());
        }
        let finest = self.recordings.iter().map(|r| r.dt).fold(f64::INFINITY, f64::min);
        let longest =
            self.recordings.iter().map(|r| r.dt * r.speed.len() as f64).fold(0.0, f64::max);
        ((0.02 * finest).ln(), (0.5 * longest).max(finest).ln())
    }

    /// Filters every recording for `ln v_s` and `ln tau`.
    pub fn pass(&self, ln_v_s: f64, ln_tau: f64, scratch: &mut Vec<[f64; 2]>) -> Sums {
        let mut moving = [0.0; 15];
        for recording in &self.recordings {
            self.dips(recording, ln_v_s, scratch);
            let (speed, torque) = (recording.speed.as_slice(), recording.torque.as_slice());
            let mut total = [0.0; 15];
            self.filter(scratch, recording.dt * (-ln_tau).exp(), |state, k| {
                if k >= self.settle
                    && let (Some(&v), Some(&y)) = (speed.get(k), torque.get(k))
                {
                    state.add(v, y, &mut total);
                }
            });
            moving.iter_mut().zip(total).for_each(|(sum, total)| *sum += total);
        }
        let [n, v, vv, y, vy, yy] = self.totals;
        let [p1, pv, py, pp, ps, pq, s1, sv, sy, ss, sq, q1, qv, qy, qq] = moving;
        Sums {
            linear: [[n, p1, v], [p1, pp, pv], [v, pv, vv]],
            torque: [y, py, vy],
            by: [[s1, ps, sv], [q1, pq, qv]],
            by_torque: [sy, qy],
            by_by: [[ss, sq], [sq, qq]],
            yy,
        }
    }

    /// What is left of the torques at `ln v_s`, `ln tau` and `f_c`, dip, `f_v`, the latter two less
    /// the baseline.
    pub fn residuals(&self, ln_v_s: f64, ln_tau: f64, linear: &[f64; 3]) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.samples());
        let mut dips = Vec::new();
        for recording in &self.recordings {
            self.dips(recording, ln_v_s, &mut dips);
            let mut phi = vec![0.0; dips.len()];
            let rho = recording.dt * (-ln_tau).exp();
            self.filter(&dips, rho, |state, k| {
                if let Some(phi) = phi.get_mut(k) {
                    *phi = state.phi;
                }
            });
            let samples = recording.torque.iter().zip(&recording.speed).zip(&phi).skip(self.settle);
            all.extend(
                samples.map(|((y, v), phi)| y - linear[0] - linear[1] * phi - linear[2] * v),
            );
        }
        all
    }

    /// The dip `exp(-|v/v_s|^delta)` and its derivative with respect to `ln v_s`, sample by sample.
    fn dips(&self, recording: &Ready, ln_v_s: f64, dips: &mut Vec<[f64; 2]>) {
        let inverse = (-self.delta * ln_v_s).exp();
        dips.clear();
        dips.extend(recording.power.iter().map(|power| {
            let exponent = power * inverse;
            if exponent > GONE {
                [0.0; 2]
            } else {
                let dip = (-exponent).exp();
                [dip, self.delta * exponent * dip]
            }
        }));
    }

    /// Runs the lag over one recording; `see` gets its output and derivatives at every sample where
    /// they are not zero.
    #[inline(always)]
    fn filter(&self, dips: &[[f64; 2]], rho: f64, mut see: impl FnMut(&Lag, usize)) {
        let n = dips.len();
        let inner = step(rho, 2);
        let [early, late] = linear(rho);
        let mut state = match (self.initial, dips.first()) {
            (InitialLag::Steady, Some(&[dip, slope])) => {
                Lag { phi: dip, by_v_s: slope, by_tau: 0.0 }
            }
            _ => Lag { phi: 1.0, by_v_s: 0.0, by_tau: 0.0 },
        };
        let mut at = 0;
        let edge = |k: usize| {
            // The ends see one-sided stencils.
            let before = k - k.saturating_sub(2).min(n - TAPS);
            (step(rho, before), k - before)
        };
        while at + 1 < n {
            see(&state, at);
            if at < 2 || at + 4 > n {
                let (step, first) = edge(at);
                if let Some(window) = dips.get(first..first + TAPS) {
                    state.advance(&step, window, at - first, early, late);
                }
                at += 1;
                continue;
            }
            // All inner samples in one go.
            let last = n - 3;
            for (window, k) in dips.windows(TAPS).zip(at..last) {
                if k > at {
                    if state.is_silent() && window.iter().all(|dip| dip[0] == 0.0) {
                        state = Lag::default();
                        continue;
                    }
                    see(&state, k);
                }
                state.advance(&inner, window, 2, early, late);
            }
            at = last;
        }
        see(&state, at);
    }
}

/// Output of the lag and its derivatives with respect to `ln v_s` and `ln tau`.
#[derive(Debug, Clone, Copy, Default)]
struct Lag {
    phi: f64,
    by_v_s: f64,
    by_tau: f64,
}

impl Lag {
    /// To the next sample; the present one stands at `here` in the window. The derivatives are
    /// filtered with the straight line between two samples: Gauss and Newton's directions need no
    /// more. That with respect to `ln tau` is the lag's response to `phi - dip`.
    #[inline(always)]
    fn advance(&mut self, step: &Step, window: &[[f64; 2]], here: usize, early: f64, late: f64) {
        let (Some(now), Some(next)) = (window.get(here), window.get(here + 1)) else { return };
        let mut phi = step.decay * self.phi;
        for (tap, dip) in step.taps.iter().zip(window) {
            phi += tap * dip[0];
        }
        self.by_v_s = step.decay * self.by_v_s + early * now[1] + late * next[1];
        self.by_tau =
            step.decay * self.by_tau + early * (self.phi - now[0]) + late * (phi - next[0]);
        self.phi = phi;
    }

    fn is_silent(&self) -> bool {
        self.phi.abs() < SILENT && self.by_v_s.abs() < SILENT && self.by_tau.abs() < SILENT
    }

    #[inline(always)]
    fn add(&self, v: f64, y: f64, sums: &mut [f64; 15]) {
        let Self { phi: p, by_v_s: s, by_tau: q } = *self;
        let terms = [
            p,
            p * v,
            p * y,
            p * p,
            p * s,
            p * q,
            s,
            s * v,
            s * y,
            s * s,
            s * q,
            q,
            q * v,
            q * y,
            q * q,
        ];
        sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }
}

/// What a pass leaves: inner products of the columns of `f_c`, of the dip and of `f_v`, of the
/// derivatives of the dip's column, and of the torque.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sums {
    pub linear: [[f64; 3]; 3],
    pub torque: [f64; 3],
    /// Derivatives with respect to `ln v_s` and `ln tau` times the linear columns.
    pub by: [[f64; 3]; 2],
    pub by_torque: [f64; 2],
    pub by_by: [[f64; 2]; 2],
    pub yy: f64,
}

fn too_few(found: usize) -> IdentError {
    IdentError::TooFewSamples {
        what: "the frictional lag",
        needed: FEWEST,
        found,
        lower: Some("the samples to settle"),
    }
}

fn checked(recording: &LagRecording, options: &LagOptions) -> Result<Ready, IdentError> {
    let LagRecording { velocity, torque, dt } = *recording;
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(IdentError::TimeStep(dt));
    }
    if velocity.len() != torque.len() {
        let (found, expected) = (velocity.len(), torque.len());
        return Err(IdentError::UnequalLengths { channel: "the velocity", found, expected });
    }
    let found = velocity.len().saturating_sub(options.settle);
    if found < FEWEST {
        return Err(too_few(found));
    }
    for (channel, values) in [("the velocity", velocity), ("the torque", torque)] {
        if let Some((index, &value)) =
            values.iter().enumerate().find(|(_, value)| !crate::finite::usable(**value))
        {
            return Err(IdentError::NotFinite { channel, index, value });
        }
    }
    let side = velocity.first().map_or(1.0, |v| v.signum());
    if let Some(index) = velocity.iter().position(|v| v * side <= 0.0) {
        return Err(IdentError::Reversal { index });
    }
    let speed: Vec<f64> = velocity.iter().map(|v| side * v).collect();
    let delta = options.delta;
    let power = speed.iter().map(|v| if delta == 2.0 { v * v } else { v.powf(delta) }).collect();
    Ok(Ready { speed, power, torque: torque.iter().map(|y| side * y).collect(), dt })
}
