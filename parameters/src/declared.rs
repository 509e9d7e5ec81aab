//! Structs whose fields are declared parameters, and what a field can be.

use std::fmt;

use crate::{Declaration, ParameterValue, Spec, ValueRange, Values};

/// A number of a declared struct lies outside its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutOfRange {
    /// The field.
    pub name: &'static str,
    /// What came.
    pub value: f64,
    /// What was expected.
    pub range: ValueRange,
}

impl OutOfRange {
    /// What was expected, in words.
    #[must_use]
    pub fn expected(&self) -> String {
        match self.range {
            ValueRange::Any => "a finite number".to_owned(),
            ValueRange::POSITIVE => "a finite number above zero".to_owned(),
            ValueRange::NON_NEGATIVE => "a finite number, zero or more".to_owned(),
            ValueRange::Double(low, high) => format!("from {low} to {high}"),
            ValueRange::Integer(low, high) => format!("a whole number from {low} to {high}"),
            ValueRange::Either(low, high) => format!("{high} or {low}"),
            ValueRange::NotZero => "a finite number other than zero".to_owned(),
        }
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} must be {}, but is {}", self.name, self.expected(), self.value)
    }
}

impl std::error::Error for OutOfRange {}

/// What a field of a declared struct can be: a value, or a struct that is declared itself, whose
/// parameters then have the field's name before theirs. [`parameters!`](crate::parameters)
/// implements it for structs, [`choices!`](crate::choices) for enums.
pub trait Declared {
    /// Adds the declaration, with the present value as the default.
    fn declare(&self, name: &str, spec: &Spec, into: &mut Vec<Declaration>);

    /// Becomes what `values` say; what they do not say stays.
    fn take(&mut self, name: &str, values: &Values);

    /// Adds the present value.
    fn give(&self, name: &str, into: &mut Values);

    /// Holds numbers to their range.
    ///
    /// # Errors
    /// [`OutOfRange`] for the first that lies outside.
    fn check_within(&self, name: &'static str, range: ValueRange) -> Result<(), OutOfRange> {
        let _ = (name, range);
        Ok(())
    }

    /// The declarations of a struct, in the order of its fields; the present values are the
    /// defaults.
    fn declarations(&self) -> Vec<Declaration> {
        let mut all = Vec::new();
        self.declare("", &Spec::default(), &mut all);
        all
    }

    /// A struct with what `values` say in place of its own.
    #[must_use]
    fn with(mut self, values: &Values) -> Self
    where
        Self: Sized,
    {
        self.take("", values);
        self
    }

    /// The present values of a struct.
    fn values(&self) -> Values {
        let mut all = Values::default();
        self.give("", &mut all);
        all
    }
}

/// A field's name behind that of its struct; for the macro.
#[doc(hidden)]
#[must_use]
pub fn joined(name: &str, field: &str) -> String {
    if name.is_empty() { field.to_owned() } else { format!("{name}.{field}") }
}

/// The same for a type that is one value of ROS 2: its kind, from it and to it.
macro_rules! plain {
    ($type:ty, $kind:ident, $from:expr, $to:expr, $check:expr) => {
        impl Declared for $type {
            fn declare(&self, name: &str, spec: &Spec, into: &mut Vec<Declaration>) {
                into.push(spec.declaration(name, ParameterValue::$kind($to(self))));
            }

            fn take(&mut self, name: &str, values: &Values) {
                if let Some(ParameterValue::$kind(value)) = values.get(name) {
                    *self = $from(value);
                }
            }

            fn give(&self, name: &str, into: &mut Values) {
                into.set(name, ParameterValue::$kind($to(self)));
            }

            fn check_within(
                &self,
                name: &'static str,
                range: ValueRange,
            ) -> Result<(), OutOfRange> {
                $check(self, name, range)
            }
        }
    };
}

fn real(value: &f64, name: &'static str, range: ValueRange) -> Result<(), OutOfRange> {
    if range.holds(*value) { Ok(()) } else { Err(OutOfRange { name, value: *value, range }) }
}

fn whole(value: i64, name: &'static str, range: ValueRange) -> Result<(), OutOfRange> {
    if range.holds_integer(value) {
        Ok(())
    } else {
        Err(OutOfRange { name, value: value as f64, range })
    }
}

fn any<T>(_: &T, _: &'static str, _: ValueRange) -> Result<(), OutOfRange> {
    Ok(())
}

plain!(f64, Double, |x: &f64| *x, |x: &f64| *x, real);
plain!(bool, Boolean, |x: &bool| *x, |x: &bool| *x, any);
plain!(i64, Integer, |x: &i64| *x, |x: &i64| *x, |x: &i64, n, r| whole(*x, n, r));
plain!(
    u32,
    Integer,
    |x: &i64| u32::try_from(*x).unwrap_or(if *x < 0 { 0 } else { u32::MAX }),
    |x: &u32| i64::from(*x),
    |x: &u32, n, r| whole(i64::from(*x), n, r)
);
plain!(String, String, |x: &String| x.clone(), |x: &String| x.clone(), any);

/// Declares structs of parameters: the name, type, default, unit, range and meaning of each stand
/// on one line, and from there come the struct, its checks, the declaration, and the values in and
/// out ([`Declared`]).
///
/// A line is `name: type = default, "meaning", what(...) ...;`, where `what` is a method of
/// [`Spec`]; a field without a meaning is a struct declared elsewhere. Where no field has a default
/// the struct has none.
///
/// ```
/// use parameters::{Declared, ValueRange, parameters};
///
/// parameters! {
///     /// Gains of a PI.
///     #[derive(Debug, Clone, Copy, PartialEq)]
///     pub struct PiGains {
///         k_p: f64, "Proportional gain K_p", unit("V s/rad"), range(ValueRange::POSITIVE);
///         k_i: f64, "Integral gain K_i", unit("V/rad"), range(ValueRange::NON_NEGATIVE);
///     }
/// }
///
/// parameters! {
///     /// Parameters of a node.
///     #[derive(Debug, Clone, PartialEq)]
///     pub struct NodeParameters {
///         pi: PiGains = PiGains { k_p: 1.5, k_i: 16.0 };
///         period: f64 = 0.001, "Period of the cycle", unit("s"),
///             range(ValueRange::Double(0.0001, 0.01)), read_only();
///     }
/// }
///
/// let declared = NodeParameters::default().declarations();
/// assert_eq!(declared[0].name(), "pi.k_p");
/// assert_eq!(declared[0].description(), "Proportional gain K_p [V s/rad]");
/// assert_eq!(declared[2].allowed(), "0.0001 to 0.01");
/// let wrong = PiGains { k_p: -1.0, k_i: 0.0 };
/// let said = wrong.check().unwrap_err().to_string();
/// assert_eq!(said, "k_p must be a finite number above zero, but is -1");
/// ```
#[macro_export]
macro_rules! parameters {
    (
        $(#[$outer:meta])*
        $vis:vis struct $name:ident {$(
            $(#[$inner:meta])*
            $field:ident : $type:ty = $default:expr
                $(, $meaning:literal $(, $what:ident($($how:expr),*))*)? ;
        )*}
    ) => {
        $crate::parameters! {
            $(#[$outer])*
            $vis struct $name {$(
                $(#[$inner])*
                $field: $type $(, $meaning $(, $what($($how),*))*)? ;
            )*}
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default),* }
            }
        }
    };
    (
        $(#[$outer:meta])*
        $vis:vis struct $name:ident {$(
            $(#[$inner:meta])*
            $field:ident : $type:ty
                $(, $meaning:literal $(, $what:ident($($how:expr),*))*)? ;
        )*}
    ) => {
        $(#[$outer])*
        $vis struct $name {$(
            #[doc = concat!(
                "Parameter `", stringify!($field), "`"
                $(, ": ", $meaning $(, " `", stringify!($what($($how),*)), "`")*)?
            )]
            $(#[$inner])*
            pub $field: $type,
        )*}

        impl $name {
            /// Holds every number to its range.
            ///
            /// # Errors
            /// The first that lies outside.
            $vis fn check(&self) -> Result<(), $crate::OutOfRange> {
                $crate::Declared::check_within(self, "", $crate::ValueRange::Any)
            }
        }

        impl $crate::Declared for $name {
            fn declare(
                &self,
                name: &str,
                _: &$crate::Spec,
                into: &mut Vec<$crate::Declaration>,
            ) {$(
                let spec = $crate::parameters!(@spec $($meaning $(, $what($($how),*))*)?);
                let name_of = $crate::joined(name, stringify!($field));
                $crate::Declared::declare(&self.$field, &name_of, &spec, into);
            )*}

            fn take(&mut self, name: &str, values: &$crate::Values) {$(
                let name_of = $crate::joined(name, stringify!($field));
                $crate::Declared::take(&mut self.$field, &name_of, values);
            )*}

            fn give(&self, name: &str, into: &mut $crate::Values) {$(
                let name_of = $crate::joined(name, stringify!($field));
                $crate::Declared::give(&self.$field, &name_of, into);
            )*}

            fn check_within(
                &self,
                _: &'static str,
                _: $crate::ValueRange,
            ) -> Result<(), $crate::OutOfRange> {
                $(
                    let spec = $crate::parameters!(@spec $($meaning $(, $what($($how),*))*)?);
                    let name_of = stringify!($field);
                    $crate::Declared::check_within(&self.$field, name_of, spec.allowed())?;
                )*
                Ok(())
            }
        }
    };
    (@spec) => { $crate::Spec::default() };
    (@spec $meaning:literal $(, $what:ident($($how:expr),*))*) => {
        $crate::Spec::new($meaning)$(.$what($($how),*))*
    };
}

/// Lets enums stand as fields of declared structs: they are texts, one of the names of the
/// variants. The enums derive `strum`'s `EnumString`, `IntoStaticStr` and `VariantNames`.
#[macro_export]
macro_rules! choices {
    ($($name:ty),* $(,)?) => {$(
        impl $crate::Declared for $name {
            fn declare(
                &self,
                name: &str,
                spec: &$crate::Spec,
                into: &mut Vec<$crate::Declaration>,
            ) {
                let chosen: &'static str = self.into();
                let default = $crate::ParameterValue::String(chosen.to_owned());
                let names = <$name as $crate::strum::VariantNames>::VARIANTS;
                into.push(spec.declaration(name, default).choices(names));
            }

            fn take(&mut self, name: &str, values: &$crate::Values) {
                if let Some($crate::ParameterValue::String(text)) = values.get(name)
                    && let Ok(chosen) = text.parse()
                {
                    *self = chosen;
                }
            }

            fn give(&self, name: &str, into: &mut $crate::Values) {
                let chosen: &'static str = self.into();
                into.set(name, $crate::ParameterValue::String(chosen.to_owned()));
            }
        }
    )*};
}
