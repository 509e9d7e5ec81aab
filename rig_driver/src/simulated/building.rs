//! A simulated rig from its options.

use friction_model::{AnyModel, FrictionModel, ModelVisitor};

use super::SimulatedRig;
use crate::safety::{SafetyLimits, Supervised};
use crate::{Rig, RigError, SimulationOptions};

impl SimulationOptions {
    /// The same rig under the safety layer, with the limits that follow from these options.
    #[must_use]
    pub fn supervised(self) -> Self {
        Self { safety: Some(SafetyLimits::for_simulation(&self)), ..self }
    }

    /// The simulated rig under a friction model chosen while the program runs; active, if it is
    /// under the safety layer.
    ///
    /// # Errors
    /// [`RigError`] names the option that is out of range.
    pub fn build(self, model: AnyModel) -> Result<Box<dyn Rig + Send>, RigError> {
        model.visit(Build(self))
    }
}

/// Builds the rig around a model whose type is known.
struct Build(SimulationOptions);

impl ModelVisitor for Build {
    type Output = Result<Box<dyn Rig + Send>, RigError>;

    fn visit<M>(self, model: M) -> Self::Output
    where
        M: FrictionModel<Continuous: Send + Sync, Memory: Send + Sync, Discrete: Send + Sync>
            + Send
            + Sync
            + 'static,
    {
        let rig = SimulatedRig::new(self.0, model)?;
        Ok(match self.0.safety {
            None => Box::new(rig),
            Some(limits) => Box::new(Supervised::activated(rig, limits)?),
        })
    }
}
