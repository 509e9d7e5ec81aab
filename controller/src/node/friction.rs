//! A friction estimate, as the control step takes it.

/// One friction estimate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Friction {
    /// Time of the measurement behind it \[ns since the epoch\]; zero for none.
    pub stamp_ns: u64,
    /// Estimated friction torque \[N m\].
    pub torque: f64,
}
