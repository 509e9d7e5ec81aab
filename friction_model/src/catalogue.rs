//! The one list of all models, and what is made from it: the names, and the enums that hold any
//! model, its parameters or its stepper.

#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

use crate::presets::Presets;
use crate::*;

/// Something to do with a model whose type is only known while the program runs.
pub trait ModelVisitor {
    /// What comes of it.
    type Output;

    /// Does it with `model`.
    fn visit<M>(self, model: M) -> Self::Output
    where
        M: FrictionModel<Continuous: Send + Sync, Memory: Send + Sync, Discrete: Send + Sync>
            + Send
            + Sync
            + 'static;
}

/// Something to do with a model in numbers of type `T` whose type is only known while the program
/// runs.
pub trait VisitorIn<T: Real> {
    /// What comes of it.
    type Output;

    /// Does it with `model`.
    fn visit<M: FrictionModel<T>>(self, model: M) -> Self::Output;
}

/// Makes everything that must know every model. Each line: the name, as files spell it, as headings
/// spell it, the parameters, and the types that run it, those with elements with their room: the first
/// that has room for the parameters is taken.
macro_rules! models {
    ($($name:ident $text:literal $title:literal $parameters:ident: $($variant:ident($model:ident $([$room:literal])?)),+;)+) => {
        /// Which friction model.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
        pub enum ModelName {
            $(#[doc = $title] #[cfg_attr(feature = "serde", serde(rename = $text))] $name,)+
        }

        impl ModelName {
            /// Every model, in the order of the documentation.
            pub const ALL: [Self; [$($text),+].len()] = [$(Self::$name),+];

            /// The name in files and on the command line.
            #[must_use]
            pub const fn as_str(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)+
                }
            }

            /// The name in headings and legends.
            #[must_use]
            pub const fn title(self) -> &'static str {
                match self {
                    $(Self::$name => $title,)+
                }
            }
        }

        /// The parameters of a model chosen by name, as files carry them: the name, and the
        /// parameters under it; or `asymmetric`, under it the name, and under that `forward` and
        /// `backward` with the parameters of each direction.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
        #[expect(clippy::large_enum_variant, reason = "lists live in place: no allocation")]
        pub enum AnyParameters {
            $(#[doc = $title] #[cfg_attr(feature = "serde", serde(rename = $text))] $name($parameters),)+
            /// Parameters for each direction.
            #[cfg_attr(feature = "serde", serde(rename = "asymmetric"))]
            Asymmetric(AsymmetricParameters),
        }

        /// The parameters of an [`Asymmetric`] contact of a model chosen by name.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
        #[expect(clippy::large_enum_variant, reason = "lists live in place: no allocation")]
        pub enum AsymmetricParameters {
            $(#[doc = $title] #[cfg_attr(feature = "serde", serde(rename = $text))] $name(BothWays<$parameters>),)+
        }

        /// A friction model chosen by name, with valid parameters. In files it looks as its
        /// [`AnyParameters`].
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
        #[cfg_attr(feature = "serde", serde(try_from = "AnyParameters", into = "AnyParameters"))]
        #[expect(clippy::large_enum_variant, reason = "models live in place: no allocation, and they can be copied")]
        pub enum AnyModel {
            $($(#[doc = $title] $variant($model$(<$room>)?),)+)+
            /// Any of them with parameters for each direction.
            Asymmetric(AsymmetricModel),
        }

        /// An [`Asymmetric`] contact of a model chosen by name.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[expect(clippy::large_enum_variant, reason = "models live in place: no allocation, and they can be copied")]
        pub enum AsymmetricModel {
            $($(#[doc = $title] $variant(Asymmetric<$model$(<$room>)?>),)+)+
        }

        /// A running model of any kind: a [`Stepper`] chosen while the program runs.
        #[derive(Debug, Clone)]
        #[expect(clippy::large_enum_variant, reason = "states live in place: the step path does not allocate")]
        pub enum AnyStepper {
            $($(#[doc = $title] $variant(Stepper<$model$(<$room>)?>),)+)+
            /// Any of them with parameters for each direction.
            Asymmetric(AsymmetricStepper),
        }

        /// A running [`Asymmetric`] contact of any kind.
        #[derive(Debug, Clone)]
        pub enum AsymmetricStepper {
            $($(#[doc = $title] $variant(Stepper<Asymmetric<$model$(<$room>)?>>),)+)+
        }

        impl AnyParameters {
            /// The test bed's parameters of the model of that name.
            #[must_use]
            pub fn test_bed(name: ModelName) -> Self {
                match name {
                    $(ModelName::$name => Self::$name(Presets::test_bed()),)+
                }
            }

            /// The parameters of the thesis's chapter 3 of the model of that name.
            #[must_use]
            pub fn chapter_3(name: ModelName) -> Self {
                match name {
                    $(ModelName::$name => Self::$name(Presets::chapter_3()),)+
                }
            }

            /// The name of the model.
            #[must_use]
            pub const fn name(&self) -> ModelName {
                match self {
                    $(Self::$name(_) | Self::Asymmetric(AsymmetricParameters::$name(_)) => ModelName::$name,)+
                }
            }

            /// Parameters for the forward and the backward direction; the same twice unless they
            /// are asymmetric.
            #[must_use]
            pub const fn sides(&self) -> (Self, Self) {
                match *self {
                    $(Self::Asymmetric(AsymmetricParameters::$name(both)) =>
                        (Self::$name(both.forward), Self::$name(both.backward)),)+
                    symmetric => (symmetric, symmetric),
                }
            }

            /// `forward` against forward motion and `backward` against backward motion.
            ///
            /// # Errors
            /// [`ModelError::TwoModels`] if they are of different models, or asymmetric themselves.
            pub const fn asymmetric(forward: Self, backward: Self) -> Result<Self, ModelError> {
                match (forward, backward) {
                    $((Self::$name(forward), Self::$name(backward)) =>
                        Ok(Self::Asymmetric(AsymmetricParameters::$name(BothWays { forward, backward }))),)+
                    _ => Err(ModelError::TwoModels { forward: forward.name(), backward: backward.name() }),
                }
            }

            /// The table of the model's parameters.
            #[must_use]
            pub const fn table(&self) -> &'static [Parameter] {
                match self.name() {
                    $(ModelName::$name => <$parameters as ParameterSet>::TABLE,)+
                }
            }

            /// Calls `f` with every number of the parameter `name`, of an asymmetric contact first
            /// the forward ones.
            pub fn each(&self, name: &str, f: &mut dyn FnMut(f64)) {
                match self {
                    $(Self::$name(parameters) => parameters.each(name, f),)+
                    Self::Asymmetric(_) => {
                        let (forward, backward) = self.sides();
                        forward.each(name, f);
                        backward.each(name, f);
                    }
                }
            }

            /// Multiplies the parameter `name` by `factor`, in both directions; false if there is
            /// none of that name.
            pub fn scale(&mut self, name: &str, factor: f64) -> bool {
                match self {
                    $(
                        Self::$name(parameters) => parameters.scale(name, factor),
                        Self::Asymmetric(AsymmetricParameters::$name(both)) =>
                            both.forward.scale(name, factor) && both.backward.scale(name, factor),
                    )+
                }
            }
        }

        impl AnyParameters {
            /// Sets the parameter `name` to `value`, in both directions; false if there is none of
            /// that name, or if it is a list.
            pub fn set(&mut self, name: &str, value: f64) -> bool {
                match self {
                    $(
                        Self::$name(parameters) => parameters.set(name, value),
                        Self::Asymmetric(AsymmetricParameters::$name(both)) =>
                            both.forward.set(name, value) && both.backward.set(name, value),
                    )+
                }
            }

            /// Sets the number at `index` of the parameter `name` to `value`, in both directions;
            /// false if there is none.
            pub fn set_at(&mut self, name: &str, index: usize, value: f64) -> bool {
                match self {
                    $(
                        Self::$name(parameters) => parameters.set_at(name, index, value),
                        Self::Asymmetric(AsymmetricParameters::$name(both)) =>
                            both.forward.set_at(name, index, value) && both.backward.set_at(name, index, value),
                    )+
                }
            }

            /// The numbers of the parameter `name`, of an asymmetric contact the forward ones;
            /// empty if there is none.
            #[cfg(feature = "std")]
            #[must_use]
            pub fn values(&self, name: &str) -> Vec<f64> {
                let (forward, _) = self.sides();
                let mut values = Vec::new();
                forward.each(name, &mut |value| values.push(value));
                values
            }
        }

        impl AnyParameters {
            /// Builds the model in numbers of type `T` and does something with it. `number` says
            /// what a parameter becomes: it is given whether it is one against backward motion of
            /// an asymmetric contact, its name, the place in its list (zero for one that is no
            /// list) and its value.
            /// None if the model does not accept the numbers.
            pub fn visit_in<T: Real, V: VisitorIn<T>>(
                &self,
                number: &mut dyn FnMut(bool, &'static str, usize, f64) -> T,
                visitor: V,
            ) -> Option<V::Output> {
                match self {
                    $(
                        Self::$name(parameters) => {
                            let parameters = parameters.translate(
                                &mut |name, index, value| number(false, name, index, value),
                            );
                            $(
                                if let Ok(model) = <$model<$($room,)? T>>::try_from(parameters) {
                                    return Some(visitor.visit(model));
                                }
                            )+
                        }
                        Self::Asymmetric(AsymmetricParameters::$name(both)) => {
                            let ahead = both.forward.translate(
                                &mut |name, index, value| number(false, name, index, value),
                            );
                            let back = both.backward.translate(
                                &mut |name, index, value| number(true, name, index, value),
                            );
                            $(
                                let forward = <$model<$($room,)? T>>::try_from(ahead);
                                let backward = <$model<$($room,)? T>>::try_from(back);
                                if let (Ok(forward), Ok(backward)) = (forward, backward) {
                                    return Some(visitor.visit(Asymmetric { forward, backward }));
                                }
                            )+
                        }
                    )+
                }
                None
            }
        }

        impl TryFrom<AnyParameters> for AnyModel {
            type Error = ModelError;

            fn try_from(parameters: AnyParameters) -> Result<Self, ModelError> {
                match parameters {
                    $(
                        AnyParameters::$name(p) => Err(ModelError::TimeStep(0.0))
                            $(.or_else(|_: ModelError| <$model$(<$room>)?>::try_from(p).map(Self::$variant)))+,
                        AnyParameters::Asymmetric(AsymmetricParameters::$name(BothWays { forward, backward })) => {
                            Err(ModelError::TimeStep(0.0))
                            $(.or_else(|_: ModelError| {
                                let (forward, backward) = (forward.try_into()?, backward.try_into()?);
                                Ok(Self::Asymmetric(AsymmetricModel::$variant(Asymmetric::<$model$(<$room>)?> { forward, backward })))
                            }))+
                        }
                    )+
                }
            }
        }

        impl From<AnyModel> for AnyParameters {
            fn from(model: AnyModel) -> Self {
                match model {
                    $($(
                        AnyModel::$variant(model) => Self::$name(*model.parameters()),
                        AnyModel::Asymmetric(AsymmetricModel::$variant(Asymmetric { forward, backward })) => {
                            let (forward, backward) = (*forward.parameters(), *backward.parameters());
                            Self::Asymmetric(AsymmetricParameters::$name(BothWays { forward, backward }))
                        }
                    )+)+
                }
            }
        }

        impl AnyModel {
            /// Which model it is; an asymmetric contact has the name of its model.
            #[must_use]
            pub const fn name(&self) -> ModelName {
                match self {
                    $($(Self::$variant(_) | Self::Asymmetric(AsymmetricModel::$variant(_)) => ModelName::$name,)+)+
                }
            }

            /// Does something with the model itself.
            pub fn visit<V: ModelVisitor>(self, visitor: V) -> V::Output {
                match self {
                    $($(
                        Self::$variant(model) => visitor.visit(model),
                        Self::Asymmetric(AsymmetricModel::$variant(model)) => visitor.visit(model),
                    )+)+
                }
            }

            /// The force after a long time at constant `velocity`, see
            /// [`FrictionModel::steady_state`].
            #[must_use]
            pub fn steady_state(&self, velocity: f64) -> f64 {
                match self {
                    $($(
                        Self::$variant(model) => model.steady_state(velocity),
                        Self::Asymmetric(AsymmetricModel::$variant(model)) => model.steady_state(velocity),
                    )+)+
                }
            }

            /// Starts the model at rest with the period `dt`, each velocity held for it.
            #[must_use]
            pub fn start(&self, dt: TimeStep) -> AnyStepper {
                self.start_by(Scheme::Held, dt)
            }

            /// Starts the model at rest with the period `dt`, stepped by `scheme`.
            #[must_use]
            pub fn start_by(&self, scheme: Scheme, dt: TimeStep) -> AnyStepper {
                match *self {
                    $($(
                        Self::$variant(model) => AnyStepper::$variant(Stepper::by(scheme, model, dt)),
                        Self::Asymmetric(AsymmetricModel::$variant(model)) =>
                            AnyStepper::Asymmetric(AsymmetricStepper::$variant(Stepper::by(scheme, model, dt))),
                    )+)+
                }
            }
        }

        impl AsymmetricStepper {
            /// The friction now at `velocity`; the state then advances by one period. Apart from
            /// [`AnyStepper::step`], which stays smaller and faster for it.
            #[inline(never)]
            fn step(&mut self, velocity: f64) -> f64 {
                match self {
                    $($(Self::$variant(stepper) => stepper.step(velocity),)+)+
                }
            }
        }

        impl AnyStepper {
            /// Which model runs.
            #[must_use]
            pub const fn name(&self) -> ModelName {
                match self {
                    $($(Self::$variant(_) | Self::Asymmetric(AsymmetricStepper::$variant(_)) => ModelName::$name,)+)+
                }
            }

            /// How velocities between two steps are taken.
            #[must_use]
            pub const fn scheme(&self) -> Scheme {
                match self {
                    $($(
                        Self::$variant(stepper) => stepper.scheme(),
                        Self::Asymmetric(AsymmetricStepper::$variant(stepper)) => stepper.scheme(),
                    )+)+
                }
            }

            /// The friction now at `velocity`; the state then advances by one period. See
            /// [`Stepper::step`].
            #[inline]
            pub fn step(&mut self, velocity: f64) -> f64 {
                match self {
                    $($(Self::$variant(stepper) => stepper.step(velocity),)+)+
                    Self::Asymmetric(stepper) => stepper.step(velocity),
                }
            }

            /// [`step`](Self::step) with an extra `rate` in the derivative of every continuous
            /// state. See [`Stepper::step_injected`].
            #[inline]
            pub fn step_injected(&mut self, velocity: f64, rate: f64) -> f64 {
                match self {
                    $($(
                        Self::$variant(stepper) => stepper.step_injected(velocity, rate),
                        Self::Asymmetric(AsymmetricStepper::$variant(stepper)) => stepper.step_injected(velocity, rate),
                    )+)+
                }
            }

            /// The part of the force at `velocity` that is viscous, see [`FrictionModel::viscous`].
            #[inline]
            #[must_use]
            pub fn viscous(&self, velocity: f64) -> f64 {
                match self {
                    $($(
                        Self::$variant(stepper) => stepper.viscous(velocity),
                        Self::Asymmetric(AsymmetricStepper::$variant(stepper)) => stepper.viscous(velocity),
                    )+)+
                }
            }

            /// Back to rest.
            pub fn reset(&mut self) {
                match self {
                    $($(
                        Self::$variant(stepper) => stepper.reset(),
                        Self::Asymmetric(AsymmetricStepper::$variant(stepper)) => stepper.reset(),
                    )+)+
                }
            }

            /// The inner quantities at `velocity`.
            #[inline]
            #[must_use]
            pub fn internals(&self, velocity: f64) -> Internals {
                match self {
                    $($(
                        Self::$variant(stepper) => stepper.internals(velocity),
                        Self::Asymmetric(AsymmetricStepper::$variant(stepper)) => stepper.internals(velocity),
                    )+)+
                }
            }
        }
    };
}

models! {
    Coulomb "coulomb" "Coulomb" CoulombParameters: Coulomb(Coulomb);
    Viscous "viscous" "Viscous" ViscousParameters: Viscous(Viscous);
    CoulombViscous "coulomb_viscous" "Coulomb and viscous" CoulombViscousParameters: CoulombViscous(CoulombViscous);
    Stiction "stiction" "Stiction" StictionParameters: Stiction(Stiction);
    Stribeck "stribeck" "Stribeck" StribeckParameters: Stribeck(Stribeck);
    RateDependentStiction "rate_dependent_stiction" "Rate-dependent stiction" RateDependentStictionParameters:
        RateDependentStiction(RateDependentStiction);
    Karnopp "karnopp" "Karnopp" KarnoppParameters: Karnopp(Karnopp);
    TwoLine "two_line" "Two lines" TwoLineParameters: TwoLine(TwoLine);
    RbfNetwork "rbf_network" "RBF network" RbfNetworkParameters: RbfNetwork(RbfNetwork);
    BengisuAkay "bengisu_akay" "Bengisu-Akay" BengisuAkayParameters: BengisuAkay(BengisuAkay);
    Wojewoda "wojewoda" "Wojewoda" WojewodaParameters: Wojewoda(Wojewoda);
    Armstrong "armstrong" "Armstrong, seven parameters" ArmstrongParameters: Armstrong(Armstrong);
    Bristle "bristle" "Bristle" BristleParameters: Bristle(Bristle);
    ResetIntegrator "reset_integrator" "Reset integrator" ResetIntegratorParameters: ResetIntegrator(ResetIntegrator);
    Dahl "dahl" "Dahl" DahlParameters: Dahl(Dahl);
    BlimanSorine "bliman_sorine" "Bliman-Sorine" BlimanSorineParameters: BlimanSorine(BlimanSorine);
    LuGre "lugre" "LuGre" LuGreParameters: LuGre(LuGre);
    ElastoPlastic "elasto_plastic" "Elasto-plastic" ElastoPlasticParameters: ElastoPlastic(ElastoPlastic);
    Leuven "leuven" "Leuven" LeuvenParameters: Leuven(Leuven);
    Gms "gms" "GMS" GmsParameters: Gms(Gms[4]), Gms16(Gms[16]);
    Xiong "xiong" "Xiong" XiongParameters: Xiong(Xiong[4]), Xiong16(Xiong[16]);
    Proposed "proposed" "Proposed" ProposedParameters: Proposed(Proposed);
    ProposedLinear "proposed_linear" "Proposed, straight branches" ProposedParameters: ProposedLinear(ProposedLinear);
}

/// Parameters for each direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct BothWays<P> {
    /// Against forward motion.
    pub forward: P,
    /// Against backward motion.
    pub backward: P,
}
