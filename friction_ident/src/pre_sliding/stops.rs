//! The stop: a spring that slips at its width.

/// The deflection of a stop of a given width along a path from the unloaded contact: it follows the
/// path and slips at `+-width`.
pub fn stops(width: f64, path: &[f64], out: &mut [f64]) {
    let (mut before, mut deflection) = (0.0, 0.0f64);
    for (&x, out) in path.iter().zip(out) {
        deflection = (deflection + (x - before)).max(-width).min(width);
        before = x;
        *out = deflection;
    }
}
