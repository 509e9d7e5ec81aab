//! The Stribeck curve between rest and sliding.

/// `exp(-(v/v_s)^2)` (Stribeck; thesis eq. 2.9 with exponent 2), and its derivative with respect to
/// `v_s`.
pub(super) fn dip(v: f64, v_s: f64) -> (f64, f64) {
    let ratio = (v / v_s).powi(2);
    let near = (-ratio).exp();
    (near, 2.0 * near * ratio / v_s)
}
