//! Macros with which a model is declared, in this crate and outside it: its parameters once, what
//! ties it to them, and what models without states have in common.

/// Declares the parameters of a model: the struct that files carry and its
/// [`ParameterSet`](crate::ParameterSet) table in one place.
///
/// A field is its documentation (with the unit in brackets), a serde attribute where it may be left
/// out, then `name: type, Unit, Range;`. Square brackets are escaped, as rustdoc takes them for a
/// link otherwise; [`Parameter::meaning`](crate::Parameter::meaning) has them without. A type is
/// `f64`, `Option<f64>`, `u32` or [`Elements`](crate::Elements); [`Value`](crate::Value) can be
/// implemented for more. With the feature `serde`, the struct is read and written by field names,
/// and a name that it does not have is an error.
///
/// With `Set<T>` for the name, and `T` for `f64` in the types, the parameters are generic over
/// [`Real`](crate::Real), and have a method `cast` into another precision and one, `translate`, into
/// numbers of another kind.
///
/// ```
/// use friction_model::{ParameterSet, Range, parameters};
///
/// parameters! {
///     /// Parameters of a spring.
///     SpringParameters {
///         /// Stiffness k \[N/m\], above zero.
///         k: f64, Stiffness, Range::Positive;
///         /// Force at rest \[N\]; zero if left out.
///         #[serde(default)]
///         f_0: f64, Force, Range::Any;
///     }
/// }
///
/// let wrong = SpringParameters { k: -2.0, f_0: 0.0 };
/// assert_eq!(
///     wrong.check("spring").unwrap_err().to_string(),
///     "spring.k must be a finite number above zero, but is -2 N m/rad; change it in the parameter file",
/// );
/// assert!(SpringParameters::TABLE[1].optional);
/// assert_eq!(SpringParameters::TABLE[0].meaning, "Stiffness k [N/m], above zero.");
/// ```
#[macro_export]
macro_rules! parameters {
    (
        $(#[doc = $about:literal])+
        $set:ident $(<$real:ident>)? {
            $(
                $(#[doc = $doc:literal])+
                $(#[serde($($serde:tt)+)])?
                $field:ident: $kind:ty, $unit:ident, $range:expr;
            )*
        }
    ) => {
        $crate::__with_serde! {
            {
                $(#[doc = $about])+
                #[derive(
                    Debug, Clone, Copy, PartialEq,
                    $crate::__serde::Serialize, $crate::__serde::Deserialize,
                )]
                #[serde(deny_unknown_fields, crate = "friction_model::__serde", bound = "")]
                pub struct $set $(<$real: $crate::Real = f64>)? {
                    $(
                        $(#[doc = $doc])+
                        $(#[serde($($serde)+)])?
                        pub $field: $kind,
                    )*
                }
            }
            {
                $(#[doc = $about])+
                #[derive(Debug, Clone, Copy, PartialEq)]
                pub struct $set $(<$real: $crate::Real = f64>)? {
                    $($(#[doc = $doc])+ pub $field: $kind,)*
                }
            }
        }

        $crate::__cast! { $set [$($real)?] $($field)* }

        impl $(<$real: $crate::Real>)? $crate::ParameterSet for $set $(<$real>)? {
            const TABLE: &'static [$crate::Parameter] = &[
                $($crate::Parameter {
                    name: stringify!($field),
                    meaning: {
                        const TEXT: &str = concat!($($doc),+).trim_ascii();
                        const SHOWN: [u8; $crate::__shown_length(TEXT)] = $crate::__shown(TEXT);
                        match ::core::str::from_utf8(&SHOWN) {
                            Ok(shown) => shown,
                            Err(_) => TEXT,
                        }
                    },
                    unit: $crate::Unit::$unit,
                    range: $range,
                    optional: !concat!("" $(, stringify!($($serde)+))?).is_empty(),
                },)*
            ];

            fn each(&self, name: &str, f: &mut dyn FnMut(f64)) {
                match name {
                    $(stringify!($field) => $crate::Value::each(&self.$field, f),)*
                    _ => {}
                }
            }

            fn scale(&mut self, name: &str, factor: f64) -> bool {
                match name {
                    $(stringify!($field) => $crate::Value::scale(&mut self.$field, factor),)*
                    _ => return false,
                }
                true
            }

            fn set(&mut self, name: &str, value: f64) -> bool {
                match name {
                    $(stringify!($field) => $crate::Value::set(&mut self.$field, value),)*
                    _ => false,
                }
            }

            fn set_at(&mut self, name: &str, index: usize, value: f64) -> bool {
                match name {
                    $(stringify!($field) => $crate::Value::set_at(&mut self.$field, index, value),)*
                    _ => false,
                }
            }
        }
    };
}

/// How long `text` is without the backslashes that escape square brackets.
#[doc(hidden)]
#[must_use]
pub const fn __shown_length(text: &str) -> usize {
    let (text, mut length, mut i) = (text.as_bytes(), 0, 0);
    while i < text.len() {
        length += !is_escape(text, i) as usize;
        i += 1;
    }
    length
}

/// `text` without the backslashes that escape square brackets.
#[doc(hidden)]
#[must_use]
pub const fn __shown<const LENGTH: usize>(text: &str) -> [u8; LENGTH] {
    let (text, mut shown, mut length, mut i) = (text.as_bytes(), [0; LENGTH], 0, 0);
    while i < text.len() {
        if !is_escape(text, i) {
            shown[length] = text[i];
            length += 1;
        }
        i += 1;
    }
    shown
}

const fn is_escape(text: &[u8], i: usize) -> bool {
    text[i] == b'\\' && i + 1 < text.len() && matches!(text[i + 1], b'[' | b']')
}

/// Ties a model to its parameters, which it keeps in a field of that name: `From` gives them back,
/// and with the feature `serde` the model looks in files as they do.
///
/// `built_from!(Model, Parameters)`, or with generics `built_from!([const N: usize] Model<N>,
/// Parameters)`. The model implements `TryFrom<Parameters>`.
#[macro_export]
macro_rules! built_from {
    ($model:ident, $set:ident) => {
        $crate::built_from!([] $model, $set);
    };
    ([$($generics:tt)*] $model:ty, $set:ty) => {
        impl<$($generics)*> From<$model> for $set {
            fn from(model: $model) -> Self {
                model.parameters
            }
        }

        $crate::__with_serde! {
            {
                impl<$($generics)*> $crate::__serde::Serialize for $model {
                    fn serialize<S: $crate::__serde::Serializer>(
                        &self,
                        serializer: S,
                    ) -> Result<S::Ok, S::Error> {
                        $crate::__serde::Serialize::serialize(&self.parameters, serializer)
                    }
                }

                impl<'de, $($generics)*> $crate::__serde::Deserialize<'de> for $model {
                    fn deserialize<D: $crate::__serde::Deserializer<'de>>(
                        deserializer: D,
                    ) -> Result<Self, D::Error> {
                        let parameters =
                            <$set as $crate::__serde::Deserialize>::deserialize(deserializer)?;
                        parameters.try_into().map_err($crate::__serde::de::Error::custom)
                    }
                }
            }
            {}
        }
    };
}

/// The items of [`FrictionModel`](crate::FrictionModel) that are the same for every model without
/// states, which keeps its parameters in a field of that name: the fixed-step form is the steady
/// state, and so is the derivative form unless another method is named.
///
/// `memoryless!(Parameters)` or `memoryless!(Parameters, method)`, inside the `impl` of the trait.
#[macro_export]
macro_rules! memoryless {
    ([$real:ty] $set:ty) => {
        $crate::memoryless!([$real] $set, steady_state);
    };
    ($set:ty) => {
        $crate::memoryless!([f64] $set, steady_state);
    };
    ($set:ty, $force:ident) => {
        $crate::memoryless!([f64] $set, $force);
    };
    ([$real:ty] $set:ty, $force:ident) => {
        type Parameters = $set;
        type Continuous = [$real; 0];
        type Memory = ();
        type Discrete = ();

        fn parameters(&self) -> &$set {
            &self.parameters
        }

        fn rest(&self) -> $crate::State<[$real; 0], ()> {
            $crate::State { continuous: [], memory: () }
        }

        #[inline]
        fn evaluate(&self, _: &[$real; 0], (): &(), velocity: $real) -> $crate::Evaluation<[$real; 0], $real> {
            $crate::Evaluation { force: self.$force(velocity), rates: [] }
        }

        fn commit(&self, _: &mut $crate::State<[$real; 0], ()>, _: $real, _: $real) {}

        fn discretise(&self, _: $crate::TimeStep) {}

        #[inline]
        fn step(&self, (): &(), _: &mut $crate::State<[$real; 0], ()>, velocity: $real) -> $real {
            self.steady_state($crate::arithmetic::bounded(velocity))
        }

        #[inline]
        fn advance(&self, (): &(), _: &mut $crate::State<[$real; 0], ()>, _: $real, _: $real) {}

        #[inline]
        fn force(&self, _: &$crate::State<[$real; 0], ()>, velocity: $real) -> $real {
            self.steady_state($crate::arithmetic::bounded(velocity))
        }
    };
}

/// The methods `cast` and `translate` of a parameter set that is generic over its numbers.
#[doc(hidden)]
#[macro_export]
macro_rules! __cast {
    ($set:ident [] $($field:ident)*) => {};
    ($set:ident [$real:ident] $($field:ident)*) => {
        impl<$real: $crate::Real> $set<$real> {
            /// The same parameters in numbers of another precision.
            #[must_use]
            pub fn cast<To: $crate::Real>(self) -> $set<To> {
                self.translate(&mut |_, _, value| To::of(value.double()))
            }

            /// The same parameters in numbers of another kind: what `number` makes of a parameter's
            /// name, the place in its list (zero for one that is no list) and the value.
            #[must_use]
            pub fn translate<To: $crate::Real>(
                self,
                number: &mut dyn FnMut(&'static str, usize, $real) -> To,
            ) -> $set<To> {
                $set {
                    $($field: $crate::Translate::translate(
                        self.$field,
                        &mut |index, value| number(stringify!($field), index, value),
                    ),)*
                }
            }
        }
    };
}

/// The first of two pieces of code where the feature `serde` is on, the second where it is off: the
/// features of this crate, wherever the macro is used.
#[cfg(feature = "serde")]
#[doc(hidden)]
#[macro_export]
macro_rules! __with_serde {
    ({ $($with:tt)* } { $($without:tt)* }) => { $($with)* };
}

#[cfg(not(feature = "serde"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __with_serde {
    ({ $($with:tt)* } { $($without:tt)* }) => { $($without)* };
}
