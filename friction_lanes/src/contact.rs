//! Contacts side by side under one velocity.

use crate::block::Block;

/// The contacts of a block, all under the same velocity. Each method does in every lane what the
/// method of its name in [`FrictionModel`](friction_model::FrictionModel) does; velocities are
/// [bounded](friction_model::arithmetic::bounded).
pub trait Contact {
    /// The friction now, after which the velocity is held for a period.
    fn step<const FUSED: bool>(&mut self, velocity: f64) -> Block;

    /// A period in which the velocity goes from one to the other. `mean` is the mean of both.
    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, mean: f64) {
        self.step::<FUSED>(mean);
    }

    /// The friction in this state.
    fn force<const FUSED: bool>(&self, velocity: f64) -> Block;
}
