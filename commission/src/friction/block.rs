//! A block: one speed, forwards and back over the same way.
//!
//! Windows of both directions are paired where the shaft is at the same place: what depends on the
//! place, as a load that hangs, a cable or the gear's ripple, is the same in both and falls out of
//! half their difference.

use controller::{ControllerOptions, Reference};
use friction_ident::statistics::line;
use rig_driver::Measurement;
use rig_setup::REST;
use serde::{Deserialize, Serialize};

use super::trail::{Driven, Trail};
use crate::axis::{Axis, Bench};
use crate::reach::Reach;
use crate::{CommissionError, Stage};

/// Length of a window \[s\].
pub(super) const WINDOW: f64 = 0.5;
/// Windows in each direction.
const WINDOWS: usize = 4;
/// Windows that have to be steady.
const ENOUGH: usize = 2;
/// How near the lower end a block begins where the travel has ends, as a share of it, and the part
/// of it that the way out may take.
const HOME: f64 = 0.05;
const WAY: f64 = 0.9;
/// Shortest and longest time for the speed to settle in each direction \[s\], and how often the
/// loop's own time it is.
const SETTLE: (f64, f64) = (0.8, 2.5);
const TIMES: f64 = 4.0;
/// Way in which bristles and backlash have turned round \[rad\], and the longest time for it \[s\].
const TURNED: f64 = 0.05;
const LONGEST: f64 = 5.0;
/// Share of it in which the speed is reached.
const STARTING: f64 = 0.4;
/// A window whose speed misses the block's by more than this share was no steady motion.
const STEADY: f64 = 0.2;
/// A part of it below this share of its speed stood; each part has that many counts.
const STOOD: f64 = 0.25;
const COUNTS: f64 = 4.0;
const PARTS: usize = 10;

/// A block's mean: half the difference of both directions. The windows of a block share whatever is
/// wrong at its speed, so that they are one point and not several.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Speed [rad/s].
    pub velocity: f64,
    /// Voltage of friction and back-EMF \[V\].
    pub volts: f64,
    /// Voltage that acts in one direction, whichever way it turns \[V\].
    pub one_way: f64,
    /// Standard deviation of the speed over the mean, as far as the encoder shows it: where it is
    /// large, the mean voltage is not that of the mean speed.
    pub uneven: f64,
    /// Rig time at which it was measured \[s\].
    pub time: f64,
}

/// What a block says: of its speed, and of its places where they could be told.
pub type Measured = (Point, Option<Trail>);

/// How blocks are measured on a rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blocks {
    /// The loop that follows the speed, with what the reference takes fed forward.
    pub controller: ControllerOptions,
    /// Its natural frequency [rad/s].
    pub natural_frequency: f64,
    /// Friction in motion, roughly \[V\].
    pub friction: f64,
    /// Voltage that an acceleration takes \[V s^2/rad\].
    pub inertia: f64,
    /// Gain of the drive [rad/(V s)].
    pub gain: f64,
    /// Its delay \[s\].
    pub delay: f64,
    /// Angle of one count \[rad\].
    pub encoder_step: f64,
    /// Where the shaft may be, where its travel has ends.
    pub reach: Option<Reach>,
    /// Mean speed on the way to where a block begins, at most [rad/s]: a smooth move is nearly twice
    /// as fast in its middle.
    pub homeward: f64,
}

impl Blocks {
    fn settle(&self, velocity: f64) -> f64 {
        let by_loop = (TIMES / self.natural_frequency).clamp(SETTLE.0, SETTLE.1);
        by_loop.max((TURNED / velocity).min(LONGEST))
    }

    fn half(&self, velocity: f64) -> f64 {
        2.0 * self.settle(velocity) + WINDOWS as f64 * WINDOW
    }

    /// The fastest speed whose way out is within the travel [rad/s].
    #[must_use]
    pub fn fastest(&self) -> f64 {
        let Some(reach) = self.reach else { return f64::INFINITY };
        // Where the speed is fast, the loop's own time counts and not the way that bristles take.
        let settle = (TIMES / self.natural_frequency).clamp(SETTLE.0, SETTLE.1);
        WAY * reach.length() / ((2.0 - STARTING) * settle + WINDOWS as f64 * WINDOW)
    }

    /// Rig time of a block at `velocity` [rad/s], with the rest before it \[s\].
    #[must_use]
    pub fn seconds(&self, velocity: f64) -> f64 {
        REST + 2.0 * self.half(velocity)
    }

    /// Measures a block; none where the shaft did not turn steadily.
    ///
    /// # Errors
    /// [`CommissionError`] if the rig refuses or the time is up.
    pub fn measure(
        &self,
        axis: &mut Axis<'_>,
        bench: &Bench,
        stage: Stage,
        velocity: f64,
    ) -> Result<Option<Measured>, CommissionError> {
        let half = self.half(velocity);
        let reference = |time: f64| self.reference(velocity, time);
        // The way out goes upwards.
        if let Some(reach) = self.reach {
            let home = (reach.low, HOME * reach.length());
            axis.go(bench, stage, self.controller, home, reach.length().min(self.homeward))?;
        }
        let friction = |now: &Reference| {
            if now.velocity == 0.0 { 0.0 } else { self.friction * now.velocity.signum() }
        };
        let seen = axis.follow(bench, stage, 2.0 * half, self.controller, reference, friction)?;
        let time = axis.used();
        let Some(point) = self.point(&seen, velocity, bench.period()) else { return Ok(None) };
        let lasts = WINDOWS as f64 * WINDOW;
        let begins = (self.settle(velocity), 2.0 * half - self.settle(velocity) - lasts);
        let told = (velocity, bench.origin(), bench.period());
        let driven = Driven { gain: self.gain, inertia: self.inertia, delay: self.delay };
        let trail = driven.trail(&seen, told, (begins, lasts));
        Ok(Some((Point { time, ..point }, trail)))
    }

    /// The way out, and the same back: the speed is reached and left steadily.
    fn reference(&self, velocity: f64, time: f64) -> Reference {
        let (half, start) = (self.half(velocity), STARTING * self.settle(velocity));
        let sign = if time < half { 1.0 } else { -1.0 };
        // Time along the way out, whichever way it is gone.
        let along = if time < half { time } else { 2.0 * half - time }.max(0.0);
        let before_turn = half - along;
        let pace = velocity / start;
        let (way, speed, gains) = if along < start {
            (0.5 * pace * along * along, pace * along, pace)
        } else if before_turn < start {
            let whole = velocity * (half - start);
            (whole - 0.5 * pace * before_turn * before_turn, pace * before_turn, -pace)
        } else {
            (velocity * (along - 0.5 * start), velocity, 0.0)
        };
        // Backwards speed and time turn, so that the acceleration stays.
        Reference { position: way, velocity: sign * speed, acceleration: gains }
    }

    /// The mean of the windows of both directions, in pairs; those without steady motion are left
    /// out.
    fn point(&self, seen: &[Measurement], velocity: f64, period: f64) -> Option<Point> {
        let cycles = |seconds: f64| (seconds / period).round() as usize;
        let window = |from: f64| {
            let first = cycles(from);
            let path = seen.get(first..=first + cycles(WINDOW))?;
            let speed = speed(path)?;
            let (slowest, uneven) = self.parts(path, speed);
            if (speed.abs() - velocity).abs() > STEADY * velocity || slowest < STOOD {
                return None;
            }
            // A reading tells the voltage of the cycle before it.
            let volts = seen.get(first + 1..=first + cycles(WINDOW))?;
            let mean =
                volts.iter().map(|seen| seen.voltage_applied).sum::<f64>() / volts.len() as f64;
            let (early, late) = path.split_at(path.len() / 2);
            let acceleration = (self::speed(late)? - self::speed(early)?) / (0.5 * WINDOW);
            Some((speed, mean - self.inertia * acceleration, uneven))
        };
        let pair = |i: usize| {
            let from = self.settle(velocity) + i as f64 * WINDOW;
            let (forward, volts_forward, uneven_forward) = window(from)?;
            // The way back meets the last window first.
            let (backward, volts_backward, uneven_backward) =
                window(2.0 * self.half(velocity) - from - WINDOW)?;
            Some(Point {
                velocity: 0.5 * (forward - backward),
                volts: 0.5 * (volts_forward - volts_backward),
                one_way: 0.5 * (volts_forward + volts_backward),
                uneven: 0.5 * (uneven_forward + uneven_backward),
                time: 0.0,
            })
        };
        let pairs: Vec<Point> = (0..WINDOWS).filter_map(pair).collect();
        let mean = |of: fn(&Point) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
        (pairs.len() >= ENOUGH).then(|| Point {
            velocity: mean(|pair| pair.velocity),
            volts: mean(|pair| pair.volts),
            one_way: mean(|pair| pair.one_way),
            uneven: mean(|pair| pair.uneven),
            time: 0.0,
        })
    }

    /// The slowest part of a window, and the standard deviation of all, over its speed; as far as the
    /// encoder shows them.
    fn parts(&self, path: &[Measurement], speed: f64) -> (f64, f64) {
        let counts = speed.abs() * WINDOW / self.encoder_step;
        let parts = ((counts / COUNTS) as usize).min(PARTS);
        if parts < 3 {
            return (1.0, 0.0);
        }
        let of = |part: &[Measurement]| self::speed(part).map_or(0.0, |of| of / speed);
        let all: Vec<f64> = path.chunks_exact(path.len() / parts).map(of).collect();
        let squares = all.iter().map(|of| (of - 1.0).powi(2)).sum::<f64>();
        let slowest = all.iter().copied().fold(f64::INFINITY, f64::min);
        (slowest, (squares / all.len() as f64).sqrt())
    }
}

/// Speed along a part of a path [rad/s].
fn speed(path: &[Measurement]) -> Option<f64> {
    let points: Vec<(f64, f64)> =
        path.iter().map(|seen| (seen.time, seen.encoder_position)).collect();
    Some(line(&points)?.slope.value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blocks() -> Blocks {
        Blocks {
            controller: ControllerOptions::default(),
            natural_frequency: 20.0,
            friction: 0.0,
            inertia: 0.02,
            gain: 1.0,
            delay: 0.0,
            encoder_step: 1e-3,
            reach: None,
            homeward: 1.0,
        }
    }

    fn seen(path: impl Fn(f64) -> f64) -> Vec<Measurement> {
        let half = blocks().half(0.3);
        (0..=7200)
            .map(|k| {
                let time = f64::from(k) * 1e-3;
                let forward = k <= 3600;
                let way = if forward { time } else { 2.0 * half - time };
                Measurement {
                    time,
                    encoder_position: path(way),
                    voltage_applied: if forward { 0.7 } else { -0.4 },
                    ..Measurement::default()
                }
            })
            .collect()
    }

    #[test]
    fn the_reference_is_smooth_and_goes_back_the_same_way() {
        let (blocks, h) = (blocks(), 1e-5);
        let half = blocks.half(0.3);
        for i in 1..720 {
            let time = 0.01 * f64::from(i) + 1e-3;
            let at = |time: f64| blocks.reference(0.3, time);
            let (before, now, after) = (at(time - h), at(time), at(time + h));
            let speed = (after.position - before.position) / (2.0 * h);
            let gains = (after.velocity - before.velocity) / (2.0 * h);
            assert!((speed - now.velocity).abs() < 1e-4, "{time}: {speed} {now:?}");
            assert!((gains - now.acceleration).abs() < 1e-3, "{time}: {gains} {now:?}");
            assert!((now.position - at(2.0 * half - time).position).abs() < 1e-9);
        }
    }

    #[test]
    fn what_acts_one_way_is_parted_from_friction() {
        let found = blocks().point(&seen(|way| 0.3 * way), 0.3, 1e-3).unwrap();
        assert!((found.velocity - 0.3).abs() < 1e-6, "{found:?}");
        assert!((found.volts - 0.55).abs() < 1e-9, "{found:?}");
        assert!((found.one_way - 0.15).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_shaft_that_sticks_is_left_out_even_if_its_mean_speed_is_right() {
        assert_eq!(blocks().point(&seen(|way| 0.2 * way), 0.3, 1e-3), None);
        // It stands and slips twice a second.
        let sticks = |way: f64| {
            0.3 * ((2.0 * way).floor() + ((2.0 * way).fract() * 4.0 - 3.0).max(0.0)) / 2.0
        };
        assert_eq!(blocks().point(&seen(sticks), 0.3, 1e-3), None);
    }
}
