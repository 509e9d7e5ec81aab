//! A short list of numbers that lives in place: parameters of models with several elements.

use core::ops::{Deref, DerefMut};

use crate::{ModelError, Range, Real, Translate, Unit, Value};

/// Up to `CAPACITY` numbers, stored in place so that models stay plain values that can be copied.
#[derive(Clone, Copy)]
pub struct Elements<const CAPACITY: usize = 16, T: Real = f64> {
    length: usize,
    values: [T; CAPACITY],
}

impl<const CAPACITY: usize, T: Real> Elements<CAPACITY, T> {
    /// The numbers of `values`; `None` if there are more than `CAPACITY`.
    #[must_use]
    pub fn from_slice(values: &[T]) -> Option<Self> {
        let mut list = Self { length: values.len(), values: [T::ZERO; CAPACITY] };
        list.values.get_mut(..values.len())?.copy_from_slice(values);
        Some(list)
    }

    /// `length` numbers, at most `CAPACITY`, each computed from its index.
    #[must_use]
    pub fn from_fn(length: usize, f: impl FnMut(usize) -> T) -> Self {
        Self { length: length.min(CAPACITY), values: core::array::from_fn(f) }
    }
}

impl<const N: usize, const CAPACITY: usize, T: Real> From<[T; N]> for Elements<CAPACITY, T> {
    /// The array's numbers, as many as there is room for.
    fn from(values: [T; N]) -> Self {
        Self::from_fn(N, |i| values.get(i).copied().unwrap_or(T::ZERO))
    }
}

impl<const CAPACITY: usize, T: Real> Deref for Elements<CAPACITY, T> {
    type Target = [T];
    fn deref(&self) -> &[T] {
        self.values.get(..self.length).unwrap_or(&self.values)
    }
}

impl<const CAPACITY: usize, T: Real> DerefMut for Elements<CAPACITY, T> {
    fn deref_mut(&mut self) -> &mut [T] {
        let length = self.length.min(CAPACITY);
        &mut self.values[..length]
    }
}

impl<const CAPACITY: usize, T: Real> core::fmt::Debug for Elements<CAPACITY, T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

impl<const CAPACITY: usize, T: Real> PartialEq for Elements<CAPACITY, T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<const CAPACITY: usize, T: Real, U: Real> Translate<T, U> for Elements<CAPACITY, T> {
    type Into = Elements<CAPACITY, U>;
    fn translate(self, number: &mut dyn FnMut(usize, T) -> U) -> Self::Into {
        let mut translated = Elements { length: self.length, values: [U::ZERO; CAPACITY] };
        for (index, (to, from)) in translated.iter_mut().zip(self.iter()).enumerate() {
            *to = number(index, *from);
        }
        translated
    }
}

impl<const CAPACITY: usize, T: Real> Value for Elements<CAPACITY, T> {
    fn each(&self, f: &mut dyn FnMut(f64)) {
        self.iter().for_each(|value| f(value.double()));
    }
    fn scale(&mut self, factor: f64) {
        self.iter_mut().for_each(|value| value.scale(factor));
    }
    fn set(&mut self, _: f64) -> bool {
        false
    }
    fn set_at(&mut self, index: usize, value: f64) -> bool {
        self.get_mut(index).map(|place| *place = T::of(value)).is_some()
    }
}

/// In files, a list of numbers.
#[cfg(feature = "serde")]
mod in_files {
    use core::marker::PhantomData;

    use serde::de::{Error, SeqAccess, Visitor};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Elements;
    use crate::Real;

    impl<const CAPACITY: usize, T: Real> Serialize for Elements<CAPACITY, T> {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            serializer.collect_seq(self.iter())
        }
    }

    impl<'de, const CAPACITY: usize, T: Real> Deserialize<'de> for Elements<CAPACITY, T> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            struct List<const CAPACITY: usize, T>(PhantomData<T>);

            impl<'de, const CAPACITY: usize, T: Real> Visitor<'de> for List<CAPACITY, T> {
                type Value = Elements<CAPACITY, T>;

                fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                    write!(f, "a list of at most {CAPACITY} numbers")
                }

                fn visit_seq<A: SeqAccess<'de>>(
                    self,
                    mut list: A,
                ) -> Result<Self::Value, A::Error> {
                    let mut elements = Elements { length: 0, values: [T::ZERO; CAPACITY] };
                    while let Some(value) = list.next_element()? {
                        let Some(place) = elements.values.get_mut(elements.length) else {
                            return Err(A::Error::invalid_length(elements.length + 1, &self));
                        };
                        *place = value;
                        elements.length += 1;
                    }
                    Ok(elements)
                }
            }

            deserializer.deserialize_seq(List(PhantomData))
        }
    }
}

/// Checks the lists of a model with elements: the shares sum to 1, there is room for all of them,
/// and every other list is as long.
///
/// Printed shares are rounded, so their sum may be off by a thousandth.
pub(crate) fn check<T: Real>(
    model: &'static str,
    room: usize,
    shares: &'static str,
    share: &[T],
    others: &[(&'static str, &[T])],
) -> Result<(), ModelError> {
    let length =
        |parameter, given, expected| ModelError::Elements { model, parameter, given, expected };
    if share.is_empty() || share.len() > room {
        return Err(length(shares, share.len(), if share.is_empty() { 1 } else { room }));
    }
    for (parameter, list) in others {
        if list.len() != share.len() {
            return Err(length(*parameter, list.len(), share.len()));
        }
    }
    let sum: T = share.iter().copied().sum();
    if (sum - T::ONE).abs() > T::of(1e-3) {
        let expected = Range::Such("such that all sum to 1 (the value given is their sum)");
        return Err(ModelError::OutOfRange {
            model,
            parameter: shares,
            value: sum.double(),
            unit: Unit::None,
            expected,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_reads_back_and_a_longer_one_is_refused() {
        let list = Elements::<4>::from([1.0, 2.5]);
        assert_eq!(serde_json::to_string(&list).unwrap(), "[1.0,2.5]");
        assert_eq!(serde_json::from_str::<Elements<4>>("[1.0,2.5]").unwrap(), list);
        let message = serde_json::from_str::<Elements<2>>("[1, 2, 3]").unwrap_err().to_string();
        assert!(message.contains("at most 2 numbers"), "{message}");
        assert_eq!(Elements::<2>::from_slice(&[1.0, 2.0, 3.0]), None);
    }
}
