//! A position loop under friction, simulated.

use core::f64::consts::TAU;

use friction_model::{Body, Drive, FrictionModel};
use serde::{Deserialize, Serialize};

use super::TransferFunction;
use crate::describing_function::{HarmonicError, positive};

/// A position loop: a body and its controller.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PidLoop {
    /// Inertia m \[kg or kg m^2\], above zero.
    pub inertia: f64,
    /// Velocity gain K_v \[N s/m or N m s/rad\].
    pub k_v: f64,
    /// Position gain K_p \[N/m or N m/rad\].
    pub k_p: f64,
    /// Integral gain K_i \[N/(m s) or N m/(rad s)\].
    pub k_i: f64,
    /// Reference position r \[m or rad\].
    pub reference: f64,
}

impl PidLoop {
    /// The thesis's example, section 3.4.2.
    #[must_use]
    pub const fn thesis() -> Self {
        Self { inertia: 1.0, k_v: 6.0, k_p: 3.0, k_i: 4.0, reference: 1.0 }
    }

    /// `G = s / (m s^3 + (K_v + f_v) s^2 + K_p s + K_i)`, from friction to displacement with the
    /// sign turned; `f_v` \[N s/m or N m s/rad\] is friction's viscous part, which is linear.
    ///
    /// # Errors
    /// [`HarmonicError`] if a number is not finite, or all are zero.
    pub fn linear_part(&self, f_v: f64) -> Result<TransferFunction, HarmonicError> {
        TransferFunction::new(
            vec![0.0, 1.0],
            vec![self.k_i, self.k_p, self.k_v + f_v, self.inertia],
        )
    }
}

/// How long and how finely a loop is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Schedule {
    /// Integration step \[s\].
    pub dt: f64,
    /// End of the simulation \[s\].
    pub duration: f64,
    /// From here on the motion counts as settled \[s\].
    pub settled: f64,
    /// One step in this many is kept for drawing.
    pub keep: u32,
}

impl Default for Schedule {
    /// 200 s in steps of 0.1 ms, settled after 80 s, drawn every 50 ms.
    fn default() -> Self {
        Self { dt: 1e-4, duration: 200.0, settled: 80.0, keep: 500 }
    }
}

/// A sustained oscillation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// Half of the distance between the extremes \[m or rad\].
    pub amplitude: f64,
    /// Mean time between upward crossings of the reference \[s\].
    pub period: f64,
    /// `2 pi / period` \[rad/s\].
    pub angular_frequency: f64,
}

/// The largest deviation between two crossings of the reference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// When \[s\].
    pub time: f64,
    /// Position minus reference \[m or rad\].
    pub deviation: f64,
}

/// A simulated loop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Simulated {
    /// The oscillation once settled. `None` if the reference is not crossed upwards three times, or
    /// if the amplitudes of the two halves of the settled time differ by more than 5 %: it then
    /// rests, decays or grows.
    pub cycle: Option<Cycle>,
    /// Every peak from the first crossing of the reference on; the last one may be cut by the end.
    pub peaks: Vec<Peak>,
    /// Times kept for drawing \[s\].
    pub time: Vec<f64>,
    /// Positions at these times \[m or rad\].
    pub position: Vec<f64>,
}

/// Simulates the loop from rest at position zero, with [`Body`].
///
/// # Errors
/// [`HarmonicError`] unless inertia, step and duration are finite and above zero.
pub fn simulate<M: FrictionModel>(
    model: &M,
    pid: &PidLoop,
    schedule: &Schedule,
) -> Result<Simulated, HarmonicError> {
    positive("the inertia [kg or kg m^2]", pid.inertia)?;
    let dt = positive("the integration step [s]", schedule.dt)?;
    let duration = positive("the duration [s]", schedule.duration)?;
    let PidLoop { k_v, k_p, k_i, reference, .. } = *pid;
    let mut body = Body::<M, 1>::new(model.clone(), pid.inertia);
    let mut watch = Watch::new(schedule, -reference);
    let (mut time, mut position) = (vec![0.0], vec![0.0]);
    for k in 1..=(duration / dt).round() as u64 {
        body.advance(dt, |at| Drive {
            force: -k_v * at.velocity - k_p * at.position - k_i * at.driver[0],
            rates: [at.position - reference],
        });
        let t = k as f64 * dt;
        let x = body.moment().position;
        watch.see(t, x - reference);
        if k % u64::from(schedule.keep.max(1)) == 0 {
            time.push(t);
            position.push(x);
        }
    }
    let (cycle, peaks) = watch.conclude();
    Ok(Simulated { cycle, peaks, time, position })
}

/// Watches the deviation from the reference go by.
struct Watch {
    settled: f64,
    middle: f64,
    before: (f64, f64),
    /// The peak since the last crossing; none before the first.
    peak: Option<Peak>,
    peaks: Vec<Peak>,
    /// Upward crossings once settled: the first, the last, how many between.
    upward: Option<(f64, f64, u32)>,
    /// Extremes of both halves of the settled time.
    halves: [(f64, f64); 2],
}

impl Watch {
    fn new(schedule: &Schedule, start: f64) -> Self {
        Self {
            settled: schedule.settled,
            middle: 0.5 * (schedule.settled + schedule.duration),
            before: (0.0, start),
            peak: None,
            peaks: Vec::new(),
            upward: None,
            halves: [(f64::INFINITY, f64::NEG_INFINITY); 2],
        }
    }

    fn see(&mut self, t: f64, deviation: f64) {
        let (t0, d0) = self.before;
        self.before = (t, deviation);
        let upward = d0 < 0.0 && deviation >= 0.0;
        if upward || (d0 > 0.0 && deviation <= 0.0) {
            self.peaks.extend(self.peak.replace(Peak { time: t, deviation }));
        }
        if let Some(peak) = &mut self.peak
            && deviation.abs() > peak.deviation.abs()
        {
            *peak = Peak { time: t, deviation };
        }
        if t < self.settled {
            return;
        }
        if upward {
            let crossing = t0 + (t - t0) * d0 / (d0 - deviation);
            self.upward = match self.upward {
                None => Some((crossing, crossing, 0)),
                Some((first, _, count)) => Some((first, crossing, count + 1)),
            };
        }
        let [first, second] = &mut self.halves;
        let (low, high) = if t < self.middle { first } else { second };
        (*low, *high) = (low.min(deviation), high.max(deviation));
    }

    fn conclude(mut self) -> (Option<Cycle>, Vec<Peak>) {
        self.peaks.extend(self.peak);
        let [first, second] = self.halves.map(|(low, high)| 0.5 * (high - low));
        let cycle = match self.upward {
            Some((from, to, count @ 2..)) if (second - first).abs() <= 0.05 * first => {
                let low = self.halves[0].0.min(self.halves[1].0);
                let high = self.halves[0].1.max(self.halves[1].1);
                let period = (to - from) / f64::from(count);
                Some(Cycle {
                    amplitude: 0.5 * (high - low),
                    period,
                    angular_frequency: TAU / period,
                })
            }
            _ => None,
        };
        (cycle, self.peaks)
    }
}

#[cfg(test)]
mod tests {
    use friction_model::{Coulomb, CoulombParameters, Viscous, ViscousParameters};

    use super::*;

    #[test]
    fn rest_and_decay_are_no_cycles() {
        // Viscous friction: the loop settles, for ever smaller.
        let viscous = Viscous::try_from(ViscousParameters { f_v: 0.0 }).unwrap();
        let pid = PidLoop { k_v: 2.0, ..PidLoop::thesis() };
        let decays =
            simulate(&viscous, &pid, &Schedule { dt: 1e-3, ..Schedule::default() }).unwrap();
        assert_eq!(decays.cycle, None);
        assert!(decays.peaks.len() > 10 && decays.position.last().unwrap() - 1.0 < 1e-6);
        // Coulomb friction without an integral: it stops beside the reference.
        let coulomb = Coulomb::try_from(CoulombParameters { f_c: 0.5 }).unwrap();
        let pid = PidLoop { k_i: 0.0, ..PidLoop::thesis() };
        assert_eq!(simulate(&coulomb, &pid, &Schedule::default()).unwrap().cycle, None);
    }

    #[test]
    fn impossible_inputs_are_refused() {
        let pid = PidLoop { inertia: 0.0, ..PidLoop::thesis() };
        assert!(simulate(&Coulomb::test_bed(), &pid, &Schedule::default()).is_err());
        let schedule = Schedule { dt: f64::NAN, ..Schedule::default() };
        assert!(simulate(&Coulomb::test_bed(), &PidLoop::thesis(), &schedule).is_err());
        let pid = PidLoop { k_p: f64::INFINITY, ..PidLoop::thesis() };
        assert!(pid.linear_part(0.0).is_err());
    }
}
