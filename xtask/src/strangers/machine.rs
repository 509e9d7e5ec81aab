//! Machines that nobody has seen: an axis drawn at random, and a recording of it.
//!
//! The axis follows a motion that is known exactly, so that its torque is too: inertia, friction,
//! gravity, an offset, a ripple. What a recording adds comes after: encoder steps, coloured noise, a
//! delay, lost motion, uneven times.

use std::f64::consts::TAU;
use std::fmt::Write;

use anyhow::{Context, Result};
use friction_model::{AnyModel, ModelName, TimeStep};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

/// Which machines are drawn. Shares are drawn evenly in their logarithm.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    families: [ModelName; 4],
    /// Static friction as a multiple of the kinetic one.
    dip: [f64; 2],
    /// Stribeck velocity as a share of the largest speed.
    v_s: [f64; 2],
    /// Deflection at breakaway as a share of the travel.
    bend: [f64; 2],
}

impl Kind {
    /// Friction without memory, with a dip, with bristles, with several of them.
    pub const USUAL: Self = Self {
        families: [
            ModelName::CoulombViscous,
            ModelName::Stribeck,
            ModelName::LuGre,
            ModelName::Gms,
        ],
        dip: [1.05, 1.6],
        v_s: [0.01, 0.08],
        bend: [3e-4, 1e-2],
    };
    /// Bristles that bend far under strong dips: what happens near rest counts.
    pub const NEAR_REST: Self = Self {
        families: [ModelName::LuGre, ModelName::ElastoPlastic, ModelName::LuGre, ModelName::Dahl],
        dip: [1.2, 2.5],
        v_s: [0.02, 0.2],
        bend: [1e-3, 3e-2],
    };
}

/// Share of the kinetic level at which the elasto-plastic bristle begins to slide.
const ELASTIC: f64 = 0.7;
/// Sampling rates \[Hz\].
const RATES: [f64; 6] = [100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0];
/// Longest step of the friction \[s\].
const STEP: f64 = 1e-4;
/// Elements of the family with several bristles.
const ELEMENTS: usize = 4;

/// What is true of a machine. SI units.
#[derive(Debug, Clone)]
pub struct Truth {
    pub family: ModelName,
    pub inertia: f64,
    pub f_c: f64,
    pub f_s: f64,
    pub v_s: f64,
    pub f_v: f64,
    pub offset: f64,
    /// `a sin q + b cos q`.
    pub gravity: Option<[f64; 2]>,
    /// Amplitude, periods a radian, phase.
    pub ripple: Option<[f64; 3]>,
    pub delay: f64,
    pub backlash: f64,
    pub noise: f64,
    /// How long the noise remembers.
    pub colour: f64,
    pub encoder: f64,
    pub rate: f64,
    pub uneven: bool,
    pub rests: bool,
    /// The file has a velocity.
    pub velocity: bool,
    pub duration: f64,
    /// Stiffness at rest.
    sigma0: f64,
    /// Amplitude, angular frequency, phase of each tone of the motion.
    tones: Vec<[f64; 3]>,
}

/// A recording as a table.
pub struct Rows {
    pub time: Vec<f64>,
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    pub torque: Vec<f64>,
}

impl Truth {
    /// The machine of a number.
    pub fn draw(kind: Kind, seed: u64) -> Self {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut within = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
        let mut log = |low: f64, high: f64| within(low.ln(), high.ln()).exp();
        let (f_c, speed, travel) = (log(0.02, 50.0), log(0.3, 20.0), log(0.3, 4.0));
        let f_s = f_c * log(kind.dip[0], kind.dip[1]);
        let v_s = speed * log(kind.v_s[0], kind.v_s[1]);
        let f_v = f_c / speed * log(0.1, 1.0);
        let slow = speed / travel;
        let duration = f64::max(log(20.0, 60.0), 12.0 * TAU / slow);
        let mut chance = |share: f64| within(0.0, 1.0) < share;
        let (gravity, offset, ripple) = (chance(0.5), chance(0.6), chance(0.3));
        let (delay, backlash, coloured) = (chance(0.4), chance(0.2), chance(0.5));
        let (uneven, rests, velocity) = (chance(0.25), chance(0.5), chance(0.3));
        let tones = (0..4)
            .map(|k| {
                let relative = within(0.6, 1.6) * f64::from(k + 1);
                [travel * within(0.4, 1.0) / relative, slow * relative, within(0.0, TAU)]
            })
            .collect();
        let mut log = |low: f64, high: f64| within(f64::ln(low), f64::ln(high)).exp();
        let rate = RATES[(log(1.0, 6.999)) as usize - 1];
        let inertia = f_c / (speed * slow) * log(0.1, 2.0);
        let sigma0 = f_s / (travel * log(kind.bend[0], kind.bend[1]));
        let noise = f_c * log(0.01, 0.15);
        let colour = if coloured { log(2.0, 20.0) / rate } else { 0.0 };
        let encoder = TAU / 2f64.powf(log(11.0, 18.0).round());
        let lash = travel * log(1e-3, 1e-2);
        let wait = log(0.2, 2.0) * f64::min(3e-3, 2.0 / rate);
        let weight = [log(1.0, 4.0) * f_c, log(0.3, 4.0) * f_c];
        let cog = [f_c * log(0.02, 0.1), log(5.0, 60.0).round(), log(0.1, 6.0)];
        let constant = f_c * log(0.05, 0.6);
        Self {
            family: kind.families[(seed % 4) as usize],
            inertia,
            f_c,
            f_s,
            v_s,
            f_v,
            offset: if offset { constant } else { 0.0 },
            gravity: gravity.then_some(weight),
            ripple: ripple.then_some(cog),
            delay: if delay { wait } else { 0.0 },
            backlash: if backlash { lash } else { 0.0 },
            noise,
            colour,
            encoder,
            rate,
            uneven,
            rests,
            velocity,
            duration,
            sigma0,
            tones,
        }
    }

    /// Its friction.
    fn friction(&self) -> Result<AnyModel> {
        let mut parameters = AnyModel::test_bed(self.family).parameters();
        let share = |index: usize| (index + 1) as f64 / 10.0;
        for (name, value) in [
            ("f_s", self.f_s),
            ("f_c", self.f_c),
            ("v_s", self.v_s),
            ("f_v", self.f_v),
            ("z_ba", ELASTIC * self.f_c / self.sigma0),
            ("sigma0", self.sigma0),
            ("sigma1", 0.1 * self.sigma0 * self.f_s / self.sigma0 / self.v_s),
        ] {
            parameters.set(name, value);
        }
        if self.family == ModelName::Gms {
            for element in 0..ELEMENTS {
                let stiffness = self.sigma0 * share(ELEMENTS - 1 - element);
                parameters.set_at("alpha", element, share(element));
                parameters.set_at("sigma0", element, stiffness);
                parameters.set_at("sigma1", element, 0.05 * share(element) * self.f_s / self.v_s);
                parameters.set_at("c", element, 5.0 * self.f_s);
            }
        }
        AnyModel::try_from(parameters).context("a machine that cannot be")
    }

    /// Position, velocity and acceleration of the motion; where it rests, for a third of the time,
    /// the time of its tones stands still.
    fn motion(&self, t: f64) -> [f64; 3] {
        let (s, rate, change) = self.warped(t);
        let mut sum = [0.0; 3];
        for [amplitude, w, phase] in &self.tones {
            let (sin, cos) = (w * s + phase).sin_cos();
            sum[0] += amplitude * sin;
            sum[1] += amplitude * w * cos;
            sum[2] -= amplitude * w * w * sin;
        }
        [sum[0], sum[1] * rate, sum[2] * rate * rate + sum[1] * change]
    }

    /// The time of the tones, its rate and the rate of that.
    fn warped(&self, t: f64) -> (f64, f64, f64) {
        if !self.rests {
            return (t, 1.0, 0.0);
        }
        // It goes for two sixths, slows down over one, rests for two and speeds up again.
        let period = self.duration / 6.0;
        let (whole, part) = ((t / period).floor(), 6.0 * (t / period).fract());
        let (at, rate, change) = match part {
            p if p < 2.0 => (p, 1.0, 0.0),
            p if p < 3.0 => {
                let x = p - 2.0;
                (
                    2.0 + x - x.powi(3) + 0.5 * x.powi(4),
                    1.0 - 3.0 * x * x + 2.0 * x.powi(3),
                    -6.0 * x + 6.0 * x * x,
                )
            }
            p if p < 5.0 => (2.5, 0.0, 0.0),
            p => {
                let x = p - 5.0;
                (
                    2.5 + x.powi(3) - 0.5 * x.powi(4),
                    3.0 * x * x - 2.0 * x.powi(3),
                    6.0 * x - 6.0 * x * x,
                )
            }
        };
        let sixth = period / 6.0;
        (sixth * (3.0 * whole + at), rate, change / sixth)
    }

    /// What is recorded of it.
    ///
    /// # Errors
    /// A friction that cannot be.
    pub fn record(&self, seed: u64) -> Result<Rows> {
        let mut rng = Pcg64Mcg::seed_from_u64(!seed);
        let times = self.times(&mut rng);
        let inner = (1.0 / (self.rate * STEP)).ceil().max(1.0);
        let dt = 1.0 / (self.rate * inner);
        let steps = ((self.duration + 0.1) / dt).ceil() as usize;
        let mut contact = self.friction()?.start(TimeStep::new(dt)?);
        let mut lash = self.motion(0.0)[0];
        let torque: Vec<f64> = (0..steps)
            .map(|k| {
                let [q, v, a] = self.motion(k as f64 * dt);
                // Half of the inertia, and the weight, hang behind the lost motion.
                let half = 0.5 * self.backlash;
                let before = lash;
                lash = lash.clamp(q - half, q + half);
                let carried = if self.backlash == 0.0 || lash != before { 1.0 } else { 0.0 };
                let [sin, cos] = self.gravity.unwrap_or_default();
                let weight = sin * lash.sin() + cos * lash.cos();
                let ripple =
                    self.ripple.map_or(0.0, |[size, n, phase]| size * (n * q + phase).sin());
                let inertia =
                    self.inertia * if self.backlash == 0.0 { 1.0 } else { 0.5 + 0.5 * carried };
                inertia * a + contact.step(v) + weight + ripple + self.offset
            })
            .collect();
        let at = |t: f64| {
            let place = (t / dt).max(0.0);
            let (index, part) = (place.floor() as usize, place.fract());
            let value = |k: usize| torque.get(k).or(torque.last()).copied().unwrap_or_default();
            value(index) + part * (value(index + 1) - value(index))
        };
        let mut coloured = 0.0;
        let keep = if self.colour > 0.0 { (-1.0 / (self.colour * self.rate)).exp() } else { 0.0 };
        let mut rows = Rows { time: times, position: vec![], velocity: vec![], torque: vec![] };
        let counts = |q: f64| (q / self.encoder).round() * self.encoder;
        for &t in &rows.time {
            let [q, v, _] = self.motion(t);
            let white: f64 = rng.sample(StandardNormal);
            coloured = keep * coloured + (1.0 - keep * keep).sqrt() * white;
            rows.position.push(counts(q));
            let wobble: f64 = rng.sample(StandardNormal);
            rows.velocity.push(v + 0.1 * self.encoder * self.rate * wobble);
            // What is commanded now acts later.
            rows.torque.push(at(t + self.delay) + self.noise * coloured);
        }
        Ok(rows)
    }

    fn times(&self, rng: &mut Pcg64Mcg) -> Vec<f64> {
        let count = (self.duration * self.rate) as usize;
        let mut jitter = || if self.uneven { 0.6 * (rng.random::<f64>() - 0.5) } else { 0.0 };
        (0..count).map(|k| ((k as f64 + jitter()) / self.rate).max(k as f64 * 1e-9)).collect()
    }
}

impl Rows {
    /// Part of it as a file: time, position, velocity if wanted, torque.
    pub fn csv(&self, part: std::ops::Range<usize>, velocity: bool) -> String {
        let mut text = String::from(if velocity { "time,q,dq,tau\n" } else { "time,q,tau\n" });
        for k in part {
            let _ = write!(text, "{:.6},{:.7}", self.time[k], self.position[k]);
            if velocity {
                let _ = write!(text, ",{:.6e}", self.velocity[k]);
            }
            let _ = writeln!(text, ",{:.6e}", self.torque[k]);
        }
        text
    }
}
