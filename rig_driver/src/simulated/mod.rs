//! The simulated test bed, lock-step and reproducible from a seed: how it is built from what it is
//! made of ([`SimulationOptions`](crate::SimulationOptions)), its limits, the rig ([`SimulatedRig`]), and how it is opened ([`SimulatedFactory`]).

mod building;
mod factory;
mod limits;
mod rig;

pub use factory::SimulatedFactory;
pub use rig::SimulatedRig;
