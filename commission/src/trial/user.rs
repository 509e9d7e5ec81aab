//! What the user's file says of limits: that of some users contradicts itself or the rig.

use machine_rig::Machine;
use rig_driver::safety::Travel;
use rig_setup::RigLimits;

/// One user in so many makes such a mistake.
const ONE_IN: u64 = 25;

/// A mistake in the user's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mistake {
    /// More voltage than the amplifier has.
    Voltage,
    /// A travel that ends before it begins.
    Travel,
    /// A speed below zero.
    Speed,
    /// Commands are lost before they are late.
    Time,
}

impl Mistake {
    const ALL: [Self; 4] = [Self::Voltage, Self::Travel, Self::Speed, Self::Time];

    /// What the machine's user made, if any: a function of its seed.
    pub(super) fn of(machine: &Machine) -> Option<Self> {
        // Knuth's linear congruence; its upper bits are used.
        let draw = machine.seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1) >> 33;
        draw.is_multiple_of(ONE_IN).then(|| Self::ALL[(draw / ONE_IN) as usize % Self::ALL.len()])
    }

    /// The limits with the mistake in them.
    pub(super) fn made(self, machine: &Machine) -> RigLimits {
        let limits = machine.limits;
        match self {
            Self::Voltage => RigLimits { voltage: Some(1.5 * machine.voltage_range), ..limits },
            Self::Travel => {
                let travel = Some(Travel { min: 1.0, max: -1.0, margin: 0.0 });
                RigLimits { travel, ..limits }
            }
            Self::Speed => RigLimits { velocity: Some(-1.0), ..limits },
            Self::Time => RigLimits { cycle_late: Some(0.4), command_lost: Some(0.001), ..limits },
        }
    }

    /// Whether a refusal names it.
    pub(super) fn is_named(self, why: &str) -> bool {
        let word = match self {
            Self::Voltage => "voltage",
            Self::Travel => "travel",
            Self::Speed => "velocity",
            Self::Time => "command_lost",
        };
        why.contains(word)
    }
}

#[cfg(test)]
mod tests {
    use machine_rig::random;

    use super::*;

    #[test]
    fn a_few_of_a_hundred_users_make_each_of_the_mistakes() {
        let all: Vec<Mistake> =
            (0..1000).filter_map(|seed| Mistake::of(&random::machine(seed))).collect();
        assert!((20..=60).contains(&all.len()), "{}", all.len());
        assert!(Mistake::ALL.iter().all(|one| all.contains(one)), "{all:?}");
    }

    #[test]
    fn each_is_refused_by_its_name_before_anything_moves() {
        // Another test of this program may have done it.
        let _ = rig_driver::RigRegistry::standard().with(machine_rig::MachineFactory).install();
        let folder = tempfile::tempdir().unwrap();
        for mistake in Mistake::ALL {
            let made = |seed: &u64| Mistake::of(&random::machine(*seed)) == Some(mistake);
            let seed = (0..).find(made).unwrap();
            let machine = random::machine(seed);
            let file = folder.path().join(format!("{seed}.json"));
            std::fs::write(&file, machine.text().unwrap()).unwrap();
            let wanted = crate::friction::wanted::Wanted::default();
            let asked = (&wanted, 600.0, None);
            let found =
                super::super::case(&machine, &file, folder.path(), asked, &Default::default());
            let found = found.unwrap();
            assert!(found.cannot && found.rightly, "{mistake:?}: {:?}", found.refused);
        }
    }
}
