//! `simulate` along a motion in memory on one thread, for `cargo xtask bench-simulate`: number of
//! points in, one line of JSON out.

use std::io::{self, Write};
use std::time::Instant;

use anyhow::Context;
use friction_model::{AnyModel, ModelName};
use recording::AxisKind;
use recording::trajectory::Point;
use studies::simulate::{Motion, Scheme, Settings, simulate};

/// Sampling period \[s\].
const H: f64 = 1e-3;

/// Counts what is written.
#[derive(Default)]
struct Lines(u64);

impl Write for Lines {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        self.0 += text.len() as u64;
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn main() -> anyhow::Result<()> {
    let count = std::env::args().nth(1).context("expected the number of points")?;
    let count: u32 = count.parse().context("expected a whole number of points")?;
    let model = AnyModel::test_bed(ModelName::LuGre);
    let settings = Settings { scheme: Scheme::Mean, dt: H, tolerance: 1e-6, load_gain: None };
    let points = (0..count).map(|k| {
        let time = f64::from(k) * H;
        Ok(Point { time, velocity: 0.3 * (5.0 * time).sin(), load: 0.0 })
    });
    let motion = Motion { axis: AxisKind::Rotary, loaded: false, points };
    let mut written = Lines::default();
    let started = Instant::now();
    let done = simulate(&model, motion, &settings, &mut written)?;
    let seconds = started.elapsed().as_secs_f64();
    println!(
        "{}",
        serde_json::json!({ "points": done.rows, "seconds": seconds, "bytes": written.0 })
    );
    Ok(())
}
