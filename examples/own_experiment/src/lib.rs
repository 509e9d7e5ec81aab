//! An experiment from outside the suite: the shaft turns forth and back at one speed, and the two
//! levels of friction stand side by side.

use experiment_runner::profile::{DrivenQuantity, Excitation, Profile, Segment};
use experiment_runner::protocol::Displacement;
use experiment_runner::run::excited::{ExcitedJob, Series};
use experiment_runner::run::experiment::{Experiment, Progressed, Running};
use experiment_runner::run::{RunError, RunOptions};
use report::figure::{Block, Table};
use serde_json::json;

/// Friction at one speed, forwards and backwards.
#[derive(Debug, Clone, Copy)]
pub struct BothWays {
    /// The speed [rad/s].
    pub speed: f64,
    /// Time that it turns each way [s].
    pub duration: f64,
    /// How often it is done.
    pub repetitions: u32,
}

impl BothWays {
    /// Speeds up from rest, holds, turns round, holds.
    fn profile(&self) -> Profile {
        let (v, ramp) = (self.speed, 0.2);
        let line = |from, to, duration| Segment::Line { from, to, duration };
        Profile::new(vec![
            Segment::REST,
            line(0.0, v, ramp),
            line(v, v, self.duration),
            line(v, -v, 2.0 * ramp),
            line(-v, -v, self.duration),
        ])
    }
}

impl Experiment for BothWays {
    fn name(&self) -> &'static str {
        "both-ways"
    }

    fn about(&self) -> &'static str {
        "Friction at one speed, forwards and backwards"
    }

    fn rig_seconds(&self, _: &RunOptions) -> f64 {
        f64::from(self.repetitions) * self.profile().duration()
    }

    fn carry_out(&self, running: &mut Running<'_, '_>) -> Result<Progressed, RunError> {
        let series = Series {
            name: self.name(),
            // Its own stream of sensor noise; those of the suite are below 16.
            stream: 100,
            displacement: Displacement::Encoder,
            every_cycle: false,
        };
        let job = |repetition| ExcitedJob {
            stage: format!("{} rad/s both ways", self.speed),
            group: 0,
            repetition,
            excitation: Excitation { quantity: DrivenQuantity::Velocity, profile: self.profile() },
            feed_forward: true,
            until: None,
        };
        let jobs = (0..self.repetitions).map(job).collect();
        let speed = self.speed;
        // What is made of one run: the mean friction where the speed is reached, each way.
        let driven = running.drive(series, jobs, |_, channels, friction| {
            [1.0, -1.0].map(|way| {
                let near = |&(v, _): &(&f64, &f64)| (v - way * speed).abs() < 0.2 * speed;
                let (mut sum, mut n) = (0.0, 0.0);
                for (_, torque) in channels.velocity.iter().zip(&friction.torque).filter(near) {
                    sum += torque;
                    n += 1.0;
                }
                sum / n
            })
        })?;
        let runs: Vec<&[f64; 2]> = driven.of(0).collect();
        let mean = |way: usize| runs.iter().map(|run| run[way]).sum::<f64>() / runs.len() as f64;
        let (forward, backward) = (mean(0), mean(1));
        // Its figures in run.json, and a table on the page.
        running.found.own.insert(
            "both_ways".to_owned(),
            json!({ "speed": speed, "forward": forward, "backward": backward }),
        );
        running.found.blocks.push(Block::Table(Table {
            title: format!("Friction at {speed} rad/s"),
            caption: "Mean over all runs, where the speed was reached.".to_owned(),
            columns: vec!["way".to_owned(), "torque [N m]".to_owned()],
            rows: vec![
                vec!["forwards".to_owned(), format!("{forward:.4}")],
                vec!["backwards".to_owned(), format!("{backward:.4}")],
            ],
            highlight: None,
        }));
        Ok(Progressed::from(&driven))
    }
}
