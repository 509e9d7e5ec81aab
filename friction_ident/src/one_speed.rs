//! Whether a motion goes at one speed, turns apart: a triangle of position, moves with one cruise.
//!
//! How friction splits into a constant part and one that grows with speed shows between speeds. A
//! motion of one speed has others in its turns alone, where inertia, the rise of the friction from
//! rest and the force's own lag act at once. A fit tells them apart there by what it has of each,
//! with errors that count noise and not what it lacks.

/// Share of the time in motion at the one speed from which the turns are all that is left.
const SHARE: f64 = 0.75;
/// How far from the median speed still counts as it, as a share.
const WITHIN: f64 = 0.15;
/// Share of the fastest motion below which the axis turns or rests.
const MOVES: f64 = 0.1;
/// Rows of motion below which nothing is said.
const FEWEST: usize = 30;

/// That speed, the median while the axis moves; none where it goes at several.
///
/// ```
/// use friction_ident::one_speed::one_speed;
///
/// let square: Vec<f64> = (0..400).map(|k| if (k / 100) % 2 == 0 { 0.5 } else { -0.5 }).collect();
/// assert_eq!(one_speed(&square), Some(0.5));
/// let sine: Vec<f64> = (0..400).map(|k| (0.05 * f64::from(k)).sin()).collect();
/// assert_eq!(one_speed(&sine), None);
/// ```
#[must_use]
pub fn one_speed(velocity: &[f64]) -> Option<f64> {
    let mut speeds: Vec<f64> =
        velocity.iter().map(|v| v.abs()).filter(|speed| speed.is_finite()).collect();
    speeds.sort_by(f64::total_cmp);
    // A few rows of noise are no motion.
    let fastest = *speeds.get(speeds.len().checked_sub(1)? * 99 / 100)?;
    let moving = &speeds[speeds.partition_point(|speed| *speed <= MOVES * fastest)..];
    if moving.len() < FEWEST {
        return None;
    }
    let median = moving[moving.len() / 2];
    let same = moving.iter().filter(|speed| (**speed - median).abs() <= WITHIN * median).count();
    (same as f64 >= SHARE * moving.len() as f64).then_some(median)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_of_one_speed_are_told_from_others() {
        let time = || (0..4000).map(|k| 0.005 * f64::from(k));
        // A triangle whose corners a loop of 4 Hz has rounded, with rest and noise.
        let mut state = 0.0;
        let mut noise = 1_u32;
        let rounded: Vec<f64> = time()
            .map(|t| {
                let wanted = if t < 2.0 { 0.0 } else { 0.4 * (0.6 * t).sin().signum() };
                state += 0.12 * (wanted - state);
                noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                state + 0.01 * (f64::from(noise) / f64::from(u32::MAX) - 0.5)
            })
            .collect();
        let speed = one_speed(&rounded).expect("one speed");
        assert!((speed - 0.4).abs() < 0.01, "{speed}");
        let two: Vec<f64> = rounded
            .iter()
            .enumerate()
            .map(|(k, v)| if k % 2000 < 1000 { *v } else { 0.6 * v })
            .collect();
        assert_eq!(one_speed(&two), None);
        let tones: Vec<f64> = time().map(|t| t.sin() + 0.6 * (2.3 * t).cos()).collect();
        assert_eq!(one_speed(&tones), None);
        assert_eq!(one_speed(&[]), None);
        assert_eq!(one_speed(&[0.0; 500]), None);
        assert_eq!(one_speed(&[f64::NAN; 500]), None);
    }
}
