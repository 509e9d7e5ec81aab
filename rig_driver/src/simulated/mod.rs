//! The simulated test bed, lock-step and reproducible from a seed: what it is made of
//! ([`SimulationOptions`]), the rig ([`SimulatedRig`]), and how it is opened ([`SimulatedFactory`]).

mod factory;
mod options;
mod rig;

pub use factory::SimulatedFactory;
pub use options::SimulationOptions;
pub use rig::SimulatedRig;
