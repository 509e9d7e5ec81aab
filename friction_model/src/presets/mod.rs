//! Parameter sets of the 2017 thesis on position and velocity drives subject to friction
//! (A. C. Nnaji): somewhere to start from, and what the tests and the pages of the models use.
//!
//! ```
//! use friction_model::{LuGre, LuGreParameters, presets::Presets};
//!
//! let stiffer = LuGreParameters { sigma0: 30.0, ..LuGreParameters::test_bed() };
//! let model = LuGre::try_from(stiffer)?;
//! assert_ne!(model, LuGre::test_bed());
//! # Ok::<(), friction_model::ModelError>(())
//! ```

mod dynamic;
mod memoryless;

use crate::*;

/// Parameter sets that every built-in model has.
pub trait Presets: ParameterSet {
    /// The thesis's test bed (tables 4.13 to 4.16, harmonised; N m, rad, s), or for models that it
    /// does not fit there, the values that give the same levels.
    fn test_bed() -> Self;

    /// The default set of the thesis's chapter 3 (N, m, s), likewise.
    fn chapter_3() -> Self;
}

/// The sets as models: the model of the test bed, and that of chapter 3.
macro_rules! models {
    ($($test_bed:ty, $chapter_3:ty: $set:ident;)+) => {
        $(
            impl $test_bed {
                /// With the parameters of the thesis's test bed, see [`Presets`].
                ///
                /// # Panics
                /// Never: a test builds it.
                #[must_use]
                pub fn test_bed() -> Self {
                    $set::test_bed().try_into().expect("constants within range")
                }
            }

            impl $chapter_3 {
                /// With the default parameters of the thesis's chapter 3 (N, m, s), see
                /// [`Presets`].
                ///
                /// # Panics
                /// Never: a test builds it.
                #[must_use]
                pub fn chapter_3() -> Self {
                    $set::chapter_3().try_into().expect("constants within range")
                }
            }
        )+
    };
}

models! {
    Coulomb, Coulomb: CoulombParameters;
    Viscous, Viscous: ViscousParameters;
    CoulombViscous, CoulombViscous: CoulombViscousParameters;
    Stiction, Stiction: StictionParameters;
    Stribeck, Stribeck: StribeckParameters;
    RateDependentStiction, RateDependentStiction: RateDependentStictionParameters;
    Karnopp, Karnopp: KarnoppParameters;
    TwoLine, TwoLine: TwoLineParameters;
    RbfNetwork, RbfNetwork: RbfNetworkParameters;
    BengisuAkay, BengisuAkay: BengisuAkayParameters;
    Wojewoda, Wojewoda: WojewodaParameters;
    Armstrong, Armstrong: ArmstrongParameters;
    Bristle, Bristle: BristleParameters;
    ResetIntegrator, ResetIntegrator: ResetIntegratorParameters;
    Dahl, Dahl: DahlParameters;
    BlimanSorine, BlimanSorine: BlimanSorineParameters;
    LuGre, LuGre: LuGreParameters;
    ElastoPlastic, ElastoPlastic: ElastoPlasticParameters;
    Leuven, Leuven: LeuvenParameters;
    Gms<4>, Gms<10>: GmsParameters;
    Xiong<4>, Xiong<10>: XiongParameters;
    Proposed, Proposed: ProposedParameters;
    ProposedLinear, ProposedLinear: ProposedParameters;
}
