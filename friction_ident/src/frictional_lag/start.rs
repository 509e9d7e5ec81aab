//! Where the search starts: a coarse scan of `v_s`, with the lag to first order.

use nalgebra::{Matrix4, Vector4};

use crate::finite::finite;

use super::pass::Prepared;

/// Stribeck velocities tried.
const TRIALS: usize = 12;
/// Means over blocks of samples that the scan sees.
const BLOCKS: usize = 480;

/// `ln v_s` and `ln tau`. To first order in the lag `gamma = g - tau g'`, so that each trial is a
/// linear fit of four columns: 1, v, the dip and its derivative.
pub(super) fn start(data: &Prepared) -> [f64; 2] {
    let stride = (data.samples() / BLOCKS).max(1);
    // Speed, acceleration over speed, and torque of each block.
    let mut blocks = Vec::with_capacity(BLOCKS + data.recordings.len());
    for recording in &data.recordings {
        for (speeds, torques) in
            recording.speed.chunks_exact(stride).zip(recording.torque.chunks_exact(stride))
        {
            let mean = |values: &[f64]| values.iter().sum::<f64>() / stride as f64;
            let v = mean(speeds);
            let gain = speeds.last().zip(speeds.first()).map_or(0.0, |(last, first)| last - first);
            let rate = gain / (recording.dt * (stride.max(2) - 1) as f64);
            blocks.push([v, rate / v, mean(torques)]);
        }
    }
    let (low, high) = (data.speeds.0, 0.5 * data.speeds.1);
    let range = data.range(1);
    let shortest = data.recordings.iter().map(|r| 3.0 * r.dt).fold(f64::INFINITY, f64::min);
    let mut best = (f64::NEG_INFINITY, [(low * high).sqrt().ln(), shortest.ln()]);
    for trial in 0..TRIALS {
        let v_s = low * (high / low).powf(trial as f64 / (TRIALS - 1) as f64);
        let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for &[v, rate, y] in &blocks {
            let power =
                if data.delta == 2.0 { (v / v_s).powi(2) } else { (v / v_s).powf(data.delta) };
            let dip = if power < 36.0 { (-power).exp() } else { 0.0 };
            // The last column is minus the dip's derivative.
            let column = Vector4::new(1.0, v, dip, data.delta * power * dip * rate);
            normal.ger(1.0, &column, &column, 1.0);
            right.axpy(y, &column, 1.0);
        }
        let Some(solution) =
            finite(normal).and_then(|normal| normal.cholesky()).map(|factor| factor.solve(&right))
        else {
            continue;
        };
        // The fall of the sum of squares.
        let fall = solution.dot(&right);
        if fall > best.0 && solution[2] > 0.0 {
            let tau = solution[3] / solution[2];
            let tau = if tau > shortest && tau.ln() < range.1 - 2.0 { tau } else { shortest };
            best = (fall, [v_s.ln(), tau.ln()]);
        }
    }
    best.1
}
