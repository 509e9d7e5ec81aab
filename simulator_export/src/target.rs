//! Where friction is exported to: every target with its versions, and what each can hold.

use std::fmt;

use strum::VariantArray;

use crate::facts::{
    BAM, C_HEADER, ISAAC_LAB, KS_KV_KA, MJCF, MJLAB, NEWTON, ROS2_CONTROL, SDF, UR, URDF,
    USD_NEWTON, USD_PHYSX,
};
use crate::{Facts, Release, Version};

/// What takes the friction.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Hash,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantArray,
)]
#[strum(serialize_all = "snake_case")]
pub enum Target {
    /// MuJoCo: a file to include.
    Mjcf,
    /// mjlab: a configuration in Python.
    Mjlab,
    /// Newton: a configuration in Python.
    Newton,
    /// Isaac Lab: a configuration in Python.
    IsaacLab,
    /// Unified Robot Description Format: a joint's `dynamics`.
    Urdf,
    /// SDFormat: a joint axis's `dynamics`.
    Sdf,
    /// USD: attributes of PhysX on a joint.
    UsdPhysx,
    /// USD: attributes of Newton on a joint.
    UsdNewton,
    /// `ros2_control`: parameters of a joint, for the hardware's component.
    Ros2Control,
    /// Universal Robots: scales of the arm's own friction model.
    Ur,
    /// BAM, Better Actuator Models: parameters in JSON.
    Bam,
    /// The gains kS, kV and kA of a feedforward.
    KsKvKa,
    /// A C header with a step function, for firmware.
    CHeader,
}

impl Target {
    /// All names, with commas.
    #[must_use]
    pub fn list() -> String {
        let names: Vec<&str> = Self::VARIANTS.iter().map(|target| target.name()).collect();
        names.join(", ")
    }

    /// The target of that name, however it is written; none for another name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        name.trim().to_lowercase().replace(['-', ' '], "_").parse().ok()
    }

    /// As options name it.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// What is known of it.
    #[must_use]
    pub const fn facts(self) -> &'static Facts {
        match self {
            Self::Mjcf => &MJCF,
            Self::Mjlab => &MJLAB,
            Self::Newton => &NEWTON,
            Self::IsaacLab => &ISAAC_LAB,
            Self::Urdf => &URDF,
            Self::Sdf => &SDF,
            Self::UsdPhysx => &USD_PHYSX,
            Self::UsdNewton => &USD_NEWTON,
            Self::Ros2Control => &ROS2_CONTROL,
            Self::Ur => &UR,
            Self::Bam => &BAM,
            Self::KsKvKa => &KS_KV_KA,
            Self::CHeader => &C_HEADER,
        }
    }

    /// Whether any version of it has a place for the rotor's inertia.
    #[must_use]
    pub const fn has_armature(self) -> bool {
        matches!(
            self,
            Self::Mjcf
                | Self::Mjlab
                | Self::Newton
                | Self::IsaacLab
                | Self::UsdPhysx
                | Self::UsdNewton
                | Self::Bam
        )
    }

    /// Whether any version of it has a place for cogging.
    #[must_use]
    pub const fn has_cogging(self) -> bool {
        matches!(self, Self::Mjcf | Self::Mjlab | Self::Newton)
    }

    /// The earliest and the newest version that are known.
    #[must_use]
    pub fn known(self) -> (Version, Version) {
        let Facts { releases, newest, .. } = *self.facts();
        (releases.first().map_or(newest, |release| release.since), newest)
    }

    /// What is true of a version; none for one that is not known.
    #[must_use]
    pub fn release(self, version: Version) -> Option<&'static Release> {
        let Facts { releases, newest, .. } = self.facts();
        releases.iter().rev().find(|release| release.since <= version && version <= *newest)
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Holds;

    #[test]
    fn every_target_has_its_versions_in_order() {
        for &target in Target::VARIANTS {
            assert_eq!(Target::named(target.name()), Some(target));
            let facts = target.facts();
            assert!(
                facts.releases.windows(2).all(|pair| pair[0].since < pair[1].since),
                "{target}"
            );
            assert!(
                facts.releases.last().is_some_and(|last| last.since <= facts.newest),
                "{target}"
            );
            assert!(target.release(facts.newest).is_some());
        }
    }

    #[test]
    fn a_version_has_what_the_last_change_before_it_brought() {
        let holds = |text: &str| Target::Mjcf.release(text.parse().unwrap()).unwrap().holds;
        assert_eq!([holds("3.6"), holds("2.3.7")], [Holds::CoulombViscous; 2]);
        assert_eq!([holds("3.7"), holds("3.11"), holds("4.0.1")], [Holds::LuGre; 3]);
        for text in ["4.1", "1.50", "5"] {
            assert_eq!(Target::Mjcf.release(text.parse().unwrap()), None, "{text}");
        }
        assert_eq!(Target::named("mujoko"), None);
        assert_eq!(Target::named(" C-Header"), Some(Target::CHeader));
    }
}
