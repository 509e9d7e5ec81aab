//! What is read between two samples.

/// What lies between two samples, a `part` of the way to the second one. Of a quantiser it keeps to
/// the steps, and where that is one of the two samples it is that one, digit by digit: a difference
/// of rounding would be taken for a step.
pub(super) fn between([here, there]: [f64; 2], part: f64, step: Option<f64>) -> f64 {
    let way = part * (there - here);
    let Some(step) = step else { return here + way };
    let found = here + (way / step).round() * step;
    if (found - there).abs() < 0.5 * step { there } else { found }
}
