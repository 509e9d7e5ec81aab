//! Recordings as the relaxation sees them: one row a sample, at full rate or thinned out.

use crate::frictional_lag::pass::Prepared;

/// Samples that the coarse search is content with.
const COARSE: usize = 1500;

/// One recording: velocity, its power `|v|^delta`, its logarithmic derivative `v' / v` and what is
/// left of the torque.
#[derive(Debug, Clone)]
pub(super) struct Track {
    pub rows: Vec<[f64; 4]>,
    pub dt: f64,
    /// Rows that drive the state but are not fitted.
    pub settle: usize,
}

/// All recordings, and sums over the fitted rows of 1, v, v^2, y, v y, y^2.
#[derive(Debug, Clone)]
pub(super) struct Tracks {
    pub all: Vec<Track>,
    pub totals: [f64; 6],
}

impl Tracks {
    pub fn new(data: &Prepared) -> Self {
        let all = data
            .recordings
            .iter()
            .map(|recording| {
                let slopes = slope(&recording.speed, recording.dt);
                let columns = recording
                    .speed
                    .iter()
                    .zip(&recording.power)
                    .zip(slopes.iter().zip(&recording.torque));
                let rows =
                    columns.map(|((&v, &power), (slope, &y))| [v, power, slope / v, y]).collect();
                Track { rows, dt: recording.dt, settle: data.settle }
            })
            .collect();
        Self { all, totals: data.totals }
    }

    /// Every so-many-th row, so that about 1500 stay, not further apart than the lag `tau`. None
    /// where that would be all of them.
    pub fn coarse(&self, tau: f64) -> Option<Self> {
        let finest = self.all.iter().map(|track| track.dt).fold(f64::INFINITY, f64::min);
        let stride = ((self.totals[0] as usize) / COARSE).min((tau / finest) as usize);
        if stride < 2 {
            return None;
        }
        let all: Vec<Track> = self
            .all
            .iter()
            .map(|track| Track {
                rows: track.rows.iter().step_by(stride).copied().collect(),
                dt: track.dt * stride as f64,
                settle: track.settle.div_ceil(stride),
            })
            .collect();
        let mut totals = [0.0; 6];
        for &[v, _, _, y] in all.iter().flat_map(|track| track.rows.iter().skip(track.settle)) {
            totals
                .iter_mut()
                .zip([1.0, v, v * v, y, v * y, y * y])
                .for_each(|(sum, term)| *sum += term);
        }
        Some(Self { all, totals })
    }
}

/// Derivative of samples, of fourth order.
fn slope(v: &[f64], dt: f64) -> Vec<f64> {
    let n = v.len();
    let scale = 1.0 / (12.0 * dt);
    let mut slopes = vec![0.0; n];
    for (slope, window) in slopes.iter_mut().skip(2).zip(v.windows(5)) {
        if let &[a, b, _, d, e] = window {
            *slope = scale * (a - e + 8.0 * (d - b));
        }
    }
    let one_sided = |window: [f64; 5], weights: [f64; 5]| {
        scale * window.iter().zip(weights).map(|(v, weight)| v * weight).sum::<f64>()
    };
    let (outer, inner) = ([-25.0, 48.0, -36.0, 16.0, -3.0], [-3.0, -10.0, 18.0, -6.0, 1.0]);
    if let (Some(&first), Some(&last)) = (v.first_chunk::<5>(), v.last_chunk::<5>()) {
        let [a, b, c, d, e] = last;
        let ends = [
            (0, one_sided(first, outer)),
            (1, one_sided(first, inner)),
            (n - 2, -one_sided([e, d, c, b, a], inner)),
            (n - 1, -one_sided([e, d, c, b, a], outer)),
        ];
        for (k, value) in ends {
            if let Some(slope) = slopes.get_mut(k) {
                *slope = value;
            }
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::slope;

    #[test]
    fn polynomials_to_the_fourth_degree_have_their_derivatives() {
        let t = |k: usize| 0.3 * k as f64;
        let v: Vec<f64> =
            (0..12).map(|k| 1.0 - t(k) + 0.5 * t(k).powi(3) - 0.2 * t(k).powi(4)).collect();
        for (k, got) in slope(&v, 0.3).iter().enumerate() {
            let expected = -1.0 + 1.5 * t(k).powi(2) - 0.8 * t(k).powi(3);
            assert!((got - expected).abs() < 1e-10, "{k}: {got} {expected}");
        }
    }
}
