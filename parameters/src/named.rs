//! Values of enums that know nothing of parameters.

use std::fmt::Display;
use std::str::FromStr;

use crate::{Declaration, Declared, ParameterValue, Spec, Values};

/// A value of an enum of another crate, which stands as its name: a model, a source. `choices(...)`
/// of its line says which of the names are taken.
///
/// ```
/// use std::net::IpAddr;
///
/// use parameters::{Declared, Named, parameters};
///
/// parameters! {
///     /// Where a node listens.
///     #[derive(Debug, Clone, PartialEq)]
///     pub struct Listener {
///         address: Named<IpAddr> = Named([127, 0, 0, 1].into()), "Where it listens",
///             choices(|| vec!["127.0.0.1", "::1"]);
///     }
/// }
/// assert_eq!(Listener::default().declarations()[0].allowed(), "one of 127.0.0.1, ::1");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Named<T>(pub T);

impl<T: FromStr + Display> Declared for Named<T> {
    fn declare(&self, name: &str, spec: &Spec, into: &mut Vec<Declaration>) {
        into.push(spec.declaration(name, ParameterValue::String(self.0.to_string())));
    }

    fn take(&mut self, name: &str, values: &Values) {
        // The choices of its line were held to before.
        if let Some(ParameterValue::String(text)) = values.get(name)
            && let Ok(value) = text.parse()
        {
            self.0 = value;
        }
    }

    fn give(&self, name: &str, into: &mut Values) {
        into.set(name, ParameterValue::String(self.0.to_string()));
    }
}
