//! Messages with a different value in every field, by a rule that `tests/python/cdr_peer.py` knows
//! too.

use serde::de::{self, DeserializeOwned, DeserializeSeed, Deserializer, SeqAccess, Visitor};

/// A message in which every primitive, in order, has the next number n, from 1: a boolean is n odd;
/// an integer n; a float n + 0.25, negative where n is even; a string `text n ü`; a sequence has
/// two elements. The byte of a type without fields is 0.
///
/// # Panics
/// For a type that is no message.
pub fn filled<M: DeserializeOwned>() -> M {
    M::deserialize(&mut Filler { number: 0, empty: false }).expect("a message is made of these")
}

struct Filler {
    number: u8,
    /// The field is the one of a type without fields.
    empty: bool,
}

impl Filler {
    fn next(&mut self) -> u8 {
        self.number += u8::from(!self.empty);
        if self.empty { 0 } else { self.number }
    }

    fn float(&mut self) -> f64 {
        let n = self.next();
        (f64::from(n) + 0.25) * if n % 2 == 1 { 1.0 } else { -1.0 }
    }
}

macro_rules! primitive {
    ($($method:ident $visit:ident |$filler:ident| $value:expr;)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
            let $filler = self;
            visitor.$visit($value)
        })*
    };
}

impl<'de> Deserializer<'de> for &mut Filler {
    type Error = de::value::Error;

    primitive! {
        deserialize_bool visit_bool |filler| filler.next() % 2 == 1;
        deserialize_u8 visit_u8 |filler| filler.next();
        deserialize_i32 visit_i32 |filler| filler.next().into();
        deserialize_u32 visit_u32 |filler| filler.next().into();
        deserialize_i64 visit_i64 |filler| filler.next().into();
        deserialize_u64 visit_u64 |filler| filler.next().into();
        deserialize_f64 visit_f64 |filler| filler.float();
        deserialize_string visit_string |filler| format!("text {} ü", filler.next());
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Self::Error> {
        self.empty = fields == ["structure_needs_at_least_one_member"];
        visitor.visit_seq(Elements { filler: self, left: fields.len() })
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        visitor.visit_seq(Elements { filler: self, left: 2 })
    }

    fn deserialize_any<V: Visitor<'de>>(self, _visitor: V) -> Result<V::Value, Self::Error> {
        Err(de::Error::custom("messages have nothing of this kind"))
    }

    serde::forward_to_deserialize_any! {
        i8 i16 i128 u16 u128 f32 char str bytes byte_buf option unit unit_struct newtype_struct tuple tuple_struct map enum
        identifier ignored_any
    }
}

struct Elements<'a> {
    filler: &'a mut Filler,
    left: usize,
}

impl<'de> SeqAccess<'de> for Elements<'_> {
    type Error = de::value::Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Self::Error> {
        let Some(left) = self.left.checked_sub(1) else { return Ok(None) };
        self.left = left;
        seed.deserialize(&mut *self.filler).map(Some)
    }
}
