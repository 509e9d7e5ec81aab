//! The forces of every model are the same to the last bit from one version to the next.
//!
//! Figures that were published with one version can be had from a later one. A change of a model
//! that is meant shows here, and is written into the table by hand:
//! `cargo test -p friction_model --test models bits` prints the new row.

use friction_model::{AnyModel, FrictionModel, ModelName, ModelVisitor, Stepper, TimeStep, rk4};

/// A hash of the forces, for each model: of the presets one after the other, the fixed-step form,
/// with injection, and under Runge-Kutta.
const FORCES: &[(ModelName, [u64; 3])] = &[
    (ModelName::Coulomb, [0x0141b1870daedaf5, 0x7fb98fa2ede2c965, 0xbe05b3f82bed212c]),
    (ModelName::Viscous, [0xe77e92596d1040a1, 0x88ec1ac69d5ed4dd, 0xb84fe266d4ea2c8b]),
    (ModelName::CoulombViscous, [0x0174aeb4a9faa121, 0x1d0159c08c9daf89, 0x793d285485990214]),
    (ModelName::Stiction, [0x3538dc95d6aab4b1, 0x1d0159c08c9daf89, 0x793d285485990214]),
    (ModelName::Stribeck, [0xc4a90d4f3902a009, 0xe953c28f28a38d79, 0x9606df3abcaf00da]),
    (
        ModelName::RateDependentStiction,
        [0x3538dc95d6aab4b1, 0x1d0159c08c9daf89, 0x793d285485990214],
    ),
    (ModelName::Karnopp, [0xd4c1d615b6e56931, 0xee0b83c902318a29, 0x9606df3abcaf00da]),
    (ModelName::TwoLine, [0x0682e940975faf09, 0x8c9dfb666d5830fd, 0x1951170a2edfa7e0]),
    (ModelName::RbfNetwork, [0x5d99c777806e47b9, 0xc6b9214ba83cca09, 0x6f3aa0f75bb5a357]),
    (ModelName::BengisuAkay, [0x829e5dc5b6f3ce5d, 0xc82fe0dc8be7b591, 0xd06b46cc4121e9e3]),
    (ModelName::Wojewoda, [0x98ed29381b4c5505, 0xc3bf596211d5bff5, 0x0c3470519d4b749e]),
    (ModelName::Armstrong, [0x5b3282b9421722e5, 0xb528ab2dafefaee7, 0x3caf0f86d0553dc2]),
    (ModelName::Bristle, [0x50ba5fb65c6b7d5e, 0x1c38aa438a290384, 0x613cc3d39df60e45]),
    (ModelName::ResetIntegrator, [0xdb2a056f6be65d67, 0xcbf74f88cc41c285, 0xe84504b03b923aa9]),
    (ModelName::Dahl, [0xd9abf9c368bdfb17, 0x248fe88d454d06dc, 0xc1df185c4d098697]),
    (ModelName::BlimanSorine, [0xa2d717b319b30e9f, 0x5d435f91e5dd6d1d, 0x08c67121267c86f4]),
    (ModelName::LuGre, [0x2bc20e90e68597f1, 0x7b8528677175ca65, 0x31db0c077a892bbd]),
    (ModelName::ElastoPlastic, [0x0e467a318cc6a12e, 0x3af6517cbbeae82e, 0x98bf7e45a36ac2f1]),
    (ModelName::Leuven, [0x4736d83bc7657b9d, 0x0839ddde8a80e6af, 0x74125be4055c95e6]),
    (ModelName::Gms, [0x7fc93fc16cf28a02, 0x27f0d377b6531b20, 0x54065768450de3a8]),
    (ModelName::Xiong, [0x14b52b8b1dd399a8, 0x15e7caff4990dbed, 0x8b704241e5620178]),
    (ModelName::Proposed, [0xf528b71efac56a1b, 0x3988296e9a431956, 0xcd81412d07e867f7]),
    (ModelName::ProposedLinear, [0x3aaeca6452c70d24, 0xa21bfc7db59d9a02, 0xca5786090ede5a9c]),
];

/// Hash of Fowler, Noll and Vo (FNV-1a) over the bits of numbers.
struct Hash(u64);

impl Hash {
    const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, number: f64) {
        for byte in number.to_bits().to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

/// Sliding, creeping, reversals, nested loops and rest.
fn velocity(k: u32) -> f64 {
    let t = 1e-3 * f64::from(k);
    match k % 5000 {
        4000..4100 => 0.0,
        4100..4600 => 0.002 * (40.0 * t).sin() + 0.001 * (97.0 * t).sin(),
        _ => 0.02 + 0.25 * (3.0 * t).sin() + 0.01 * (41.0 * t).sin(),
    }
}

/// Adds the forces of the three schemes to their hashes.
struct Forces<'a>(&'a mut [Hash; 3]);

impl ModelVisitor for Forces<'_> {
    type Output = ();

    fn visit<M: FrictionModel>(self, model: M) {
        let [step, injected, integrated] = self.0;
        for seconds in [1e-3, 7e-3] {
            let dt = TimeStep::new(seconds).unwrap();
            let mut free = Stepper::new(model.clone(), dt);
            let mut pulled = Stepper::new(model.clone(), dt);
            for k in 0..10_000 {
                let v = velocity(k);
                step.add(free.step(v));
                let rate = if k % 3 == 0 { 0.0 } else { 0.01 * (0.01 * f64::from(k)).cos() };
                injected.add(pulled.step_injected(v, rate));
                if k % 50 == 0 {
                    let inside = free.internals(v);
                    step.add(inside.deflection);
                    step.add(inside.gamma);
                    step.add(model.steady_state(v));
                    step.add(model.stored_energy(free.state()).unwrap_or(0.0));
                }
            }
        }
        let mut state = model.rest();
        for k in 0..10_000 {
            let v = [2 * k, 2 * k + 1, 2 * k + 2].map(velocity);
            integrated.add(rk4::step(&model, &mut state, v, 2e-5));
        }
    }
}

#[test]
#[cfg_attr(
    not(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu")),
    ignore = "sin, exp and their like end in other digits on other systems"
)]
fn forces_are_what_they_always_were() {
    let mut wrong = String::new();
    for name in ModelName::ALL {
        let mut hashes = [const { Hash::new() }; 3];
        let (test_bed, chapter_3) = (AnyModel::test_bed(name), AnyModel::chapter_3(name));
        let both = AnyModel::asymmetric(&test_bed, &chapter_3).unwrap();
        for model in [test_bed, chapter_3, both] {
            model.visit(Forces(&mut hashes));
        }
        let found = hashes.map(|hash| hash.0);
        if FORCES.iter().find(|(row, _)| *row == name).is_none_or(|(_, told)| *told != found) {
            let [step, injected, integrated] = found.map(|hash| format!("{hash:#018x}"));
            wrong += &format!("    (ModelName::{name:?}, [{step}, {injected}, {integrated}]),\n");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}
