//! The parameters of a node with their values, and the rules by which they change.

use std::collections::{BTreeMap, BTreeSet};

use ::parameters::{Declaration, ParameterError, ParameterValue, Values, nearest};
use ros2_client::parameters::{ParameterType, raw};

use super::wire;
use crate::limits::quoted;

/// Judges values as a whole before they count, and takes them over if they are good: the values,
/// and the names of those that change. The text of its error is the reason that people read.
pub type Judge = Box<dyn FnMut(&Values, &BTreeSet<String>) -> Result<(), ParameterError> + Send>;

/// Values that cannot be at the start.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StoreError {
    /// One of them cannot be.
    #[error("{name}: {error}")]
    Value {
        /// The parameter.
        name: String,
        /// Why not.
        error: ParameterError,
    },
    /// They do not go together.
    #[error("{0}")]
    Together(ParameterError),
}

/// One value to set.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The parameter.
    pub name: String,
    /// Its new value.
    pub value: ParameterValue,
}

/// Declared parameters with their values.
pub struct ParameterStore {
    declared: BTreeMap<String, Declaration>,
    values: Values,
    judge: Judge,
}

impl ParameterStore {
    /// Declares parameters, with `given` values in place of the defaults. Those of `given` that are
    /// not declared are left out, see [`undeclared`](Self::undeclared).
    ///
    /// # Errors
    /// [`StoreError`] for the first value that cannot be, or if they do not go together.
    pub fn new(
        declared: Vec<Declaration>,
        given: &BTreeMap<String, ParameterValue>,
        mut judge: Judge,
    ) -> Result<Self, StoreError> {
        let mut values = Values::default();
        for parameter in &declared {
            let name = parameter.name().to_owned();
            let value = match given.get(&name) {
                None => parameter.default_value().clone(),
                Some(value) => parameter
                    .accept(value)
                    .map_err(|error| StoreError::Value { name: name.clone(), error })?,
            };
            values.set(name, value);
        }
        let all = values.iter().map(|(name, _)| name.to_owned()).collect();
        judge(&values, &all).map_err(StoreError::Together)?;
        let named = |parameter: Declaration| (parameter.name().to_owned(), parameter);
        let declared = declared.into_iter().map(named).collect();
        Ok(Self { declared, values, judge })
    }

    /// Names in `given` that nobody declared, each with the declared one that looks most like it.
    #[must_use]
    pub fn undeclared<'a>(
        &'a self,
        given: &'a BTreeMap<String, ParameterValue>,
    ) -> Vec<(&'a str, Option<&'a str>)> {
        let unknown =
            given.keys().map(String::as_str).filter(|name| !self.declared.contains_key(*name));
        let known = || self.declared.keys().map(String::as_str);
        unknown.map(|name| (name, nearest(name, known()))).collect()
    }

    /// The values.
    #[must_use]
    pub const fn values(&self) -> &Values {
        &self.values
    }

    /// Sets all of `changes` or none.
    ///
    /// # Errors
    /// [`ParameterError`]; its text is for people.
    pub fn set(&mut self, changes: &[Change]) -> Result<(), ParameterError> {
        let mut candidate = self.values.clone();
        let mut changed = BTreeSet::new();
        for Change { name, value } in changes {
            let parameter = self.declared.get(name).ok_or_else(|| {
                ParameterError::refused(format!(
                    "parameter '{}' cannot be set because it was not declared",
                    quoted(name)
                ))
            })?;
            if parameter.is_read_only() {
                return Err(ParameterError::ReadOnly { name: name.clone() });
            }
            candidate.set(name.clone(), parameter.accept(value)?);
            changed.insert(name.clone());
        }
        (self.judge)(&candidate, &changed)?;
        self.values = candidate;
        Ok(())
    }

    /// Names by prefix and depth, as `list_parameters` has it: depth 0 for all of them, else at
    /// most so many names joined by dots behind the prefix; and the prefixes of what is listed.
    #[must_use]
    pub fn list(&self, prefixes: &[String], depth: u64) -> (Vec<String>, Vec<String>) {
        let shallow = |rest: &str| depth == 0 || (rest.matches('.').count() as u64) < depth;
        let names: Vec<String> = self
            .values
            .iter()
            .map(|(name, _)| name)
            .filter(|name| {
                if prefixes.is_empty() {
                    return shallow(name);
                }
                prefixes.iter().any(|prefix| {
                    name.strip_prefix(prefix.as_str()).is_some_and(|rest| {
                        rest.is_empty() || (rest.starts_with('.') && shallow(rest))
                    })
                })
            })
            .map(str::to_owned)
            .collect();
        let found: BTreeSet<String> = names
            .iter()
            .filter_map(|name| name.rsplit_once('.'))
            .map(|(prefix, _)| prefix.to_owned())
            .collect();
        (names, found.into_iter().collect())
    }

    /// A value as it travels; not set for what is not declared.
    pub(super) fn raw(&self, name: &str) -> raw::ParameterValue {
        wire::to_raw(self.values.get(name).cloned().unwrap_or(ParameterValue::NotSet))
    }

    /// A type as it travels.
    pub(super) fn kind(&self, name: &str) -> u8 {
        self.values.get(name).map_or(ParameterType::NotSet as u8, |value| wire::kind(value) as u8)
    }

    /// A descriptor as it travels; of type not set for what is not declared.
    pub(super) fn describe(&self, name: &str) -> raw::ParameterDescriptor {
        self.declared.get(name).map_or_else(
            || raw::ParameterDescriptor {
                name: name.to_owned(),
                r#type: raw::ParameterType::NOT_SET,
                description: String::new(),
                additional_constraints: String::new(),
                read_only: false,
                dynamic_typing: false,
                floating_point_range: Vec::new(),
                integer_range: Vec::new(),
            },
            wire::descriptor,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::parameters::ValueRange;
    use ParameterValue as V;

    fn store() -> ParameterStore {
        let declared = vec![
            Declaration::double("lag.k_p", 1.5, "gain").range(ValueRange::Double(0.0, 100.0)),
            Declaration::double("lag.t_i", 0.1, "time"),
            Declaration::integer("seed", 1, "seed").range(ValueRange::Integer(0, 9)),
            Declaration::text("mode", "velocity", "mode").choices(["velocity", "position"]),
            Declaration::boolean("fixed", true, "fixed").read_only(),
        ];
        let judge = |values: &Values, _: &BTreeSet<String>| {
            if values.double("lag.k_p") > values.double("lag.t_i") * 1000.0 {
                return Err(ParameterError::refused("too steep"));
            }
            Ok(())
        };
        ParameterStore::new(declared, &BTreeMap::new(), Box::new(judge)).unwrap()
    }

    fn change(name: &str, value: V) -> Change {
        Change { name: name.into(), value }
    }

    #[test]
    fn what_cannot_be_is_refused_with_a_reason_and_changes_nothing() {
        let mut store = store();
        for (name, value, reason) in [
            ("lag.k_p", V::Double(-1.0), "0 to 100"),
            ("lag.k_p", V::Double(f64::NAN), "0 to 100"),
            ("lag.t_i", V::Double(f64::INFINITY), "finite"),
            ("lag.k_p", V::Integer(2), "write 2.0"),
            ("lag.k_p", V::NotSet, "cannot be deleted"),
            ("lag.t_i", V::Double(1e-6), "too steep"),
            ("seed", V::Integer(10), "0 to 9"),
            ("mode", V::String("speed".into()), "velocity, position"),
            ("fixed", V::Boolean(false), "read-only"),
            ("other", V::Boolean(false), "not declared"),
        ] {
            let before = store.values().clone();
            let said =
                store.set(&[change("seed", V::Integer(5)), change(name, value)]).unwrap_err();
            let said = said.to_string();
            assert!(said.contains(reason), "{name}: {said}");
            assert_eq!(*store.values(), before, "a set is whole or nothing");
        }
        store
            .set(&[change("lag.t_i", V::Double(1e-5)), change("lag.k_p", V::Double(0.0))])
            .unwrap();
        assert_eq!(store.values().double("lag.t_i"), 1e-5);
    }

    #[test]
    fn values_given_at_the_start_are_held_to_the_same_rules() {
        let declared = || {
            vec![Declaration::double("a", 1.0, "").range(ValueRange::Double(0.0, 2.0)).read_only()]
        };
        let given =
            |value| BTreeMap::from([("a".to_owned(), value), ("b".to_owned(), V::Integer(1))]);
        let good = ParameterStore::new(declared(), &given(V::Double(2.0)), Box::new(|_, _| Ok(())))
            .unwrap();
        assert_eq!(good.values().double("a"), 2.0);
        assert_eq!(good.undeclared(&given(V::Double(2.0))), [("b", None)]);
        let bad = ParameterStore::new(declared(), &given(V::Double(3.0)), Box::new(|_, _| Ok(())));
        assert!(matches!(bad.err().unwrap(), StoreError::Value { name, .. } if name == "a"));
    }

    /// The cases of rclcpp's `test_node.cpp`, `list_parameters`.
    #[test]
    fn lists_go_by_prefix_and_depth() {
        let store = store();
        let names = |prefixes: &[&str], depth| {
            store.list(&prefixes.iter().map(|p| (*p).to_owned()).collect::<Vec<_>>(), depth).0
        };
        assert_eq!(names(&[], 0), ["fixed", "lag.k_p", "lag.t_i", "mode", "seed"]);
        assert_eq!(names(&[], 1), ["fixed", "mode", "seed"]);
        assert_eq!(names(&["lag"], 0), ["lag.k_p", "lag.t_i"]);
        assert_eq!(names(&["lag"], 1), Vec::<String>::new());
        assert_eq!(names(&["lag"], 2), ["lag.k_p", "lag.t_i"]);
        assert_eq!(names(&["la"], 0), Vec::<String>::new());
        assert_eq!(names(&["mode"], 1), ["mode"]);
        assert_eq!(store.list(&[], 0).1, ["lag"]);
    }

    #[test]
    fn descriptors_carry_range_and_words() {
        let store = store();
        let gain = store.describe("lag.k_p");
        assert_eq!((gain.r#type, gain.description.as_str()), (3, "gain"));
        assert_eq!(
            (gain.floating_point_range[0].from_value, gain.floating_point_range[0].to_value),
            (0.0, 100.0)
        );
        assert_eq!(store.describe("seed").integer_range[0].to_value, 9);
        assert_eq!(store.describe("mode").additional_constraints, "one of velocity, position");
        assert!(store.describe("fixed").read_only);
        assert_eq!(store.describe("x").r#type, 0);
    }

    #[test]
    fn a_range_without_a_limit_is_told_in_words_and_not_as_the_largest_number() {
        let declared = vec![
            Declaration::double("stiffness", 1.0, "").range(ValueRange::POSITIVE),
            Declaration::double("level", 1.0, "").range(ValueRange::NON_NEGATIVE).constraint("odd"),
            Declaration::integer("seed", 1, "").range(ValueRange::Integer(0, i64::MAX)),
        ];
        let store =
            ParameterStore::new(declared, &BTreeMap::new(), Box::new(|_, _| Ok(()))).unwrap();
        for (name, words) in
            [("stiffness", "above 0"), ("level", "at least 0; odd"), ("seed", "at least 0")]
        {
            let described = store.describe(name);
            assert!(
                described.floating_point_range.is_empty() && described.integer_range.is_empty()
            );
            assert_eq!(described.additional_constraints, words);
        }
    }
}
