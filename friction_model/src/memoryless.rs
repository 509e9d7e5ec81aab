//! What a model whose force depends on the velocity alone has no need of: states, memory and
//! coefficients of the period.

/// The items of [`crate::FrictionModel`] that are the same for every model without states: the
/// fixed-step form is the steady state, and so is the derivative form unless another method is
/// named.
macro_rules! memoryless {
    ($set:ty) => {
        memoryless!($set, steady_state);
    };
    ($set:ty, $force:ident) => {
        type Parameters = $set;
        type Continuous = [f64; 0];
        type Memory = ();
        type Discrete = ();

        fn parameters(&self) -> &$set {
            &self.parameters
        }

        fn rest(&self) -> $crate::State<[f64; 0], ()> {
            $crate::State { continuous: [], memory: () }
        }

        #[inline]
        fn evaluate(&self, _: &[f64; 0], (): &(), velocity: f64) -> $crate::Evaluation<[f64; 0]> {
            $crate::Evaluation { force: self.$force(velocity), rates: [] }
        }

        fn commit(&self, _: &mut $crate::State<[f64; 0], ()>, _: f64, _: f64) {}

        fn discretise(&self, _: $crate::TimeStep) {}

        #[inline]
        fn step(&self, (): &(), _: &mut $crate::State<[f64; 0], ()>, velocity: f64) -> f64 {
            self.steady_state($crate::model::bounded(velocity))
        }
    };
}

pub(crate) use memoryless;
