//! Many logs at once: four to a lane group, all groups in step, so that the processor never waits
//! for one log's step to end.

use std::f64::consts::PI;

use wide::{CmpGt, CmpLt, f64x4};

use super::log::{ServoLog, TIME_STEP};
use super::parameter::ServoParameter::*;
use super::physics::Physics;

/// Standard gravity \[m/s^2\].
const GRAVITY: f64 = 9.806_65;
/// Duty cycle per position error \[1/rad\] and unit of gain.
const DUTY_PER_GAIN: f64 = 4096.0 / (2.0 * PI) / (256.0 * 885.0);
/// No axis of this size turns faster \[rad/s\].
const FASTEST: f64 = 100.0;
/// Samples between two looks at whether a candidate is beaten already.
const LOOK: usize = 60;

#[derive(Debug, Clone, Copy)]
struct Sample {
    goal: f64x4,
    position: f64x4,
    /// One where the motor is driven.
    enabled: f64x4,
    /// One while the log lasts.
    counts: f64x4,
}

#[derive(Debug, Clone, Copy)]
struct Group {
    gain: f64x4,
    mass: f64x4,
    length: f64x4,
    voltage: f64x4,
    position: f64x4,
    speed: f64x4,
}

/// Logs laid out for simulation.
#[derive(Debug, Clone)]
pub struct Lanes {
    groups: Vec<Group>,
    /// Samples of all groups for the first instant, then for the second, ...
    samples: Vec<Sample>,
    logs: usize,
    /// Samples of each log.
    lengths: Vec<usize>,
    total: f64,
}

impl Lanes {
    /// Lays the logs out in their order.
    pub fn new(logs: &[&ServoLog]) -> Self {
        let mut lengths: Vec<usize> = logs.iter().map(|log| log.samples()).collect();
        let longest = lengths.iter().copied().max().unwrap_or(0);
        let quads: Vec<&[&ServoLog]> = logs.chunks(4).collect();
        let lane = |quad: &[&ServoLog], of: &dyn Fn(&ServoLog) -> f64| {
            // A lane without a log repeats the group's first and does not count.
            f64x4::from(std::array::from_fn::<f64, 4, _>(|i| of(quad.get(i).unwrap_or(&quad[0]))))
        };
        let groups = quads
            .iter()
            .map(|quad| Group {
                gain: lane(quad, &|log| log.gain * DUTY_PER_GAIN),
                mass: lane(quad, &|log| log.mass),
                length: lane(quad, &|log| log.length),
                voltage: lane(quad, &|log| log.nominal_voltage),
                position: lane(quad, &|log| log.position[0]),
                speed: lane(quad, &|log| log.first_speed),
            })
            .collect();
        let mut samples = Vec::with_capacity(longest * quads.len());
        for k in 0..longest {
            for quad in &quads {
                let at = |values: &[f64]| values.get(k).or(values.last()).copied().unwrap_or(0.0);
                samples.push(Sample {
                    goal: lane(quad, &|log| at(&log.goal)),
                    position: lane(quad, &|log| at(&log.position)),
                    enabled: lane(quad, &|log| {
                        f64::from(u8::from(log.enabled.get(k).is_some_and(|on| *on)))
                    }),
                    counts: f64x4::from(std::array::from_fn::<f64, 4, _>(|i| {
                        f64::from(u8::from(quad.get(i).is_some_and(|log| k < log.samples())))
                    })),
                });
            }
        }
        let total = lengths.iter().sum::<usize>() as f64;
        lengths.shrink_to_fit();
        Self { groups, samples, logs: logs.len(), lengths, total }
    }

    /// Logs.
    pub fn logs(&self) -> usize {
        self.logs
    }

    /// Mean of |simulated - measured| over all samples of all logs \[rad\]; infinite as soon as it
    /// must exceed `limit`.
    pub fn error(&self, physics: &Physics, limit: f64) -> f64 {
        let limit = limit * self.total;
        let sums = self.run(physics, &mut |_, _| {}, limit);
        sums.iter().map(|sum| sum.reduce_add()).sum::<f64>() / self.total
    }

    /// The same for each log \[rad\].
    pub fn errors(&self, physics: &Physics) -> Vec<f64> {
        let sums = self.run(physics, &mut |_, _| {}, f64::INFINITY);
        let sums = sums.iter().flat_map(|sum| sum.to_array());
        sums.zip(&self.lengths).map(|(sum, &length)| sum / length as f64).collect()
    }

    /// The simulated positions of each log \[rad\].
    pub fn positions(&self, physics: &Physics) -> Vec<Vec<f64>> {
        let mut positions: Vec<Vec<f64>> =
            self.lengths.iter().map(|&n| Vec::with_capacity(n)).collect();
        let watch = &mut |group: usize, q: f64x4| {
            for (lane, value) in q.to_array().into_iter().enumerate() {
                let log = 4 * group + lane;
                if self.lengths.get(log).is_some_and(|&n| positions[log].len() < n) {
                    positions[log].push(value);
                }
            }
        };
        self.run(physics, watch, f64::INFINITY);
        positions
    }

    fn run(
        &self,
        physics: &Physics,
        watch: &mut impl FnMut(usize, f64x4),
        limit: f64,
    ) -> Vec<f64x4> {
        if physics.get(RippleSine) != 0.0 || physics.get(RippleCosine) != 0.0 {
            self.advance::<true, true>(physics, watch, limit)
        } else if physics.has_stribeck() {
            self.advance::<true, false>(physics, watch, limit)
        } else {
            self.advance::<false, false>(physics, watch, limit)
        }
    }

    #[inline(always)]
    fn advance<const STRIBECK: bool, const RIPPLE: bool>(
        &self,
        physics: &Physics,
        watch: &mut impl FnMut(usize, f64x4),
        limit: f64,
    ) -> Vec<f64x4> {
        let of = |parameter| f64x4::splat(physics.get(parameter));
        let (k_t, r, offset) = (of(TorqueConstant), of(Resistance), of(PositionOffset));
        let (k_c, k_e, k_m) = (of(Coulomb), of(ExternalLoad), of(MotorLoad));
        let (k_cs, k_es, k_ms) = (of(StribeckCoulomb), of(StribeckExternal), of(StribeckMotor));
        let (k_eq, k_mq) = (of(QuadraticExternal), of(QuadraticMotor));
        let (per_w_s, alpha) = (f64x4::ONE / of(StribeckVelocity), of(StribeckExponent));
        let (k_v, k_2) = (of(Viscous), of(LoadSquared));
        let (ripple_sine, ripple_cosine, ripples) =
            (of(RippleSine), of(RippleCosine), of(RippleCount));
        let per_r = k_t / r;
        let dt = f64x4::splat(TIME_STEP);
        let half_dt2 = f64x4::splat(0.5 * TIME_STEP * TIME_STEP);
        let zero = f64x4::ZERO;
        let n = self.groups.len();
        // The goal, moved by a fraction of the grid.
        let shift = physics.get(Delay) / TIME_STEP;
        let whole = shift.floor();
        let (behind, fraction) = (whole as isize, f64x4::splat(shift - whole));
        let last = (self.samples.len() / n.max(1)) as isize - 1;

        let mut states: Vec<_> = self
            .groups
            .iter()
            .map(|group| {
                let length = group.length;
                let inertia = group.mass * length * length + of(Armature);
                let gravity = group.mass * length * f64x4::splat(GRAVITY);
                (
                    group.position,
                    group.speed,
                    f64x4::ZERO,
                    inertia / dt,
                    f64x4::ONE / inertia,
                    gravity,
                )
            })
            .collect();
        for (step, samples) in self.samples.chunks_exact(n.max(1)).enumerate() {
            if step % LOOK == 0 && limit.is_finite() {
                let so_far =
                    states.iter().fold(f64x4::ZERO, |sum, state| sum + state.2).reduce_add();
                if so_far.is_nan() || so_far > limit {
                    return vec![f64x4::splat(f64::INFINITY)];
                }
            }
            let from = (step as isize - behind).clamp(0, last) as usize * n;
            let before = (step as isize - behind - 1).clamp(0, last) as usize * n;
            for (index, ((group, state), sample)) in
                self.groups.iter().zip(&mut states).zip(samples).enumerate()
            {
                let (q, w, sum, inertia_rate, per_inertia, gravity) = *state;
                watch(index, q);
                let late = self.samples[from + index].goal;
                let goal = late + (self.samples[before + index].goal - late) * fraction;

                let duty = ((goal - q) * group.gain).max(-f64x4::ONE).min(f64x4::ONE);
                let motor = sample.enabled * per_r * (group.voltage * duty - k_t * w);
                let external = -gravity * (q + offset).sin();
                let stop = inertia_rate * w + motor + external;
                let speed = w.abs();
                let mut level = k_c + (k_e * external - k_m * motor).abs() + k_2 * motor * motor;
                if STRIBECK {
                    let x = (speed * per_w_s).max(f64x4::splat(1e-100));
                    let fall = (-(x.ln() * alpha).exp().min(f64x4::splat(700.0))).exp();
                    let (e, m) = (external.abs(), motor.abs());
                    let quadratic = m.cmp_gt(e).blend(k_eq * e * e, k_mq * m * m);
                    let opposed = (external * motor).cmp_lt(zero).blend(quadratic, zero);
                    level += fall * (k_cs + (k_es * external - k_ms * motor).abs() + opposed);
                }
                if RIPPLE {
                    let (sine, cosine) = (q * ripples).sin_cos();
                    level *= (f64x4::ONE + ripple_sine * sine + ripple_cosine * cosine).max(zero);
                }
                level += speed * k_v;
                let friction = -stop.max(-level).min(level);
                let acceleration = (motor + external + friction) * per_inertia;
                let w =
                    (w + acceleration * dt).max(f64x4::splat(-FASTEST)).min(f64x4::splat(FASTEST));
                let next = q + w * dt + acceleration * half_dt2;
                let sum = sum + (q - sample.position).abs() * sample.counts;
                *state = (next, w, sum, inertia_rate, per_inertia, gravity);
            }
        }
        states.iter().map(|state| state.2).collect()
    }
}
