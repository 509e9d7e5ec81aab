//! Many logs at once: four to a lane group, all groups in step, so that the processor never waits
//! for one log's step to end.

use super::drive::Drive;
use super::log::ServoLog;

/// Standard gravity \[m/s^2\].
const GRAVITY: f64 = 9.806_65;
/// Logs of a group.
pub(super) const WIDTH: usize = 4;

/// Four logs.
pub(super) type Four = [f64; WIDTH];

/// One instant of four logs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub goal: Four,
    pub position: Four,
    /// One where the motor is driven.
    pub enabled: Four,
    /// One while the log lasts.
    pub counts: Four,
}

/// What stays the same in four logs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Group {
    pub gain: Four,
    pub damping: Four,
    /// Inertia of pendulum and arm \[kg m^2\].
    pub inertia: Four,
    /// Largest moment of their weight \[N m\].
    pub moment: Four,
    pub supply: Four,
    pub position: Four,
    pub speed: Four,
}

impl Group {
    /// Moment of a weight \[N m\].
    pub fn moment(mass: f64, length: f64) -> f64 {
        mass * length * GRAVITY
    }
}

/// Logs laid out for simulation.
#[derive(Debug, Clone)]
pub struct Lanes {
    pub(super) drive: Drive,
    pub(super) delay: f64,
    pub(super) groups: Vec<Group>,
    /// Samples of all groups for the first instant, then for the second, ...
    pub(super) samples: Vec<Sample>,
    logs: usize,
    /// Samples of each log.
    pub(super) lengths: Vec<usize>,
    pub(super) total: f64,
}

impl Lanes {
    /// Lays the logs of one servo out in their order.
    pub fn new(logs: &[&ServoLog], drive: &Drive) -> Self {
        let lengths: Vec<usize> = logs.iter().map(|log| log.samples()).collect();
        let longest = lengths.iter().copied().max().unwrap_or(0);
        let quads: Vec<&[&ServoLog]> = logs.chunks(WIDTH).collect();
        let lane = |quad: &[&ServoLog], of: &dyn Fn(&ServoLog) -> f64| -> Four {
            // A lane without a log repeats the group's first and does not count.
            std::array::from_fn(|i| of(quad.get(i).unwrap_or(&quad[0])))
        };
        let groups = quads
            .iter()
            .map(|quad| Group {
                gain: lane(quad, &|log| log.gain * drive.per_gain),
                damping: lane(quad, &|log| log.damping),
                // A thin rod about its end.
                inertia: lane(quad, &|log| {
                    (log.mass + log.arm_mass / 3.0) * log.length * log.length
                }),
                moment: lane(quad, &|log| Group::moment(log.mass + 0.5 * log.arm_mass, log.length)),
                supply: lane(quad, &|log| log.supply),
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
                    counts: std::array::from_fn(|i| {
                        f64::from(u8::from(quad.get(i).is_some_and(|log| k < log.samples())))
                    }),
                });
            }
        }
        let total = lengths.iter().sum::<usize>() as f64;
        Self { drive: *drive, delay: 0.0, groups, samples, logs: logs.len(), lengths, total }
    }

    /// Lets goals take effect after a given delay \[s\], which a delay among the parameters adds to;
    /// none is no delay.
    pub fn set_goal_delay(&mut self, delay: Option<f64>) {
        self.delay = delay.unwrap_or(0.0);
    }

    /// Logs.
    pub fn logs(&self) -> usize {
        self.logs
    }
}
