//! What is steady of a run at a constant velocity.

use std::ops::Range;

use friction_ident::Stretch;

/// The part of a run at a constant velocity that has settled; none if the velocity is not constant.
pub(super) fn steady_part(stretch: &Stretch) -> Option<Range<usize>> {
    let n = stretch.len();
    let part = n / 5..n - n / 10;
    const BLOCKS: usize = 10;
    let size = part.len() / BLOCKS;
    if size < 5 {
        return None;
    }
    let travel = stretch.travel();
    let over = |first: usize, samples: usize| {
        (travel[first + samples] - travel[first]) / (samples as f64 * stretch.time_step)
    };
    let last = part.end - 1;
    let mean = over(part.start, last - part.start);
    // Over blocks the velocity may not wander, over short windows it may not swing: noise does
    // neither, a lag experiment swings.
    let blocks = (0..BLOCKS - 1).map(|block| over(part.start + block * size, size));
    let window = (size / 4).clamp(4, 50);
    let windows = (part.start..last - window).step_by(window).map(|k| over(k, window));
    let (count, squares) =
        windows.fold((0usize, 0.0), |(count, sum), v| (count + 1, sum + (v - mean).powi(2)));
    let swing = (squares / count.max(1) as f64).sqrt();
    let steady = mean != 0.0
        && blocks.into_iter().all(|v| (v - mean).abs() < 0.05 * mean.abs())
        && swing < 0.15 * mean.abs();
    steady.then_some(part)
}

/// A part of a stretch, which must lie within it.
pub(super) fn cropped(stretch: &Stretch, part: Range<usize>) -> Stretch {
    Stretch {
        velocity: stretch.velocity[part.clone()].to_vec(),
        position: stretch.position.as_ref().map(|position| position[part.clone()].to_vec()),
        friction: stretch.friction[part].to_vec(),
        ..stretch.clone()
    }
}
